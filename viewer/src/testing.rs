//! What tests of pictures have in common.

#[expect(unreachable_pub, reason = "an example has it, too")]
mod forest;

pub(crate) use forest::forest;

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

/// Of an image that is compared with a kept one: so much of a colour may be off, of 255, without being counted, and so large a
/// share of pixels may be. Adapters round edges differently; a tree that stands a pixel beside is well beyond it.
const OFF: u8 = 20;
const SHARE: f64 = 0.006;

/// The share of pixels that are another's.
pub(crate) fn unlike(a: &[[u8; 3]], b: &[[u8; 3]]) -> f64 {
    let is_off = |(a, b): &(&[u8; 3], &[u8; 3])| (0..3).any(|k| a[k].abs_diff(b[k]) > OFF);
    a.iter().zip(b).filter(is_off).count() as f64 / a.len().max(b.len()) as f64
}

/// Whether two images are alike but for what adapters do differently.
pub(crate) fn is_alike(a: &[[u8; 3]], b: &[[u8; 3]]) -> bool {
    a.len() == b.len() && unlike(a, b) <= SHARE
}

/// The kept image of a name, of a width; with `REGENERATE=1` it is these pixels from now on.
pub(crate) fn truth(name: &str, pixels: &[[u8; 3]], width: u32) -> Vec<[u8; 3]> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/truth/{name}.png"));
    if std::env::var_os("REGENERATE").is_some_and(|value| value == "1") {
        honami_media::write::still(&path, pixels, width, pixels.len() as u32 / width).unwrap();
    }
    let image = image::open(&path).unwrap().to_rgb8();
    assert_eq!(image.width(), width, "{}", path.display());
    image.pixels().map(|pixel| pixel.0).collect()
}
