//! Homographies of known matrices, and sets of points that tell none.

use super::*;

fn grid(columns: usize, rows: usize) -> Vec<Vector2<f64>> {
    (0..columns * rows)
        .map(|i| Vector2::new((i % columns) as f64 * 25.0, (i / columns) as f64 * 25.0))
        .collect()
}

#[test]
fn a_known_matrix_is_found_from_any_four_points_and_more() {
    let known = Matrix3::new(1.2, 0.1, 300.0, -0.2, 0.9, 200.0, 1e-4, -3e-4, 1.0);
    let bars = [[0.0, 0.0], [0.0, 1.5], [0.0, 3.0], [0.0, -2.0], [-0.5, 0.0], [0.5, 0.0]].map(Vector2::from);
    for from in [grid(2, 2), grid(9, 6), bars.to_vec()] {
        let to: Vec<_> = from.iter().map(|p| moved(&known, p)).collect();
        let found = homography(&from, &to).unwrap();
        assert!((found - known / known.norm()).norm() < 1e-9, "{found}");
    }
}

#[test]
fn points_before_the_camera_have_positive_depth() {
    let known = -Matrix3::new(1.2, 0.1, 300.0, -0.2, 0.9, 200.0, 1e-4, -3e-4, 1.0);
    let to: Vec<_> = grid(3, 3).iter().map(|p| moved(&known, p)).collect();
    assert!(homography(&grid(3, 3), &to).unwrap().determinant() > 0.0);
}

#[test]
fn what_tells_no_plane_is_named() {
    let seen = |from: &[Vector2<f64>]| {
        from.iter().map(|p| Vector2::new(p.x * 3.0 + p.y, p.y * 2.0 + 7.0)).collect::<Vec<_>>()
    };
    let few = grid(3, 1);
    assert_eq!(homography(&few, &seen(&few)), Err(CameraError::TooFewPoints { wanted: 4, came: 3 }));
    let line = grid(7, 1);
    let all_but_one = [grid(5, 1), vec![Vector2::new(10.0, 60.0)]].concat();
    let same = vec![Vector2::new(1.0, 1.0); 6];
    for from in [line, all_but_one, same] {
        assert_eq!(homography(&from, &seen(&from)), Err(CameraError::Collinear), "{from:?}");
    }
    // A plane that is seen edge on.
    let edge: Vec<_> = grid(3, 3).iter().map(|p| Vector2::new(p.x + p.y, 2.0 * (p.x + p.y))).collect();
    assert_eq!(homography(&grid(3, 3), &edge), Err(CameraError::Collinear));
}
