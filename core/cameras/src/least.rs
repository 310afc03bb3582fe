//! Least squares of what was seen: Levenberg and Marquardt's method for problems in the shape of an arrow.
//!
//! Some parameters are *shared* by all residuals (the cameras), the others are a block's *own* (where the target was in a view). With
//! the matrix of second derivatives `[U W; Wᵀ V]`, V of blocks, a step solves `(U - Σ W V⁻¹ Wᵀ) δ = g - Σ W V⁻¹ h` first, so
//! work grows linearly with the number of blocks. Robust losses weigh every residual anew in each step.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use crate::Pixel;

/// Steps after which the search is given up.
const MOST_STEPS: usize = 200;
/// Damping at first, of the diagonal.
const DAMPING: f64 = 1e-3;
/// No step helps at this damping: what is left is rounding.
const MOST_DAMPING: f64 = 1e12;
/// At rest, where a step takes less than this share off the cost.
const AT_REST: f64 = 1e-11;
/// Residuals of a millionth of a millionth of a pixel are none.
const NOTHING_PX2: f64 = 1e-24;

/// What an offset of some pixels costs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Loss {
    /// Its square: right where all errors are of one kind.
    Squares,
    /// Its square up to this many pixels, linear beyond (Huber).
    Huber(f64),
    /// Its logarithm beyond some of these pixels (Cauchy): gross errors hardly count, but a start must be near.
    Cauchy(f64),
}

impl Loss {
    /// Cost of a squared offset, px².
    fn cost(self, squared: f64) -> f64 {
        match self {
            Self::Squares => squared,
            Self::Huber(at) if squared <= at * at => squared,
            Self::Huber(at) => 2.0 * at * squared.sqrt() - at * at,
            Self::Cauchy(at) => at * at * (squared / (at * at)).ln_1p(),
        }
    }

    /// What a squared offset counts, 0..=1: the slope of the cost.
    pub(crate) fn weight(self, squared: f64) -> f64 {
        match self {
            Self::Squares => 1.0,
            Self::Huber(at) => (at / squared.sqrt()).min(1.0),
            Self::Cauchy(at) => 1.0 / (1.0 + squared / (at * at)),
        }
    }
}

/// Residuals of a block, and their slopes: two rows a residual.
pub(crate) struct Block {
    pub(crate) offsets: Vec<Pixel>,
    pub(crate) by_shared: DMatrix<f64>,
    pub(crate) by_own: DMatrix<f64>,
}

impl Block {
    pub(crate) fn zeros(n_offsets: usize, n_shared: usize, n_own: usize) -> Self {
        Self {
            offsets: vec![Pixel::zeros(); n_offsets],
            by_shared: DMatrix::zeros(2 * n_offsets, n_shared),
            by_own: DMatrix::zeros(2 * n_offsets, n_own),
        }
    }
}

/// What is to be fitted.
pub(crate) trait Problem: Sized {
    fn n_shared(&self) -> usize;
    /// Parameters of each block; as many of all.
    fn n_own(&self) -> usize;
    fn n_blocks(&self) -> usize;
    /// What is seen less what was measured, pixels; `None` where something cannot be seen at all.
    fn block(&self, block: usize) -> Option<Block>;
    fn stepped(&self, shared: &DVector<f64>, own: &[DVector<f64>]) -> Self;
}

/// What fits best.
pub(crate) struct Fitted<P> {
    pub(crate) problem: P,
    /// What its offsets cost, px².
    pub(crate) cost: f64,
    /// Of one coordinate of a residual, pixels: the root of the weighted mean square, less what fitting took.
    pub(crate) sigma_px: f64,
    /// Offsets of each block.
    pub(crate) offsets: Vec<Vec<Pixel>>,
    /// Covariance of the shared parameters for errors of 1 px; times `sigma_px`² for those that were met.
    pub(crate) shared: DMatrix<f64>,
    /// Of the own ones of each block, likewise.
    pub(crate) own: Vec<DMatrix<f64>>,
}

/// Why nothing fits best.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unfitted {
    /// The start does not see what was seen.
    Start,
    /// Parameters that the residuals do not tell apart.
    Loose,
    /// Still moving after so many steps.
    Restless,
}

/// Second and first derivatives of half the cost.
struct Normal {
    cost: f64,
    u: DMatrix<f64>,
    g: DVector<f64>,
    own: Vec<Own>,
    offsets: Vec<Vec<Pixel>>,
}

struct Own {
    v: DMatrix<f64>,
    w: DMatrix<f64>,
    h: DVector<f64>,
}

/// The parameters of least cost, from a start that is near them.
pub(crate) fn fit<P: Problem>(start: P, loss: Loss) -> Result<Fitted<P>, Unfitted> {
    let mut problem = start;
    let mut normal = Normal::of(&problem, loss).ok_or(Unfitted::Start)?;
    let mut damping = DAMPING;
    for _ in 0..MOST_STEPS {
        let mut gain = None;
        while gain.is_none() && damping < MOST_DAMPING {
            let stepped = normal.step(damping).map(|(shared, own)| problem.stepped(&shared, &own));
            let tried = stepped.and_then(|stepped| Some((Normal::of(&stepped, loss)?, stepped)));
            match tried.filter(|(tried, _)| tried.cost <= normal.cost) {
                Some((tried, stepped)) => {
                    gain = Some(normal.cost - tried.cost);
                    (normal, problem) = (tried, stepped);
                    damping = (damping / 10.0).max(1e-12);
                }
                None => damping *= 10.0,
            }
        }
        let nothing = NOTHING_PX2 * normal.n_offsets() as f64;
        if gain.is_none_or(|gain| gain <= AT_REST * normal.cost || normal.cost <= nothing) {
            return normal.finish(problem, loss);
        }
    }
    Err(Unfitted::Restless)
}

