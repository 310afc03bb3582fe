//! A forest: many copies of one plant, each turned, of its size and mass, and in a wind of its own (thesis 6.4.1, 6.5).
//!
//! In every step each copy feels a wind, all over it the same (6.3); its modes go on by it; and its nodes are where its
//! modes carry them. A copy that is s times as large has all lengths s times those of the plant: it swings s times as
//! slowly, and under the same wind it bends by the same angles, since what it bears grows with s^4 as well as what holds
//! it. Amplitudes and displacements are those of the plant itself, in its own axes and size: whoever shows a copy turns
//! and scales it, and need not go through memory for that.

mod air;
mod detail;
mod numbers;
mod round;
mod state;
#[cfg(test)]
mod tests;
mod view;

pub use detail::{Detail, DetailError, Details};
pub use numbers::{Felt, Numbers};
pub use round::{Round, Winds};
pub use state::StateError;
pub use view::View;

use crate::oscillator::{Damping, Integrator, LimitError, Oscillator};
use crate::rig::{BATCH, Rig};
use crate::stirring::Stirring;
use crate::threads::Threads;
use crate::wind_basis::WindBasis;
use honami_model::brief::Brief;
use nalgebra::{Matrix3, Vector3};
use pulp::Arch;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::f64::consts::{SQRT_2, TAU};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Copies that a thread takes at a time where none is posed.
const SOME: usize = 256;

/// How a copy stands.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stand {
    /// About the upright, anticlockwise from above, radians.
    pub turn: f32,
    /// So many times as large as the plant.
    pub scale: f32,
    /// So many times as heavy as a plant of that size.
    pub mass: f32,
}

impl Default for Stand {
    fn default() -> Self {
        Self { turn: 0.0, scale: 1.0, mass: 1.0 }
    }
}

/// How a forest goes on in time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pace {
    /// Seconds of a step.
    pub step: f64,
    /// By what method.
    pub integrator: Integrator,
    /// How all copies are damped, and how much heavier than they stand.
    pub damping: Damping,
}

/// What is written of all copies.
#[derive(Debug)]
pub struct Pose<'a> {
    /// How much of every copy, which need be no more than there is; `None`: all of it.
    pub details: Option<&'a [Detail]>,
    /// Displacements, metres, in the axes and the size of the plant: the nodes of the first copy, then of the next.
    pub motion: &'a mut [[f32; 3]],
}

/// The wind at a copy, metres per second in the world.
pub type Blowing<'a> = &'a (dyn Fn(usize) -> Vector3<f64> + Sync);

/// Why there is no forest, or why it does not go on.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ForestError {
    /// No copies.
    #[error("a forest has one copy at least")]
    Empty,
    /// A copy that no plant is like.
    #[error(
        "copy {copy} is turned by {turn}, {scale} times as large and {mass} times as heavy: sizes and masses are more than 0"
    )]
    Stand {
        /// Which.
        copy: usize,
        /// Radians.
        turn: f32,
        /// Of its lengths.
        scale: f32,
        /// Of its mass.
        mass: f32,
    },
    /// Damping that no plant has.
    #[error(
        "plants are {} times as heavy, with damping {}, {} and {} times that of the air: masses are more than 0, damping is not negative",
        Brief(*mass), Brief(*alpha), Brief(*beta), Brief(*air)
    )]
    Damping {
        /// Of all copies.
        mass: f64,
        /// Damping by mass.
        alpha: f64,
        /// Damping by stiffness.
        beta: f64,
        /// So many times that of the air.
        air: f64,
    },
    /// The method does not bear so long a step.
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// More than the system gives.
    #[error("{copies} copies with {modes} modes take {} MB, which the system does not give", bytes / 1_000_000)]
    Memory {
        /// How many.
        copies: usize,
        /// Of each.
        modes: usize,
        /// Wanted.
        bytes: usize,
    },
    /// What swings for ever has no motion that goes round.
    #[error(
        "a mode of {hz:.3} Hz that nothing damps has no motion by the spectrum: its answer to its own frequency has no end"
    )]
    Undamped {
        /// Of the mode.
        hz: f64,
    },
    /// Air that moves at no speed.
    #[error("the wind at copy {copy} at {time} s is no number")]
    Wind {
        /// The first of those.
        copy: usize,
        /// Seconds.
        time: f64,
    },
}

