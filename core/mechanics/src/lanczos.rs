//! Eigenvalues of a pair of matrices near a shift, by block Lanczos.
//!
//! Two vectors at a time, so that modes of exactly equal frequency, which every symmetric plant has, are found
//! together; every new block is made orthogonal to all before in the inner product of M (Grimes, Lewis and Simon,
//! SIAM J. Matrix Anal. Appl. 15, 1994).

use crate::factor::{Factor, WIDE};
use crate::modes::{ModesError, eigen};
use crate::simd::{accumulate, dot, mixed, products};
use crate::six::DOF;
use crate::tree_matrix::TreeMatrix;
use nalgebra::{DMatrix, DMatrixView, DMatrixViewMut};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::mem::{replace, take};

/// An eigenvalue counts as found when its vector solves (K - s M)^-1 M x = nu x to so small a share of nu.
const TOLERANCE: f64 = 3e-11;
/// What is left of a column in all those before it is nothing new.
const NOTHING: f64 = 1e-10;
/// Where so small a share of a column lay in those before, its product with M is still as good as new.
const STALE: f64 = 1e-14;
/// Where so small a share lay in those before, what is left is orthogonal to them but for rounding.
const ENOUGH: f64 = 1e-6;
/// A column is freed of those before at most so many times.
const FREED_MAX: usize = 3;

/// A growing basis in which (K - s M)^-1 M is tridiagonal by blocks.
pub(crate) struct Lanczos<'a> {
    /// Of K - s M.
    factor: &'a Factor,
    shift: f64,
    mass: &'a TreeMatrix,
    height: usize,
    /// Columns of length 1 in M, orthogonal to one another.
    basis: Vec<f64>,
    /// M times the last block.
    mass_last: Vec<f64>,
    /// Room for the next block, and for its product with M.
    next: Vec<f64>,
    mass_next: Vec<f64>,
    /// Diagonal blocks, and those that lead to the next block.
    diagonal: Vec<Square>,
    below: Vec<Square>,
    chance: Pcg64,
}

type Square = [[f64; WIDE]; WIDE];

/// What the basis knows of the eigenvalues of K x = lambda M x.
pub(crate) struct Ritz {
    /// Those that are found next to the shift: ascending, none missing between them unless it was missed altogether.
    pub(crate) lambdas: Vec<f64>,
    /// Their vectors in the basis.
    small: DMatrix<f64>,
}

impl<'a> Lanczos<'a> {
    /// With room for so many columns, which may become more.
    ///
    /// # Errors
    /// [`ModesError::Memory`].
    pub(crate) fn new(
        factor: &'a Factor,
        shift: f64,
        mass: &'a TreeMatrix,
        seed: u64,
        n_columns: usize,
    ) -> Result<Self, ModesError> {
        let height = DOF * mass.len();
        let mut chance = Pcg64::seed_from_u64(seed);
        let mut first: Vec<f64> = (0..WIDE * height).map(|_| chance.random_range(-1.0..1.0)).collect();
        // Chance is mostly fast vibrations: one step towards the slow ones.
        factor.solve(&mut first);
        let (diagonal, below) = Default::default();
        let mut basis = Vec::new();
        reserve(&mut basis, n_columns * height)?;
        let [mass_last, mut mass_next] = [0, 1].map(|_| vec![0.0; WIDE * height]);
        mass.times(&first, &mut mass_next);
        let next = first;
        let mut made =
            Self { factor, shift, mass, height, basis, mass_last, next, mass_next, diagonal, below, chance };
        made.append()?;
        Ok(made)
    }

    /// Columns.
    pub(crate) fn width(&self) -> usize {
        self.basis.len() / self.height
    }

    /// So many blocks more.
    ///
    /// # Errors
    /// [`ModesError::Memory`].
    pub(crate) fn grow(&mut self, n_blocks: usize) -> Result<(), ModesError> {
        for _ in 0..n_blocks {
            let (mut next, mut mass_next) = (take(&mut self.next), take(&mut self.mass_next));
            let own = self.follow(&mut next, &mut mass_next);
            (self.next, self.mass_next) = (next, mass_next);
            self.diagonal.push(own);
            let below = self.append()?;
            self.below.push(below);
        }
        Ok(())
    }

