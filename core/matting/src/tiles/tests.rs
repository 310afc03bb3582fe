//! The step to a coarser grid: what it keeps, and the matrix that it makes.

use nalgebra::DMatrix;

use super::*;
use crate::Picture;
use crate::laplacian::laplacian;
use crate::tests::{columns, kinds};

/// The step as a matrix.
fn dense<const K: usize>(tiles: &Tiles<K>) -> DMatrix<f64> {
    let n = tiles.coarse.n_nodes() * KEPT;
    let mut dense = DMatrix::zeros(tiles.fine.n_nodes() * K, n);
    for k in 0..n {
        let mut coarse = vec![[0.0; KEPT]; tiles.coarse.n_nodes()];
        coarse[k / KEPT][k % KEPT] = 1.0;
        let mut fine = vec![[0.0; K]; tiles.fine.n_nodes()];
        tiles.add_to(&mut fine, &coarse);
        dense.column_mut(k).copy_from_slice(fine.as_flattened());
    }
    dense
}

fn by_columns<const K: usize>(shares: &[Share<K>]) -> DMatrix<f64> {
    DMatrix::from_row_slice(shares.len() * K, KEPT, shares.as_flattened().as_flattened())
}

/// One step: the vectors are kept, the columns are orthonormal or nought, the coarser matrix is Galerkin's, and what is
/// gathered is the transpose of what is added.
fn check<const K: usize>(
    name: &str,
    matrix: &Grid<K>,
    vectors: &[Share<K>],
) -> (Grid<KEPT>, Vec<Share<KEPT>>) {
    let (tiles, coarser) = Tiles::new(matrix.size, vectors);
    let step = dense(&tiles);
    let off = (&step * by_columns(&coarser) - by_columns(vectors)).amax();
    assert!(off < 1e-4, "{name}: the vectors are off by {off:e}");
    let products = step.transpose() * &step;
    for (k, column) in products.column_iter().enumerate() {
        let own = column[k];
        assert!(own == 0.0 || (own - 1.0).abs() < 1e-12, "{name}: {own}");
        let rest = column.iter().enumerate().filter(|&(j, _)| j != k).map(|(_, product)| product.abs());
        assert!(rest.fold(0.0, f64::max) < 1e-9, "{name}, column {k}");
    }
    let galerkin = tiles.coarser(matrix);
    let mut wanted = step.transpose() * matrix.dense() * &step;
    for k in 0..wanted.nrows() {
        if wanted[(k, k)] == 0.0 {
            wanted[(k, k)] = 1.0;
        }
    }
    let off = (galerkin.dense() - wanted).amax();
    assert!(off < 1e-11, "{name}: the coarser matrix is off by {off:e}");

    let fine: Vec<[f64; K]> =
        vectors.iter().map(|share| share.map(|numbers| numbers[1] - numbers[2])).collect();
    let mut gathered = vec![[f64::NAN; KEPT]; coarser.len()];
    tiles.gather(&fine, &mut gathered);
    let wanted = step.transpose() * DMatrix::from_column_slice(fine.len() * K, 1, fine.as_flattened());
    let off = gathered.as_flattened().iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-12, "{name}: gathered is off by {off:e}");
    (galerkin, coarser)
}

#[test]
fn a_step_keeps_its_vectors_and_makes_galerkins_matrix() {
    for (width, height) in [(3, 3), (10, 8), (13, 11)] {
        for (name, rgb) in kinds(width, height) {
            let picture = Picture::new(width as u32, height as u32, &rgb).unwrap();
            let vectors = crate::lost(&picture, &columns(width, height));
            let (matrix, vectors) = check(name, &laplacian(&picture, 1e-7), &vectors);
            check(name, &matrix, &vectors);
        }
    }
}
