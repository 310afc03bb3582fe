//! Forests against one plant alone, against statics, and against what they may take.

use super::{Detail, Forest, ForestError, Kind, Pace, Stand, View};
use crate::wind::{Constant, Noise, Wind};
use crate::{Beams, Damping, Drag, Form, Integrator, Modes, Options, Stirring, Threads, WindBasis};
use nalgebra::Vector3;
use std::f64::consts::PI;

const ROOMY: usize = 1 << 30;
const PACE: Pace = Pace { step: 0.02, integrator: Integrator::Exact };

fn plant(n_nodes: usize, n_modes: usize, form: Form) -> Stirring {
    let beams = Beams::new(&honami_synth::tree(n_nodes, 1).unwrap(), &Options::default()).unwrap();
    let modes = Modes::new(&beams, n_modes, 1).unwrap();
    let basis = WindBasis::new(&beams, &modes, &Drag::default());
    Stirring::new(&beams, &modes, basis, form)
}

fn threads(n: usize) -> Threads {
    Threads::new(n).unwrap()
}

fn grid(n: usize) -> Vec<Stand> {
    let side = (n as f64).sqrt().ceil() as usize;
    let at = |k: usize| Stand {
        place: [(k % side) as f32 * 10.0, (k / side) as f32 * 10.0, 0.0],
        turn: k as f32 * 0.7,
        kind: (k % 2) as u32,
    };
    (0..n).map(at).collect()
}

fn kinds() -> [Kind; 2] {
    [Kind::default(), Kind { scale: 1.3, damping: Damping { mass: 1.5, ..Damping::default() } }]
}

fn forest<'a>(plant: &'a Stirring, stands: Vec<Stand>, details: &[Detail]) -> Forest<'a> {
    Forest::new(plant, stands, &kinds(), &PACE, details, ROOMY).unwrap()
}

/// Damped to rest in a steady wind, modes are where statics puts them: f / omega^2, whatever the size and the mass.
#[test]
fn in_a_steady_wind_every_copy_comes_to_rest_bent_alike() {
    let plant = plant(60, 6, Form::Linear);
    let damping = Damping { alpha: 0.5, ..Damping::default() };
    let kinds =
        [0.5, 1.0, 2.0].map(|scale| Kind { scale, damping: Damping { mass: 1.0 + scale, ..damping } });
    let stands = (0..3).map(|kind| Stand { kind, ..Stand::default() }).collect();
    let pace = Pace { step: 1.0, ..PACE };
    let mut forest = Forest::new(&plant, stands, &kinds, &pace, &[], ROOMY).unwrap();
    let wind = Vector3::new(4.0, -3.0, 0.5);
    for _ in 0..500 {
        forest.step(&Constant(wind), &threads(1)).unwrap();
    }
    for copy in 0..3 {
        for (mode, q) in forest.amplitudes(copy).iter().enumerate() {
            let wanted = plant.basis.force(mode, &wind) / plant.omegas[mode].powi(2);
            assert!(
                (f64::from(*q) - wanted).abs() < 1e-4 * wanted.abs() + 1e-7,
                "{copy} {mode}: {q} {wanted}"
            );
        }
    }
}

/// A copy of another size swings as a plant of that size does.
#[test]
fn a_larger_copy_is_the_larger_plant() {
    let small = honami_synth::tree(50, 1).unwrap();
    let grown = small.nodes().iter().map(|node| honami_model::plant::Node {
        position: node.position.map(|v| v * 2.0),
        radius: node.radius * 2.0,
        ..*node
    });
    let grown = honami_model::plant::Plant::new(grown.collect()).unwrap();
    let stirring = |plant| {
        let beams = Beams::new(plant, &Options::default()).unwrap();
        let modes = Modes::new(&beams, 4, 1).unwrap();
        let basis = WindBasis::new(&beams, &modes, &Drag::default());
        Stirring::new(&beams, &modes, basis, Form::Linear)
    };
    let (small, grown) = (stirring(&small), stirring(&grown));
    let (stand, noise) = (vec![Stand::default()], Noise { speed: 9.0, cell: 1e9, second: 0.7, seed: 3 });
    let mut scaled =
        Forest::new(&small, stand.clone(), &[Kind { scale: 2.0, ..Kind::default() }], &PACE, &[], ROOMY)
            .unwrap();
    let mut real = Forest::new(&grown, stand, &[Kind::default()], &PACE, &[], ROOMY).unwrap();
    for _ in 0..200 {
        scaled.step(&noise, &threads(1)).unwrap();
        real.step(&noise, &threads(1)).unwrap();
    }
    let moved = (real.position(0, 49) - grown.rest[49]).norm();
    assert!(moved > 1e-4, "{moved}");
    for node in [10, 30, 49] {
        let off = (scaled.position(0, node) - real.position(0, node)).norm();
        assert!(off < 1e-4 * moved, "{node}: {off} of {moved}");
    }
}

