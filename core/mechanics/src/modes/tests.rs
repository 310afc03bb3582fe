//! Vibrations that are known in closed form, and those of another program.

use super::{Modes, ModesError};
use crate::beams::{Beams, Options};
use crate::material::Material;
use honami_model::plant::{Node, Plant, RadiusRule};
use nalgebra::{Rotation3, Vector3};
use std::f64::consts::{PI, TAU};

const LENGTH: f64 = 1.0;
const RADIUS: f64 = 0.02;
const MATERIAL: Material = Material { young: 1e10, poisson: 0.3, density: 1e3 };

/// Solutions of cos x cosh x = -1.
const BENDING: [f64; 4] =
    [1.875_104_068_711_961, 4.694_091_132_974_175, 7.854_757_438_237_613, 10.995_540_734_875_467];

/// A straight rod of so many segments.
fn rod(n: u32, direction: Vector3<f64>) -> Plant {
    let node = |k: u32| Node {
        parent: k.checked_sub(1),
        position: (direction * LENGTH * f64::from(k) / f64::from(n)).into(),
        radius: RADIUS,
    };
    Plant::new((0..=n).map(node).collect()).unwrap()
}

fn options(rule: RadiusRule) -> Options {
    Options { rule, material: MATERIAL, longest: None }
}

fn modes_of(plant: &Plant, n: usize) -> Modes {
    Modes::new(&Beams::new(plant, &options(RadiusRule::Mean)).unwrap(), n, 1).unwrap()
}

/// Frequency of a clamped rod that bends, hertz: (beta L)^2 / (2 pi L^2) sqrt(E I / (rho A)), where I / A = r^2 / 4.
fn bending_hz(beta: f64) -> f64 {
    beta.powi(2) / (TAU * LENGTH.powi(2))
        * (MATERIAL.young * RADIUS.powi(2) / (4.0 * MATERIAL.density)).sqrt()
}

fn assert_near(got: f64, wanted: f64, tolerance: f64, what: &str) {
    assert!(
        (got / wanted - 1.0).abs() < tolerance,
        "{what}: wanted {wanted}, got {got}, off by {:e}",
        got / wanted - 1.0
    );
}

#[test]
fn a_clamped_rod_bends_twists_and_stretches_at_its_frequencies() {
    let modes = modes_of(&rod(32, Vector3::z()), 16);
    for (k, beta) in BENDING.iter().enumerate() {
        // The two planes have the same frequency.
        for mode in [2 * k, 2 * k + 1] {
            let mode = if k == 3 { mode + 1 } else { mode };
            assert_near(modes.hz(mode), bending_hz(*beta), 2e-5, "bending");
        }
    }
    assert_near(bending_hz(BENDING[0]), 17.695_83, 1e-6, "the rod of the oracle");
    let twist = (MATERIAL.shear() / MATERIAL.density).sqrt() / (4.0 * LENGTH);
    assert_near(twist, 490.290_34, 1e-8, "the rod of the oracle");
    assert_near(modes.hz(6), twist * 1.000_100_4, 1e-7, "twisting");
    let stretch = (MATERIAL.young / MATERIAL.density).sqrt() / (4.0 * LENGTH);
    assert_near(stretch, 790.569_42, 1e-8, "the rod of the oracle");
    assert_near(modes.hz(9), stretch * 1.000_100_4, 1e-7, "stretching");
}

#[test]
fn the_error_falls_with_the_fourth_power_of_the_length_of_segments() {
    let cases =
        [(1, 1.004_754_3), (2, 1.000_483_44), (4, 1.000_032_71), (8, 1.000_002_08), (16, 1.000_000_13)];
    for (n, ratio) in cases {
        let modes = modes_of(&rod(n, Vector3::z()), 2);
        assert_near(modes.hz(0) / bending_hz(BENDING[0]), ratio, 5e-8, &format!("{n} segments"));
    }
    let second = modes_of(&rod(8, Vector3::z()), 4).hz(2);
    assert_near(second / bending_hz(BENDING[1]), 1.000_080_0, 5e-8, "the second bending");
    let order = |mode: usize, beta: f64| {
        let error = |n: u32| modes_of(&rod(n, Vector3::z()), mode + 1).hz(mode) / bending_hz(beta) - 1.0;
        (error(8) / error(16)).log2()
    };
    for (mode, beta) in [(0, BENDING[0]), (2, BENDING[1])] {
        let order = order(mode, beta);
        assert!((order - 4.0).abs() < 0.1, "mode {mode}: {order}");
    }
}

