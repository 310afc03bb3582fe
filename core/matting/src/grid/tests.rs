//! Products and couplings of a grid against the same matrix with all its zeros.

use nalgebra::DVector;

use super::*;
use crate::tests::noise;

/// A symmetric matrix of numbers by chance.
fn any<const K: usize>(width: usize, height: usize, offsets: &'static [Offset]) -> Grid<K> {
    Grid::new(Size { width, height }, offsets, |node, [dx, dy]| {
        let mut number = noise((node as isize * 1000 + dx * 10 + dy + 500) as u32, 19);
        let block: Block<K> = std::array::from_fn(|_| std::array::from_fn(|_| f64::from(number()) - 9.0));
        if [dx, dy] == [0, 0] {
            std::array::from_fn(|i| std::array::from_fn(|j| block[i][j] + block[j][i]))
        } else {
            block
        }
    })
}

fn check<const K: usize>(width: usize, height: usize, offsets: &'static [Offset]) {
    let grid = any::<K>(width, height, offsets);
    let dense = grid.dense();
    assert_eq!(dense, dense.transpose());
    let mut number = noise(7, 100);
    let x: Vec<[f64; K]> =
        (0..width * height).map(|_| std::array::from_fn(|_| f64::from(number()))).collect();
    // Whatever was there before is gone.
    let mut out = vec![[f64::NAN; K]; x.len()];
    grid.times(&x, &mut out);
    let wanted = &dense * DVector::from_column_slice(x.as_flattened());
    assert_eq!(out.as_flattened(), wanted.as_slice(), "{width}x{height}, {K}");
    assert_eq!(grid.diagonal().as_flattened(), dense.diagonal().as_slice());
    grid.fault(&x, &x, &mut out);
    let left = DVector::from_column_slice(x.as_flattened()) - wanted;
    assert_eq!(out.as_flattened(), left.as_slice());
}

#[test]
fn products_are_those_of_the_whole_matrix() {
    for (width, height) in [(1, 1), (1, 5), (2, 2), (5, 1), (3, 4), (7, 6)] {
        // A picture has three pixels along a side at least.
        check::<1>(width + 2, height + 2, WITHIN_TWO);
        check::<4>(width, height, WITHIN_ONE);
    }
}

#[test]
fn a_pair_is_coupled_once_and_no_farther_than_the_offsets_say() {
    let size = Size { width: 9, height: 8 };
    let ones = Grid::<1>::new(size, WITHIN_TWO, |_, _| [[1.0]]);
    let dense = ones.dense();
    for a in 0..size.n_nodes() {
        for b in 0..size.n_nodes() {
            let far = |a: usize, b: usize| a.abs_diff(b);
            let is_near = far(a % 9, b % 9).max(far(a / 9, b / 9)) <= 2;
            assert_eq!(dense[(a, b)] > 0.5, is_near, "{a} and {b}");
        }
    }
}
