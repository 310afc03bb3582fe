//! How far the clocks of two cameras are apart that look at the same movement, each from its own side.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

use super::{FEWEST, Offset, Signal, Tried, best_of, is_beyond, n_steps};
use crate::CameraError;

/// A movement in a picture over time: positions, or velocities.
#[derive(Clone, Copy, Debug)]
pub struct Movement<'a> {
    /// Seconds, growing.
    pub times_s: &'a [f64],
    /// To the right, one value each.
    pub right: &'a [f64],
    /// Down, one value each.
    pub down: &'a [f64],
}

/// Of neighbours that are averaged: binomial. Times are smoothed as well, so that uneven ones do no harm.
const WEIGHTS: [f64; 5] = [1.0 / 16.0, 4.0 / 16.0, 6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];

/// Less alike than this, two movements are strangers: their directions are free, so chance makes more alike.
const STRANGERS: f64 = 0.7;

/// The offset, of at most `most_s` either way, at which a direction in the first picture and one in the second have movements that are
/// most alike (the first canonical correlation).
///
/// Two cameras see other parts of a movement in space, and one that is no line looks delayed from another side. But there is a direction
/// in each picture that both share: across the plane that holds both lines of sight. There alone both movements are one at the right
/// offset, if what moves is about equally far away; so directions are found together with the offset, and the error counts what
/// they leave undecided: of a single ellipse all.
///
/// # Errors
/// As [`by_movement`](super::by_movement).
pub fn by_movements(first: &Movement<'_>, second: &Movement<'_>, most_s: f64) -> Result<Offset, CameraError> {
    first.axes().iter().chain(&second.axes()).try_for_each(Signal::check)?;
    let fewest = FEWEST + WEIGHTS.len() - 1;
    if let Some(few) = [first, second].into_iter().find(|movement| movement.times_s.len() < fewest) {
        let n = few.times_s.len();
        return Err(CameraError::Signal { fewest, times: n, values: n });
    }
    let [first, second] = [first, second].map(Smooth::of);
    let (first, second) = (&first.movement(), &second.movement());
    let [mine, theirs] = [first, second].map(|movement| movement.axes()[0]);
    let step = mine.step_s().min(theirs.step_s()) / 2.0;
    let least_s = mine.len_s().min(theirs.len_s()) / 2.0;
    let n = n_steps(&mine, &theirs, most_s, step);
    let alike = |offset: f64| Some(first.beside(second, offset, 0.0)?.directions()?.alike);
    let tried = (-n..=n).map(|k| k as f64 * step).filter_map(|seconds| {
        let both = first.beside(second, seconds, least_s)?;
        Some(Tried { seconds, alike: both.directions()?.alike, n: both.mine.len() })
    });
    let (best, rival_s) = best_of(&tried.collect::<Vec<_>>(), STRANGERS).ok_or(CameraError::Strangers)?;
    let start = best.seconds;
    let seconds = peak(start - step, start + step, |offset| alike(offset).unwrap_or(0.0));
    let both = first.beside(second, seconds, 0.0).ok_or(CameraError::Strangers)?;
    let directions = both.directions().ok_or(CameraError::Strangers)?;
    let error_s = both.error_s(&directions, mine.step_s()).ok_or(CameraError::Strangers)?;
    let found = Offset { seconds, error_s, alike: directions.alike, rival_s };
    if is_beyond(start, seconds, n, step) { Err(CameraError::AtTheEnd { offset: found }) } else { Ok(found) }
}

/// Where a function with one peak between two places has it, by golden sections.
fn peak(mut from: f64, mut to: f64, height: impl Fn(f64) -> f64) -> f64 {
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let inner = |from: f64, to: f64| [to - golden * (to - from), from + golden * (to - from)];
    let [mut a, mut b] = inner(from, to);
    let [mut at_a, mut at_b] = [a, b].map(&height);
    // Each step leaves 0.618 of the way: a millionth is left.
    for _ in 0..30 {
        if at_a > at_b {
            (to, b, at_b) = (b, a, at_a);
            a = inner(from, to)[0];
            at_a = height(a);
        } else {
            (from, a, at_a) = (a, b, at_b);
            b = inner(from, to)[1];
            at_b = height(b);
        }
    }
    f64::midpoint(from, to)
}

