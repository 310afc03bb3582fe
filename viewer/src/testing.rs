//! What tests of pictures have in common.

use honami_mechanics::{Beams, Damping, Drag, Form, Integrator, Modes, Options, Pace, Stirring, WindBasis};
use honami_scene::body::{Body, Foliage};
use honami_scene::grove::{Grove, Planting};
use honami_scene::{ForestScene, Orbit};

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

/// Copies of a tree of so many nodes with so many modes in a storm, from the side.
pub(crate) fn forest(n_nodes: usize, n_modes: usize, n_copies: usize) -> ForestScene {
    let plant = honami_synth::tree(n_nodes, 1).unwrap();
    let beams = Beams::new(&plant, &Options::default()).unwrap();
    let modes = Modes::new(&beams, n_modes, 1).unwrap();
    let basis = WindBasis::new(&beams, &modes, &Drag::default());
    let stirring = Stirring::new(&beams, &modes, basis, Form::Turn);
    let body = Body::new(&beams, n_modes, &Foliage::usual(&beams));
    let planting = Planting { n_copies, size_spread: 0.3, mass_spread: 0.2, spacing: None, seed: 7 };
    let height = stirring.height();
    let grove = Grove::new(height, &planting);
    let side = (n_copies as f64).sqrt().ceil() - 1.0;
    let middle = (0.4 * height * side) as f32;
    let target = [middle, middle, 0.45 * height as f32];
    ForestScene {
        name: "a tree".to_owned(),
        body,
        places: grove.places.iter().map(|at| [at.x as f32, at.y as f32]).collect(),
        stands: grove.stands,
        kilograms: 300.0,
        pace: Pace {
            step: 0.02,
            integrator: Integrator::Exact,
            damping: Damping { alpha: 0.3, beta: 0.008, mass: 1.0, air: 1.0 },
        },
        wind: "noise:speed=14".to_owned(),
        run_in: 2.0,
        orbit: Orbit {
            target,
            distance: (1.7 + 0.6 * side as f32) * height as f32,
            azimuth: 0.4,
            elevation: 0.14,
            angle: 0.7,
        },
        stirring,
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
