//! How leaves move: together on a branch, at the frequencies of the branches that carry them.

use std::f64::consts::{PI, TAU};

use super::{scene, small};
use crate::{LeafTruth, Scene, Settings};

/// Steps of a leaf from frame to frame.
fn steps(leaf: &LeafTruth) -> Vec<[f64; 2]> {
    leaf.path.windows(2).map(|pair| [pair[1].x - pair[0].x, pair[1].y - pair[0].y]).collect()
}

/// Root mean square of how differently two leaves step, pixels.
fn apart(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2));
    (squares.sum::<f64>() / a.len() as f64).sqrt()
}

#[test]
fn leaves_of_one_branch_move_more_alike_than_leaves_of_others() {
    for seed in 1..5 {
        let scene = scene(&Settings { seed, n_frames: 100, n_leaves: 120, ..small() });
        let leaves = &scene.truth().leaves;
        let steps: Vec<_> = leaves.iter().map(steps).collect();
        let (mut same, mut other) = ((0.0, 0), (0.0, 0));
        for (i, a) in leaves.iter().enumerate() {
            for (j, b) in leaves.iter().enumerate().skip(i + 1) {
                let sum = if a.branch == b.branch { &mut same } else { &mut other };
                sum.0 += apart(&steps[i], &steps[j]);
                sum.1 += 1;
            }
        }
        let (same, other) = (same.0 / f64::from(same.1), other.0 / f64::from(other.1));
        assert!(same < 0.65 * other, "seed {seed}: {same} px within branches, {other} px between them");
    }
}

#[test]
fn every_branch_rides_on_its_parent() {
    let scene = scene(&small());
    let branches = &scene.truth().branches;
    for branch in branches {
        let parent = branch.parent.map(|id| &branches[id as usize]);
        assert!(parent.is_none_or(|parent| parent.id < branch.id && parent.order + 1 == branch.order));
        assert!(branch.order <= 3 && (1..=3).contains(&branch.mode_hz.len()));
    }
    assert!(scene.truth().leaves.iter().all(|leaf| branches[leaf.branch as usize].order >= 2));
    for frame in [5, 20] {
        let (rest, pose) = (scene.pose(0), scene.pose(frame));
        for (id, branch) in branches.iter().enumerate() {
            let Some(parent) = branch.parent.map(|parent| parent as usize) else { continue };
            let place = |pose: &crate::pose::Pose| pose.branches[parent].into_local(pose.branches[id].origin);
            assert!((place(&rest) - place(&pose)).norm() < 1e-9, "branch {id} left its parent");
        }
    }
}

/// The strongest frequency of a branch's leaves between 0.2 and 6 Hz.
fn peak_hz(scene: &Scene, branch: u32) -> Option<f64> {
    let leaves: Vec<_> = scene.truth().leaves.iter().filter(|leaf| leaf.branch == branch).collect();
    let n_frames = leaves.first()?.path.len();
    let power = |hz: f64| {
        let (mut sum, mut mean) = ([[0.0; 2]; 2], [0.0; 2]);
        for at in leaves.iter().flat_map(|leaf| &leaf.path) {
            mean = [mean[0] + at.x, mean[1] + at.y];
        }
        let mean = mean.map(|m| m / (leaves.len() * n_frames) as f64);
        for (frame, at) in leaves.iter().flat_map(|leaf| leaf.path.iter().enumerate()) {
            let window = (PI * frame as f64 / n_frames as f64).sin().powi(2);
            let (sin, cos) = (TAU * hz * frame as f64 / scene.settings().fps).sin_cos();
            for (sum, off) in sum.iter_mut().zip([at.x - mean[0], at.y - mean[1]]) {
                *sum = [sum[0] + window * off * sin, sum[1] + window * off * cos];
            }
        }
        sum.as_flattened().iter().map(|s| s * s).sum::<f64>()
    };
    let grid = (10..300).map(|step| f64::from(step) * 0.02);
    grid.map(|hz| (hz, power(hz))).max_by(|a, b| a.1.total_cmp(&b.1)).map(|(hz, _)| hz)
}

#[test]
fn the_leaves_of_a_branch_move_at_one_of_its_modes() {
    let scene = scene(&Settings { n_frames: 500, n_leaves: 40, ..small() });
    let mut n_seen = 0;
    for branch in &scene.truth().branches {
        let Some(peak_hz) = peak_hz(&scene, branch.id) else { continue };
        let modes_hz = scene.truth().modes_of(branch.id);
        assert!(
            modes_hz.iter().any(|hz| (hz - peak_hz).abs() < 0.06),
            "branch {}: {peak_hz} Hz is none of {modes_hz:?}",
            branch.id
        );
        n_seen += 1;
    }
    assert!(n_seen >= 4, "{n_seen} branches with leaves");
}
