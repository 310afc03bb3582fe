//! Forests against one plant alone, against statics, and against what they may take.

use super::{Detail, Details, Forest, ForestError, Pace, Pose, Stand, StateError, View};
use crate::wind::{Noise, Wind};
use crate::{Beams, Damping, Drag, Form, Integrator, Modes, Options, Stirring, Threads, WindBasis};
use nalgebra::{Rotation3, Vector3};
use std::f64::consts::PI;

pub(super) const PACE: Pace = Pace {
    step: 0.02,
    integrator: Integrator::Exact,
    damping: Damping { alpha: 0.3, beta: 0.008, mass: 1.0, air: 1.0 },
};

fn stirring(plant: &honami_model::plant::Plant, n_modes: usize, form: Form) -> Stirring {
    let beams = Beams::new(plant, &Options::default()).unwrap();
    let modes = Modes::new(&beams, n_modes, 1).unwrap();
    let basis = WindBasis::new(&beams, &modes, &Drag::default());
    Stirring::new(&beams, &modes, basis, form)
}

pub(super) fn plant(n_nodes: usize, n_modes: usize, form: Form) -> Stirring {
    stirring(&honami_synth::tree(n_nodes, 1).unwrap(), n_modes, form)
}

pub(super) fn threads(n: usize) -> Threads {
    Threads::new(n).unwrap()
}

/// Some copies as the plant is, some larger and heavier, each turned.
fn stands(n: usize) -> Vec<Stand> {
    let sizes = [(1.0, 1.0), (1.3, 1.5)];
    let of = |k: usize| Stand { turn: k as f32 * 0.7, scale: sizes[k % 2].0, mass: sizes[k % 2].1 };
    (0..n).map(of).collect()
}

/// Where copies stand, metres.
fn place(copy: usize) -> Vector3<f64> {
    Vector3::new((copy % 20) as f64 * 10.0, (copy / 20) as f64 * 10.0, 0.0)
}

pub(super) fn forest(plant: &Stirring, stands: &[Stand], pace: &Pace) -> Forest {
    let nodes: Vec<u32> = (0..plant.n_nodes() as u32).collect();
    Forest::new(plant, &nodes, stands, pace).unwrap()
}

/// So many steps in a wind that blows at every place as it does.
pub(super) fn go(forest: &mut Forest, n: usize, wind: &dyn Wind, threads: &Threads) {
    for _ in 0..n {
        let time = forest.time();
        forest.step(&|copy| wind.sample(&place(copy), time), None, threads).unwrap();
    }
}

fn posed(forest: &mut Forest, details: Option<&[Detail]>, threads: &Threads) -> Vec<[f32; 3]> {
    let all = forest.rig.n_nodes() * forest.len();
    let n = details.map_or(all, |details| details.iter().map(|detail| detail.n_nodes as usize).sum());
    let mut motion = vec![[f32::NAN; 3]; n];
    forest.pose(Pose { details, motion: &mut motion }, threads);
    motion
}

pub(super) fn blowing(v: Vector3<f64>) -> impl Wind {
    crate::wind::Constant(v)
}