/// A forest at a time.
#[derive(Debug)]
pub struct Forest {
    /// Of all modes of the plant, radians per second.
    omegas: Vec<f64>,
    /// What wind does to them.
    by_wind: WindBasis,
    rig: Rig,
    /// Of every copy: sine and cosine of its turn, and its kind.
    copies: Vec<([f64; 2], u32)>,
    kinds: Vec<Kind>,
    /// p of every mode: all x, then all y, then all z.
    basis: Vec<f32>,
    /// T of every mode, a row for each of its numbers.
    tensors: Vec<f32>,
    /// Amplitudes of modes, `(n_copies, n_modes)`, and how fast they change.
    amplitudes: Vec<f32>,
    speeds: Vec<f32>,
    pace: Pace,
    time: f64,
}

/// What copies of one size and mass have in common.
#[derive(Clone, Debug)]
struct Kind {
    scale: f64,
    mass: f64,
    /// Steps of all modes: six rows of a number a mode.
    steps: Vec<f32>,
    /// What the air takes from a mode in half a step, by the damping of a mode of the plant.
    air: f64,
}

/// Copies that a thread takes at a time.
struct Piece<'a> {
    first: usize,
    detail: Detail,
    amplitudes: &'a mut [f32],
    speeds: &'a mut [f32],
    motion: &'a mut [[f32; 3]],
}

impl Forest {
    /// A forest at rest at time 0, of which these nodes of the beams are written, in this order. It keeps nothing of the plant
    /// but what it moves by: of what is for every node nothing in double precision.
    ///
    /// # Errors
    /// [`ForestError`].
    pub fn new(plant: &Stirring, nodes: &[u32], stands: &[Stand], pace: &Pace) -> Result<Self, ForestError> {
        if stands.is_empty() {
            return Err(ForestError::Empty);
        }
        let mut found = BTreeMap::new();
        let mut copies = Vec::with_capacity(stands.len());
        for (copy, &Stand { turn, scale, mass }) in stands.iter().enumerate() {
            let is_plant = turn.is_finite() && [scale, mass].iter().all(|v| v.is_finite() && *v > 0.0);
            if !is_plant {
                return Err(ForestError::Stand { copy, turn, scale, mass });
            }
            let next = found.len() as u32;
            let kind = *found.entry([scale, mass].map(f32::to_bits)).or_insert(next);
            copies.push((f64::from(turn).sin_cos().into(), kind));
        }
        let mut kinds = vec![Kind { scale: 1.0, mass: 1.0, steps: Vec::new(), air: 0.0 }; found.len()];
        for (bits, kind) in found {
            let [scale, mass] = bits.map(|bits| f64::from(f32::from_bits(bits)));
            kinds[kind as usize] = Kind { scale, mass, steps: Vec::new(), air: 0.0 };
        }
        let n_modes = plant.omegas.len();
        let n_numbers = stands.len() * n_modes;
        let (mut amplitudes, mut speeds) = (Vec::new(), Vec::new());
        for numbers in [&mut amplitudes, &mut speeds] {
            let bytes = 2 * n_numbers * size_of::<f32>();
            let full = |_| ForestError::Memory { copies: stands.len(), modes: n_modes, bytes };
            numbers.try_reserve_exact(n_numbers).map_err(full)?;
            numbers.resize(n_numbers, 0.0);
        }
        let axis = |axis: usize| plant.basis.forces.iter().map(move |force| force[axis] as f32);
        let basis = (0..3).flat_map(axis).collect();
        let tensors = air::rows(&plant.basis);
        let rig = Rig::new(&plant.following, nodes);
        let (omegas, by_wind) = (plant.omegas.clone(), plant.basis.clone());
        let (now, time) = (*pace, 0.0);
        let mut made =
            Self { omegas, by_wind, rig, copies, kinds, basis, tensors, amplitudes, speeds, pace: now, time };
        made.retune(pace)?;
        Ok(made)
    }

