//! The fitted weights of suspicion.
//!
//! Made by `cargo xtask bench suspicion --fit`; the same command without `--fit` measures them on other clips.

use super::{Weight, Weights};

/// The weights in use.
pub const WEIGHTS: Weights = Weights {
    base: -9.4254,
    parts: [
        Weight { slope: 0.4198, missing: 0.4726 },
        Weight { slope: 3.6558, missing: 2.8875 },
        Weight { slope: 0.9695, missing: 1.4753 },
        Weight { slope: 1.7647, missing: 3.9358 },
        Weight { slope: 0.1903, missing: 0.3712 },
    ],
    track: [0.4566, 1.0486],
};
