//! The instruction set that the fast kernels use, asked of the processor once.

use std::sync::OnceLock;

/// An instruction set that this processor has.
///
/// Values come only from [`best`] and [`available`], after the processor was asked: holding one is the proof
/// that its kernels may run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Level(Set);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Set {
    Scalar,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Level {
    /// Name for the provenance of a result: `scalar`, `avx2` or `avx512`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.0 {
            Set::Scalar => "scalar",
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => "avx512",
        }
    }

    pub(crate) fn set(self) -> Set {
        self.0
    }
}

/// Every level that runs here, slowest first.
pub fn available() -> impl Iterator<Item = Level> {
    let mut levels = vec![Level(Set::Scalar)];
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx2") {
            levels.push(Level(Set::Avx2));
        }
        if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512bw") {
            levels.push(Level(Set::Avx512));
        }
    }
    levels.into_iter()
}

/// The fastest level of this processor.
#[must_use]
pub fn best() -> Level {
    static BEST: OnceLock<Level> = OnceLock::new();
    *BEST.get_or_init(|| available().last().unwrap_or(Level(Set::Scalar)))
}

/// Name of the level that the kernels use, for the provenance of a result.
#[must_use]
pub fn level() -> &'static str {
    best().name()
}
