//! Distances and pieces, against every pair of pixels and by eye.

use super::*;
use crate::tests::noise;

#[test]
fn near_is_no_farther_than_the_radius() {
    for (width, height, of) in [(1, 1, 2), (9, 1, 4), (1, 9, 4), (14, 11, 30), (14, 11, 300)] {
        let mut number = noise(width as u32, of);
        let size = Size { width, height };
        let shape: Vec<bool> = (0..width * height).map(|_| number() == 0).collect();
        for radius in [0, 1, 2, 5, 30] {
            let found = near(&shape, size, radius);
            for (pixel, found) in found.into_iter().enumerate() {
                let is_near = |other: usize| {
                    let [dx, dy] =
                        [(pixel % width).abs_diff(other % width), (pixel / width).abs_diff(other / width)];
                    dx * dx + dy * dy <= radius * radius
                };
                let wanted = (0..shape.len()).any(|other| shape[other] && is_near(other));
                assert_eq!(found, wanted, "{width}x{height}, radius {radius}, pixel {pixel}");
            }
        }
    }
}

#[test]
fn pieces_hang_together_by_rows_and_columns() {
    let rows = ["......", ".##.#.", ".#...#", "......"];
    let shape: Vec<bool> = rows.concat().bytes().map(|b| b == b'#').collect();
    let found = pieces(&shape, Size { width: 6, height: 4 });
    let mut found: Vec<(Vec<usize>, bool)> =
        found.into_iter().map(|piece| (piece.pixels, piece.at_border)).collect();
    found.iter_mut().for_each(|(pixels, _)| pixels.sort_unstable());
    assert_eq!(found, [(vec![7, 8, 13], false), (vec![10], false), (vec![17], true)]);
}
