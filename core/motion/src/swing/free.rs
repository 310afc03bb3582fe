//! What was let go: damped sines on a straight line, by least squares.
//!
//! x(t) = c + d t + sum of e^(-alpha t) (a cos omega t + b sin omega t). Sines are added one after the other, each where
//! the rest is strongest, and all are fitted again together (as RELAX does: Li and Stoica, IEEE Trans. Signal Process. 44,
//! 1996) by Levenberg's and Marquardt's steps, as long as Schwarz's criterion wants another. In white noise least squares
//! are as exact as anything can be; the inverse of their normal equations is Cramer's and Rao's bound. Where noise is
//! stronger about the swing than elsewhere, that noise counts.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector, Matrix4, Vector4};

use super::periodogram::Periodogram;
use super::{Manner, SURE, Seen, Swing, Told};

/// Sines at most.
const MOST: usize = 4;
/// Decays to begin with, in e-folds over the series.
const DECAYS: [f64; 8] = [-2.0, -0.5, 0.0, 1.0, 3.0, 8.0, 20.0, 60.0];
/// Frequencies to begin with, about the strongest: so many cycles more or fewer over the series.
const CYCLES: [f64; 5] = [-0.4, -0.2, 0.0, 0.2, 0.4];
/// Steps of the search.
const STEPS: usize = 60;
/// The last step makes squares less by no more than this.
const LAST: f64 = 1e-13;
/// A second sine beside the swing leaves no more than this share of the rest there: what bends the first one's decay,
/// as damping that changes with how far it swings, is no mode of its own.
const CLEARED: f64 = 0.25;
/// What is lost in noise sooner does not swing.
const FEWEST_CYCLES: f64 = 1.0;
/// Numbers of a sine: a, b, alpha, omega; before the first come c and d.
const OF_SINE: usize = 4;
const OF_LINE: usize = 2;

/// Where another sine is looked for.
#[derive(Clone, Copy)]
enum Where {
    /// In the band that somebody asked for.
    Wanted,
    Anywhere,
    /// Not beside the swing.
    Aside,
}

/// Sines and a line, over a series whose time goes from 0 to 1.
pub(super) struct Fit {
    at: Vec<f64>,
    rest: Vec<f64>,
    squares: f64,
}

impl Fit {
    /// Sines that a series is made of, the first of them within its band.
    pub(super) fn new(seen: &Seen) -> Self {
        let n = seen.series.len();
        let limit = seen.rounding * n as f64;
        let line = Self { at: vec![0.0; OF_LINE], rest: seen.series.clone(), squares: squares(&seen.series) };
        let Some(first) = line.with_another(seen, Where::Wanted) else { return line };
        let mut best = first;
        let mut is_crowded = false;
        while best.sines().count() < MOST {
            let place = if is_crowded { Where::Aside } else { Where::Anywhere };
            let Some(next) = best.with_another(seen, place).filter(|next| next.is_sound(seen)) else { break };
            let gain = n as f64 * (best.squares.max(limit) / next.squares.max(limit)).ln();
            // A sine is four numbers, and its frequency was chosen of all there are.
            let is_worth = gain > (OF_SINE + 1) as f64 * (n as f64).ln();
            let is_beside = next.n_within(seen) > best.n_within(seen);
            if is_worth && !(is_beside && next.rest_in_band(seen) > CLEARED * best.rest_in_band(seen)) {
                best = next;
            } else if is_crowded || !is_beside {
                break;
            } else {
                is_crowded = true;
            }
        }
        best
    }

    /// With one more sine, which begins where the rest is strongest, with the decay and the frequency that explain most.
    fn with_another(&self, seen: &Seen, place: Where) -> Option<Self> {
        let padded = Periodogram::padded(&self.rest, seen.fps, 2);
        let n_cycles = |hz: f64| hz * seen.series.len() as f64 / seen.fps;
        let all = [2.0 * padded.step_hz, seen.fps / 2.0];
        let band = [seen.band.start, seen.band.end - 1].map(|k| k as f64 * seen.periodogram.step_hz);
        let strongest = match place {
            Where::Wanted => padded.strongest(seen.within_hz),
            Where::Anywhere => padded.strongest(all),
            Where::Aside => [[all[0], band[0]], [band[1], all[1]]]
                .into_iter()
                .filter_map(|side| padded.strongest(side))
                .max_by(|a, b| padded.power[*a].total_cmp(&padded.power[*b])),
        };
        let about = n_cycles(strongest? as f64 * padded.step_hz);
        let starts = CYCLES.iter().flat_map(|more| DECAYS.map(|decay| (decay, TAU * (about + more))));
        let fits = starts.filter_map(|(alpha, omega)| alone(&self.rest, alpha, omega));
        let start = fits.min_by(|a, b| a.0.total_cmp(&b.0))?.1;
        Some(descend(&seen.series, [&self.at[..], &start[..]].concat()))
    }