    /// Copies.
    #[must_use]
    pub fn len(&self) -> usize {
        self.copies.len()
    }

    /// Whether there are none, which cannot be.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.copies.is_empty()
    }

    /// How it goes on.
    #[must_use]
    pub fn pace(&self) -> &Pace {
        &self.pace
    }

    /// Seconds since the beginning.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// What it takes, bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let kinds: usize = self.kinds.iter().map(|kind| kind.steps.len()).sum();
        let numbers = self.amplitudes.capacity() + self.speeds.capacity() + kinds;
        let numbers = numbers + self.basis.len() + self.tensors.len();
        let of_mode = size_of::<f64>() + size_of::<Vector3<f64>>() + size_of::<Matrix3<f64>>();
        let of_plant = of_mode * self.omegas.len() + self.rig.bytes();
        numbers * size_of::<f32>() + size_of_val(self.copies.as_slice()) + of_plant
    }

    /// From where it is it goes on at another pace.
    ///
    /// # Errors
    /// [`ForestError`]; it then goes on as before.
    pub fn retune(&mut self, pace: &Pace) -> Result<(), ForestError> {
        let Damping { alpha, beta, mass, air } = pace.damping;
        let is_plant =
            mass.is_finite() && mass > 0.0 && [alpha, beta, air].iter().all(|v| v.is_finite() && *v >= 0.0);
        if !is_plant {
            return Err(ForestError::Damping { mass, alpha, beta, air });
        }
        pace.bears_kinds(&self.omegas, &self.kinds)?;
        let steps = self.kinds.iter().map(|kind| steps(&self.omegas, kind, pace));
        let steps = steps.collect::<Result<Vec<_>, _>>()?;
        for (kind, steps) in self.kinds.iter_mut().zip(steps) {
            kind.steps = steps;
            kind.air = kind.by_air(&pace.damping) * pace.step / 2.0;
        }
        self.pace = *pace;
        Ok(())
    }

    /// Back to rest at time 0.
    pub fn reset(&mut self) {
        self.amplitudes.fill(0.0);
        self.speeds.fill(0.0);
        self.time = 0.0;
    }

    /// A step, under a wind that blows on from its beginning till its end; then, where wanted, where the nodes are.
    ///
    /// # Errors
    /// [`ForestError::Wind`]; copies that have a wind have gone on.
    ///
    /// # Panics
    /// As [`pose`](Self::pose).
    pub fn step(
        &mut self,
        wind: Blowing<'_>,
        pose: Option<Pose<'_>>,
        threads: &Threads,
    ) -> Result<(), ForestError> {
        let n_modes = self.omegas.len();
        let calm = AtomicUsize::new(usize::MAX);
        let (rig, copies, kinds) = (&self.rig, &self.copies, &self.kinds);
        let (basis, tensors) = (&self.basis, &self.tensors);
        let pieces = pieces(n_modes, rig, &mut self.amplitudes, &mut self.speeds, pose);
        threads.each(pieces.into_iter(), |piece| {
            // Instructions are chosen once for some copies: for one alone that would take as long as its step.
            Arch::new().dispatch(
                #[inline(always)]
                || {
                    let rows = piece.amplitudes.chunks_exact_mut(n_modes);
                    let rows = rows.zip(piece.speeds.chunks_exact_mut(n_modes));
                    for (copy, (q, speed)) in (piece.first..).zip(rows) {
                        let (turn, kind) = &copies[copy];
                        let v = wind(copy);
                        if v.iter().all(|v| v.is_finite()) {
                            let (kind, own) = (&kinds[*kind as usize], in_own_axes(turn, &v));
                            let held = air::weights(&own, kind.air);
                            advance(&kind.steps, (basis, pressed(&own)), (tensors, held), q, speed);
                        } else {
                            calm.fetch_min(copy, Relaxed);
                        }
                    }
                },
            );
            piece.pose(rig, n_modes);
        });
        let time = self.time;
        self.time += self.pace.step;
        match calm.into_inner() {
            usize::MAX => Ok(()),
            copy => Err(ForestError::Wind { copy, time }),
        }
    }

    /// Writes where the nodes are now.
    ///
    /// # Panics
    /// When there is not a detail a copy, or not room for just what is wanted.
    pub fn pose(&mut self, pose: Pose<'_>, threads: &Threads) {
        let (n_modes, rig) = (self.omegas.len(), &self.rig);
        let pieces = pieces(n_modes, rig, &mut self.amplitudes, &mut self.speeds, Some(pose));
        threads.each(pieces.into_iter(), |piece| piece.pose(rig, n_modes));
    }

    /// Amplitudes of a copy's modes.
    #[must_use]
    pub fn amplitudes(&self, copy: usize) -> &[f32] {
        let n_modes = self.omegas.len();
        &self.amplitudes[copy * n_modes..][..n_modes]
    }

    /// Puts a copy's modes where they are wanted, standing still.
    pub fn pull(&mut self, copy: usize, amplitudes: &[f32]) {
        let n_modes = self.omegas.len();
        self.amplitudes[copy * n_modes..][..n_modes].copy_from_slice(amplitudes);
        self.speeds[copy * n_modes..][..n_modes].fill(0.0);
    }

    /// The same of every copy: one that is twice as large is pulled twice as far.
    pub fn pull_all(&mut self, amplitudes: &[f32]) {
        (0..self.len()).for_each(|copy| self.pull(copy, amplitudes));
    }
}

