//! Closed forms of exact homographies.

use super::*;
use crate::staged::{Noise, SIZE, board, board_views};

#[test]
fn exact_views_give_the_camera_back() {
    let camera = Camera { fy: 520.0, ..Camera::pinhole(536.0, Pixel::new(331.0, 215.0)) };
    let views = board_views(&camera, 5, &mut Noise::new(0, 0.0));
    let homographies: Vec<_> = views.iter().map(|view| board().seen_as(view).unwrap()).collect();
    let found = starts(&homographies, SIZE)[0];
    for (got, want) in found.numbers().into_iter().zip(camera.numbers()) {
        assert!((got - want).abs() < 1e-6, "{found:?}");
    }
    let centred = Camera::pinhole(536.0, Pixel::new(319.5, 239.5));
    let view = board_views(&centred, 1, &mut Noise::new(0, 0.0));
    let found = starts(&[board().seen_as(&view[0]).unwrap()], SIZE);
    // One view tells one focal length where the centre is known, and nothing else.
    let square = found.last().unwrap();
    assert!((square.fx - 536.0).abs() < 1e-6 && (square.fy - 536.0).abs() < 1e-6, "{found:?}");
}