/// Twisting and stretching are linear between nodes.
#[test]
fn the_error_of_twisting_falls_with_the_square() {
    let twist = (MATERIAL.shear() / MATERIAL.density).sqrt() / (4.0 * LENGTH);
    let error = |n: u32| {
        let modes = modes_of(&rod(n, Vector3::z()), 9);
        let nearest = (0..9).map(|mode| modes.hz(mode) / twist - 1.0);
        nearest.min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap()
    };
    for n in [8, 16] {
        let order = (error(n) / error(2 * n)).log2();
        assert!((order - 2.0).abs() < 0.01, "{n} segments: {order}");
    }
}

/// How much of the rod's mass takes part when its foot is shaken, mode by mode: 4 s^2 / (beta L)^2 in closed form.
#[test]
fn effective_masses_are_those_of_a_clamped_rod() {
    let n = 64;
    let beams = Beams::new(&rod(n, Vector3::z()), &options(RadiusRule::Mean)).unwrap();
    let modes = Modes::new(&beams, 6, 1).unwrap();
    let per_metre = MATERIAL.density * PI * RADIUS.powi(2);
    for (k, known) in [0.613_06, 0.188_26, 0.064_67].into_iter().enumerate() {
        let beta = BENDING[k];
        let wanted = ((beta.sinh() - beta.sin()) / (beta.cosh() + beta.cos()) * 2.0 / beta).powi(2);
        assert!((wanted - known).abs() < 1e-4, "the rod of the oracle: {wanted}");
        // An even load on a segment: shares of the ends, and of how they turn.
        let part = |mode: usize| {
            let of_segment = |tip: usize| {
                let l = LENGTH / f64::from(n);
                let (u, psi) = (|node| modes.displacement(mode, node), |node| modes.rotation(mode, node));
                (u(tip - 1) + u(tip)) * (l / 2.0)
                    + (psi(tip - 1) - psi(tip)).cross(&Vector3::z()) * (l * l / 12.0)
            };
            (1..=n as usize).map(of_segment).sum::<Vector3<f64>>() * per_metre
        };
        // The two planes together, shaken along x.
        let mass = part(2 * k).x.powi(2) + part(2 * k + 1).x.powi(2);
        assert!((mass / (per_metre * LENGTH) - wanted).abs() < 1e-5, "{k}: {}", mass / (per_metre * LENGTH));
    }
}

/// Between any two modes the pivots count those below, also of a tree too large to be worked out as a whole.
#[test]
fn the_count_of_pivots_is_the_number_of_the_mode() {
    let beams = Beams::new(&honami_synth::tree(300, 3).unwrap(), &options(RadiusRule::Mean)).unwrap();
    let modes = Modes::new(&beams, 40, 1).unwrap();
    let (flexibility, mass) = (crate::factor::Flexibility::new(&beams), beams.mass());
    for below in [1, 5, 10, 25, 39] {
        let between = f64::midpoint(modes.omegas[below - 1].powi(2), modes.omegas[below].powi(2));
        let factor = crate::factor::Factor::new(&flexibility, &mass, between).unwrap();
        assert_eq!(factor.n_negative(), below);
    }
}

#[test]
fn frequencies_do_not_depend_on_where_the_rod_points() {
    let upright = modes_of(&rod(8, Vector3::z()), 6);
    for direction in [Vector3::x(), -Vector3::z(), Vector3::new(0.3, -0.5, 0.8).normalize()] {
        let leaning = modes_of(&rod(8, direction), 6);
        for mode in 0..6 {
            assert_near(leaning.omegas[mode], upright.omegas[mode], 1e-9, "leaning");
        }
        assert_near(leaning.omegas[0], leaning.omegas[1], 1e-9, "the two planes");
    }
}

#[test]
fn a_mass_at_the_tip_slows_it_as_it_should() {
    let plant = rod(32, Vector3::z());
    let mut beams = Beams::new(&plant, &options(RadiusRule::Mean)).unwrap();
    let mass = MATERIAL.density * PI * RADIUS.powi(2) * LENGTH;
    beams.load([(32, mass)]);
    let modes = Modes::new(&beams, 2, 1).unwrap();
    assert_near(modes.hz(0), bending_hz(1.247_917_409_4), 1e-8, "tip mass = mass of the rod");
}

