//! A cycle is a good guess, and the same guess whatever it was asked before.

use super::*;
use crate::Picture;
use crate::laplacian::laplacian;
use crate::solve::solve;
use crate::tests::{columns, kinds};

fn cycle(rgb: &[[u8; 3]], width: usize, height: usize) -> Cycle {
    let picture = Picture::new(width as u32, height as u32, rgb).unwrap();
    let marks = columns(width, height);
    let mut matrix = laplacian(&picture, 1e-7);
    for (block, mark) in matrix.blocks[0].iter_mut().zip(&marks) {
        block[0][0] += mark.alpha().map_or(0.0, |_| 100.0);
    }
    Cycle::new(matrix, &crate::lost(&picture, &marks))
}

#[test]
fn the_most_that_smoothing_reckons_with_is_no_less_than_the_matrix_feels() {
    for (name, rgb) in kinds(17, 14) {
        let cycle = cycle(&rgb, 17, 14);
        let root: Vec<f64> =
            cycle.pixels.inverse.as_flattened().iter().map(|inverse| inverse.sqrt()).collect();
        let mut scaled = cycle.matrix().dense();
        for i in 0..root.len() {
            for j in 0..root.len() {
                scaled[(i, j)] *= root[i] * root[j];
            }
        }
        let largest = scaled.symmetric_eigenvalues().max();
        let most = cycle.pixels.most;
        assert!((largest..1.5 * largest).contains(&most), "{name}: {largest} is taken to be {most}");
    }
}

#[test]
fn a_larger_picture_takes_hardly_more_steps() {
    for (width, height) in [(9, 9), (30, 20), (75, 60), (200, 150)] {
        for (name, rgb) in kinds(width, height) {
            let mut cycle = cycle(&rgb, width, height);
            let is_last = |k: usize| k % width == width - 1;
            let right: Vec<[f64; 1]> =
                (0..width * height).map(|k| [if is_last(k) { 100.0 } else { 0.0 }]).collect();
            let first = vec![[0.0]; right.len()];
            let solved = solve(&mut cycle, &right, first.clone(), &mut |_| true).unwrap();
            assert!(solved.n_steps <= 80, "{name} {width}x{height}: {} steps", solved.n_steps);
            // What was asked before changes nothing.
            let again = solve(&mut cycle, &right, first, &mut |_| true).unwrap();
            assert_eq!(solved.x, again.x);
        }
    }
}
