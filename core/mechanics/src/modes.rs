//! The slowest vibrations of a plant, and a proof that none was missed.

mod dense;
#[cfg(test)]
mod tests;

pub(crate) use dense::eigen;

use crate::beams::Beams;
use crate::factor::{Factor, Flexibility, Singular, WIDE};
use crate::lanczos::Lanczos;
use crate::simd::dot;
use crate::six::DOF;
use crate::tree_matrix::TreeMatrix;
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Up to so many degrees of freedom all vibrations are worked out at once.
const DENSE: usize = 96;
/// And of a plant with up to so many where more than half of them are wanted: that takes seconds, and grows with the cube.
const DENSE_MOST: usize = 1500;
/// Eigenvalues closer than this, relatively, are equal for the proof.
const GAP: f64 = 1e-7;
/// Columns that it mostly takes to find so many vibrations, each.
const WIDTH: usize = 3;
/// Blocks that tell about where the first eigenvalue lies.
const BLOCKS_FIRST: usize = 4;
/// Blocks between two looks at how far it is; and so many columns of the basis are worth one more, since a look takes time
/// that grows with their cube.
const BLOCKS_A_LOOK: usize = 2;
const COLUMNS_A_BLOCK: usize = 64;
/// Bytes that a node takes in matrices and their factors, about.
const NODE_BYTES: usize = 4000;
/// Attempts at a shift amid what is wanted; where all fail, many eigenvalues are as one, and any shift serves.
const SHIFTS_MAX: usize = 12;

/// Vibration modes of a plant, slowest first, each of modal mass 1 kg m^2 per its unit: phi^T M phi = 1.
#[derive(Clone, Debug)]
pub struct Modes {
    /// Angular frequencies, radians per second, ascending.
    pub omegas: Vec<f64>,
    /// How far each is from solving its equation: |phi - omega^2 K^-1 M phi| in M, where |phi| is 1.
    pub residuals: Vec<f64>,
    /// Displacements and rotations of all nodes but the root, 6 a node, mode after mode.
    shapes: Vec<f64>,
    n_nodes: usize,
}

/// Why there are no modes.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ModesError {
    /// No plant vibrates so little.
    #[error("{wanted} modes were asked for, and the plant has {there} degrees of freedom")]
    TooMany {
        /// Asked for.
        wanted: usize,
        /// Of the plant.
        there: usize,
    },
    /// More than half of many.
    #[error(
        "{wanted} modes of {there} were asked for: more than half of them are worked out where there are {DENSE_MOST} at \
         most, here {} can be had", there.div_ceil(2) - 1
    )]
    Half {
        /// Asked for.
        wanted: usize,
        /// Of the plant.
        there: usize,
    },
    /// More than the system gives.
    #[error(
        "to find the modes takes {} MB more than the system gives: fewer modes, or fewer nodes, are wanted",
        bytes / 1_000_000
    )]
    Memory {
        /// Wanted at once.
        bytes: usize,
    },
    /// A shift for which the matrix has no factors.
    #[error(transparent)]
    Singular(#[from] Singular),
    /// Matrices that overflow or vanish.
    #[error(
        "the plant cannot be calculated with: its lengths, radii, masses or its wood are too small, too large or too far \
         apart"
    )]
    Numbers,
    /// Whoever watches has stopped it.
    #[error("stopped")]
    Stopped,
    /// It went on for long and could not be sure.
    #[error(
        "{wanted} modes were asked for, {found} were found, and it is not proved that these are the slowest: more of them, or \
         fewer, may be"
    )]
    Uncertain {
        /// Asked for.
        wanted: usize,
        /// Found, of those beyond.
        found: usize,
    },
}

impl Modes {
    /// The slowest modes of beams. Their number is proved: so many eigenvalues, and no more, lie below (the count of
    /// negative pivots of K - s M).
    ///
    /// # Errors
    /// [`ModesError`].
    pub fn new(beams: &Beams, n_modes: usize, seed: u64) -> Result<Self, ModesError> {
        Self::watched(beams, n_modes, seed, &|_found| true)
    }