/// Kirchhoff's cone: omega L^2 / sqrt(E I0 / rho A0) = 8.719; of so many cylinders less.
#[test]
fn a_cone_of_cylinders_tends_to_kirchhoffs() {
    for (n, wanted) in [(8, 8.246), (16, 8.623), (32, 8.696), (64, 8.713)] {
        let node = |k: u32| Node {
            parent: k.checked_sub(1),
            position: [0.0, 0.0, LENGTH * f64::from(k) / f64::from(n)],
            // The point has no radius; the rule of the tip takes that of the middle.
            radius: RADIUS * (1.0 - (f64::from(k) - 0.5).max(0.0) / f64::from(n)),
        };
        let plant = Plant::new((0..=n).map(node).collect()).unwrap();
        let modes = Modes::new(&Beams::new(&plant, &options(RadiusRule::Tip)).unwrap(), 1, 1).unwrap();
        let scale = (MATERIAL.young * RADIUS.powi(2) / 4.0 / MATERIAL.density).sqrt() / LENGTH.powi(2);
        assert_near(modes.omegas[0] / scale, wanted, 1e-4, &format!("{n} cylinders"));
    }
}

/// Four arms on a trunk: where they swing against one another the trunk is at rest, and each is a clamped rod.
#[test]
fn arms_that_swing_against_one_another_leave_the_trunk_at_rest() {
    let n = 8;
    let mut nodes: Vec<Node> = rod(n, Vector3::z()).nodes().to_vec();
    for arm in 0..4 {
        let direction =
            Rotation3::from_axis_angle(&Vector3::z_axis(), f64::from(arm) * PI / 2.0) * Vector3::x();
        let mut parent = n;
        for k in 1..=n {
            let position = Vector3::z() * LENGTH + direction * LENGTH * f64::from(k) / f64::from(n);
            nodes.push(Node { parent: Some(parent), position: position.into(), radius: RADIUS });
            parent = nodes.len() as u32 - 1;
        }
    }
    let modes = modes_of(&Plant::new(nodes).unwrap(), 12);
    let clamped = bending_hz(BENDING[0]);
    let nearest =
        (0..12).min_by(|a, b| (modes.hz(*a) - clamped).abs().total_cmp(&(modes.hz(*b) - clamped).abs()));
    assert_near(modes.hz(nearest.unwrap()), clamped, 3e-6, "an arm");
}

/// Many equal arms have many equal modes, of which only some are wanted: they are those that all at once gives.
#[test]
fn of_many_equal_modes_as_many_are_found_as_are_wanted() {
    for (n_arms, n_modes) in [(16, 12), (40, 12), (40, 25), (100, 25)] {
        let mut nodes: Vec<Node> = rod(1, Vector3::z()).nodes().to_vec();
        for arm in 0..n_arms {
            let turned =
                Rotation3::from_axis_angle(&Vector3::z_axis(), 2.0 * PI * f64::from(arm) / f64::from(n_arms));
            let position = Vector3::z() * LENGTH + turned * Vector3::x() * LENGTH;
            nodes.push(Node { parent: Some(1), position: position.into(), radius: RADIUS });
        }
        let beams = Beams::new(&Plant::new(nodes).unwrap(), &options(RadiusRule::Mean)).unwrap();
        let few = Modes::new(&beams, n_modes, 1).unwrap();
        let all = Modes::new(&beams, 3 * n_arms as usize + 4, 1).unwrap();
        for mode in 0..n_modes {
            assert_near(few.omegas[mode], all.omegas[mode], 1e-7, &format!("{n_arms} arms, mode {mode}"));
        }
        let equal = few.omegas.windows(2).filter(|pair| pair[1] / pair[0] - 1.0 < 1e-7).count();
        assert!(equal >= n_modes / 2, "{n_arms} arms: {equal} are equal to the one before");
    }
}

#[test]
fn modes_are_of_mass_one_and_solve_their_equation() {
    let plant = honami_synth::tree(300, 7).unwrap();
    let beams = Beams::new(&plant, &options(RadiusRule::Mean)).unwrap();
    let (modes, mass) = (Modes::new(&beams, 25, 1).unwrap(), beams.mass());
    let mut product = vec![0.0; modes.shape(0).len()];
    for mode in 0..25 {
        mass.times(modes.shape(mode), &mut product);
        for other in 0..25 {
            let wanted = f64::from(u8::from(mode == other));
            assert!((crate::simd::dot(&product, modes.shape(other)) - wanted).abs() < 1e-10);
        }
        assert!(modes.residuals[mode] < 1e-9, "{:e}", modes.residuals[mode]);
    }
}

