//! A forest: many copies of one plant in one wind, each at its place, turned, and of its kind (thesis 6.4.1, 6.5).
//!
//! In every step each copy feels the wind at its place, all over it the same (6.3); its modes go on by it; and its nodes
//! are where its modes carry them. A copy that is s times as large has all lengths s times those of the plant: it swings
//! s times as slowly, and under the same wind it bends by the same angles, since what it bears grows with s^4 as well as
//! what holds it. Amplitudes are those of the plant itself; positions are scaled where they are asked for.

mod detail;
#[cfg(test)]
mod tests;
mod view;

pub use detail::{Detail, DetailError};
pub use view::View;

use crate::oscillator::{Damping, Integrator, LimitError, Oscillator};
use crate::rig::BATCH;
use crate::stirring::Stirring;
use crate::threads::Threads;
use crate::wind::Wind;
use detail::Details;
use nalgebra::Vector3;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Copies that a thread takes at a time for a step.
const SOME: usize = 256;
/// Where on a copy's height its wind is measured, from the ground.
const CROWN: f64 = 2.0 / 3.0;

/// Where a copy stands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stand {
    /// Of its root, metres.
    pub place: [f32; 3],
    /// About the upright, anticlockwise from above, radians.
    pub turn: f32,
    /// Which of the kinds it is.
    pub kind: u32,
}

/// What copies of one size and wood have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kind {
    /// So many times as large as the plant.
    pub scale: f64,
    /// And so damped and heavy.
    pub damping: Damping,
}

impl Default for Kind {
    fn default() -> Self {
        Self { scale: 1.0, damping: Damping::default() }
    }
}

/// How a forest goes on in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Seconds of a step.
    pub step: f64,
    /// By what method.
    pub integrator: Integrator,
}

/// Why there is no forest, or why it does not go on.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ForestError {
    /// No copies, or no kinds.
    #[error("a forest has one copy and one kind at least")]
    Empty,
    /// A copy of a kind that there is not, or at no place.
    #[error("copy {copy} stands at {place:?} m, turned by {turn}, and is of kind {kind} of {n_kinds}")]
    Stand {
        /// Which.
        copy: usize,
        /// Metres.
        place: [f32; 3],
        /// Radians.
        turn: f32,
        /// Counted from 0.
        kind: u32,
        /// How many there are.
        n_kinds: usize,
    },
    /// A kind that no plant is of.
    #[error(
        "kind {kind} is {scale} times as large and {mass} times as heavy with damping {alpha} and {beta}: sizes and masses are more than 0, damping is not negative"
    )]
    Kind {
        /// Counted from 0.
        kind: usize,
        /// Of its lengths.
        scale: f64,
        /// Of its mass.
        mass: f64,
        /// Damping by mass.
        alpha: f64,
        /// Damping by stiffness.
        beta: f64,
    },
    /// The method does not bear so long a step.
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// More than there is room for.
    #[error("{copies} copies of {nodes} nodes take {} MB, and there are {}", bytes / 1_000_000, there / 1_000_000)]
    Memory {
        /// Of the plant.
        copies: usize,
        /// Of a copy.
        nodes: usize,
        /// Wanted.
        bytes: usize,
        /// Allowed.
        there: usize,
    },
    /// Air that moves at no speed.
    #[error("the wind at copy {copy} at {time} s is no number")]
    Wind {
        /// The first of those.
        copy: usize,
        /// Seconds.
        time: f64,
    },
    /// Details that cannot be.
    #[error(transparent)]
    Detail(#[from] DetailError),
}

/// A forest at a time.
#[derive(Debug)]
pub struct Forest<'a> {
    plant: &'a Stirring,
    stands: Vec<Stand>,
    kinds: Vec<Steps>,
    /// p of every mode: all x, then all y, then all z.
    basis: Vec<f32>,
    /// Amplitudes of modes, `(n_copies, n_modes)`, and how fast they change.
    amplitudes: Vec<f32>,
    speeds: Vec<f32>,
    details: Details,
    seen: Vec<Seen>,
    /// Of every detail: the first that is seen with it, and where its displacements begin.
    firsts: Vec<[usize; 2]>,
    displacements: Vec<f32>,
    memory: usize,
    step: f64,
    n_steps: u64,
}