impl Piece<'_> {
    fn pose(self, rig: &Rig, n_modes: usize) {
        if !self.motion.is_empty() {
            let rows = self.amplitudes.chunks_exact(n_modes);
            rig.pose_batch(rows, self.detail.n_modes as usize, self.motion.as_flattened_mut());
        }
    }
}

/// All copies in pieces, each of one detail.
fn pieces<'a>(
    n_modes: usize,
    rig: &Rig,
    mut amplitudes: &'a mut [f32],
    mut speeds: &'a mut [f32],
    pose: Option<Pose<'a>>,
) -> Vec<Piece<'a>> {
    let n_copies = amplitudes.len() / n_modes;
    let whole = Detail { n_nodes: rig.n_nodes() as u32, n_modes: n_modes as u32 };
    let (details, mut motion) = pose.map_or((None, &mut [][..]), |pose| (pose.details, pose.motion));
    let runs: Vec<(Detail, usize)> = match details {
        Some(details) => {
            assert_eq!(details.len(), n_copies, "a detail a copy");
            details.chunk_by(|a, b| a == b).map(|run| (run[0].at_most(whole), run.len())).collect()
        }
        None if motion.is_empty() => vec![(Detail::default(), n_copies)],
        None => vec![(whole, n_copies)],
    };
    let (mut pieces, mut first) = (Vec::new(), 0);
    for (detail, n) in runs {
        let most = if detail.n_nodes == 0 { SOME } else { BATCH };
        for begin in (0..n).step_by(most) {
            let n = most.min(n - begin);
            let amplitudes = split(&mut amplitudes, n * n_modes);
            let speeds = split(&mut speeds, n * n_modes);
            let motion = split(&mut motion, n * detail.n_nodes as usize);
            pieces.push(Piece { first, detail, amplitudes, speeds, motion });
            first += n;
        }
    }
    assert!(motion.is_empty(), "room for just what is wanted");
    pieces
}

/// Takes the first so many off.
fn split<'a, T>(rest: &mut &'a mut [T], n: usize) -> &'a mut [T] {
    let (taken, others) = std::mem::take(rest).split_at_mut(n);
    *rest = others;
    taken
}

/// A wind in the axes of a copy.
#[inline(always)]
fn in_own_axes([sin, cos]: &[f64; 2], v: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(cos * v.x + sin * v.y, cos * v.y - sin * v.x, v.z)
}

/// |v| v.
#[inline(always)]
fn pressed(v: &Vector3<f64>) -> [f32; 3] {
    (v * v.norm()).map(|v| v as f32).into()
}