    /// The operator on the last block, less what lies in the basis, and M times that; the share of the last block itself.
    fn follow(&self, next: &mut [f64], mass_next: &mut [f64]) -> Square {
        next.copy_from_slice(&self.mass_last);
        self.factor.solve(next);
        // In exact numbers it lies in the last two blocks alone, and how much in the last but one is known.
        let mut own = Square::default();
        own.copy_from_slice(&products(self.height, &self.mass_last, next));
        let mut shares: Vec<[f64; WIDE]> = Vec::new();
        if let Some(below) = self.below.last() {
            shares.extend((0..WIDE).map(|j| std::array::from_fn(|k| below[k][j])));
        }
        shares.extend(own);
        self.free(&shares, next);
        self.mass.times(next, mass_next);
        for _ in 0..FREED_MAX {
            let shares = products(self.height, &self.basis, mass_next);
            self.free(&shares, next);
            for (own, share) in own.iter_mut().zip(&shares[shares.len() - WIDE..]) {
                own.iter_mut().zip(share).for_each(|(own, share)| *own += share);
            }
            let squares = products(self.height, next, mass_next);
            let is_within = |share: f64| {
                let most = |k: usize| shares.iter().fold(0.0_f64, |most, share| most.max(share[k].abs()));
                (0..WIDE).all(|k| most(k).powi(2) <= share.powi(2) * squares[k][k].abs())
            };
            if is_within(STALE) {
                break;
            }
            self.mass.times(next, mass_next);
            if is_within(ENOUGH) {
                break;
            }
        }
        own
    }

    /// Takes from two columns their shares in the last of the basis.
    fn free(&self, shares: &[[f64; WIDE]], wide: &mut [f64]) {
        let from = self.basis.len() - shares.len() * self.height;
        let shares: Vec<[f64; WIDE]> = shares.iter().map(|share| share.map(|share| -share)).collect();
        accumulate(self.height, &self.basis[from..], &shares, wide);
    }

    /// Makes the next columns orthogonal to one another and of length 1 and adds them; what was there is they
    /// times what is returned. A column that is nothing new is another, by chance.
    fn append(&mut self) -> Result<Square, ModesError> {
        let (mut wide, mut mass_wide) = (take(&mut self.next), take(&mut self.mass_next));
        let height = self.height;
        let mut triangle = Square::default();
        let mut squares = products(height, &wide, &mass_wide);
        let before = squares[1][1].max(0.0).sqrt();
        triangle[0][0] = squares[0][0].max(0.0).sqrt();
        if triangle[0][0] < f64::MIN_POSITIVE {
            self.replace(&mut wide, &mut mass_wide, 0);
            squares = products(height, &wide, &mass_wide);
        }
        let first = squares[0][0].max(0.0).sqrt().max(f64::MIN_POSITIVE);
        triangle[0][1] = squares[0][1] / first;
        for columns in [&mut wide, &mut mass_wide] {
            mixed(columns, [first.recip(), -triangle[0][1] / first, 1.0]);
        }
        // Twice is enough (Kahan and Parlett).
        squares = products(height, &wide, &mass_wide);
        let share = squares[0][1];
        triangle[0][1] += share;
        let second = (squares[1][1] - share.powi(2)).max(0.0).sqrt();
        let by = if second <= NOTHING * before {
            [1.0, 0.0, self.replace(&mut wide, &mut mass_wide, 1).recip()]
        } else {
            triangle[1][1] = second;
            [1.0, -share / second, second.recip()]
        };
        for columns in [&mut wide, &mut mass_wide] {
            mixed(columns, by);
        }
        reserve(&mut self.basis, wide.len())?;
        self.basis.extend_from_slice(&wide);
        self.next = wide;
        self.mass_next = replace(&mut self.mass_last, mass_wide);
        Ok(triangle)
    }

    /// Puts chance into a column, orthogonal to all before; its length.
    fn replace(&mut self, wide: &mut [f64], mass_wide: &mut [f64], k: usize) -> f64 {
        let height = self.height;
        let mut column: Vec<f64> = (0..height).map(|_| self.chance.random_range(-1.0..1.0)).collect();
        self.factor.solve(&mut column);
        let mut mass_column = vec![0.0; height];
        for _ in 0..2 {
            self.mass.times(&column, &mut mass_column);
            for old in self.basis.chunks(height).chain(wide[..k * height].chunks(height)) {
                let share = dot(old, &mass_column);
                column.iter_mut().zip(old).for_each(|(x, v)| *x -= share * v);
            }
        }
        self.mass.times(&column, &mut mass_column);
        wide[k * height..][..height].copy_from_slice(&column);
        mass_wide[k * height..][..height].copy_from_slice(&mass_column);
        dot(&column, &mass_column).max(f64::MIN_POSITIVE).sqrt()
    }

