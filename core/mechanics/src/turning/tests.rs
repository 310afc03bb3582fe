//! Against circles, cones and the modes themselves.

use super::Turning;
use crate::{Beams, Modes, Options};
use honami_model::plant::{Node, Plant};
use nalgebra::{DVector, Rotation3, Vector3};
use std::f64::consts::PI;

fn plant(nodes: &[(Option<u32>, [f64; 3])]) -> Beams {
    let node = |&(parent, position): &(Option<u32>, [f64; 3])| Node { parent, position, radius: 0.01 };
    Beams::new(&Plant::new(nodes.iter().map(node).collect()).unwrap(), &Options::default()).unwrap()
}

/// All modes, and the amplitudes at which they are together what a moment at a node makes of the plant.
fn under_moment(beams: &Beams, node: usize, moment: Vector3<f64>) -> (Modes, Vec<f64>) {
    let modes = Modes::new(beams, 6 * (beams.len() - 1), 1).unwrap();
    let of = |mode: usize| modes.rotation(mode, node).dot(&moment) / modes.omegas[mode].powi(2);
    let amplitudes = (0..modes.len()).map(of).collect();
    (modes, amplitudes)
}

/// The relative errors of lengths: the largest.
fn longest_error(beams: &Beams, moved: &[Vector3<f64>]) -> f64 {
    let errors = beams.segments().map(|(base, tip, section, along)| {
        let now = along * section.length + moved[tip] - moved[base];
        (now.norm() / section.length - 1.0).abs()
    });
    errors.fold(0.0, f64::max)
}

/// A rod bent by a moment at its tip is an arc of a circle of radius E I / M, up to a half.
#[test]
fn a_rod_under_a_moment_is_an_arc() {
    let n = 40;
    let nodes: Vec<_> =
        (0..=n).map(|k| ((k > 0).then(|| k - 1), [0.0, 0.0, f64::from(k) / f64::from(n)])).collect();
    let beams = plant(&nodes);
    let stiffness = 1e10 * PI * 0.01_f64.powi(4) / 4.0;
    for angle in [0.5, 1.5, 3.1] {
        let (modes, amplitudes) = under_moment(&beams, n as usize, Vector3::y() * (stiffness * angle));
        let moved = Turning::new(&beams, &modes).displacements(&amplitudes);
        for (k, moved) in moved.iter().enumerate() {
            let arc = k as f64 / f64::from(n);
            let wanted = Vector3::new(1.0 - (angle * arc).cos(), 0.0, (angle * arc).sin()) / angle;
            let got = beams.position(k) - beams.position(0) + moved;
            // Chords instead of arcs: a 24th of the square of a segment's angle.
            let near = (angle / f64::from(n)).powi(2) / 24.0 + 1e-6;
            assert!((got - wanted).norm() < 1.01 * near, "{angle} {k}: {got} {wanted}");
        }
        assert!(longest_error(&beams, &moved) < 1e-13);
    }
}

/// What stands on a stem that is twisted goes round with it, as it is: also what leans.
#[test]
fn branches_go_round_with_a_twisted_stem() {
    let branch = [[0.3, 0.0, 1.3], [0.5, 0.2, 1.8]];
    let beams =
        plant(&[(None, [0.0; 3]), (Some(0), [0.0, 0.0, 1.0]), (Some(1), branch[0]), (Some(2), branch[1])]);
    let shear = 1e10 / 2.6;
    let angle = 1.2;
    let moment = shear * PI * 0.01_f64.powi(4) / 2.0 * angle;
    let (modes, amplitudes) = under_moment(&beams, 1, Vector3::z() * moment);
    let moved = Turning::new(&beams, &modes).displacements(&amplitudes);
    let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
    // The stem's top turns by all of the angle, its one segment by half of it and about itself.
    for node in [2, 3] {
        let at = beams.position(node);
        assert!((at + moved[node] - turned * at).norm() < 1e-6, "{node}: {}", moved[node]);
    }
}

