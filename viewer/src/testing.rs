//! What tests of pictures have in common.

use crate::gpu::{Gpu, GpuError};

/// The best adapter; `None`, which is told, where there is none, which `HONAMI_SKIP=never` forbids.
#[track_caller]
pub(crate) fn gpu() -> Option<Gpu> {
    match Gpu::open(None) {
        Ok(gpu) => Some(gpu),
        Err(GpuError::None) => {
            let never = std::env::var_os("HONAMI_SKIP").is_some_and(|value| value == "never");
            assert!(!never, "there is nothing to draw with, and HONAMI_SKIP=never forbids to do without");
            std::io::Write::write_all(&mut std::io::stderr(), b"skipped: needs something to draw with\n")
                .unwrap();
            None
        }
        Err(error) => panic!("{error}"),
    }
}
