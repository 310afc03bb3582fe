//! Eigenvalues of a pair of matrices near a shift, by block Lanczos.
//!
//! Two vectors at a time, so that modes of exactly equal frequency, which every symmetric plant has, are found
//! together; every new block is made orthogonal to all before in the inner product of M (Grimes, Lewis and Simon,
//! SIAM J. Matrix Anal. Appl. 15, 1994).

use crate::factor::{Factor, WIDE};
use crate::simd::{accumulate, combined, dot, products};
use crate::tree_matrix::{DOF, TreeMatrix};
use nalgebra::{DMatrix, SymmetricEigen};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// An eigenvalue counts as found when its vector solves (K - s M)^-1 M x = nu x to so small a share of nu.
const TOLERANCE: f64 = 1e-11;
/// What is left of a column in all those before it is nothing new.
const NOTHING: f64 = 1e-10;
/// Blocks between two looks at how far it is.
const BLOCKS_A_LOOK: usize = 4;

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
    pub(crate) fn new(factor: &'a Factor, shift: f64, mass: &'a TreeMatrix, seed: u64) -> Self {
        let height = DOF * mass.len();
        let mut chance = Pcg64::seed_from_u64(seed);
        let mut first: Vec<f64> = (0..WIDE * height).map(|_| chance.random_range(-1.0..1.0)).collect();
        // Chance is mostly fast vibrations: one step towards the slow ones.
        factor.solve_columns::<WIDE>(&mut first);
        let (basis, mass_last, diagonal, below) = Default::default();
        let mut made = Self { factor, shift, mass, height, basis, mass_last, diagonal, below, chance };
        made.append(first);
        made
    }

    /// Columns.
    pub(crate) fn width(&self) -> usize {
        self.basis.len() / self.height
    }

    /// Some blocks more.
    pub(crate) fn grow(&mut self) {
        for _ in 0..BLOCKS_A_LOOK {
            let mut next = self.mass_last.clone();
            self.factor.solve_columns::<WIDE>(&mut next);
            let last = self.width() - WIDE;
            let mut own = Square::default();
            // All before; and the last ones again, which is where the most of it was.
            for from in [0, last.saturating_sub(WIDE)] {
                let mass_next = self.times_mass(&next);
                let old = &self.basis[from * self.height..];
                let mut shares = products(self.height, old, &mass_next);
                for (own, share) in own.iter_mut().zip(&shares[last - from..]) {
                    own.iter_mut().zip(share).for_each(|(own, share)| *own += share);
                }
                shares.iter_mut().flatten().for_each(|share| *share = -*share);
                accumulate(self.height, old, &shares, &mut next);
            }
            self.diagonal.push(own);
            let below = self.append(next);
            self.below.push(below);
        }
    }

    fn times_mass(&self, wide: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; wide.len()];
        for (x, product) in wide.chunks(self.height).zip(product.chunks_mut(self.height)) {
            self.mass.times(x, product);
        }
        product
    }

    /// Makes columns orthogonal to one another and of length 1 and adds them; what was given is they times what is
    /// returned. A column that is nothing new is another, by chance.
    #[expect(clippy::needless_range_loop, reason = "k counts columns of three arrays")]
    fn append(&mut self, mut wide: Vec<f64>) -> Square {
        let height = self.height;
        let mut triangle = Square::default();
        let mut mass_wide = self.times_mass(&wide);
        for k in 0..WIDE {
            let at = k * height..(k + 1) * height;
            let before = dot(&wide[at.clone()], &mass_wide[at.clone()]).max(0.0).sqrt();
            // Twice is enough (Kahan and Parlett).
            for j in (0..k).chain(0..k) {
                let share = dot(&wide[j * height..][..height], &mass_wide[at.clone()]);
                triangle[j][k] += share;
                for columns in [&mut wide, &mut mass_wide] {
                    let (done, open) = columns.split_at_mut(k * height);
                    let done = &done[j * height..][..height];
                    open.iter_mut().zip(done).for_each(|(x, v)| *x -= share * v);
                }
            }
            let mut length = dot(&wide[at.clone()], &mass_wide[at.clone()]).max(0.0).sqrt();
            triangle[k][k] = length;
            if length <= NOTHING * before {
                triangle[k][k] = 0.0;
                length = self.replace(&mut wide, &mut mass_wide, k);
            }
            for columns in [&mut wide, &mut mass_wide] {
                columns[at.clone()].iter_mut().for_each(|x| *x /= length);
            }
        }
        self.basis.extend_from_slice(&wide);
        self.mass_last = mass_wide;
        triangle
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
    pub(crate) fn ritz(&self, n_below: usize) -> Ritz {
        let eigen = SymmetricEigen::new(self.tridiagonal());
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
        Ritz {
            lambdas: order.iter().map(|k| self.shift + nu(k).recip()).collect(),
            small: eigen.eigenvectors.select_columns(&order),
        }
    }

    /// The smallest eigenvalue that the basis can tell of, found or not.
    pub(crate) fn smallest(&self) -> f64 {
        let largest = self.tridiagonal().symmetric_eigenvalues().max();
        self.shift + largest.recip()
    }

    /// Vectors of the first few that are found, one after the other, of length 1 in M.
    pub(crate) fn vectors(&self, ritz: &Ritz, n: usize) -> Vec<f64> {
        combined(self.height, &self.basis, &ritz.small.columns(0, n).into_owned())
    }
}
