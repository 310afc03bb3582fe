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
            let wanted = turning.of_mode(mode, q_max);
            let size = wanted.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
            for (form, worst) in forms.iter().zip(&mut worst) {
                let bending = Bending::new(&modes, &turning, mode, q_max, *form);
                let got: Vec<_> = (0..beams.len()).map(|node| bending.displacement(node, q_max)).collect();
                let off =
                    got.iter().zip(&wanted).map(|(a, b)| (a - b).norm_squared()).sum::<f64>().sqrt() / size;
                worst[0] = worst[0].max(off);
                worst[1] = worst[1].max(stretch(&beams, &got));
            }
        }
    }
    let [linear, node, two, three] = worst;
    assert!(linear[0] > 0.1 && node[0] < 0.01 && two[0] < 0.015 && three[0] < node[0] / 2.0, "{worst:?}");
    assert!(linear[1] > 0.01 && two[1] < 0.0025 && three[1] < 0.0025, "{worst:?}");
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
