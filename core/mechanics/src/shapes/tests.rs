//! Motions made of a few shapes, of curves and of nothing: each node in each frame as near as was wanted, by no more shapes
//! than it takes.

use super::{Shapes, Sums};
use crate::Threads;
use nalgebra::{DMatrix, Rotation3, Vector3};

const N_NODES: usize = 23;

/// So many frames of a stem whose nodes swing on arcs, the higher the farther, and of a twig that goes round.
fn swinging(n_frames: usize) -> Vec<Vec<[f32; 3]>> {
    let node = |k: usize, frame: usize| {
        let t = frame as f64 * 0.13;
        let turn = 0.08 * k as f64 * Vector3::new((1.7 * t).sin(), 0.6 * t.cos(), 0.0);
        let twig = if k > 18 { Vector3::z() * (0.5 * (3.1 * t).sin()) } else { Vector3::zeros() };
        let rest = Vector3::new(0.3 * f64::from(k > 18), 0.0, k as f64 * 0.1);
        let moved = Rotation3::new(turn) * Rotation3::new(twig) * rest - rest;
        moved.map(|v| v as f32).into()
    };
    (0..n_frames).map(|frame| (0..N_NODES).map(|k| node(k, frame)).collect()).collect()
}

fn gathered(frames: &[Vec<[f32; 3]>], near: f64, at_once: usize, n_threads: usize) -> (usize, Sums) {
    let (mut shapes, threads) = (Shapes::new(N_NODES, near), Threads::new(n_threads).unwrap());
    for some in frames.chunks(at_once) {
        shapes.take(&some.concat(), &threads).unwrap();
    }
    (shapes.len(), shapes.fewest(&threads))
}

/// How far nodes are from where sums have them, at most.
fn off(frames: &[Vec<[f32; 3]>], sums: &Sums) -> f64 {
    let n = sums.shapes.len();
    let off = |(frame, moved): (usize, &Vec<[f32; 3]>)| {
        let weights = &sums.weights[frame * n..][..n];
        let apart = moved.iter().enumerate().map(|(node, moved)| {
            let made: Vector3<f64> =
                sums.shapes.iter().zip(weights).map(|(shape, w)| shape[node] * f64::from(*w)).sum();
            (made - Vector3::from(moved.map(f64::from))).norm()
        });
        apart.fold(0.0, f64::max)
    };
    frames.iter().enumerate().map(off).fold(0.0, f64::max)
}

/// How many singular vectors of all frames it takes until every node is near.
fn of_svd(frames: &[Vec<[f32; 3]>], near: f64) -> usize {
    let column = |frame: &Vec<[f32; 3]>| frame.as_flattened().iter().map(|v| f64::from(*v)).collect();
    let columns: Vec<Vec<f64>> = frames.iter().map(column).collect();
    let whole = DMatrix::from_fn(3 * N_NODES, frames.len(), |row, frame| columns[frame][row]);
    let svd = whole.clone().svd(true, true);
    let (u, v) = (svd.u.unwrap(), svd.v_t.unwrap());
    (0..)
        .find(|&n| {
            let scaled =
                u.columns(0, n) * DMatrix::from_diagonal(&svd.singular_values.rows(0, n).into_owned());
            let left = &whole - scaled * v.rows(0, n);
            let far = left.as_slice().chunks(3).map(|v| v.iter().map(|v| v * v).sum::<f64>().sqrt());
            far.fold(0.0, f64::max) <= near
        })
        .unwrap()
}

#[test]
fn every_node_of_every_frame_is_near_by_hardly_more_shapes_than_singular_vectors() {
    let frames = swinging(200);
    for (near, at_once) in [(0.1, 1), (0.01, 7), (1e-3, 200), (1e-5, 3)] {
        let (n_gathered, sums) = gathered(&frames, near, at_once, 1);
        let off = off(&frames, &sums);
        // What is told is never too little, and it is no empty promise.
        assert!(
            off <= sums.off + 1e-6 && sums.off <= near && off > 0.2 * near - 1e-6,
            "{near}: {off} {}",
            sums.off
        );
        let (n, n_svd) = (sums.shapes.len(), of_svd(&frames, near));
        assert!(n >= n_svd && n <= n_svd + 2 && n <= n_gathered, "{near}: {n} {n_svd} {n_gathered}");
        assert!(
            sums.parts.is_sorted_by(|a, b| a >= b) && (0.9..=1.0 + 1e-9).contains(&sums.parts.iter().sum())
        );
        let far = |k: usize| sums.weights.iter().skip(k).step_by(n).copied().fold(f32::MIN, f32::max);
        assert!((0..n).all(|k| (far(k) - 1.0).abs() < 1e-6), "{near}");
    }
}

/// Sums of three shapes are three shapes.
#[test]
fn a_motion_of_three_shapes_has_no_more() {
    let shape = |k: usize, node: usize| ((node * (k + 2)) as f64 * 0.37).sin();
    let frame = |frame: usize| {
        let of = |node: usize, axis: usize| {
            let parts = (0..3).map(|k| shape(k, 3 * node + axis) * ((frame * (k + 1)) as f64 * 0.11).cos());
            parts.sum::<f64>() as f32
        };
        (0..N_NODES).map(|node| [of(node, 0), of(node, 1), of(node, 2)]).collect()
    };
    let frames: Vec<Vec<[f32; 3]>> = (0..130).map(frame).collect();
    let (_, sums) = gathered(&frames, 1e-4, 10, 2);
    assert_eq!(sums.shapes.len(), 3);
    assert!(off(&frames, &sums) < 1e-5 && (sums.parts.iter().sum::<f64>() - 1.0).abs() < 1e-6);
}

#[test]
fn shapes_are_the_same_on_any_number_of_threads() {
    let frames = swinging(90);
    assert_eq!(gathered(&frames, 1e-3, 30, 1), gathered(&frames, 1e-3, 30, 3));
}

/// What stands still has no shapes; what is no number is refused, also behind a node that is.
#[test]
fn stillness_has_none_and_what_is_no_number_is_refused() {
    let still = vec![vec![[0.0; 3]; N_NODES]; 5];
    let (_, sums) = gathered(&still, 1e-3, 5, 1);
    assert!(sums.shapes.is_empty() && sums.weights.is_empty() && sums.off == 0.0);
    let mut frames = swinging(4);
    frames[2][7][1] = f32::NAN;
    let (mut shapes, threads) = (Shapes::new(N_NODES, 1e-3), Threads::new(1).unwrap());
    let error = shapes.take(&frames.concat(), &threads).unwrap_err();
    assert!(error.to_string().contains("frame 2 of a motion"), "{error}");
}