impl Normal {
    fn of(problem: &impl Problem, loss: Loss) -> Option<Self> {
        let (n_shared, n_blocks) = (problem.n_shared(), problem.n_blocks());
        let mut normal = Self {
            cost: 0.0,
            u: DMatrix::zeros(n_shared, n_shared),
            g: DVector::zeros(n_shared),
            own: Vec::with_capacity(n_blocks),
            offsets: Vec::with_capacity(n_blocks),
        };
        for block in 0..n_blocks {
            normal.add(problem.block(block)?, loss);
        }
        normal.cost.is_finite().then_some(normal)
    }

    fn add(&mut self, block: Block, loss: Loss) {
        let Block { offsets, mut by_shared, mut by_own } = block;
        let mut residuals = DVector::zeros(2 * offsets.len());
        for (i, offset) in offsets.iter().enumerate() {
            let squared = offset.norm_squared();
            self.cost += loss.cost(squared);
            let root = loss.weight(squared).sqrt();
            for (row, coordinate) in [(2 * i, offset.x), (2 * i + 1, offset.y)] {
                residuals[row] = root * coordinate;
                by_shared.row_mut(row).scale_mut(root);
                by_own.row_mut(row).scale_mut(root);
            }
        }
        let (shared_t, own_t) = (by_shared.transpose(), by_own.transpose());
        self.u += &shared_t * &by_shared;
        self.g += &shared_t * &residuals;
        self.own.push(Own { v: &own_t * &by_own, w: shared_t * &by_own, h: own_t * residuals });
        self.offsets.push(offsets);
    }

    fn n_offsets(&self) -> usize {
        self.offsets.iter().map(Vec::len).sum()
    }

    /// Steps of the shared and of all own parameters; `None` where the damped matrix is not positive.
    fn step(&self, damping: f64) -> Option<(DVector<f64>, Vec<DVector<f64>>)> {
        let (mut s, mut rhs) = (damped(&self.u, damping), self.g.clone());
        let mut own = Vec::with_capacity(self.own.len());
        for Own { v, w, h } in &self.own {
            let v = damped(v, damping).cholesky()?;
            let back = v.solve(&w.transpose());
            rhs -= w * v.solve(h);
            s -= w * &back;
            own.push((v.solve(h), back));
        }
        let shared = if s.is_empty() { rhs } else { s.cholesky()?.solve(&rhs) };
        let own = own.into_iter().map(|(alone, back)| back * &shared - alone).collect();
        Some((-shared, own))
    }

    fn finish<P: Problem>(self, problem: P, loss: Loss) -> Result<Fitted<P>, Unfitted> {
        let (mut weighted, mut weights) = (0.0, 0.0);
        for squared in self.offsets.iter().flatten().map(Pixel::norm_squared) {
            weighted += loss.weight(squared) * squared;
            weights += 2.0 * loss.weight(squared);
        }
        let n_parameters = problem.n_shared() + problem.n_own() * problem.n_blocks();
        let free = weights - n_parameters as f64;
        // As many numbers as parameters fit always, and say nothing of errors.
        let sigma_px = if free > 0.0 { (weighted / free).sqrt() } else { 0.0 };
        let (shared, own) = self.covariances().ok_or(Unfitted::Loose)?;
        Ok(Fitted { problem, cost: self.cost, sigma_px, offsets: self.offsets, shared, own })
    }

    fn covariances(&self) -> Option<(DMatrix<f64>, Vec<DMatrix<f64>>)> {
        let mut s = self.u.clone();
        let mut own = Vec::with_capacity(self.own.len());
        for Own { v, w, .. } in &self.own {
            let v = inverse(v, &v.diagonal())?;
            let back = &v * w.transpose();
            s -= w * &back;
            own.push((v, back));
        }
        let shared = inverse(&s, &self.u.diagonal())?;
        let own = own.into_iter().map(|(v, back)| v + &back * &shared * back.transpose()).collect();
        Some((shared, own))
    }
}

fn damped(matrix: &DMatrix<f64>, damping: f64) -> DMatrix<f64> {
    let mut damped = matrix.clone();
    for i in 0..matrix.nrows() {
        damped[(i, i)] += damping * matrix[(i, i)].max(f64::MIN_POSITIVE);
    }
    damped
}

/// Inverse of a symmetric matrix that is positive by more than rounding, whatever the units of its rows; `size` is what they were
/// before anything was taken off.
fn inverse(matrix: &DMatrix<f64>, size: &DVector<f64>) -> Option<DMatrix<f64>> {
    /// What is below is rounding.
    const SMALLEST: f64 = 1e-13;
    if matrix.is_empty() {
        return Some(matrix.clone());
    }
    if size.iter().any(|size| !(size.is_finite() && *size > 0.0)) {
        return None;
    }
    let scale = DMatrix::from_diagonal(&size.map(|size| 1.0 / size.sqrt()));
    let eigen = (&scale * matrix * &scale).symmetric_eigen();
    if eigen.eigenvalues.min() <= SMALLEST {
        return None;
    }
    let vectors = &eigen.eigenvectors;
    let turned = vectors * DMatrix::from_diagonal(&eigen.eigenvalues.map(|v| 1.0 / v)) * vectors.transpose();
    Some(&scale * turned * scale)
}

#[cfg(test)]
mod tests;
