//! Forks shifted towards what bears them, until bones change their length least (thesis 4.11, 4.12).

use crate::bones::distance;
use crate::tree::Group;

/// Steps in which the best shift is first looked for.
const STEPS: u32 = 64;
/// Halvings, as it were, of the step that was best: each leaves 0.62 of it.
const ROUNDS: u32 = 40;
/// Bones that change by so little tell no shift from another, pixels.
const NOTHING: f64 = 1e-6;

/// Shifts every fork, from the root to the tips, along the way from what bears it to where it is; returns how much of that
/// way was left of each, 0 to 1.
pub(super) fn shift(groups: &[Group], base: [f64; 3], at: &mut [Vec<[f64; 3]>]) -> Vec<f64> {
    let mut alphas = Vec::new();
    for (row, group) in groups.iter().enumerate().filter(|(_, group)| !group.children.is_empty()) {
        let n_frames = at[row].len();
        let origin: Vec<[f64; 3]> =
            group.parent.map_or_else(|| vec![base; n_frames], |parent| at[parent].clone());
        let ends: Vec<&[[f64; 3]]> = group.children.iter().map(|&child| at[child].as_slice()).collect();
        let alpha = best(&origin, &at[row], &ends);
        let shifted = origin.iter().zip(&at[row]).map(|(from, to)| between(*from, *to, alpha)).collect();
        at[row] = shifted;
        alphas.push(alpha);
    }
    alphas
}

/// The share of the way at which bones change least; half of it where none is better than that.
fn best(origin: &[[f64; 3]], mean: &[[f64; 3]], ends: &[&[[f64; 3]]]) -> f64 {
    let spread = |alpha: f64| unrest(origin, mean, ends, alpha);
    let step = 1.0 / f64::from(STEPS);
    let on_grid = (0..=STEPS).map(|k| (f64::from(k) * step, spread(f64::from(k) * step)));
    let (near, _) = on_grid.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0.5, 0.0));
    let ratio = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut low, mut high) = ((near - step).max(0.0), (near + step).min(1.0));
    for _ in 0..ROUNDS {
        let (a, b) = (high - ratio * (high - low), low + ratio * (high - low));
        if spread(a) <= spread(b) { high = b } else { low = a }
    }
    let found = [0.5, near, f64::midpoint(low, high)].map(|alpha| (alpha, spread(alpha)));
    let least = found.iter().map(|found| found.1).fold(f64::INFINITY, f64::min);
    found.iter().find(|found| found.1 <= least + NOTHING).map_or(0.5, |found| found.0)
}

/// How much the bones at a fork change their length: standard deviations of those to its ends (thesis 4.11) and, which is
/// missing there, of the one that it ends itself (errata E22). Pixels.
pub(super) fn unrest(origin: &[[f64; 3]], mean: &[[f64; 3]], ends: &[&[[f64; 3]]], alpha: f64) -> f64 {
    let fork = |frame: usize| between(origin[frame], mean[frame], alpha);
    let n = origin.len();
    let to_ends: f64 = ends.iter().map(|end| deviation((0..n).map(|t| distance(fork(t), end[t])))).sum();
    to_ends + deviation((0..n).map(|t| distance(fork(t), origin[t])))
}

/// The standard deviation; 0 of none.
fn deviation(lengths: impl Iterator<Item = f64>) -> f64 {
    let (mut first, mut n, mut sum, mut squares) = (None, 0.0, 0.0, 0.0);
    for length in lengths {
        // About the first: lengths are large, and change little.
        let change = length - *first.get_or_insert(length);
        (n, sum, squares) = (n + 1.0, sum + change, squares + change * change);
    }
    if n > 0.0 { (squares / n - (sum / n) * (sum / n)).max(0.0).sqrt() } else { 0.0 }
}

fn between(from: [f64; 3], to: [f64; 3], share: f64) -> [f64; 3] {
    std::array::from_fn(|axis| from[axis] + share * (to[axis] - from[axis]))
}