/// A copy that is posed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen {
    /// Which.
    pub copy: u32,
    /// With which nodes and modes.
    pub detail: u32,
}

/// Steps of all modes of a kind: six rows of a number a mode.
#[derive(Clone, Debug)]
struct Steps {
    scale: f64,
    rows: Vec<f32>,
}

impl<'a> Forest<'a> {
    /// A forest at rest at time 0. It takes no more than `memory` bytes.
    ///
    /// # Errors
    /// [`ForestError`].
    pub fn new(
        plant: &'a Stirring,
        stands: Vec<Stand>,
        kinds: &[Kind],
        pace: &Pace,
        details: &[Detail],
        memory: usize,
    ) -> Result<Self, ForestError> {
        if stands.is_empty() || kinds.is_empty() {
            return Err(ForestError::Empty);
        }
        for (copy, &Stand { place, turn, kind }) in stands.iter().enumerate() {
            let is_number = place.iter().chain([&turn]).all(|v| v.is_finite());
            if !is_number || kind as usize >= kinds.len() {
                return Err(ForestError::Stand { copy, place, turn, kind, n_kinds: kinds.len() });
            }
        }
        let details = Details::new(plant, details)?;
        let n_modes = plant.omegas.len();
        // Before anything of that size is asked for.
        let state = stands.len() * 2 * n_modes * size_of::<f32>();
        room(plant, stands.len(), state + details.bytes(), memory)?;
        let kinds = kinds
            .iter()
            .enumerate()
            .map(|(k, kind)| steps(plant, k, kind, pace))
            .collect::<Result<Vec<_>, _>>()?;
        let basis =
            (0..3).flat_map(|axis| plant.basis.forces.iter().map(move |force| force[axis] as f32)).collect();
        Ok(Self {
            plant,
            kinds,
            basis,
            amplitudes: vec![0.0; stands.len() * n_modes],
            speeds: vec![0.0; stands.len() * n_modes],
            details,
            firsts: Vec::new(),
            seen: Vec::with_capacity(stands.len()),
            stands,
            displacements: Vec::new(),
            memory,
            step: pace.step,
            n_steps: 0,
        })
    }

    /// Copies.
    #[must_use]
    pub fn len(&self) -> usize {
        self.stands.len()
    }

