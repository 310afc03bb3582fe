//! Poses against the curves that they are made of.

use super::{Rig, arc::arc_tangent};
use crate::{Beams, Bending, Following, Form, Modes, Options, Threads, Turning};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

#[test]
fn a_pose_is_the_sum_of_what_every_mode_does() {
    for (n_nodes, n_modes, n_copies) in [(23, 3, 1), (60, 5, 7), (101, 4, 100)] {
        let beams = Beams::new(&honami_synth::tree(n_nodes, 1).unwrap(), &Options::default()).unwrap();
        let modes = Modes::new(&beams, n_modes, 1).unwrap();
        let q_max: Vec<f64> = (0..n_modes).map(|k| 1.0 + k as f64).collect();
        let mut chance = Pcg64::seed_from_u64(1);
        let amplitudes: Vec<f32> = (0..n_copies * n_modes).map(|_| chance.random_range(-1.0..1.0)).collect();
        for form in [Form::Linear, Form::Mode(2), Form::Mode(3)] {
            let turning = Turning::new(&beams, &modes);
            let bendings: Vec<Bending> =
                (0..n_modes).map(|mode| Bending::new(&modes, &turning, mode, q_max[mode], form)).collect();
            let nodes: Vec<u32> = (0..beams.len() as u32).collect();
            let rig = Rig::new(&Following::Curves(bendings.clone()), &nodes);
            let mut poses = vec![f32::NAN; n_copies * rig.n_columns()];
            rig.pose(&amplitudes, &Threads::new(1).unwrap(), &mut poses);
            for (copy, pose) in poses.chunks(rig.n_columns()).enumerate() {
                let of_copy = &amplitudes[copy * n_modes..(copy + 1) * n_modes];
                for (node, got) in pose.as_chunks::<3>().0.iter().enumerate() {
                    let moves = bendings.iter().zip(of_copy);
                    let wanted: nalgebra::Vector3<f64> =
                        moves.map(|(b, q)| b.displacement(node, f64::from(*q))).sum();
                    let size = wanted.norm().max(1e-3);
                    for axis in 0..3 {
                        assert!(
                            (f64::from(got[axis]) - wanted[axis]).abs() < 1e-5 * size,
                            "{form:?} {copy} {node}"
                        );
                    }
                }
            }
            let mut again = vec![f32::NAN; poses.len()];
            rig.pose(&amplitudes, &Threads::new(3).unwrap(), &mut again);
            assert!(
                poses.iter().zip(&again).all(|(a, b)| a.to_bits() == b.to_bits()),
                "the same bits on 3 threads"
            );
        }
    }
}

#[test]
fn arc_tangents_are_right_to_seven_digits() {
    for k in -40_000..=40_000 {
        let x = f64::from(k).powi(3) * 1e-11;
        let off = f64::from(arc_tangent(x as f32)) - f64::from(x as f32).atan();
        assert!(off.abs() < 3e-7, "{x}: {off:e}");
    }
}

/// Turns of all modes together, of any number of copies, for nodes in any order, some of them twice: what is worked out
/// in single numbers is what is worked out in double ones.
#[test]
fn a_pose_by_turns_is_what_the_modes_together_do() {
    for (n_nodes, n_modes, n_copies) in [(2, 3, 1), (60, 5, 7), (150, 12, 61)] {
        let beams = Beams::new(&honami_synth::tree(n_nodes, 1).unwrap(), &Options::default()).unwrap();
        let modes = Modes::new(&beams, n_modes, 1).unwrap();
        let turning = Turning::new(&beams, &modes);
        let mut chance = Pcg64::seed_from_u64(2);
        // Up to three radians, and some beyond what a segment turns at most.
        let most: Vec<f64> = (0..n_modes).map(|mode| modes.amplitude(mode, 6.0) / n_modes as f64).collect();
        let amplitudes: Vec<f32> = (0..n_copies * n_modes)
            .map(|k| (most[k % n_modes] * chance.random_range(-1.0..1.0)) as f32)
            .collect();
        let all: Vec<u32> = (0..n_nodes as u32).collect();
        let some: Vec<u32> = (0..n_nodes).map(|_| chance.random_range(0..n_nodes as u32)).collect();
        for nodes in [all, beams.coarse_to_fine(), beams.ends(), some] {
            let rig = Rig::new(&Following::Turns(turning.clone()), &nodes);
            let mut poses = vec![f32::NAN; n_copies * rig.n_columns()];
            rig.pose(&amplitudes, &Threads::new(2).unwrap(), &mut poses);
            for (copy, pose) in poses.chunks(rig.n_columns()).enumerate() {
                let of_copy: Vec<f64> =
                    amplitudes[copy * n_modes..][..n_modes].iter().map(|q| f64::from(*q)).collect();
                let wanted = turning.displacements(&of_copy);
                for (got, node) in pose.as_chunks::<3>().0.iter().zip(&nodes) {
                    let wanted = wanted[*node as usize].cast::<f32>();
                    let off = (nalgebra::Vector3::from(*got) - wanted).amax();
                    assert!(off < 1e-5, "{n_nodes} {copy} {node}: {got:?} {wanted}");
                }
            }
        }
    }
}

/// Beyond what any plant does it stays a plant.
#[test]
fn turns_beyond_all_measure_are_numbers_and_keep_lengths() {
    let beams = Beams::new(&honami_synth::tree(90, 1).unwrap(), &Options::default()).unwrap();
    let modes = Modes::new(&beams, 4, 1).unwrap();
    let nodes: Vec<u32> = (0..90).collect();
    let rig = Rig::new(&Following::Turns(Turning::new(&beams, &modes)), &nodes);
    for q in [1.0, 1e3, 1e12, 1e30] {
        let mut pose = vec![f32::NAN; rig.n_columns()];
        rig.pose(&[q, -q, 0.3 * q, 0.0], &Threads::new(1).unwrap(), &mut pose);
        let at = |node: usize| {
            beams.position(node) + nalgebra::Vector3::from(pose.as_chunks::<3>().0[node]).cast::<f64>()
        };
        for (base, tip, section, _) in beams.segments() {
            let length = (at(tip) - at(base)).norm();
            assert!((length / section.length - 1.0).abs() < 1e-4, "{q} {tip}: {length} {}", section.length);
        }
    }
}

#[test]
fn the_first_nodes_by_the_first_modes_are_those_of_a_rig_of_them() {
    let beams = Beams::new(&honami_synth::tree(80, 1).unwrap(), &Options::default()).unwrap();
    let modes = Modes::new(&beams, 4, 1).unwrap();
    let backwards: Vec<u32> = (0..80).rev().collect();
    let amplitudes = [0.3, -0.8, 0.7, -0.2];
    for form in [Form::Linear, Form::Mode(3), Form::Turn] {
        let following = Following::new(&beams, &modes, form);
        for nodes in [&backwards, &beams.coarse_to_fine()] {
            for (n_nodes, n_modes) in [(1, 1), (7, 4), (22, 2), (80, 3), (80, 0)] {
                let some = |nodes: &[u32], n_modes: usize, amplitudes: &[f32]| {
                    let mut pose = vec![f32::NAN; 3 * n_nodes];
                    Rig::new(&following, nodes).pose_batch([amplitudes].into_iter(), n_modes, &mut pose);
                    pose
                };
                // Modes that are not there are modes that do nothing.
                let mut still = amplitudes;
                still[n_modes..].fill(0.0);
                let few = some(&nodes[..n_nodes], 4, &still);
                assert_eq!(some(nodes, n_modes, &amplitudes), few, "{form:?} {n_nodes} {n_modes}");
            }
        }
    }
}