/// A movement with less of its noise. What is read between samples has less of it than what is read on them, so noise draws offsets to
/// half a frame; this leaves hardly any for that.
struct Smooth([Vec<f64>; 3]);

impl Smooth {
    fn of(movement: &Movement<'_>) -> Self {
        let smooth = |values: &[f64]| {
            let sum = |five: &[f64]| five.iter().zip(WEIGHTS).map(|(value, weight)| value * weight).sum();
            values.windows(WEIGHTS.len()).map(sum).collect()
        };
        Self([movement.times_s, movement.right, movement.down].map(smooth))
    }

    fn movement(&self) -> Movement<'_> {
        let [times_s, right, down] = &self.0;
        Movement { times_s, right, down }
    }
}

impl<'a> Movement<'a> {
    fn axes(&self) -> [Signal<'a>; 2] {
        [self.right, self.down].map(|values| Signal { times_s: self.times_s, values })
    }

    /// This movement, and the other one so much later, at this one's times; `None` where they share less than this time.
    fn beside(&self, other: &Movement<'_>, offset_s: f64, least_s: f64) -> Option<Both> {
        let [right, down] = other.axes();
        let (mut both, mut span) = (Both::default(), (f64::INFINITY, f64::NEG_INFINITY));
        for ((&t, &x), &y) in self.times_s.iter().zip(self.right).zip(self.down) {
            if let (Some((u, du)), Some((v, dv))) = (right.at(t + offset_s), down.at(t + offset_s)) {
                both.mine.push(Vector2::new(x, y));
                both.theirs.push(Vector2::new(u, v));
                both.slopes.push(Vector2::new(du, dv));
                span = (span.0.min(t), span.1.max(t));
            }
        }
        (both.mine.len() >= FEWEST && span.1 - span.0 >= least_s).then(|| both.centred())
    }
}

/// Two movements at the same times, about their means.
#[derive(Default)]
struct Both {
    mine: Vec<Vector2<f64>>,
    theirs: Vec<Vector2<f64>>,
    slopes: Vec<Vector2<f64>>,
}

/// In which directions of either picture they are most alike, so long that one is about as large as the other.
struct Directions {
    mine: Vector2<f64>,
    theirs: Vector2<f64>,
    alike: f64,
}

impl Both {
    fn centred(mut self) -> Self {
        for values in [&mut self.mine, &mut self.theirs, &mut self.slopes] {
            let mean = values.iter().sum::<Vector2<f64>>() / values.len() as f64;
            values.iter_mut().for_each(|value| *value -= mean);
        }
        self
    }

