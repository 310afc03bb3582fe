//! A small forest for tests.

use honami_mechanics::{
    Beams, Damping, Drag, Form, Integrator, Modes, Options, Pace, Stand, Stirring, WindBasis,
};
use honami_model::plant::{Node, Plant};

use crate::body::{Body, Foliage};
use crate::{ForestScene, Orbit};

/// A stem of 4 m with a twig from each node, in so many copies, 3 m apart in a row.
pub(crate) fn forest(n_copies: usize, wind: &str) -> ForestScene {
    let node = |parent, position, radius| Node { parent, position, radius };
    let mut nodes = vec![node(None, [0.0; 3], 0.04)];
    let mut stem = 0;
    for k in 1..=20 {
        let (z, side) = (0.2 * f64::from(k), if k % 2 == 0 { 1.0 } else { -1.0 });
        nodes.push(node(Some(stem), [0.0, 0.0, z], 0.04 - 0.0015 * f64::from(k)));
        stem = nodes.len() as u32 - 1;
        nodes.push(node(Some(stem), [0.5 * side, 0.1, z + 0.3], 0.004));
    }
    let beams = Beams::new(&Plant::new(nodes).unwrap(), &Options::default()).unwrap();
    let modes = Modes::new(&beams, 6, 1).unwrap();
    let basis = WindBasis::new(&beams, &modes, &Drag::default());
    let pace = Pace { step: 0.04, integrator: Integrator::Exact, damping: Damping::default() };
    let stand = |k: usize| Stand { turn: k as f32, ..Stand::default() };
    ForestScene {
        name: "twigs".to_owned(),
        stirring: Stirring::new(&beams, &modes, basis, Form::Turn),
        body: Body::new(&beams, modes.len(), &Foliage { per_end: 5, length: 0.2, seed: 1 }),
        places: (0..n_copies).map(|k| [3.0 * k as f32, 0.0]).collect(),
        stands: (0..n_copies).map(stand).collect(),
        kilograms: beams.kilograms(),
        pace,
        wind: wind.to_owned(),
        run_in: 2.0,
        orbit: Orbit { target: [0.0, 0.0, 2.0], distance: 12.0, azimuth: 0.0, elevation: 0.05, angle: 0.6 },
    }
}
