//! What moving air takes from the speed of a plant: damping that grows with the wind.
//!
//! A step is a half of it, all else for the whole step, and the other half (Strang, SIAM J. Numer. Anal. 5, 1968). Each
//! of the parts takes energy or leaves it, so that it is stable whatever the step and the wind; a constant force bends
//! by what it should; and, the determinant of a step being e^(-gamma dt), a swing dies as fast as it should. What is off
//! by the square of the step is its frequency.

#[cfg(test)]
mod tests;

use crate::wind_basis::WindBasis;
use nalgebra::Vector3;

/// Numbers of a symmetric tensor: xx, yy, zz, xy, xz, yz.
pub(super) const SIX: usize = 6;

/// T of every mode: a row of all modes for each of its numbers.
pub(super) fn rows(basis: &WindBasis) -> Vec<f32> {
    let places = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
    let row = |place| basis.dampings.iter().map(move |tensor| tensor[place] as f32);
    places.into_iter().flat_map(row).collect()
}

/// What T is to be multiplied by, number by number, for |v| tr T + v T v / |v| in a wind in its own axes, so many times.
#[inline(always)]
pub(super) fn weights(v: &Vector3<f64>, times: f64) -> [f32; SIX] {
    let speed = v.norm();
    if speed == 0.0 {
        return [0.0; SIX];
    }
    let along = v / speed;
    let own = |k: usize| (times * (speed + along[k] * v[k])) as f32;
    let mixed = |a: usize, b: usize| (times * 2.0 * along[a] * v[b]) as f32;
    [own(0), own(1), own(2), mixed(0, 1), mixed(0, 2), mixed(1, 2)]
}

/// e^-x of 0 and above, to 1e-6 up to 1; never more than 1 or less than 0, and just 1 of 0.
#[inline(always)]
pub(super) fn fade(x: f32) -> f32 {
    // The fourth root first: of so small a number seven terms do.
    let x = x.max(0.0) / 4.0;
    let rest = 1.0 + x / 4.0 * (1.0 + x / 5.0 * (1.0 + x / 6.0));
    let root = 1.0 + x * (1.0 + x / 2.0 * (1.0 + x / 3.0 * rest));
    let square = root * root;
    1.0 / (square * square)
}