#[test]
fn a_turned_copy_in_a_turned_wind_is_a_turned_pose() {
    let plant = plant(40, 5, Form::Mode(2));
    let stands = vec![Stand::default(), Stand { turn: 0.9, ..Stand::default() }];
    let run = |wind: Vector3<f64>, copy: usize| {
        let mut forest = Forest::new(&plant, stands.clone(), &[Kind::default()], &PACE, &[], ROOMY).unwrap();
        for _ in 0..40 {
            forest.step(&Constant(wind), &threads(1)).unwrap();
        }
        forest.position(copy, 39)
    };
    let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), 0.9);
    let wind = Vector3::new(6.0, 2.0, 0.0);
    let wanted = turn * run(wind, 0);
    assert!((run(turn * wind, 1) - wanted).norm() < 1e-5);
}

#[test]
fn a_forest_moves_to_the_same_bits_on_any_number_of_threads() {
    let plant = plant(70, 8, Form::Mode(3));
    let wind = Noise { speed: 8.0, cell: 20.0, second: 2.0, seed: 5 };
    let bits = |n_threads: usize, details: &[Detail], view: Option<&View>| {
        let mut forest = forest(&plant, grid(700), details);
        for _ in 0..5 {
            forest.step(&wind, &threads(n_threads)).unwrap();
        }
        forest.pose(view, &threads(n_threads)).unwrap();
        let seen = forest.seen().to_vec();
        let numbers: Vec<u32> =
            (0..seen.len()).flat_map(|k| forest.displacements(k)).map(|v| v.to_bits()).collect();
        (seen, numbers)
    };
    let details = [Detail { from: 60.0, n_nodes: 20, n_modes: 3 }];
    let eye = view();
    for view in [None, Some(&eye)] {
        let one = bits(1, &details, view);
        assert!(one.1.iter().any(|v| *v != 0));
        assert!(one == bits(2, &details, view) && one == bits(3, &details, view));
    }
}

fn view() -> View {
    View {
        eye: Vector3::new(-20.0, 120.0, 3.0),
        towards: Vector3::new(1.0, 0.2, 0.0),
        angle: 0.6,
        aspect: 1.6,
        far: 200.0,
    }
}

#[test]
fn what_is_posed_is_where_every_node_is_and_far_copies_have_less_of_it() {
    let plant = plant(60, 8, Form::Mode(2));
    let details =
        [Detail { from: 60.0, n_nodes: 20, n_modes: 8 }, Detail { from: 120.0, n_nodes: 5, n_modes: 2 }];
    let mut forest = forest(&plant, grid(400), &details);
    let wind = Noise { speed: 12.0, cell: 30.0, second: 2.0, seed: 5 };
    for _ in 0..9 {
        forest.step(&wind, &threads(1)).unwrap();
    }
    let eye = view();
    forest.pose(Some(&eye), &threads(1)).unwrap();
    let mut n_of = [0; 3];
    for (k, seen) in forest.seen().iter().enumerate() {
        n_of[seen.detail as usize] += 1;
        let stand = forest.stands[seen.copy as usize];
        let scale = forest.kinds[stand.kind as usize].scale;
        let nodes = forest.nodes(seen.detail);
        assert_eq!(nodes[0], 0, "the root is kept");
        let moved = forest.displacements(k);
        assert_eq!(moved.len(), 3 * nodes.len());
        for (node, moved) in nodes.iter().zip(moved.as_chunks::<3>().0) {
            let own = plant.rest[*node as usize] + Vector3::from(*moved).cast();
            let turned =
                nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), f64::from(stand.turn)) * own;
            let at = Vector3::from(stand.place).cast() + turned * scale;
            // The coarsest detail has fewer modes.
            let near = if seen.detail < 2 { 1e-5 } else { 0.2 };
            assert!((at - forest.position(seen.copy as usize, *node as usize)).norm() < near);
        }
    }
    assert!(n_of.iter().all(|n| *n > 5) && n_of.iter().sum::<usize>() < 300, "{n_of:?}");
}

