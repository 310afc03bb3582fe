//! The fitted weights of suspicion.
//!
//! Made by `cargo xtask bench suspicion --fit`; the same command without `--fit` measures them on other clips.

use super::{Weight, Weights};

const fn weight(slope: f64, missing: f64, ordinary: f64) -> Weight {
    Weight { slope, missing, ordinary }
}

/// Of trackers that know the feature from the frame before.
pub(super) const STEPWISE: Weights = Weights {
    base: -16.7523,
    parts: [
        weight(0.5526, 0.8984, 0.1073),
        weight(3.2667, 2.6781, 0.6890),
        weight(0.8973, 1.3885, 1.3406),
        weight(1.1011, 2.9484, 2.1807),
        weight(0.4137, 0.9073, 1.4820),
        weight(0.0000, 0.0000, 0.0000),
        weight(3.6623, 7.5005, 1.2399),
        weight(0.2720, 0.6458, 2.3405),
    ],
    track: [0.3928, 1.0320],
};

/// Of trackers that know it as its key-frame shows it.
pub(super) const ANCHORED: Weights = Weights {
    base: -9.5882,
    parts: [
        weight(0.1289, 0.7148, 1.7235),
        weight(2.7174, 1.6931, 0.5461),
        weight(0.8813, 1.1938, 1.4660),
        weight(0.5702, 1.2538, 2.0830),
        weight(0.2366, 0.1802, 2.4038),
        weight(6.8945, 2.2033, 0.1641),
        weight(0.0000, 0.0000, 0.0000),
        weight(0.1489, 0.2173, 2.1408),
    ],
    track: [0.5268, 0.9745],
};
