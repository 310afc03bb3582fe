//! Motion by the spectrum (thesis 5.5.3): what a forest does in a wind that begins again after its end.
//!
//! What presses on a mode is then a sum of waves, and the mode answers each by itself, q(f) = g(f) F(f) (5.40; errata E34).
//! So does what comes of it go round: it has no beginning to die away, and its last frame goes on into its first. The drag
//! is that of all steps, |v| v as it blows; of the air's damping, which is not the same at any time, there is the mean.

#[cfg(test)]
mod tests;

use super::{Forest, ForestError, in_own_axes};
use crate::threads::Threads;
use nalgebra::{Matrix3, Vector3};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::{Arc, Mutex, PoisonError};

/// The wind at a copy and a time, metres per second in the world, seconds.
pub type Winds<'a> = &'a (dyn Fn(usize, f64) -> Vector3<f64> + Sync);

/// What a thread takes for a step of the wind, bytes: the wind, what presses along each axis, and a mode's answer.
const STEP_BYTES: usize = size_of::<Vector3<f64>>() + 4 * size_of::<Complex<f64>>();

/// A motion of a forest that goes round.
#[derive(Clone, Debug, PartialEq)]
pub struct Round {
    n_frames: usize,
    n_modes: usize,
    /// Seconds of a frame.
    frame_s: f64,
    /// Amplitudes of modes and how fast they change, `(n_copies, n_frames, n_modes)`.
    states: Vec<[f32; 2]>,
}

impl Round {
    /// A copy's modes in a frame: amplitudes, and how fast they change, per second.
    fn row(&self, copy: usize, frame: usize) -> &[[f32; 2]] {
        &self.states[(copy * self.n_frames + frame) * self.n_modes..][..self.n_modes]
    }
}

impl Forest {
    /// What [`round`](Self::round) takes, bytes.
    #[must_use]
    pub fn round_bytes(&self, n_frames: usize, n_substeps: usize, n_threads: usize) -> usize {
        let n_numbers = self.amplitudes.len().saturating_mul(n_frames);
        let records = n_frames.saturating_mul(n_substeps).saturating_mul(n_threads);
        n_numbers.saturating_mul(size_of::<[f32; 2]>()).saturating_add(records.saturating_mul(STEP_BYTES))
    }

    /// What it does for ever in a wind that begins again after so many frames, each of so many steps, by the spectrum. The
    /// wind is looked at at every step; between them it is what has no faster waves.
    ///
    /// # Errors
    /// [`ForestError::Undamped`], [`ForestError::Wind`], [`ForestError::Memory`].
    ///
    /// # Panics
    /// Without a frame or a step.
    pub fn round(
        &self,
        n_frames: usize,
        n_substeps: usize,
        wind: Winds<'_>,
        threads: &Threads,
    ) -> Result<Round, ForestError> {
        assert!(n_frames > 0 && n_substeps > 0, "a step at least");
        let (copies, n_modes) = (self.len(), self.omegas.len());
        let bytes = self.round_bytes(n_frames, n_substeps, 1);
        let full = |_| ForestError::Memory { copies, modes: n_modes, bytes };
        let mut states = Vec::new();
        states.try_reserve_exact(self.amplitudes.len().saturating_mul(n_frames)).map_err(full)?;
        states.resize(self.amplitudes.len() * n_frames, [0.0; 2]);
        let step = self.pace.step;
        let waves = Waves::new(n_frames * n_substeps, step);
        let failed: Mutex<BTreeMap<usize, ForestError>> = Mutex::default();
        threads.each(states.chunks_exact_mut(n_frames * n_modes).enumerate(), |(copy, rows)| {
            let own = |k: usize| in_own_axes(&self.copies[copy].0, &wind(copy, k as f64 * step));
            let record: Vec<Vector3<f64>> = (0..waves.n).map(own).collect();
            let wild = record.iter().position(|v| !v.iter().all(|v| v.is_finite()));
            let answered = match wild {
                Some(k) => Err(ForestError::Wind { copy, time: k as f64 * step }),
                None => self.answer(copy, &record, &waves, (rows, n_substeps)),
            };
            if let Err(error) = answered {
                failed.lock().unwrap_or_else(PoisonError::into_inner).insert(copy, error);
            }
        });
        // The same on any number of threads.
        match failed.into_inner().unwrap_or_else(PoisonError::into_inner).pop_first() {
            Some((_, error)) => Err(error),
            None => Ok(Round { n_frames, n_modes, frame_s: step * n_substeps as f64, states }),
        }
    }