/// Copies out of the picture have no corner that an eye would see.
#[test]
fn nothing_that_is_in_the_picture_is_left_out() {
    let eye = view();
    let forward = eye.towards.normalize();
    let right = forward.cross(&Vector3::z()).normalize();
    let up = right.cross(&forward);
    let half = (eye.angle / 2.0).tan();
    for k in 0..2000 {
        let t = f64::from(k);
        let centre =
            Vector3::new((t * 7.1) % 260.0 - 40.0, (t * 3.7) % 300.0 - 20.0, (t * 1.3) % 60.0 - 20.0);
        let is_in = |at: Vector3<f64>| {
            let (x, y, z) = (at.dot(&right), at.dot(&up), at.dot(&forward));
            z > 0.0 && z < eye.far && y.abs() <= z * half && x.abs() <= z * half * eye.aspect
        };
        let any = (0..500).any(|j| {
            let (a, b) = (f64::from(j) * 2.4, f64::from(j) / 250.0 - 1.0);
            let on = Vector3::new((1.0 - b * b).sqrt() * a.cos(), (1.0 - b * b).sqrt() * a.sin(), b);
            is_in(centre + on * 4.0 - eye.eye)
        });
        let sees = eye.sees(&centre, 4.0);
        assert!(sees || !any, "{centre}");
        // Well away from the picture nothing is kept: more than the ball beyond an edge.
        let at = centre - eye.eye;
        let beside = at.dot(&right).abs() > at.dot(&forward).max(0.0) * half * eye.aspect + 4.0 * 3.0;
        assert!(!(sees && beside && at.dot(&forward) > 4.0), "{centre}");
    }
}

/// What is borne: positions, the matrix of the plant, two numbers a mode, and a tenth of it for the rest.
#[test]
fn a_forest_takes_little_more_memory_than_its_positions() {
    for (k, n, m, form) in [
        (3000, 20, 10, Form::Mode(3)),
        (2000, 100, 25, Form::Mode(3)),
        (300, 800, 25, Form::Mode(2)),
        (1000, 100, 25, Form::Linear),
    ] {
        let plant = plant(n, m, form);
        let mut forest = forest(&plant, grid(k), &[]);
        forest.step(&Constant(Vector3::x()), &threads(2)).unwrap();
        forest.pose(None, &threads(2)).unwrap();
        let bound = 1.1 * ((k * n * 3 + n * m * 9 + k * m * 2) * 4) as f64;
        assert!((forest.bytes() as f64) < bound, "{k} x {n} x {m}: {} of {bound}", forest.bytes());
    }
}

#[test]
fn what_does_not_fit_is_refused_with_its_size() {
    let plant = plant(100, 5, Form::Linear);
    let state = Forest::new(&plant, grid(100_000), &kinds(), &PACE, &[], 1_000_000).unwrap_err();
    assert_eq!(state.to_string(), "100000 copies of 100 nodes take 4 MB, and there are 1");
    let mut forest = Forest::new(&plant, grid(100_000), &kinds(), &PACE, &[], 50_000_000).unwrap();
    let error = forest.pose(None, &threads(1)).unwrap_err();
    assert!(matches!(error, ForestError::Memory { bytes, there: 50_000_000, .. } if bytes > 120_000_000));
}