#[test]
fn more_modes_than_there_are_is_an_error() {
    let beams = Beams::new(&rod(2, Vector3::z()), &Options::default()).unwrap();
    for wanted in [0, 13] {
        let error = Modes::new(&beams, wanted, 1).unwrap_err();
        assert_eq!(error, ModesError::TooMany { wanted, there: 12 });
    }
}

/// All at once and the slowest by iteration: the same modes, also where nearly half of all are wanted.
#[test]
fn many_modes_of_few_nodes_are_the_same_by_both_ways() {
    let beams = Beams::new(&honami_synth::tree(30, 2).unwrap(), &options(RadiusRule::Mean)).unwrap();
    // 174 degrees of freedom.
    let (few, all) = (Modes::new(&beams, 80, 1).unwrap(), Modes::new(&beams, 90, 1).unwrap());
    for mode in 0..80 {
        assert_near(few.omegas[mode], all.omegas[mode], 1e-9, &format!("mode {mode}"));
    }
}

#[test]
fn more_than_half_of_the_modes_of_a_large_plant_is_an_error_with_the_figure() {
    let beams = Beams::new(&honami_synth::tree(300, 1).unwrap(), &Options::default()).unwrap();
    let error = Modes::new(&beams, 1000, 1).unwrap_err();
    assert_eq!(error, ModesError::Half { wanted: 1000, there: 1794 });
    assert!(error.to_string().ends_with("where there are 1500 at most, here 896 can be had"), "{error}");
    let most = [2, 251, 252, 300].map(Modes::most);
    assert_eq!(most, [6, 1500, 752, 896]);
    assert!(matches!(Modes::new(&beams, most[3] + 1, 1), Err(ModesError::Half { .. })));
}

/// Masses that vanish to the digits that there are, of a plant that is worked out all at once and of one that is not; what
/// is only far from wood has its modes.
#[test]
fn a_plant_whose_masses_vanish_is_an_error_by_both_ways() {
    for (n, density) in [(8, 1e-318), (40, 1e-318), (8, 1e-100), (40, 1e-100), (8, 1e100), (40, 1e100)] {
        let options = Options { material: Material { density, ..MATERIAL }, ..Options::default() };
        match Modes::new(&Beams::new(&rod(n, Vector3::z()), &options).unwrap(), 4, 1) {
            Ok(modes) if density > 1e-318 => {
                let wanted = bending_hz(BENDING[0]) * (MATERIAL.density / density).sqrt();
                assert_near(modes.hz(0), wanted, 1e-4, &format!("{n} segments of {density:e} kg/m3"));
            }
            Err(ModesError::Numbers | ModesError::Singular(_)) if density <= 1e-318 => (),
            other => panic!("{n} segments of {density:e} kg/m3: {:?}", other.map(|modes| modes.omegas)),
        }
    }
}

#[test]
fn what_modes_take_is_known_before() {
    // Thrice as many columns as modes, and the modes: 8 bytes a number, 6 numbers a node.
    let bytes = Modes::bytes(3437, 25);
    assert!((16_000_000..40_000_000).contains(&bytes), "{bytes}");
    assert_eq!(Modes::bytes(1 << 40, usize::MAX), usize::MAX);
}

#[test]
fn whoever_watches_the_search_is_told_how_far_it_is_and_may_stop_it() {
    let plant = rod(60, Vector3::z());
    let beams = Beams::new(&plant, &options(RadiusRule::Mean)).unwrap();
    let told = std::cell::RefCell::new(Vec::new());
    let watch = |found| {
        told.borrow_mut().push(found);
        true
    };
    let modes = Modes::watched(&beams, 12, 1, &watch).unwrap();
    assert_eq!(modes.omegas, Modes::new(&beams, 12, 1).unwrap().omegas);
    let told = told.into_inner();
    assert!(told[0] == 0 && told.iter().all(|found| *found <= 12) && told.len() > 1, "{told:?}");
    let stopped = Modes::watched(&beams, 12, 1, &|_found| false);
    assert_eq!(stopped.err(), Some(ModesError::Stopped));
}
