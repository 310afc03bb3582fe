//! The fitted weights of suspicion.
//!
//! Made by `cargo xtask bench suspicion --fit`; the same command without `--fit` measures them on other clips.

use super::{Weight, Weights};

const fn weight(slope: f64, missing: f64, ordinary: f64) -> Weight {
    Weight { slope, missing, ordinary }
}

/// Of trackers that know the feature from the frame before.
pub(super) const STEPWISE: Weights = Weights {
    base: -16.0036,
    parts: [
        weight(0.5690, 0.8872, 0.1096),
        weight(3.2902, 2.6745, 0.6887),
        weight(0.8992, 1.4241, 1.3400),
        weight(1.1710, 3.0726, 2.1793),
        weight(0.4250, 0.9278, 1.4822),
        weight(0.0000, 0.0000, 0.0000),
        weight(3.4905, 7.1751, 1.2364),
    ],
    track: [0.3678, 1.0352],
};

/// Of trackers that know it as its key-frame shows it.
pub(super) const ANCHORED: Weights = Weights {
    base: -9.7016,
    parts: [
        weight(0.1465, 0.5065, 1.7193),
        weight(2.7331, 1.6345, 0.5416),
        weight(0.9179, 1.1858, 1.4595),
        weight(0.7371, 1.3913, 2.0743),
        weight(0.2397, 0.1186, 2.3888),
        weight(7.3758, 2.0588, 0.1604),
        weight(0.0000, 0.0000, 0.0000),
    ],
    track: [0.3065, 0.9970],
};