/// Damped to rest in a steady wind, modes are where statics puts them: f / omega^2, whatever the size and the mass.
#[test]
fn in_a_steady_wind_every_copy_comes_to_rest_bent_alike() {
    let plant = plant(60, 6, Form::Linear);
    let stands = [0.5, 1.0, 2.0].map(|scale| Stand { scale, mass: 1.0 + scale, ..Stand::default() });
    let pace = Pace { step: 1.0, damping: Damping { alpha: 0.5, ..PACE.damping }, ..PACE };
    let mut forest = forest(&plant, &stands, &pace);
    let wind = Vector3::new(4.0, -3.0, 0.5);
    go(&mut forest, 500, &blowing(wind), &threads(1));
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

/// A round rod's slowest modes are any two across each other: whichever were found, it is pulled to the same place.
#[test]
fn equal_modes_are_pulled_to_the_same_place_whichever_were_found() {
    let node = |k: u32| honami_model::plant::Node {
        parent: k.checked_sub(1),
        position: [0.0, 0.0, f64::from(k)],
        radius: 0.02,
    };
    let rod = honami_model::plant::Plant::new((0..6).map(node).collect()).unwrap();
    let beams = Beams::new(&rod, &Options::default()).unwrap();
    for seed in [1, 2, 3, 4] {
        let modes = Modes::new(&beams, 4, seed).unwrap();
        let basis = WindBasis::new(&beams, &modes, &Drag::default());
        let plant = Stirring::new(&beams, &modes, basis, Form::Linear);
        let mut forest = forest(&plant, &[Stand::default()], &PACE);
        forest.pull(0, &plant.pulled(0.25).unwrap());
        let [x, y, z] = posed(&mut forest, None, &threads(1))[5];
        assert!((x - 0.25).abs() < 1e-5 && y.abs() < 1e-5 && z.abs() < 1e-5, "{seed}: {x} {y} {z}");
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
    let motion = |plant: &honami_model::plant::Plant, scale: f32| {
        let mut forest =
            forest(&stirring(plant, 4, Form::Linear), &[Stand { scale, ..Stand::default() }], &PACE);
        go(
            &mut forest,
            200,
            &Noise { speed: 9.0, cell: 1e9, second: 0.7, seed: 3, n_cells: None },
            &threads(1),
        );
        posed(&mut forest, None, &threads(1))
    };
    let (scaled, real) = (motion(&small, 2.0), motion(&grown, 1.0));
    let (scaled, real) = (scaled.as_flattened(), real.as_flattened());
    let most = real.iter().fold(0.0_f32, |most, v| v.abs().max(most));
    assert!(most > 1e-4 && scaled.iter().zip(real).all(|(a, b)| (2.0 * a - b).abs() < 1e-4 * most));
}

/// In its own axes nothing has changed.
#[test]
fn a_turned_copy_in_a_turned_wind_moves_as_before() {
    let plant = plant(40, 5, Form::Mode(2));
    let run = |turn: f32| {
        let mut forest = forest(&plant, &[Stand { turn, ..Stand::default() }], &PACE);
        let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), f64::from(turn));
        go(&mut forest, 40, &blowing(turned * Vector3::new(6.0, 2.0, 0.0)), &threads(1));
        posed(&mut forest, None, &threads(1))
    };
    let (plain, turned) = (run(0.0), run(0.9));
    assert!(plain[39][0].abs() > 1e-3);
    let pairs = plain.as_flattened().iter().zip(turned.as_flattened());
    assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-5));
}

/// In one call or in many, on any number of threads, posed or not on the way.
#[test]
fn a_forest_moves_to_the_same_bits_on_any_number_of_threads() {
    let wind = Noise { speed: 8.0, cell: 20.0, second: 2.0, seed: 5, n_cells: None };
    let details: Vec<Detail> =
        (0..700).map(|k| Detail { n_nodes: [70, 20, 0][k / 5 % 3], n_modes: [8, 3][k / 7 % 2] }).collect();
    let details = [None, Some(details.as_slice())];
    for (form, details) in
        [Form::Mode(3), Form::Turn].into_iter().flat_map(|form| details.map(|some| (form, some)))
    {
        let plant = plant(70, 8, form);
        let bits = |n_threads: usize| {
            let mut forest = forest(&plant, &stands(700), &PACE);
            go(&mut forest, 5, &wind, &threads(n_threads));
            let motion = posed(&mut forest, details, &threads(n_threads));
            let bits: Vec<u32> = motion.as_flattened().iter().map(|v| v.to_bits()).collect();
            (bits, forest.save())
        };
        let one = bits(1);
        assert!(one.0.iter().any(|v| *v != 0));
        assert!(one == bits(2) && one == bits(3));
        let mut forest = forest(&plant, &stands(700), &PACE);
        go(&mut forest, 4, &wind, &threads(2));
        let (time, mut motion) = (forest.time(), vec![[f32::NAN; 3]; one.0.len() / 3]);
        let pose = Pose { details, motion: &mut motion };
        forest.step(&|copy| wind.sample(&place(copy), time), Some(pose), &threads(2)).unwrap();
        assert!(motion.as_flattened().iter().map(|v| v.to_bits()).eq(one.0), "a step and its pose at once");
    }
}