    fn sines(&self) -> impl Iterator<Item = &[f64]> {
        self.at[OF_LINE..].chunks_exact(OF_SINE)
    }

    /// Whether no sine is beyond what can be seen, and none is there only to take another away.
    fn is_sound(&self, seen: &Seen) -> bool {
        let size = seen.series.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let top = 0.5 * seen.series.len() as f64;
        self.sines().all(|sine| {
            let cycles = sine[3] / TAU;
            let largest = sine[0].hypot(sine[1]) * (-sine[2]).exp().max(1.0);
            (0.25..top).contains(&cycles) && largest < 5.0 * size
        })
    }

    /// Sines within the band of a series.
    pub(super) fn n_within(&self, seen: &Seen) -> usize {
        self.sines().filter(|sine| is_within(sine, seen)).count()
    }

    /// Power of the rest at the band's frequencies, on average.
    fn rest_in_band(&self, seen: &Seen) -> f64 {
        let rest = &Periodogram::new(&self.rest, seen.fps).power[seen.band.clone()];
        (rest.iter().sum::<f64>() / rest.len() as f64).max(seen.rounding)
    }

    /// Minus the logarithm of the likelihood of the band's frequencies.
    pub(super) fn misfit(&self, seen: &Seen) -> f64 {
        seen.band.len() as f64 * self.rest_in_band(seen).ln()
    }

    /// The mean square of what no sine explains, from a sample on.
    pub(super) fn squares_from(&self, first: usize) -> f64 {
        squares(&self.rest[first..])
    }

    /// Samples of the series.
    pub(super) fn n_samples(&self) -> usize {
        self.rest.len()
    }

    /// The numbers that were sought.
    pub(super) fn n_numbers(&self) -> usize {
        self.at.len()
    }

    /// The sine that moves most where a swing is looked for.
    pub(super) fn strongest(&self, seen: &Seen) -> Option<Swing> {
        let n = seen.series.len() as f64;
        let seconds = n / seen.fps;
        let energy = |sine: &[f64]| sine[0].hypot(sine[1]).powi(2) * mean_decay(2.0 * sine[2]);
        let of = self.sines().enumerate().filter(|(_, sine)| is_within(sine, seen));
        let (which, sine) = of.max_by(|a, b| energy(a.1).total_cmp(&energy(b.1)))?;
        let dof = (2 * seen.band.len()).saturating_sub(OF_SINE * self.n_within(seen)).max(1) as f64;
        let noise = self.rest_in_band(seen) * 2.0 * seen.band.len() as f64 / dof;
        let normal = normal(&seen.series, &self.at).0;
        let covariance = normal.cholesky()?.inverse() * noise;
        let k = OF_LINE + OF_SINE * which + 2;
        let per_second = |v: f64| v / seconds;
        let (alpha, omega) = (per_second(sine[2]), per_second(sine[3]));
        let spread = [[k, k], [k, k + 1], [k + 1, k + 1]].map(|[i, j]| covariance[(i, j)] / seconds.powi(2));
        // Natural frequency (alpha^2 + omega^2)^1/2 and damping alpha / that, and how they follow alpha and omega.
        let natural = alpha.hypot(omega);
        let error = |of_alpha: f64, of_omega: f64| {
            let [aa, ao, oo] = spread;
            (of_alpha.powi(2) * aa + 2.0 * of_alpha * of_omega * ao + of_omega.powi(2) * oo).max(0.0).sqrt()
        };
        let hz = Told { value: natural / TAU, error: error(alpha / natural, omega / natural) / TAU };
        let cube = natural.powi(3);
        let ratio =
            Told { value: alpha / natural, error: error(omega * omega / cube, -alpha * omega / cube) };
        let manner = match ratio.value / ratio.error.max(f64::MIN_POSITIVE) {
            sure if sure > SURE => Manner::LetGo,
            sure if sure < -SURE => Manner::Growing,
            _ => Manner::Steady,
        };
        // Until it is as small as the noise.
        let folds = (sine[0].hypot(sine[1]) / noise.sqrt()).ln().max(0.0);
        let share = if sine[2] > 0.0 { (folds / sine[2]).min(1.0) } else { 1.0 };
        let n_cycles = share * sine[3] / TAU;
        (n_cycles >= FEWEST_CYCLES).then_some(Swing { manner, hz, ratio, n_cycles, first: 0 })
    }
}