    /// As [`new`](Self::new); whoever watches is told how many are found, again and again, and says whether to go on.
    ///
    /// # Errors
    /// [`ModesError::Stopped`], and the others.
    pub fn watched(
        beams: &Beams,
        n_modes: usize,
        seed: u64,
        watch: &dyn Fn(usize) -> bool,
    ) -> Result<Self, ModesError> {
        let mass = beams.mass();
        let there = DOF * mass.len();
        if n_modes > there || n_modes == 0 {
            return Err(ModesError::TooMany { wanted: n_modes, there });
        }
        let flexibility = Flexibility::new(beams);
        // Statics: only what is no number has no factors.
        let factor = Factor::new(&flexibility, &mass, 0.0).map_err(|_singular| ModesError::Numbers)?;
        let (lambdas, vectors) = if there <= DENSE.max(2 * n_modes) {
            if there > DENSE_MOST {
                return Err(ModesError::Half { wanted: n_modes, there });
            }
            let found = dense::all(&factor, &mass, n_modes)?;
            if !is_proved(&flexibility, &mass, &found.0)? {
                return Err(ModesError::Uncertain { wanted: n_modes, found: n_modes });
            }
            found
        } else {
            few(&flexibility, &factor, &mass, (n_modes, seed), watch)?
        };
        Self::checked(&factor, &mass, &lambdas, vectors)
    }

    /// How many can be had of beams with so many nodes: of a small plant all, of others less than half.
    #[must_use]
    pub fn most(n_nodes: usize) -> usize {
        let there = DOF * n_nodes.saturating_sub(1);
        if there > DENSE_MOST { there.div_ceil(2) - 1 } else { there }
    }

    /// What it takes to find so many modes of beams with so many nodes, bytes, about.
    #[must_use]
    pub fn bytes(n_nodes: usize, n_modes: usize) -> usize {
        let columns = (WIDTH + 1).saturating_mul(n_modes);
        let column = DOF * size_of::<f64>() * n_nodes;
        columns.saturating_mul(column).saturating_add(NODE_BYTES * n_nodes)
    }

    fn checked(
        factor: &Factor,
        mass: &TreeMatrix,
        lambdas: &[f64],
        shapes: Vec<f64>,
    ) -> Result<Self, ModesError> {
        let are_modes = lambdas.iter().all(|lambda| lambda.is_finite() && *lambda > 0.0);
        if !(are_modes && shapes.iter().all(|v| v.is_finite())) {
            return Err(ModesError::Numbers);
        }
        let height = DOF * mass.len();
        let omegas: Vec<f64> = lambdas.iter().map(|lambda| lambda.sqrt()).collect();
        let (mut left, mut product) = (Vec::new(), Vec::new());
        let mut residuals = Vec::with_capacity(lambdas.len());
        for (shapes, lambdas) in shapes.chunks(WIDE * height).zip(lambdas.chunks(WIDE)) {
            left.resize(shapes.len(), 0.0);
            product.resize(shapes.len(), 0.0);
            mass.times(shapes, &mut left);
            factor.solve(&mut left);
            let columns = left.chunks_mut(height).zip(shapes.chunks(height));
            for ((left, shape), lambda) in columns.zip(lambdas) {
                left.iter_mut().zip(shape).for_each(|(y, x)| *y = x - *y * lambda);
            }
            mass.times(&left, &mut product);
            let columns = left.chunks(height).zip(product.chunks(height));
            residuals.extend(columns.map(|(left, product)| dot(left, product).max(0.0).sqrt()));
        }
        Ok(Self { omegas, residuals, shapes, n_nodes: mass.len() })
    }

    /// How many.
    #[must_use]
    pub fn len(&self) -> usize {
        self.omegas.len()
    }

    /// Whether there are none, which cannot be.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.omegas.is_empty()
    }

    /// Frequency of a mode, hertz.
    #[must_use]
    pub fn hz(&self, mode: usize) -> f64 {
        self.omegas[mode] / TAU
    }

    /// Displacements and rotations of a mode, 6 numbers a node; the root, which is clamped, has none.
    #[must_use]
    pub fn shape(&self, mode: usize) -> &[f64] {
        let height = DOF * self.n_nodes;
        &self.shapes[mode * height..(mode + 1) * height]
    }

    /// Displacement of a node of the beams in a mode: node 0 is the root, which does not move.
    #[must_use]
    pub fn displacement(&self, mode: usize, node: usize) -> Vector3<f64> {
        self.part(mode, node, 0)
    }

    /// Rotation of a node of the beams in a mode, a vector about which it turns.
    #[must_use]
    pub fn rotation(&self, mode: usize, node: usize) -> Vector3<f64> {
        self.part(mode, node, 3)
    }

    /// Amplitude at which the node that turns most turns by so many radians. A rod whose tip moves by 30 % of its length
    /// under its own weight turns there by 0.4.
    #[must_use]
    pub fn amplitude(&self, mode: usize, turn: f64) -> f64 {
        let most = (0..=self.n_nodes).map(|node| self.rotation(mode, node).norm()).fold(0.0, f64::max);
        turn / most.max(f64::MIN_POSITIVE)
    }

    fn part(&self, mode: usize, node: usize, first: usize) -> Vector3<f64> {
        node.checked_sub(1).map_or_else(Vector3::zeros, |node| {
            Vector3::from_column_slice(&self.shape(mode)[DOF * node + first..][..3])
        })
    }
}

