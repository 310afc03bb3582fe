//! Conjugate gradients, led by multigrid.

use crate::MattingError;
use crate::cycle::Cycle;
use crate::work::{dot, each};

/// Solved when the energy of the error, `√(eᵀ A e)` as the cycle judges it, is less. On four video frames no opacity changes
/// by more than 1 of 255 with a bound 2000 times as tight.
const ENERGY: f64 = 2e-5;
/// Steps after which there is something wrong; pictures of leaves take some 50.
const MOST_STEPS: usize = 1000;

/// A solution, and what it took.
pub(crate) struct Solution {
    pub(crate) x: Vec<[f64; 1]>,
    pub(crate) n_steps: usize,
}

/// Solves for a right side, from a first guess on. `go_on` is told the share that is done, 0 to 1, before each step.
pub(crate) fn solve(
    cycle: &mut Cycle,
    right: &[[f64; 1]],
    mut x: Vec<[f64; 1]>,
    go_on: &mut dyn FnMut(f64) -> bool,
) -> Result<Solution, MattingError> {
    let nought = vec![[0.0]; right.len()];
    let [mut fault, mut before, mut led, mut felt] = [nought.clone(), nought.clone(), nought.clone(), nought];
    cycle.matrix().fault(&x, right, &mut fault);
    cycle.solve(&fault, &mut led);
    let mut way = led.clone();
    let mut energy = dot(&led, &fault);
    let first = energy.sqrt();
    for n_steps in 0..MOST_STEPS {
        if energy.sqrt() <= ENERGY {
            return Ok(Solution { x, n_steps });
        }
        if !go_on((first / energy.sqrt()).ln() / (first / ENERGY).ln()) {
            return Err(MattingError::Stopped);
        }
        cycle.matrix().times(&way, &mut felt);
        let along = energy / dot(&way, &felt);
        each(&mut x, &way, &way, |x, way, _| *x += along * way);
        before.copy_from_slice(&fault);
        each(&mut fault, &felt, &felt, |fault, felt, _| *fault -= along * felt);
        cycle.solve(&fault, &mut led);
        // A cycle is not quite linear, so that the new way must be told from the last (Polak & Ribière).
        let next = dot(&led, &fault);
        let turn = (next - dot(&led, &before)) / energy;
        each(&mut way, &led, &led, |way, led, _| *way = led + turn * *way);
        energy = next;
    }
    Err(MattingError::Unsolved { n_steps: MOST_STEPS, energy: energy.sqrt() })
}
