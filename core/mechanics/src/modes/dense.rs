//! All vibrations of a small plant at once.

use super::ModesError;
use crate::factor::Factor;
use crate::six::DOF;
use crate::tree_matrix::TreeMatrix;
use nalgebra::{DMatrix, Dyn, SymmetricEigen};

/// Steps that an eigenvalue takes at most: two are usual.
const STEPS: usize = 60;

/// The smallest eigenvalues of K x = lambda M x and their vectors.
///
/// # Errors
/// [`ModesError::Numbers`] where M is not positive definite, to the digits that there are.
pub(super) fn all(
    factor: &Factor,
    mass: &TreeMatrix,
    n_modes: usize,
) -> Result<(Vec<f64>, Vec<f64>), ModesError> {
    let height = DOF * mass.len();
    // M^-1 is not sparse, but M = L L^T has the same eigenvalues in L^T K^-1 L.
    let column = |of: &dyn Fn(&mut [f64])| {
        let mut whole = DMatrix::zeros(height, height);
        for k in 0..height {
            let mut unit = vec![0.0; height];
            unit[k] = 1.0;
            of(&mut unit);
            whole.column_mut(k).copy_from_slice(&unit);
        }
        whole
    };
    let flexible = column(&|x| factor.solve(x));
    let heavy = column(&|x| {
        let mut product = vec![0.0; x.len()];
        mass.times(x, &mut product);
        x.copy_from_slice(&product);
    });
    let lower = heavy.cholesky().ok_or(ModesError::Numbers)?.l();
    let both = lower.tr_mul(&flexible) * &lower;
    let eigen = eigen((&both + both.transpose()) * 0.5)?;
    let order = largest(&eigen, n_modes);
    let lambdas = order.iter().map(|&k| eigen.eigenvalues[k].recip()).collect();
    // x = L^-T y.
    let mut vectors = eigen.eigenvectors.select_columns(&order);
    lower.tr_solve_lower_triangular_mut(&mut vectors);
    Ok((lambdas, vectors.as_slice().to_vec()))
}

/// Eigenvalues and vectors of a symmetric matrix. Of what is no number the search would not end.
///
/// # Errors
/// [`ModesError::Numbers`].
pub(crate) fn eigen(matrix: DMatrix<f64>) -> Result<SymmetricEigen<f64, Dyn>, ModesError> {
    if !matrix.iter().all(|v| v.is_finite()) {
        return Err(ModesError::Numbers);
    }
    let n_steps = STEPS * matrix.nrows();
    SymmetricEigen::try_new(matrix, f64::EPSILON, n_steps).ok_or(ModesError::Numbers)
}

/// Places of the largest eigenvalues, in order.
fn largest(eigen: &SymmetricEigen<f64, Dyn>, n: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    order.truncate(n);
    order
}