/// Where the tip of a rod of length 1 is that an even load w bends which always points across it at rest: E I angle'' =
/// -w (1 - s) cos(angle), clamped below, free above. By shooting.
fn elastica(load: f64, stiffness: f64) -> [f64; 2] {
    let n = 2000;
    let ds = 1.0 / f64::from(n);
    let shoot = |bend: f64| {
        let (mut angle, mut bend, mut at) = (0.0_f64, bend, [0.0; 2]);
        for k in 0..n {
            let falls = |angle: f64, s: f64| -load / stiffness * (1.0 - s) * angle.cos();
            let s = f64::from(k) * ds;
            // The midpoint rule.
            let middle = [angle + ds / 2.0 * bend, bend + ds / 2.0 * falls(angle, s)];
            angle += ds * middle[1];
            bend += ds * falls(middle[0], s + ds / 2.0);
            at = [at[0] + ds * middle[0].sin(), at[1] + ds * middle[0].cos()];
        }
        (bend, at)
    };
    let (mut low, mut high) = (0.0, load / stiffness);
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if shoot(middle).0 > 0.0 { high = middle } else { low = middle }
    }
    shoot(low).1
}

/// What turns leave out: large loads bend a rod less than small ones promise. Up to 15 % of its length it is as good as
/// there, and at 30 % three times as near as straight lines.
#[test]
fn a_rod_under_an_even_load_is_near_the_elastica() {
    let n = 40;
    let nodes: Vec<_> =
        (0..=n).map(|k| ((k > 0).then(|| k - 1), [0.0, 0.0, f64::from(k) / f64::from(n)])).collect();
    let beams = plant(&nodes);
    let modes = Modes::new(&beams, 60, 1).unwrap();
    let turning = Turning::new(&beams, &modes);
    let stiffness = 1e10 * PI * 0.01_f64.powi(4) / 4.0;
    for (deflection, most, times) in [(0.05, 2e-4, 8.0), (0.15, 2.5e-3, 5.0), (0.30, 0.015, 3.4)] {
        let load = 8.0 * stiffness * deflection;
        let share = |node: usize| load / f64::from(n) * if node == n as usize { 0.5 } else { 1.0 };
        let force =
            |mode| (1..=n as usize).map(|node| share(node) * modes.displacement(mode, node).x).sum::<f64>();
        let amplitudes: Vec<f64> =
            (0..modes.len()).map(|mode| force(mode) / modes.omegas[mode].powi(2)).collect();
        let moved = turning.displacements(&amplitudes)[n as usize];
        let [x, z] = elastica(load, stiffness);
        let off = (moved - Vector3::new(x, 0.0, z - 1.0)).norm();
        let straight = (Vector3::new(deflection, 0.0, 0.0) - Vector3::new(x, 0.0, z - 1.0)).norm();
        assert!(off < most && straight > times * off, "{deflection}: {moved} {x} {z}: {off} {straight}");
    }
}

/// To first order it is what the modes do, but for their stretching, which slow modes have next to none of.
#[test]
fn small_amplitudes_are_those_of_the_modes() {
    let beams = Beams::new(&honami_synth::tree(120, 2).unwrap(), &Options::default()).unwrap();
    let modes = Modes::new(&beams, 6, 1).unwrap();
    let turning = Turning::new(&beams, &modes);
    let amplitudes: Vec<f64> = (0..6).map(|mode| modes.amplitude(mode, 1e-6)).collect();
    let moved = turning.displacements(&amplitudes);
    let both = |node: usize| {
        let linear: Vector3<f64> = (0..6).map(|mode| modes.displacement(mode, node) * amplitudes[mode]).sum();
        (linear, moved[node])
    };
    let linear = DVector::from_iterator(360, (0..120).flat_map(|node| Vec::from(both(node).0.as_slice())));
    let got = DVector::from_iterator(360, (0..120).flat_map(|node| Vec::from(both(node).1.as_slice())));
    assert!((&linear - got).norm() < 1e-5 * linear.norm());
}

/// Whatever modes act together, however far, and whatever they were made for.
#[test]
fn lengths_are_kept_by_many_modes_at_once() {
    for seed in [1, 2, 3] {
        let beams = Beams::new(&honami_synth::tree(300, seed).unwrap(), &Options::default()).unwrap();
        let modes = Modes::new(&beams, 12, 1).unwrap();
        for turn in [0.1, 0.7, 5.0] {
            let amplitudes: Vec<f64> =
                (0..12).map(|mode| modes.amplitude(mode, turn) * (mode as f64 + seed as f64).sin()).collect();
            let moved = Turning::new(&beams, &modes).displacements(&amplitudes);
            assert!(longest_error(&beams, &moved) < 1e-12, "{seed} {turn}");
            assert!(moved[0] == Vector3::zeros() && moved.iter().flatten().all(|v| v.is_finite()));
        }
    }
}
