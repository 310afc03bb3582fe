//! A mode in time: q'' + gamma q' + omega^2 q = f / m (6.17).

#[cfg(test)]
mod tests;

use rustfft::num_complex::Complex;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Rayleigh's damping (6.11), the air's, and what scales the mass (6.36): chosen while it runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Damping {
    /// Of the mass, per second.
    pub alpha: f64,
    /// Of the stiffness, seconds.
    pub beta: f64,
    /// So many times as heavy as its wood.
    pub mass: f64,
    /// So many times what the drag of its branches and leaves makes of the wind; 0: none.
    pub air: f64,
}

impl Default for Damping {
    /// 5 % of critical at 1 Hz, what the air adds to that, and no added mass.
    fn default() -> Self {
        Self { alpha: 0.3, beta: 0.008, mass: 1.0, air: 1.0 }
    }
}

/// A mode as an oscillator of mass `mass` kg m^2 per unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillator {
    /// Angular frequency, radians per second.
    pub omega: f64,
    /// Damping, per second; the ratio to critical is gamma / (2 omega).
    pub gamma: f64,
    /// Modal mass.
    pub mass: f64,
}

/// A method to go on in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Integrator {
    /// Exact for a force that stays, stable whatever the step.
    #[default]
    Exact,
    /// The thesis's (errata E41), up to its limit.
    Symplectic,
    /// Newmark's with constant mean acceleration.
    Newmark,
}

/// A step that a method does not bear.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LimitError {
    /// No time at all, or backward.
    #[error("a step takes more than 0 s, not {0} s")]
    Step(f64),
    /// A method that is not stable for it.
    #[error(
        "symplectic Euler grows without bound in steps of {step} s at {hz:.3} Hz: less than {limit:.6} s is wanted, or another method"
    )]
    Limit {
        /// Asked for, seconds.
        step: f64,
        /// The longest that is borne, seconds.
        limit: f64,
        /// Frequency of the mode.
        hz: f64,
    },
}

/// Where a mode is and how fast it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Amplitude.
    pub q: f64,
    /// Its change, per second.
    pub speed: f64,
}

impl Oscillator {
    /// A mode of mass 1 and this frequency with the damping of its plant, but for the air's, which is the wind's matter: omega' = omega / sqrt(m) (6.37) and
    /// gamma' = alpha + beta omega'^2 (6.18; errata E42: 6.38 has m alpha + beta omega').
    #[must_use]
    pub fn new(omega: f64, damping: &Damping) -> Self {
        let omega = omega / damping.mass.sqrt();
        Self { omega, gamma: damping.alpha + damping.beta * omega.powi(2), mass: damping.mass }
    }

    /// The matrix of a step of `dt` seconds under a force that stays: exact, and stable whatever the step.
    #[must_use]
    pub fn step(&self, dt: f64) -> Step {
        let (half, square) = (self.gamma / 2.0, self.omega.powi(2));
        let inside = square - half.powi(2);
        // e^(-half t) times cos and sin / root, or cosh and sinh / root where it is damped beyond critical.
        let root = inside.abs().sqrt();
        let (c, s) = if root * dt < 1e-6 {
            let decay = (-half * dt).exp();
            (decay * (1.0 - inside * dt.powi(2) / 2.0), decay * dt * (1.0 - inside * dt.powi(2) / 6.0))
        } else if inside > 0.0 {
            let decay = (-half * dt).exp();
            (decay * (root * dt).cos(), decay * (root * dt).sin() / root)
        } else {
            let (slow, fast) = (((root - half) * dt).exp(), ((-root - half) * dt).exp());
            (f64::midpoint(slow, fast), (slow - fast) / (2.0 * root))
        };
        let stays = c + half * s;
        Step {
            q_of_q: stays,
            q_of_speed: s,
            q_of_force: (1.0 - stays) / (square * self.mass),
            speed_of_q: -square * s,
            speed_of_speed: c - half * s,
            speed_of_force: s / self.mass,
        }
    }

    /// The matrix of a step by a method, under a force that stays.
    ///
    /// # Errors
    /// [`LimitError`] where it is not stable.
    pub(crate) fn step_by(&self, integrator: Integrator, dt: f64) -> Result<Step, LimitError> {
        if !(dt.is_finite() && dt > 0.0) {
            return Err(LimitError::Step(dt));
        }
        let of = |next: &dyn Fn(State, f64) -> State| {
            let [of_q, of_speed] = [(1.0, 0.0), (0.0, 1.0)].map(|(q, speed)| next(State { q, speed }, 0.0));
            let of_force = next(State::default(), 1.0);
            Step {
                q_of_q: of_q.q,
                q_of_speed: of_speed.q,
                q_of_force: of_force.q,
                speed_of_q: of_q.speed,
                speed_of_speed: of_speed.speed,
                speed_of_force: of_force.speed,
            }
        };
        let limit = self.symplectic_limit();
        match integrator {
            Integrator::Exact => Ok(self.step(dt)),
            Integrator::Newmark => Ok(of(&|state, force| self.newmark(state, force, force, dt))),
            Integrator::Symplectic if dt < limit => Ok(of(&|state, force| self.symplectic(state, force, dt))),
            Integrator::Symplectic => Err(LimitError::Limit { step: dt, limit, hz: self.omega / TAU }),
        }
    }

