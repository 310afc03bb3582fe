//! Poses against the curves that they are made of.

use super::{Rig, arc::arc_tangent};
use crate::{Beams, Bending, Form, Modes, Options, Threads};
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
            let bendings: Vec<Bending> =
                (0..n_modes).map(|mode| Bending::new(&beams, &modes, mode, q_max[mode], form)).collect();
            let nodes: Vec<u32> = (0..beams.len() as u32).collect();
            let rig = Rig::new(&bendings, &nodes);
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

#[test]
fn the_first_nodes_by_the_first_modes_are_those_of_a_rig_of_them() {
    let beams = Beams::new(&honami_synth::tree(80, 1).unwrap(), &Options::default()).unwrap();
    let modes = Modes::new(&beams, 4, 1).unwrap();
    let bendings: Vec<Bending> =
        (0..4).map(|mode| Bending::new(&beams, &modes, mode, 2.0, Form::Mode(3))).collect();
    let all: Vec<u32> = (0..80).rev().collect();
    let amplitudes = [0.3, -0.8, 0.7, -0.2];
    for (n_nodes, n_modes) in [(1, 1), (7, 4), (22, 2), (80, 3), (80, 0)] {
        let some = |rig: Rig| {
            let mut pose = vec![f32::NAN; 3 * n_nodes];
            rig.pose_batch([&amplitudes[..]].into_iter(), n_modes, &mut pose);
            pose
        };
        let few = some(Rig::new(&bendings[..n_modes.max(1)], &all[..n_nodes]));
        assert_eq!(some(Rig::new(&bendings, &all)), few, "{n_nodes} {n_modes}");
    }
}