/// Whether a sine is about the strongest frequency of a series, where one is looked for, and swings.
fn is_within(sine: &[f64], seen: &Seen) -> bool {
    let cycles = sine[3] / TAU;
    let [lowest, highest] = seen.within_hz.map(|hz| hz * seen.series.len() as f64 / seen.fps);
    let band = (seen.band.start as f64 - 0.5).max(lowest)..(seen.band.end as f64 - 0.5).min(highest);
    band.contains(&cycles) && sine[2].abs() < sine[3]
}

fn squares(rest: &[f64]) -> f64 {
    rest.iter().map(|v| v * v).sum()
}

/// The mean of e^(-rate t) from 0 to 1.
fn mean_decay(rate: f64) -> f64 {
    if rate.abs() < 1e-6 { 1.0 } else { -(-rate).exp_m1() / rate }
}

/// e^(-alpha t) (cos omega t, sin omega t) at each of n samples, t from 0 to 1.
fn turning(alpha: f64, omega: f64, n: usize) -> impl Iterator<Item = [f64; 2]> {
    let step = 1.0 / n as f64;
    let (by, turn) = ((-alpha * step).exp(), omega * step);
    let [c, s] = [by * turn.cos(), by * turn.sin()];
    std::iter::successors(Some([1.0, 0.0]), move |[x, y]| Some([x * c - y * s, x * s + y * c])).take(n)
}

/// A sine with a level and a slope, and what squares it leaves.
fn alone(series: &[f64], alpha: f64, omega: f64) -> Option<(f64, [f64; OF_SINE])> {
    let n = series.len() as f64;
    let (mut normal, mut product) = (Matrix4::zeros(), Vector4::zeros());
    for (k, (v, [c, s])) in series.iter().zip(turning(alpha, omega, series.len())).enumerate() {
        let row = Vector4::new(c, s, 1.0, k as f64 / n);
        normal += row * row.transpose();
        product += row * *v;
    }
    let found = normal.cholesky()?.solve(&product);
    let left = squares(series) - found.dot(&product);
    left.is_finite().then_some((left, [found[0], found[1], alpha, omega]))
}

/// Normal equations about some numbers: matrix, right side, and what they leave.
fn normal(series: &[f64], at: &[f64]) -> (DMatrix<f64>, DVector<f64>, Vec<f64>) {
    let (n, p) = (series.len(), at.len());
    let mut turns: Vec<_> =
        at[OF_LINE..].chunks_exact(OF_SINE).map(|sine| turning(sine[2], sine[3], n)).collect();
    let (mut matrix, mut right) = (DMatrix::zeros(p, p), DVector::zeros(p));
    let mut row = DVector::zeros(p);
    let mut rest = Vec::with_capacity(n);
    for (k, v) in series.iter().enumerate() {
        let t = k as f64 / n as f64;
        (row[0], row[1]) = (1.0, t);
        let mut left = v - at[0] - at[1] * t;
        for (sine, turn) in turns.iter_mut().enumerate() {
            let [c, s] = turn.next().unwrap_or_default();
            let k = OF_LINE + OF_SINE * sine;
            let value = at[k] * c + at[k + 1] * s;
            row.as_mut_slice()[k..k + OF_SINE].copy_from_slice(&[
                c,
                s,
                -t * value,
                t * (at[k + 1] * c - at[k] * s),
            ]);
            left -= value;
        }
        matrix.syger(1.0, &row, &row, 1.0);
        right.axpy(left, &row, 1.0);
        rest.push(left);
    }
    matrix.fill_upper_triangle_with_lower_triangle();
    (matrix, right, rest)
}

/// From some numbers to where squares are least nearby (Marquardt, J. SIAM 11, 1963).
fn descend(series: &[f64], mut at: Vec<f64>) -> Fit {
    let (mut matrix, mut right, mut rest) = normal(series, &at);
    let mut least = squares(&rest);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let mut damped = matrix.clone();
        (0..at.len()).for_each(|k| damped[(k, k)] *= 1.0 + damping);
        let next = damped.cholesky().map(|factor| factor.solve(&right)).map(|step| {
            let next: Vec<f64> = at.iter().zip(step.iter()).map(|(v, by)| v + by).collect();
            let (matrix, right, rest) = normal(series, &next);
            (squares(&rest), next, matrix, right, rest)
        });
        if let Some(next) = next
            && next.0 < least
        {
            let is_last = least - next.0 < LAST * least;
            (least, at, matrix, right, rest) = next;
            damping = (damping / 8.0).max(1e-12);
            if is_last {
                break;
            }
        } else {
            damping *= 6.0;
            if damping > 1e8 {
                break;
            }
        }
    }
    Fit { at, rest, squares: least }
}
