//! Moments of the angles between all headings of a step, from their sorted order.

use std::f64::consts::{PI, TAU};

use super::Moments;
use super::steps::Steps;

/// Number, sum and sum of squares of the angles between all pairs of velocities, for every step.
pub(super) fn moments(steps: &Steps) -> Vec<Moments> {
    (0..steps.len()).map(|step| of_headings(steps.headings(step))).collect()
}

/// Moments of |θj - θi| wrapped to 0..=π over all pairs, in O(n log n) instead of O(n²).
///
/// In sorted order θj - θi >= 0; those up to π count as they are, the others as 2π - (θj - θi), and prefix
/// sums of θ and θ² give both sums for a whole run of j at once.
pub(super) fn of_headings(mut headings: Vec<f64>) -> Moments {
    headings.sort_by(f64::total_cmp);
    let n = headings.len();
    let prefix = |power: i32| {
        let mut sums = vec![0.0; n + 1];
        for (k, heading) in headings.iter().enumerate() {
            sums[k + 1] = sums[k] + heading.powi(power);
        }
        sums
    };
    let (first, second) = (prefix(1), prefix(2));
    let mut moments = Moments { n_pairs: (n * n.saturating_sub(1)) as f64 / 2.0, ..Moments::default() };
    let mut far = 0;
    for (i, &heading) in headings.iter().enumerate() {
        while far < n && headings[far] - heading <= PI {
            far += 1;
        }
        for (range, origin, sign) in [(i + 1..far, heading, 1.0), (far..n, heading + TAU, -1.0)] {
            let len = range.len() as f64;
            let (sum, squares) =
                (first[range.end] - first[range.start], second[range.end] - second[range.start]);
            moments.sum += sign * (sum - len * origin);
            moments.squares += squares - 2.0 * origin * sum + len * origin * origin;
        }
    }
    moments
}
