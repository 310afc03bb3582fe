//! Slopes of bundles against differences.

use nalgebra::{DVector, Vector3};

use super::*;
use crate::staged::{LENS, Noise, board, poses, seen};

#[test]
fn slopes_are_those_of_differences() {
    let (target, stands) = (board(), poses(2, [100.0, 62.5], 450.0, 60.0));
    let right_from_left = Pose::new(Vector3::new(0.02, -0.1, 0.03), Vector3::new(-80.0, 2.0, 5.0));
    let square = Model { focal: Focal::Square, ..Model::WHOLE };
    let right = Camera { fx: 500.0, fy: 500.0, ..LENS };
    let mut noise = Noise::new(5, 0.5);
    let views: Vec<Vec<Sighting>> = stands
        .iter()
        .map(|pose| {
            let seen_right = seen(&right, &right_from_left.after(pose), &target, &mut noise);
            vec![seen(&LENS, pose, &target, &mut noise), seen_right]
        })
        .collect();
    let cameras = [(LENS, Model::WHOLE), (right, square)];
    let bundle = Bundle::new(&target, &views, &cameras, vec![Pose::identity(), right_from_left], stands);
    assert_eq!(bundle.n_shared(), 9 + 8 + 6);
    let block = bundle.block(1).unwrap();
    let still = || vec![DVector::zeros(6); 2];
    let offsets = |bundle: &Bundle<'_>| {
        let block = bundle.block(1).unwrap();
        DVector::from_iterator(2 * block.offsets.len(), block.offsets.iter().flat_map(|o| [o.x, o.y]))
    };
    let check = |slopes: &DMatrix<f64>, column: usize, stepped: &dyn Fn(f64) -> DVector<f64>| {
        let difference = (stepped(1e-6) - stepped(-1e-6)) / 2e-6;
        let far = (difference - slopes.column(column)).amax();
        assert!(far < 1e-4, "column {column}: {far}");
    };
    for k in 0..bundle.n_shared() {
        check(&block.by_shared, k, &|h| {
            let mut step = DVector::zeros(bundle.n_shared());
            step[k] = h;
            offsets(&bundle.stepped(&step, &still()))
        });
    }
    for k in 0..6 {
        check(&block.by_own, k, &|h| {
            let mut own = still();
            own[1][k] = h;
            offsets(&bundle.stepped(&DVector::zeros(bundle.n_shared()), &own))
        });
    }
}