    /// Whether there are none, which cannot be.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.stands.is_empty()
    }

    /// Seconds since the beginning.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.n_steps as f64 * self.step
    }

    /// What it takes, bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let numbers = self.amplitudes.capacity() + self.speeds.capacity() + self.displacements.capacity();
        let kinds: usize = self.kinds.iter().map(|kind| kind.rows.len()).sum();
        (numbers + kinds + self.basis.len()) * size_of::<f32>()
            + self.stands.capacity() * size_of::<Stand>()
            + self.seen.capacity() * size_of::<Seen>()
            + self.details.bytes()
    }

    /// A step: what blows at its beginning blows till its end.
    ///
    /// # Errors
    /// [`ForestError::Wind`]; copies that have a wind have gone on.
    pub fn step(&mut self, wind: &dyn Wind, threads: &Threads) -> Result<(), ForestError> {
        let (n_modes, time) = (self.plant.omegas.len(), self.time());
        let calm = AtomicUsize::new(usize::MAX);
        let (stands, kinds, basis, height) = (&self.stands, &self.kinds, &self.basis, self.plant.height);
        let rows = self.amplitudes.chunks_mut(SOME * n_modes).zip(self.speeds.chunks_mut(SOME * n_modes));
        threads.each(rows.enumerate(), |(k, (amplitudes, speeds))| {
            let rows = amplitudes.chunks_exact_mut(n_modes).zip(speeds.chunks_exact_mut(n_modes));
            for (copy, (q, speed)) in (k * SOME..).zip(rows) {
                let stand = &stands[copy];
                let kind = &kinds[stand.kind as usize];
                let up = Vector3::z() * (CROWN * kind.scale * height);
                let v = wind.sample(&(Vector3::from(stand.place).cast() + up), time);
                if v.iter().all(|v| v.is_finite()) {
                    advance(&kind.rows, basis, pressed(stand, &v), q, speed);
                } else {
                    calm.fetch_min(copy, Relaxed);
                }
            }
        });
        self.n_steps += 1;
        match calm.into_inner() {
            usize::MAX => Ok(()),
            copy => Err(ForestError::Wind { copy, time }),
        }
    }

    /// Works out where the nodes are of all copies, or of those in view with the nodes and modes of their detail.
    ///
    /// # Errors
    /// [`ForestError::Memory`].
    pub fn pose(&mut self, view: Option<&View>, threads: &Threads) -> Result<(), ForestError> {
        let n_numbers = self.look(view);
        let more = n_numbers.saturating_sub(self.displacements.capacity());
        let wanted = self.bytes() + more * size_of::<f32>();
        room(self.plant, self.seen.len(), wanted, self.memory)?;
        if self.displacements.try_reserve_exact(n_numbers.saturating_sub(self.displacements.len())).is_err() {
            let (copies, nodes) = (self.seen.len(), self.plant.rest.len());
            return Err(ForestError::Memory { copies, nodes, bytes: wanted, there: self.bytes() });
        }
        self.displacements.resize(n_numbers, 0.0);
        let n_modes = self.plant.omegas.len();
        let mut rest = self.displacements.as_mut_slice();
        let batches = self.seen.chunk_by(|a, b| a.detail == b.detail).flat_map(|detail| detail.chunks(BATCH));
        let pieces: Vec<_> = batches
            .map(|seen| {
                let rig = &self.details.rigs[seen[0].detail as usize];
                let (piece, others) = std::mem::take(&mut rest).split_at_mut(seen.len() * rig.n_columns());
                rest = others;
                (rig, seen, piece)
            })
            .collect();
        let amplitudes = &self.amplitudes;
        threads.each(pieces.into_iter(), |(rig, seen, piece)| {
            let rows = seen.iter().map(|seen| &amplitudes[seen.copy as usize * n_modes..][..n_modes]);
            rig.pose_batch(rows, piece);
        });
        Ok(())
    }

    /// Which copies are posed, by details; how many numbers they have.
    fn look(&mut self, view: Option<&View>) -> usize {
        self.seen.clear();
        self.firsts.clear();
        let mut n_numbers = 0;
        for detail in 0..self.details.rigs.len() as u32 {
            self.firsts.push([self.seen.len(), n_numbers]);
            for (copy, stand) in (0..).zip(&self.stands) {
                let wanted = view.map_or(Some(0), |view| {
                    let scale = self.kinds[stand.kind as usize].scale;
                    self.details.of(self.plant, view, &Vector3::from(stand.place).cast(), scale)
                });
                if wanted == Some(detail) {
                    self.seen.push(Seen { copy, detail });
                    n_numbers += self.details.rigs[detail as usize].n_columns();
                }
            }
            if view.is_none() {
                break;
            }
        }
        n_numbers
    }

    /// Copies that were posed, those of one detail together.
    #[must_use]
    pub fn seen(&self) -> &[Seen] {
        &self.seen
    }

    /// Displacements of the k-th copy that was posed, in the frame and the size of the plant: three numbers a node of its
    /// detail.
    ///
    /// # Panics
    /// When not so many were posed.
    #[must_use]
    pub fn displacements(&self, k: usize) -> &[f32] {
        let detail = self.seen[k].detail as usize;
        let ([first_seen, first], n_columns) = (self.firsts[detail], self.details.rigs[detail].n_columns());
        &self.displacements[first + (k - first_seen) * n_columns..][..n_columns]
    }

    /// Nodes of the beams that a detail has.
    #[must_use]
    pub fn nodes(&self, detail: u32) -> &[u32] {
        &self.details.nodes[detail as usize]
    }

    /// Where a node of a copy is now, metres, whether it was posed or not.
    #[must_use]
    pub fn position(&self, copy: usize, node: usize) -> Vector3<f64> {
        let moved = self.details.rigs[0].displacement(self.amplitudes(copy), node);
        self.placed(copy, &(self.plant.rest[node] + Vector3::from(moved).cast()))
    }

    /// Where a node of a copy is at rest, metres.
    #[must_use]
    pub fn at_rest(&self, copy: usize, node: usize) -> Vector3<f64> {
        self.placed(copy, &self.plant.rest[node])
    }

    /// From the frame of the plant to where a copy stands.
    fn placed(&self, copy: usize, own: &Vector3<f64>) -> Vector3<f64> {
        let stand = &self.stands[copy];
        let (sin, cos) = f64::from(stand.turn).sin_cos();
        let turned = Vector3::new(cos * own.x - sin * own.y, sin * own.x + cos * own.y, own.z);
        Vector3::from(stand.place).cast() + turned * self.kinds[stand.kind as usize].scale
    }

    /// Amplitudes of a copy's modes.
    #[must_use]
    pub fn amplitudes(&self, copy: usize) -> &[f32] {
        let n_modes = self.plant.omegas.len();
        &self.amplitudes[copy * n_modes..][..n_modes]
    }

    /// Puts a copy's modes where they are wanted, standing still.
    pub fn pull(&mut self, copy: usize, amplitudes: &[f32]) {
        let n_modes = self.plant.omegas.len();
        self.amplitudes[copy * n_modes..][..n_modes].copy_from_slice(amplitudes);
        self.speeds[copy * n_modes..][..n_modes].fill(0.0);
    }
}