#[test]
fn what_is_no_forest_is_named() {
    let plant = plant(20, 3, Form::Linear);
    let stand = |kind, x| vec![Stand { place: [x, 0.0, 0.0], turn: 0.0, kind }];
    let of = |stands: Vec<Stand>, kinds: &[Kind], pace: &Pace, details: &[Detail]| {
        Forest::new(&plant, stands, kinds, pace, details, ROOMY).err().map(|error| error.to_string())
    };
    let good = [Kind::default()];
    let heavy = |mass| [Kind { damping: Damping { mass, ..Damping::default() }, ..Kind::default() }];
    assert_eq!(of(stand(0, 1.0), &good, &PACE, &[]), None);
    assert_eq!(of(vec![], &good, &PACE, &[]).unwrap(), "a forest has one copy and one kind at least");
    assert!(of(stand(1, 1.0), &good, &PACE, &[]).unwrap().ends_with("is of kind 1 of 1"));
    assert!(of(stand(0, f32::NAN), &good, &PACE, &[]).unwrap().starts_with("copy 0 stands at [NaN"));
    for mass in [0.0, -2.0, f64::NAN] {
        assert!(of(stand(0, 0.0), &heavy(mass), &PACE, &[]).unwrap().contains("masses are more than 0"));
    }
    for step in [0.0, -0.1, f64::NAN] {
        let error = of(stand(0, 0.0), &good, &Pace { step, ..PACE }, &[]).unwrap();
        assert_eq!(error, format!("a step takes more than 0 s, not {step} s"));
    }
    for detail in [
        Detail { from: 0.0, n_nodes: 3, n_modes: 1 },
        Detail { from: 9.0, n_nodes: 0, n_modes: 1 },
        Detail { from: 9.0, n_nodes: 21, n_modes: 1 },
        Detail { from: 9.0, n_nodes: 3, n_modes: 4 },
    ] {
        assert!(of(stand(0, 0.0), &good, &PACE, &[detail]).unwrap().starts_with("detail 1 begins at"));
    }
}

#[test]
fn steps_beyond_the_limit_of_a_method_are_refused_with_it() {
    let plant = plant(20, 3, Form::Linear);
    let fastest = plant.omegas[2];
    let of = |step: f64, integrator: Integrator| {
        let kinds = [Kind { damping: Damping { alpha: 0.0, beta: 0.0, mass: 1.0 }, scale: 1.0 }];
        Forest::new(&plant, grid(1), &kinds, &Pace { step, integrator }, &[], ROOMY).map(|_| ())
    };
    let limit = 2.0 / fastest;
    assert!(of(limit * 0.99, Integrator::Symplectic).is_ok());
    let error = of(limit * 1.01, Integrator::Symplectic).unwrap_err().to_string();
    let wanted = format!("less than {limit:.6} s is wanted, or another method");
    assert!(
        error.contains(&wanted) && error.contains(&format!("at {:.3} Hz", fastest / (2.0 * PI))),
        "{error}"
    );
    for integrator in [Integrator::Exact, Integrator::Newmark] {
        assert!(of(limit * 100.0, integrator).is_ok());
    }
}

#[test]
fn a_wind_that_is_no_number_is_named_with_the_first_copy_that_feels_it() {
    struct Hole;
    impl Wind for Hole {
        fn sample(&self, place: &Vector3<f64>, time: f64) -> Vector3<f64> {
            if place.x > 25.0 && time > 0.01 { Vector3::repeat(f64::NAN) } else { Vector3::x() }
        }
    }
    let plant = plant(20, 3, Form::Linear);
    let mut forest = forest(&plant, grid(600), &[]);
    forest.step(&Hole, &threads(3)).unwrap();
    let error = forest.step(&Hole, &threads(3)).unwrap_err();
    assert_eq!(error.to_string(), "the wind at copy 3 at 0.02 s is no number");
}

/// All methods agree where steps are short.
#[test]
fn methods_agree_in_short_steps() {
    let plant = plant(30, 4, Form::Linear);
    let end = |integrator: Integrator| {
        let pace = Pace { step: 1e-4, integrator };
        let mut forest = Forest::new(&plant, grid(1), &[Kind::default()], &pace, &[], ROOMY).unwrap();
        for _ in 0..4000 {
            forest.step(&Constant(Vector3::new(8.0, 1.0, 0.0)), &threads(1)).unwrap();
        }
        forest.position(0, 29)
    };
    let exact = end(Integrator::Exact);
    let moved = (exact - plant.rest[29]).norm();
    for integrator in [Integrator::Symplectic, Integrator::Newmark] {
        assert!((end(integrator) - exact).norm() < 3e-3 * moved, "{integrator:?}");
    }
}