#[test]
fn what_is_left_out_changes_nothing_of_what_is_wanted() {
    for form in [Form::Mode(3), Form::Turn] {
        let plant = plant(60, 8, form);
        let mut forest = forest(&plant, &stands(100), &PACE);
        go(
            &mut forest,
            9,
            &Noise { speed: 12.0, cell: 30.0, second: 2.0, seed: 5, n_cells: None },
            &threads(1),
        );
        let all = posed(&mut forest, None, &threads(1));
        let details: Vec<Detail> = (0..100)
            .map(|k| Detail { n_nodes: [60, 22, 0, 1][k / 3 % 4], n_modes: [8, 8, 2][k % 3] })
            .collect();
        let some = posed(&mut forest, Some(&details), &threads(1));
        let mut some = some.as_slice();
        for (k, Detail { n_nodes, n_modes }) in details.into_iter().enumerate() {
            let n_nodes = n_nodes as usize;
            let (own, others) = some.split_at(n_nodes);
            some = others;
            if n_modes == 8 {
                assert!(own == &all[60 * k..][..n_nodes], "{k}");
            } else {
                // As if only the first modes were out.
                let mut few = [0.0; 8];
                few[..2].copy_from_slice(&forest.amplitudes(k)[..2]);
                let mut alone = self::forest(&plant, &[Stand::default()], &PACE);
                alone.pull(0, &few);
                let wanted = posed(&mut alone, None, &threads(1));
                let off =
                    own.iter().zip(&wanted).all(|(a, b)| (0..3).all(|axis| (a[axis] - b[axis]).abs() < 1e-6));
                assert!(off, "{k}");
            }
        }
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
fn far_copies_have_less_of_it_and_those_out_of_view_nothing() {
    let plant = plant(60, 8, Form::Linear);
    let [near, far] = [(20, 8), (5, 2)].map(|(n_nodes, n_modes)| Detail { n_nodes, n_modes });
    let details = Details::new(&[(60.0, near), (120.0, far)]).unwrap();
    let eye = view();
    let mut n_of = [0; 4];
    for copy in 0..400 {
        let detail = details.of(&plant, &eye, &place(copy), 1.0);
        let distance = (place(copy) + Vector3::z() * plant.height / 2.0 - eye.eye).norm();
        let wanted = [u32::MAX, 20, 5][usize::from(distance >= 60.0) + usize::from(distance >= 120.0)];
        assert!(detail.n_nodes == wanted || detail.n_nodes == 0, "{distance}: {detail:?}");
        n_of[[u32::MAX, 20, 5, 0].iter().position(|n| *n == detail.n_nodes).unwrap()] += 1;
    }
    assert!(n_of.iter().all(|n| *n > 5) && n_of[3] > 100, "{n_of:?}");
    let large = details.of(&plant, &eye, &(eye.eye + Vector3::x() * 100.0), 3.0);
    assert_eq!(large.n_nodes, u32::MAX, "a large one keeps its nodes for longer");
    let none = Detail { n_nodes: 0, ..near };
    for wrong in [vec![(0.0, near)], vec![(9.0, near), (9.0, far)], vec![(9.0, none)]] {
        let error = Details::new(&wrong).unwrap_err().to_string();
        assert!(error.starts_with("detail ") && error.contains("farther and farther"), "{error}");
    }
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
        (3000, 20, 10, Form::Turn),
        (2000, 100, 25, Form::Turn),
        (1000, 100, 25, Form::Linear),
    ] {
        let bytes = forest(&plant(n, m, form), &stands(k), &PACE).bytes() + 12 * k * n;
        let bound = 1.1 * ((k * n * 3 + n * m * 9 + k * m * 2) * 4) as f64;
        assert!((bytes as f64) < bound, "{k} x {n} x {m}: {bytes} of {bound}");
    }
}

#[test]
fn what_is_no_forest_is_named() {
    let plant = plant(20, 3, Form::Linear);
    let of = |stands: &[Stand], pace: &Pace| {
        Forest::new(&plant, &[0, 5], stands, pace).err().map(|error| error.to_string())
    };
    let one = [Stand::default()];
    assert_eq!(of(&one, &PACE), None);
    assert_eq!(of(&[], &PACE).unwrap(), "a forest has one copy at least");
    for size in [0.0, -2.0, f32::NAN] {
        for stand in [Stand { scale: size, ..one[0] }, Stand { mass: size, ..one[0] }] {
            assert!(of(&[one[0], stand], &PACE).unwrap().starts_with("copy 1 is turned by 0"));
        }
    }
    assert!(of(&[Stand { turn: f32::NAN, ..one[0] }], &PACE).unwrap().contains("turned by NaN"));
    for damping in [
        Damping { mass: 0.0, ..PACE.damping },
        Damping { alpha: -1.0, ..PACE.damping },
        Damping { air: f64::NAN, ..PACE.damping },
    ] {
        assert!(of(&one, &Pace { damping, ..PACE }).unwrap().contains("damping is not negative"));
    }
    for step in [0.0, -0.1, f64::NAN] {
        let error = of(&one, &Pace { step, ..PACE }).unwrap();
        assert_eq!(error, format!("a step takes more than 0 s, not {step} s"));
    }
}

#[test]
fn steps_beyond_the_limit_of_a_method_are_refused_with_it() {
    let plant = plant(20, 3, Form::Linear);
    let fastest = plant.omegas[2];
    let damping = Damping { alpha: 0.0, beta: 0.0, mass: 1.0, air: 0.0 };
    let of = |step: f64, integrator: Integrator| {
        Forest::new(&plant, &[0], &[Stand::default()], &Pace { step, integrator, damping }).map(|_| ())
    };
    // The limit of the fastest, though slower ones are beyond theirs, too.
    let limit = 2.0 / fastest;
    let refused = of(10.0, Integrator::Symplectic).unwrap_err();
    assert!(refused.to_string().contains(&format!("less than {limit:.6} s")), "{refused}");
    let pace = Pace { step: limit / 1.9, integrator: Integrator::Symplectic, damping };
    let stands = [1.0, 0.5].map(|scale| Stand { scale, ..Stand::default() });
    assert!(pace.bears(&plant.omegas, &stands[..1]).is_ok(), "half of the limit");
    assert!(pace.bears(&plant.omegas, &stands).is_err(), "what is half as large swings twice as fast");
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
    let mut forest = forest(&plant(20, 3, Form::Linear), &stands(600), &PACE);
    go(&mut forest, 1, &blowing(Vector3::x()), &threads(3));
    let hole = |copy: usize| Vector3::repeat(if copy > 2 { f64::NAN } else { 1.0 });
    let error = forest.step(&hole, None, &threads(3)).unwrap_err();
    assert_eq!(error, ForestError::Wind { copy: 3, time: 0.02 });
}

/// All methods agree where steps are short.
#[test]
fn methods_agree_in_short_steps() {
    let plant = plant(30, 4, Form::Linear);
    let end = |integrator: Integrator| {
        let mut forest = forest(&plant, &stands(1), &Pace { step: 1e-4, integrator, ..PACE });
        go(&mut forest, 4000, &blowing(Vector3::new(8.0, 1.0, 0.0)), &threads(1));
        Vector3::from(posed(&mut forest, None, &threads(1))[29])
    };
    let exact = end(Integrator::Exact);
    for integrator in [Integrator::Symplectic, Integrator::Newmark] {
        assert!((end(integrator) - exact).norm() < 3e-3 * exact.norm(), "{integrator:?}");
    }
}

/// Twice as heavy from a time on: it goes on from where it is as one that is so from there.
#[test]
fn a_forest_goes_on_at_another_pace_from_where_it_is() {
    let plant = plant(30, 4, Form::Linear);
    let wind = blowing(Vector3::new(8.0, 1.0, 0.0));
    let heavy = Pace { damping: Damping { mass: 2.0, ..PACE.damping }, step: 0.01, ..PACE };
    let mut tuned = forest(&plant, &stands(3), &PACE);
    go(&mut tuned, 20, &wind, &threads(1));
    let mut other = forest(&plant, &stands(3), &heavy);
    other.load(&tuned.save()).unwrap();
    tuned.retune(&heavy).unwrap();
    let wrong = Pace { step: f64::NAN, ..PACE };
    assert!(tuned.retune(&wrong).is_err() && *tuned.pace() == heavy, "what is refused changes nothing");
    go(&mut tuned, 20, &wind, &threads(1));
    go(&mut other, 20, &wind, &threads(1));
    assert_eq!(tuned.save(), other.save());
    tuned.reset();
    assert_eq!(tuned.save(), forest(&plant, &stands(3), &PACE).save());
}

#[test]
fn a_saved_state_is_that_of_its_own_forest_alone() {
    let plant = plant(30, 4, Form::Linear);
    let mut forest = forest(&plant, &stands(3), &PACE);
    go(&mut forest, 7, &blowing(Vector3::x()), &threads(1));
    let saved = forest.save();
    let size = |bytes: &[u8], forest: &mut Forest| forest.load(bytes).unwrap_err();
    for bytes in [&[][..], &saved[..9], &saved[..saved.len() - 1]] {
        assert!(matches!(size(bytes, &mut forest), StateError::Size { wanted: 120, .. }), "{}", bytes.len());
    }
    let mut other = self::forest(&plant, &stands(4), &PACE);
    let error = size(&saved, &mut other).to_string();
    assert!(error.contains("of 4 copies") && error.ends_with("of 3 copies with 4 modes"), "{error}");
    let mut broken = saved.clone();
    broken[24..28].copy_from_slice(&f32::NAN.to_le_bytes());
    assert_eq!(forest.load(&broken), Err(StateError::Numbers));
    assert_eq!(forest.save(), saved, "what is refused changes nothing");
}

/// Copies of any size and mass, that moved before: all are where they were pulled to, and stand still.
#[test]
fn a_pull_pulls_every_copy() {
    let plant = plant(30, 4, Form::Linear);
    let mut forest = forest(&plant, &stands(3), &PACE);
    go(&mut forest, 5, &blowing(Vector3::x()), &threads(1));
    let pulled = plant.pulled(0.3).unwrap();
    forest.pull_all(&pulled);
    assert!((0..3).all(|copy| forest.amplitudes(copy) == pulled) && pulled[0].abs() > 0.0, "{pulled:?}");
    assert!(forest.speeds.iter().all(|speed| speed.to_bits() == 0));
}
