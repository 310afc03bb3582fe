//! A forest to try things on.

use honami_mechanics::{Beams, Damping, Drag, Form, Integrator, Modes, Options, Pace, Stirring, WindBasis};
use honami_scene::body::{Body, Foliage};
use honami_scene::grove::{Grove, Planting};
use honami_scene::{ForestScene, Orbit};

/// Copies of a tree of so many nodes with so many modes in a storm, from the side.
pub fn forest(n_nodes: usize, n_modes: usize, n_copies: usize) -> ForestScene {
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