/// The smallest eigenvalues of K x = lambda M x and their vectors, with the proof that none was missed.
///
/// They are sought about a shift amid them: there the wanted ones are far apart for the iteration, and the factors of
/// K - s M tell how many lie below.
fn few(
    flexibility: &Flexibility,
    factor: &Factor,
    mass: &TreeMatrix,
    (n_modes, seed): (usize, u64),
    watch: &dyn Fn(usize) -> bool,
) -> Result<(Vec<f64>, Vec<f64>), ModesError> {
    goes_on(watch, 0)?;
    let (shift, shifted) = amid(flexibility, factor, mass, n_modes, seed)?;
    let n_below = shifted.n_negative();
    let mut lanczos = Lanczos::new(&shifted, shift, mass, seed, WIDTH * n_modes)?;
    let width_max = (12 * n_modes + 136).min(DOF * mass.len());
    let mut found = 0;
    while lanczos.width() < width_max {
        goes_on(watch, found.min(n_modes))?;
        lanczos.grow(BLOCKS_A_LOOK.max(lanczos.width() / COLUMNS_A_BLOCK))?;
        if lanczos.width() < n_modes + found.max(n_modes / 2) {
            continue;
        }
        let ritz = lanczos.ritz(n_below)?;
        found = ritz.lambdas.len();
        let Some(wanted) = ritz.lambdas.get(..n_modes) else { continue };
        if is_proved(flexibility, mass, wanted)? {
            return Ok((wanted.to_vec(), lanczos.vectors(&ritz, n_modes)?));
        }
    }
    Err(ModesError::Uncertain { wanted: n_modes, found })
}

fn goes_on(watch: &dyn Fn(usize) -> bool, found: usize) -> Result<(), ModesError> {
    if watch(found) { Ok(()) } else { Err(ModesError::Stopped) }
}

/// Whether these eigenvalues, in order, are the smallest: as many lie below the last, and below those that are equal to
/// it, as are known to. Of equal ones any will do.
fn is_proved(flexibility: &Flexibility, mass: &TreeMatrix, lambdas: &[f64]) -> Result<bool, ModesError> {
    let Some(last) = lambdas.last() else { return Ok(false) };
    let below = last * (1.0 - GAP);
    let known = lambdas.partition_point(|lambda| *lambda < below);
    Ok(Factor::count(flexibility, mass, below)? == known)
}

/// A shift that about half of the wanted eigenvalues lie below, and the factors of K - s M there.
fn amid(
    flexibility: &Flexibility,
    factor: &Factor,
    mass: &TreeMatrix,
    n_modes: usize,
    seed: u64,
) -> Result<(f64, Factor), ModesError> {
    let mut lanczos = Lanczos::new(factor, 0.0, mass, seed, 0)?;
    lanczos.grow(BLOCKS_FIRST)?;
    let first = lanczos.smallest()?;
    let half = n_modes as f64 / 2.0;
    let near = (half / 3.0).max(1.0);
    // A shift that too few lie below, one that too many lie below, and how many.
    let (mut low, mut high): ((f64, f64), Option<(f64, f64)>) = ((first, 1.0), None);
    let mut shift = 2.0 * first;
    for _ in 1..SHIFTS_MAX {
        let shifted = Factor::new(flexibility, mass, shift)?;
        let n_below = shifted.n_negative() as f64;
        if (n_below - half).abs() <= near {
            return Ok((shift, shifted));
        }
        if n_below < half {
            low = (shift, n_below.max(1.0));
        } else {
            high = Some((shift, n_below));
        }
        shift = high.map_or(2.0 * low.0, |high| {
            // Counts grow about as a power.
            let share = (half.max(1.0) / low.1).ln() / (high.1 / low.1).ln();
            low.0 * (high.0 / low.0).powf(share.clamp(0.3, 0.7))
        });
    }
    Ok((shift, Factor::new(flexibility, mass, shift)?))
}
