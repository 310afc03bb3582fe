//! How long branches stay, and how near the curves come.

use super::{Bending, Form};
use crate::{Beams, Modes, Options, Turning};
use nalgebra::Vector3;

fn plant(seed: u64) -> (Beams, Modes) {
    let plant = honami_synth::tree(400, seed).unwrap();
    let beams = Beams::new(&plant, &Options { longest: None, ..Options::default() }).unwrap();
    let modes = Modes::new(&beams, 12, 1).unwrap();
    (beams, modes)
}

/// Relative error of lengths, root of the mean square over segments.
fn stretch(beams: &Beams, moved: &[Vector3<f64>]) -> f64 {
    let errors = beams.segments().map(|(base, tip, section, direction)| {
        let along = direction * section.length + moved[tip] - moved[base];
        (along.norm() / section.length - 1.0).powi(2)
    });
    let (sum, n) = errors.fold((0.0, 0.0), |(sum, n), error| (sum + error, n + 1.0));
    f64::sqrt(sum / n)
}

/// Distance from where nodes should be, as a share of how far they move; roots of mean squares.
fn off(got: &[Vector3<f64>], wanted: &[Vector3<f64>]) -> f64 {
    let apart: f64 = got.iter().zip(wanted).map(|(a, b)| (a - b).norm_squared()).sum();
    (apart / wanted.iter().map(Vector3::norm_squared).sum::<f64>()).sqrt()
}

/// Curves with three powers and one arc tangent a mode are as near as the thesis's with one a node, and both far nearer
/// than the mode alone.
#[test]
fn one_arc_tangent_a_mode_with_three_powers_is_as_near_as_one_a_node() {
    let forms = [Form::Linear, Form::Node, Form::Mode(2), Form::Mode(3)];
    let mut worst = [[0.0_f64; 2]; 4];
    for seed in [1, 2] {
        let (beams, modes) = plant(seed);
        let turning = Turning::new(&beams, &modes);
        for mode in 0..12 {
            let q_max = modes.amplitude(mode, 0.4);
            for (form, worst) in forms.iter().zip(&mut worst) {
                let bending = Bending::new(&modes, &turning, mode, q_max, *form);
                // To either side, and on the way, where curves are fitted and where they are not.
                for share in [1.0, -1.0, 0.55, -0.55] {
                    let q = share * q_max;
                    let got: Vec<_> = (0..beams.len()).map(|node| bending.displacement(node, q)).collect();
                    worst[0] = worst[0].max(off(&got, &turning.of_mode(mode, q)));
                    worst[1] = worst[1].max(stretch(&beams, &got));
                }
            }
        }
    }
    let [linear, node, two, three] = worst;
    assert!(linear[0] > 0.1 && node[0] < 0.01 && two[0] < 0.015 && three[0] < node[0] / 2.0, "{worst:?}");
    assert!(linear[1] > 0.01 && two[1] < 0.0025 && three[1] < 0.0025, "{worst:?}");
}

/// Curves of modes that act together, to whatever sides, come near what turns of them all do: nearer by far than straight
/// lines, and not as near as where one acts alone.
#[test]
fn curves_of_several_modes_come_near_whichever_way_each_goes() {
    let (beams, modes) = plant(1);
    let turning = Turning::new(&beams, &modes);
    let curves = |form| -> Vec<Bending> {
        (0..4).map(|mode| Bending::new(&modes, &turning, mode, modes.amplitude(mode, 0.4), form)).collect()
    };
    let [linear, two, three] = [Form::Linear, Form::Mode(2), Form::Mode(3)].map(curves);
    for signs in [[1.0, 1.0, 1.0, 1.0], [-1.0, 1.0, -1.0, 1.0], [1.0, -1.0, -1.0, 1.0], [-1.0; 4]] {
        let q: Vec<f64> = (0..4).map(|mode| 0.4 * signs[mode] * modes.amplitude(mode, 0.4)).collect();
        let wanted = turning.displacements(&q);
        let of = |curves: &[Bending]| {
            let at = |node| curves.iter().zip(&q).map(|(curve, q)| curve.displacement(node, *q)).sum();
            off(&(0..beams.len()).map(at).collect::<Vec<Vector3<f64>>>(), &wanted)
        };
        let [linear, two, three] = [&linear, &two, &three].map(|curves| of(curves));
        assert!(linear > 0.07 && two < 0.0075 && three < 0.006, "{signs:?}: {linear} {two} {three}");
    }
}

#[test]
fn small_amplitudes_are_those_of_the_mode() {
    let (beams, modes) = plant(3);
    let q_max = modes.amplitude(0, 0.2);
    let bending = Bending::new(&modes, &Turning::new(&beams, &modes), 0, q_max, Form::Mode(3));
    for node in (0..beams.len()).step_by(20) {
        let linear = modes.displacement(0, node) * (q_max * 1e-3);
        let size = linear.norm().max(1e-6);
        assert!((bending.displacement(node, q_max * 1e-3) - linear).norm() < 0.02 * size);
    }
}