    fn directions(&self) -> Option<Directions> {
        /// What moves along a line alone has no spread across it; as much of its spread keeps the arithmetic whole.
        const RIDGE: f64 = 1e-9;
        let product = |a: &[Vector2<f64>], b: &[Vector2<f64>]| -> Matrix2<f64> {
            a.iter().zip(b).map(|(a, b)| a * b.transpose()).sum()
        };
        let spread = |of: &[Vector2<f64>]| {
            let spread = product(of, of);
            (spread + Matrix2::identity() * (RIDGE * spread.trace())).try_inverse()
        };
        let across = product(&self.mine, &self.theirs);
        let (mine, theirs) = (spread(&self.mine)?, spread(&self.theirs)?);
        let back = theirs * across.transpose();
        let share = mine * across * back;
        let half = share.trace() / 2.0;
        let most = half + (half * half - share.determinant()).max(0.0).sqrt();
        // Both rows of `share - most` are across the direction; the longer one tells it better.
        let rest = share - Matrix2::identity() * most;
        let rows = [rest.row(0), rest.row(1)].map(|row| Vector2::new(-row[1], row[0]));
        let longer = if rows[0].norm() >= rows[1].norm() { rows[0] } else { rows[1] };
        // All directions are alike: any will do.
        let direction = longer.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vector2::x);
        let alike = most.max(0.0).sqrt().min(1.0);
        alike.is_finite().then(|| Directions { mine: direction, theirs: back * direction, alike })
    }

    /// The standard error of the offset: of a least squares fit in which both directions are free as well.
    fn error_s(&self, directions: &Directions, step_s: f64) -> Option<f64> {
        /// What lies between samples is not known better than to a thousandth of the movement.
        const UNKNOWN: f64 = 1e-3;
        let n = self.mine.len();
        let turned = Vector2::new(-directions.mine.y, directions.mine.x);
        let column = |of: &[Vector2<f64>], along: Vector2<f64>| {
            DVector::from_iterator(n, of.iter().map(|value| value.dot(&along)))
        };
        let free = [
            column(&self.theirs, Vector2::x()),
            column(&self.theirs, Vector2::y()),
            column(&self.mine, turned),
        ];
        let free = DMatrix::from_columns(&free).svd(true, false);
        let bases = free.u?;
        let largest = free.singular_values.max();
        let without = |mut values: DVector<f64>| {
            for (base, size) in bases.column_iter().zip(&free.singular_values) {
                if *size > 1e-9 * largest {
                    values.axpy(-base.dot(&values), &base, 1.0);
                }
            }
            values
        };
        let own = without(column(&self.slopes, directions.theirs));
        let signal = column(&self.mine, directions.mine);
        let left = without(signal.clone());
        let squares = left.norm_squared().max(UNKNOWN * UNKNOWN * signal.norm_squared());
        let power = own.norm_squared();
        let next: f64 = left.as_slice().windows(2).map(|pair| pair[0] * pair[1]).sum();
        // Samples of what is left depend on each other; of a correlation c there are (1 - c) / (1 + c) as many.
        let c = (next / squares.max(f64::MIN_POSITIVE)).clamp(0.0, 0.99);
        let variance = squares / (n as f64 - 5.0) * (1.0 + c) / (1.0 - c);
        (power > 0.0).then(|| (variance / power).sqrt().max(1e-6 * step_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::staged::Noise;

    /// A branch that sways in ellipses: two directions with two tones each, pushed now and then.
    fn place(t: f64) -> [f64; 3] {
        let push = |since: f64, hz: f64| {
            if since < 0.0 { 0.0 } else { (-0.5 * since).exp() * (std::f64::consts::TAU * hz * since).sin() }
        };
        let x = push(t - 0.4, 1.3) + 0.7 * push(t - 3.0, 1.3);
        let z = push(t - 0.7, 1.1) - 0.8 * push(t - 2.6, 1.1) + 0.3 * push(t - 5.0, 2.0);
        [x, 0.15 * x + 0.25 * z, z]
    }

    /// What a camera sees that looks along z turned by this angle about the vertical.
    fn view(fps: f64, n: usize, clock_s: f64, angle: f64, noise: &mut Noise) -> [Vec<f64>; 3] {
        let times: Vec<f64> = (0..n).map(|k| k as f64 / fps).collect();
        let places: Vec<[f64; 3]> = times.iter().map(|t| place(t - clock_s)).collect();
        let right =
            places.iter().map(|p| 40.0 * (angle.cos() * p[0] + angle.sin() * p[2]) + noise.draw()).collect();
        let down = places.iter().map(|p| -40.0 * p[1] + noise.draw()).collect();
        [times, right, down]
    }

    fn movement([times_s, right, down]: &[Vec<f64>; 3]) -> Movement<'_> {
        Movement { times_s, right, down }
    }

    #[test]
    fn what_sways_in_ellipses_tells_the_offset_from_another_side() {
        let first = view(25.0, 200, 0.0, 0.0, &mut Noise::new(1, 0.05));
        for angle in [0.3, 0.8, 1.3] {
            let second = view(30.0, 240, 0.3137, angle, &mut Noise::new(2, 0.05));
            let found = by_movements(&movement(&first), &movement(&second), 1.0).unwrap();
            assert!((found.seconds - 0.3137).abs() < 0.003, "{angle}: {found:?}");
            assert!((found.seconds - 0.3137).abs() < 4.0 * found.error_s, "{angle}: {found:?}");
            assert!(found.alike > 0.99, "{found:?}");
        }
        // To the right alone it is hardly known.
        let [times, right, _] = view(30.0, 240, 0.3137, 0.3, &mut Noise::new(2, 0.05));
        let alone = super::super::by_movement(
            Signal { times_s: &first[0], values: &first[1] },
            Signal { times_s: &times, values: &right },
            1.0,
        )
        .unwrap();
        assert!(alone.error_s > 0.01, "{alone:?}");
    }

    #[test]
    fn errors_of_offsets_are_those_of_many_trials() {
        let (mut squares, mut told, n) = (0.0, 0.0, 60);
        for seed in 0..n {
            let first = view(25.0, 200, 0.0, 0.0, &mut Noise::new(seed, 2.0));
            let second = view(25.0, 200, 0.21, 0.8, &mut Noise::new(1000 + seed, 0.3));
            let found = by_movements(&movement(&first), &movement(&second), 0.6).unwrap();
            squares += (found.seconds - 0.21).powi(2);
            told += found.error_s.powi(2);
        }
        let ratio = (squares / told).sqrt();
        assert!((0.6..1.6).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_single_ellipse_decides_nothing_and_a_line_does() {
        let at = |clock_s: f64, of: fn(f64) -> [f64; 2]| {
            let times: Vec<f64> = (0..200).map(|k| f64::from(k) / 25.0).collect();
            let seen: Vec<[f64; 2]> = times.iter().map(|t| of(t - clock_s)).collect();
            [times, seen.iter().map(|p| p[0]).collect(), seen.iter().map(|p| p[1]).collect()]
        };
        let ellipse = |t: f64| [9.0 * (7.0 * t).cos(), 3.0 * (7.0 * t).sin()];
        let (first, second) = (at(0.0, ellipse), at(0.1, ellipse));
        let undecided = by_movements(&movement(&first), &movement(&second), 0.3);
        assert!(
            undecided.as_ref().map_or(true, |found| {
                found.error_s > (found.seconds - 0.1).abs() || found.rival_s.is_some()
            }),
            "{undecided:?}"
        );
        let line = |t: f64| [9.0 * (7.0 * t + (t * 1.3).sin()).cos(), 0.0];
        let (first, second) = (at(0.0, line), at(0.1, line));
        let found = by_movements(&movement(&first), &movement(&second), 0.3).unwrap();
        assert!((found.seconds - 0.1).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn an_even_sway_has_rivals_and_few_samples_that_are_alike_say_less_than_many() {
        let sway = |times: &[f64], clock_s: f64, noise: &mut Noise| {
            let at = |t: f64| 9.0 * (0.01 * (t - clock_s) * (t - clock_s) + 4.0 * (t - clock_s)).sin();
            times.iter().map(|&t| at(t) + noise.draw()).collect::<Vec<f64>>()
        };
        let times: Vec<f64> = (0..240).map(|k| f64::from(k) / 25.0).collect();
        for seed in 0..20 {
            let view = |clock_s: f64, seed: u64| {
                let mut noise = Noise::new(seed, 0.3);
                [times.clone(), sway(&times, clock_s, &mut noise), (0..240).map(|_| noise.draw()).collect()]
            };
            let (first, second) = (view(0.0, seed), view(-0.36, 100 + seed));
            let found = by_movements(&movement(&first), &movement(&second), 5.0).unwrap();
            assert!((found.seconds + 0.36).abs() < 0.05, "{seed}: {found:?}");
            let rival = found.rival_s.unwrap();
            // Directions are free, so half a swing is one.
            assert!((rival - found.seconds).abs() > 0.6, "{seed}: {found:?}");
        }
    }

    #[test]
    fn strangers_are_named() {
        let first = view(25.0, 200, 0.0, 0.0, &mut Noise::new(1, 0.0));
        let mut noise = Noise::new(9, 1.0);
        let stranger = [first[0].clone(), vec![0.0; 200], (0..200).map(|_| noise.draw()).collect()];
        let still = [first[0].clone(), vec![3.0; 200], vec![1.0; 200]];
        for other in [stranger, still] {
            let found = by_movements(&movement(&first), &movement(&other), 1.0);
            assert_eq!(found, Err(CameraError::Strangers));
        }
    }
}