/// Refuses what would take more than is allowed.
fn room(plant: &Stirring, copies: usize, bytes: usize, there: usize) -> Result<(), ForestError> {
    let nodes = plant.rest.len();
    if bytes > there { Err(ForestError::Memory { copies, nodes, bytes, there }) } else { Ok(()) }
}

/// |v| v in the frame of a copy.
fn pressed(stand: &Stand, v: &Vector3<f64>) -> [f32; 3] {
    let (sin, cos) = f64::from(stand.turn).sin_cos();
    let own = Vector3::new(cos * v.x + sin * v.y, cos * v.y - sin * v.x, v.z) * v.norm();
    [own.x as f32, own.y as f32, own.z as f32]
}

/// The step of every mode of a kind.
fn steps(plant: &Stirring, k: usize, kind: &Kind, pace: &Pace) -> Result<Steps, ForestError> {
    let Kind { scale, damping: Damping { alpha, beta, mass } } = *kind;
    let is_plant = [scale, mass].iter().all(|v| v.is_finite() && *v > 0.0)
        && [alpha, beta].iter().all(|v| v.is_finite() && *v >= 0.0);
    if !is_plant {
        return Err(ForestError::Kind { kind: k, scale, mass, alpha, beta });
    }
    let n_modes = plant.omegas.len();
    let mut rows = vec![0.0; 6 * n_modes];
    for (mode, omega) in plant.omegas.iter().enumerate() {
        // Of an amplitude in the plant's own size: m s^3 of mass, s^2 of wind, and s of length.
        let mut oscillator = Oscillator::new(omega / scale, &kind.damping);
        oscillator.mass = mass * scale.powi(2);
        let step = oscillator.step_by(pace.integrator, pace.step)?;
        for (row, number) in step.numbers().into_iter().enumerate() {
            rows[row * n_modes + mode] = number as f32;
        }
    }
    Ok(Steps { scale, rows })
}

/// A step of all modes of a copy.
fn advance(steps: &[f32], basis: &[f32], [x, y, z]: [f32; 3], q: &mut [f32], speed: &mut [f32]) {
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || {
            let n = q.len();
            let speed = &mut speed[..n];
            let row = |k: usize| &steps[k * n..][..n];
            let [qq, qs, qf, sq, ss, sf] = [row(0), row(1), row(2), row(3), row(4), row(5)];
            let [px, py, pz] = [&basis[..n], &basis[n..][..n], &basis[2 * n..][..n]];
            for m in 0..n {
                let force = x * px[m] + y * py[m] + z * pz[m];
                let (q_now, speed_now) = (q[m], speed[m]);
                q[m] = qq[m] * q_now + qs[m] * speed_now + qf[m] * force;
                speed[m] = sq[m] * q_now + ss[m] * speed_now + sf[m] * force;
            }
        },
    );
}