    /// A step of the thesis (6.19 - 6.21), which is the symplectic Euler's (errata E41), under a force that stays.
    pub(crate) fn symplectic(&self, state: State, force: f64, dt: f64) -> State {
        let gain = force / self.mass - self.gamma * state.speed - self.omega.powi(2) * state.q;
        let speed = state.speed + dt * gain;
        State { q: state.q + dt * speed, speed }
    }

    /// A step of Newmark's method with constant mean acceleration (beta 1/4, gamma 1/2), under a force that changes
    /// linearly from `before` to `after`.
    pub(crate) fn newmark(&self, state: State, before: f64, after: f64, dt: f64) -> State {
        let (square, gamma) = (self.omega.powi(2), self.gamma);
        let gain = before / self.mass - gamma * state.speed - square * state.q;
        let q = state.q + dt * state.speed + dt.powi(2) / 4.0 * gain;
        let speed = state.speed + dt / 2.0 * gain;
        let next = (after / self.mass - gamma * speed - square * q)
            / (1.0 + dt / 2.0 * gamma + dt.powi(2) / 4.0 * square);
        State { q: q + dt.powi(2) / 4.0 * next, speed: speed + dt / 2.0 * next }
    }

    /// What it makes of a wave of force at a frequency, hertz: the amplitude that goes on, complex (5.39; errata E34: the
    /// signs of the printed difference are the wrong way round, and without damping there is no answer at its own frequency).
    pub(crate) fn response(&self, hz: f64) -> Complex<f64> {
        let drive = TAU * hz;
        (self.mass * Complex::new(self.omega.powi(2) - drive.powi(2), self.gamma * drive)).inv()
    }

    /// The longest step, seconds, for which symplectic Euler stays bounded: omega dt < 2 (sqrt(1 + zeta^2) - zeta)
    /// (errata E41: damping lowers the limit), also beyond critical damping.
    pub(crate) fn symplectic_limit(&self) -> f64 {
        let zeta = self.damping();
        2.0 / (((1.0 + zeta.powi(2)).sqrt() + zeta) * self.omega)
    }

    /// Its damping, of critical: from 1 on it creeps back to rest and does not swing.
    #[must_use]
    pub fn damping(&self) -> f64 {
        self.gamma / (2.0 * self.omega)
    }

    /// How often it swings by a method in steps of `dt` seconds, as a share of how often it does: without damping
    /// (2 / x) atan(x / 2) by Newmark's and (2 / x) asin(x / 2) by symplectic Euler (errata E41), x = omega dt. `None`
    /// where it does not swing, or the method bears no such step.
    #[must_use]
    pub fn swings(&self, integrator: Integrator, dt: f64) -> Option<f64> {
        let step = self.step_by(integrator, dt).ok()?;
        let swing = (self.omega.powi(2) - (self.gamma / 2.0).powi(2)).sqrt();
        // A step turns its state by so much, and makes it smaller.
        let middle = f64::midpoint(step.q_of_q, step.speed_of_speed);
        let left = step.q_of_q * step.speed_of_speed - step.q_of_speed * step.speed_of_q;
        let turn = (middle / left.sqrt()).acos();
        let share = if integrator == Integrator::Exact { 1.0 } else { turn / (swing * dt) };
        (swing > 0.0 && share.is_finite()).then_some(share)
    }
}

/// What a step does: numbers that a state and a force are multiplied by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    q_of_q: f64,
    q_of_speed: f64,
    q_of_force: f64,
    speed_of_q: f64,
    speed_of_speed: f64,
    speed_of_force: f64,
}

impl Step {
    /// What q is multiplied by, its speed and the force for the next q; then the same for the next speed.
    pub(crate) fn numbers(&self) -> [f64; 6] {
        [
            self.q_of_q,
            self.q_of_speed,
            self.q_of_force,
            self.speed_of_q,
            self.speed_of_speed,
            self.speed_of_force,
        ]
    }

    /// The state after the step.
    #[must_use]
    pub fn next(&self, State { q, speed }: State, force: f64) -> State {
        State {
            q: self.q_of_q * q + self.q_of_speed * speed + self.q_of_force * force,
            speed: self.speed_of_q * q + self.speed_of_speed * speed + self.speed_of_force * force,
        }
    }
}