impl Pace {
    /// Whether its method bears its steps in all copies of a plant with modes of these angular frequencies.
    ///
    /// # Errors
    /// [`LimitError`], with the limit of the mode and the copy that bear least.
    pub fn bears(&self, omegas: &[f64], stands: &[Stand]) -> Result<(), LimitError> {
        let kind = |stand: &Stand| Kind {
            scale: stand.scale.into(),
            mass: stand.mass.into(),
            steps: Vec::new(),
            air: 0.0,
        };
        self.bears_kinds(omegas, &stands.iter().map(kind).collect::<Vec<_>>())
    }

    fn bears_kinds(&self, omegas: &[f64], kinds: &[Kind]) -> Result<(), LimitError> {
        if self.integrator != Integrator::Symplectic {
            return Ok(());
        }
        let limit = |mode: Oscillator| {
            // Where the air takes all speed, every step, it bears less: of its trace 1 - (omega dt)^2 is left.
            let limit = if self.damping.air > 0.0 { SQRT_2 / mode.omega } else { f64::INFINITY };
            (limit.min(mode.symplectic_limit()), mode.omega / TAU)
        };
        let modes = kinds.iter().flat_map(|kind| kind.oscillators(omegas, &self.damping));
        let least = modes.map(limit).min_by(|a, b| a.0.total_cmp(&b.0));
        match least {
            Some((limit, hz)) if self.step >= limit => Err(LimitError::Limit { step: self.step, limit, hz }),
            _ => Ok(()),
        }
    }
}

impl Kind {
    /// The modes of a plant in copies of this kind, but for what the air takes.
    fn oscillators(&self, omegas: &[f64], damping: &Damping) -> impl Iterator<Item = Oscillator> {
        let damping = Damping { mass: damping.mass * self.mass, ..*damping };
        // Of an amplitude in the plant's own size: m s^3 of mass, s^2 of wind, and s of length.
        let mass = damping.mass * self.scale.powi(2);
        let of = move |omega: &f64| Oscillator { mass, ..Oscillator::new(omega / self.scale, &damping) };
        omegas.iter().map(of)
    }

    /// What the air takes from a mode, per second, by the damping of a mode of the plant: of s times the size the drag on
    /// a mode is s^3 times as much, the mass s^4 times (lengths of both included).
    fn by_air(&self, damping: &Damping) -> f64 {
        damping.air / (damping.mass * self.mass * self.scale)
    }
}

/// The step of every mode of a kind.
fn steps(omegas: &[f64], kind: &Kind, pace: &Pace) -> Result<Vec<f32>, LimitError> {
    let n_modes = omegas.len();
    let mut rows = vec![0.0; 6 * n_modes];
    for (mode, oscillator) in kind.oscillators(omegas, &pace.damping).enumerate() {
        let step = oscillator.step_by(pace.integrator, pace.step)?;
        for (row, number) in step.numbers().into_iter().enumerate() {
            rows[row * n_modes + mode] = number as f32;
        }
    }
    Ok(rows)
}

/// A step of all modes of a copy: the force by the basis, and what the air takes by the tensors.
#[inline(always)]
fn advance(
    steps: &[f32],
    (basis, [x, y, z]): (&[f32], [f32; 3]),
    (tensors, held): (&[f32], [f32; air::SIX]),
    q: &mut [f32],
    speed: &mut [f32],
) {
    let n = q.len();
    let speed = &mut speed[..n];
    let [qq, qs, qf, sq, ss, sf] = [0, 1, 2, 3, 4, 5].map(
        #[inline(always)]
        |k| &steps[k * n..][..n],
    );
    let [px, py, pz] = [&basis[..n], &basis[n..][..n], &basis[2 * n..][..n]];
    let tensors = [0, 1, 2, 3, 4, 5].map(
        #[inline(always)]
        |k| &tensors[k * n..][..n],
    );
    for m in 0..n {
        let force = x * px[m] + y * py[m] + z * pz[m];
        let mut taken = 0.0;
        for (tensor, held) in tensors.iter().zip(held) {
            taken += tensor[m] * held;
        }
        let left = air::fade(taken);
        let (q_now, speed_now) = (q[m], speed[m] * left);
        q[m] = qq[m] * q_now + qs[m] * speed_now + qf[m] * force;
        speed[m] = (sq[m] * q_now + ss[m] * speed_now + sf[m] * force) * left;
    }
}