    /// What the modes of a copy do in a wind in its own axes: a row a frame, of so many steps.
    fn answer(
        &self,
        copy: usize,
        record: &[Vector3<f64>],
        waves: &Waves,
        (rows, every): (&mut [[f32; 2]], usize),
    ) -> Result<(), ForestError> {
        let (basis, n_modes, damping) = (&self.by_wind, self.omegas.len(), &self.pace.damping);
        let kind = &self.kinds[self.copies[copy].1 as usize];
        let pressed = [0, 1, 2].map(|axis| waves.of(record.iter().map(|v| v.norm() * v[axis])));
        let takes = |v: &Vector3<f64>| {
            Matrix3::from_diagonal_element(v.norm()) + v * v.transpose() / v.norm().max(f64::MIN_POSITIVE)
        };
        let by_air =
            record.iter().map(takes).sum::<Matrix3<f64>>() / record.len() as f64 * kind.by_air(damping);
        for (mode, mut oscillator) in kind.oscillators(&self.omegas, damping).enumerate() {
            oscillator.gamma += basis.dampings[mode].dot(&by_air);
            if oscillator.gamma <= 0.0 {
                return Err(ForestError::Undamped { hz: oscillator.omega / TAU });
            }
            let force = basis.forces[mode];
            let wave = |k: usize| (0..3).map(|axis| pressed[axis][k] * force[axis]).sum::<Complex<f64>>();
            let states = waves.back(|k, hz| wave(k) * oscillator.response(hz));
            for (row, state) in rows.chunks_exact_mut(n_modes).zip(states.iter().step_by(every)) {
                row[mode] = [state.re as f32, state.im as f32];
            }
        }
        Ok(())
    }

    /// Puts all copies where a motion that goes round has them in a frame, as fast as they then are.
    ///
    /// # Panics
    /// When it is of another forest, or has no such frame.
    pub fn put(&mut self, round: &Round, frame: usize) {
        assert!(frame < round.n_frames, "a frame of the motion");
        let rows = (0..self.copies.len()).flat_map(|copy| round.row(copy, frame));
        for ((q, speed), state) in self.amplitudes.iter_mut().zip(&mut self.speeds).zip(rows) {
            [*q, *speed] = *state;
        }
        self.time = frame as f64 * round.frame_s;
    }
}

/// Waves of all frequencies that go a whole number of times into a record.
struct Waves {
    n: usize,
    /// Hertz, from one to the next.
    hz: f64,
    forward: Arc<dyn Fft<f64>>,
    inverse: Arc<dyn Fft<f64>>,
}

impl Waves {
    fn new(n: usize, step: f64) -> Self {
        let mut planner = FftPlanner::new();
        let (forward, inverse) = (planner.plan_fft_forward(n), planner.plan_fft_inverse(n));
        Self { n, hz: 1.0 / (n as f64 * step), forward, inverse }
    }

    /// Of so many numbers.
    fn of(&self, numbers: impl Iterator<Item = f64>) -> Vec<Complex<f64>> {
        let mut waves: Vec<_> = numbers.map(|v| Complex::from(v / self.n as f64)).collect();
        self.forward.process(&mut waves);
        waves
    }

    /// Numbers by their waves, the real part, and how fast they change, the imaginary one.
    fn back(&self, wave: impl Fn(usize, f64) -> Complex<f64>) -> Vec<Complex<f64>> {
        let mut waves: Vec<Complex<f64>> = (0..self.n)
            .map(|k| {
                let n = if 2 * k > self.n { k as f64 - self.n as f64 } else { k as f64 };
                let (hz, speed) = (n * self.hz, Complex::new(0.0, TAU * n * self.hz));
                let q = wave(k, hz);
                // The fastest of an even number is half each of two, of which the other is its conjugate.
                let [q, speed] = if 2 * k == self.n {
                    [q, speed * q].map(|v| Complex::from(v.re))
                } else {
                    [q, speed * q]
                };
                q + speed * Complex::<f64>::i()
            })
            .collect();
        self.inverse.process(&mut waves);
        waves
    }
}