    /// The operator in the basis.
    fn tridiagonal(&self) -> DMatrix<f64> {
        let n = self.diagonal.len() * WIDE;
        let mut small = DMatrix::zeros(n, n);
        for (k, (own, below)) in self.diagonal.iter().zip(&self.below).enumerate() {
            let at = WIDE * k;
            for (i, j) in (0..WIDE).flat_map(|i| (0..WIDE).map(move |j| (i, j))) {
                small[(at + i, at + j)] = f64::midpoint(own[i][j], own[j][i]);
                if at + WIDE + i < n {
                    small[(at + WIDE + i, at + j)] = below[i][j];
                    small[(at + j, at + WIDE + i)] = below[i][j];
                }
            }
        }
        small
    }

    /// Eigenvalues that are found: all of the `n_below` below the shift, if so many are, and those above it up to the
    /// first that is not.
    ///
    /// # Errors
    /// [`ModesError::Numbers`].
    pub(crate) fn ritz(&self, n_below: usize) -> Result<Ritz, ModesError> {
        let eigen = eigen(self.tridiagonal())?;
        let n = eigen.eigenvalues.len();
        let last = self.below.last().copied().unwrap_or_default();
        let is_found = |k: usize| {
            let tail = |row: &[f64; WIDE]| -> f64 {
                row.iter().enumerate().map(|(j, v)| v * eigen.eigenvectors[(n - WIDE + j, k)]).sum()
            };
            let error = last.iter().map(|row| tail(row).powi(2)).sum::<f64>().sqrt();
            error <= TOLERANCE * eigen.eigenvalues[k].abs()
        };
        let nu = |k: &usize| eigen.eigenvalues[*k];
        let (mut above, below): (Vec<usize>, Vec<usize>) = (0..n).partition(|k| nu(k) > 0.0);
        // 1 / (lambda - s): the largest are the nearest above, the smallest the nearest below.
        let mut below: Vec<usize> = below.into_iter().filter(|k| is_found(*k)).collect();
        below.sort_by(|a, b| nu(b).total_cmp(&nu(a)));
        above.sort_by(|a, b| nu(b).total_cmp(&nu(a)));
        let above = above.into_iter().take_while(|k| is_found(*k));
        let order: Vec<usize> =
            if below.len() < n_below { Vec::new() } else { below.into_iter().chain(above).collect() };
        Ok(Ritz {
            lambdas: order.iter().map(|k| self.shift + nu(k).recip()).collect(),
            small: eigen.eigenvectors.select_columns(&order),
        })
    }

    /// The smallest eigenvalue that the basis can tell of, found or not.
    ///
    /// # Errors
    /// [`ModesError::Numbers`].
    pub(crate) fn smallest(&self) -> Result<f64, ModesError> {
        let largest = eigen(self.tridiagonal())?.eigenvalues.max();
        Ok(self.shift + largest.recip())
    }

    /// Vectors of the first few that are found, one after the other, of length 1 in M.
    ///
    /// # Errors
    /// [`ModesError::Memory`].
    pub(crate) fn vectors(&self, ritz: &Ritz, n: usize) -> Result<Vec<f64>, ModesError> {
        let basis = DMatrixView::from_slice(&self.basis, self.height, ritz.small.nrows());
        let mut vectors = Vec::new();
        reserve(&mut vectors, n * self.height)?;
        vectors.resize(n * self.height, 0.0);
        let mut columns = DMatrixViewMut::from_slice(&mut vectors, self.height, n);
        columns.gemm(1.0, &basis, &ritz.small.columns(0, n), 0.0);
        Ok(vectors)
    }
}

/// Room for so many numbers more.
fn reserve(numbers: &mut Vec<f64>, n_more: usize) -> Result<(), ModesError> {
    let bytes = n_more.saturating_mul(size_of::<f64>());
    numbers.try_reserve(n_more).map_err(|_full| ModesError::Memory { bytes })
}
