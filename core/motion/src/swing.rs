//! How fast something swings and how soon it comes to rest, from a series of where it was.
//!
//! A mode that is pulled and let go, and one that the wind drives, have nearly the same shape of spectrum about its
//! frequency: A (1 + C r^2) r^-D / ((1 - r^2)^2 + (2 zeta r)^2) + B, r = f / f0; C is how much of it began with a push, and
//! 0 for the wind; D how steeply the wind falls with frequency, 5/3 in turbulence, and 0 without. It is fitted to the
//! periodogram by Whittle's likelihood, whose errors are those of a spectrum that was drawn (Whittle, Ark. Mat. 2, 1953).

#[cfg(test)]
mod tests;

use realfft::RealFftPlanner;
use std::f64::consts::TAU;

/// The band that is fitted, in shares of the strongest frequency.
const BAND: [f64; 2] = [0.6, 1.5];
/// And so many frequencies to either side of the strongest, at least.
const BESIDE: usize = 3;
/// Damping to begin with.
const RATIO: f64 = 0.05;
/// Steps of the search.
const STEPS: usize = 800;
/// Numbers that are sought: logarithms of f0, zeta, B / A and C; and D.
const N: usize = 5;
/// Of fewer frequencies D would be a guess: it is 0.
const SLOPED: usize = 20;

/// How something swings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// Natural frequency, hertz.
    pub hz: f64,
    /// Damping, of critical.
    pub ratio: f64,
}

impl Swing {
    /// Logarithm of how much smaller each swing is than the one before, 2 pi zeta / sqrt(1 - zeta^2).
    #[must_use]
    pub fn log_decrement(&self) -> f64 {
        TAU * self.ratio / (1.0 - self.ratio.powi(2)).max(f64::MIN_POSITIVE).sqrt()
    }
}

/// The strongest swing of a series, evenly sampled at `fps`, between `lowest` and `highest` hertz; `None` where the
/// series is too short for a fit, does not move or is no number.
#[must_use]
pub fn swing(series: &[f64], fps: f64, [lowest, highest]: [f64; 2]) -> Option<Swing> {
    if series.len() < 4 || !series.iter().all(|v| v.is_finite()) {
        return None;
    }
    let power = periodogram(&straightened(series))?;
    let step = fps / series.len() as f64;
    let within = |from: f64, to: f64| {
        let first = (from / step).ceil().max(1.0) as usize;
        first..((to / step).floor() as usize + 1).min(power.len())
    };
    let peak = within(lowest, highest).max_by(|a, b| power[*a].total_cmp(&power[*b]))?;
    let hz = peak as f64 * step;
    let band = within(BAND[0] * hz, BAND[1] * hz);
    let (first, end) = (band.start.min(peak.checked_sub(BESIDE)?), band.end.max(peak + BESIDE + 1));
    // A series that stands still is straight but for rounding.
    let size = series.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let rounding = (f64::EPSILON * size * series.len() as f64).powi(2);
    if first < 1 || end > power.len() || power[peak] <= rounding {
        return None;
    }
    let rows: Vec<(f64, f64)> = (first..end).map(|k| (k as f64 * step, power[k])).collect();
    let start = [hz.ln(), RATIO.ln(), (1e-3 / (4.0 * RATIO.powi(2))).ln(), 0.0, 0.0];
    let [found, ratio, ..] = smallest(start, |at| misfit(&rows, at)).map(f64::exp);
    let is_there = (rows[0].0..=rows[rows.len() - 1].0).contains(&found) && (1e-5..1.0).contains(&ratio);
    is_there.then_some(Swing { hz: found, ratio })
}

/// Less its mean and its straight line.
fn straightened(series: &[f64]) -> Vec<f64> {
    let n = series.len() as f64;
    let (mean, middle) = (series.iter().sum::<f64>() / n, (n - 1.0) / 2.0);
    let (mut product, mut square) = (0.0, 0.0);
    for (k, v) in series.iter().enumerate() {
        let t = k as f64 - middle;
        product += t * (v - mean);
        square += t * t;
    }
    let slope = product / square.max(f64::MIN_POSITIVE);
    series.iter().enumerate().map(|(k, v)| v - mean - slope * (k as f64 - middle)).collect()
}

fn periodogram(series: &[f64]) -> Option<Vec<f64>> {
    let forward = RealFftPlanner::<f64>::new().plan_fft_forward(series.len());
    let (mut input, mut output) = (series.to_vec(), forward.make_output_vec());
    forward.process(&mut input, &mut output).ok()?;
    Some(output.iter().map(|v| v.norm_sqr()).collect())
}

/// Minus the logarithm of the likelihood, with the best A.
fn misfit(rows: &[(f64, f64)], at: [f64; N]) -> f64 {
    let [.., slope] = at;
    let [hz, ratio, floor, push, _] = at.map(f64::exp);
    let slope = if rows.len() < SLOPED { 0.0 } else { slope };
    let (mut scale, mut sum) = (0.0, 0.0);
    for (f, power) in rows {
        let r = f / hz;
        let resonance = ((1.0 - r * r).powi(2) + (2.0 * ratio * r).powi(2)).recip();
        let shape = (1.0 + push * r * r) * r.powf(-slope) * resonance + floor;
        scale += power / shape;
        sum += shape.ln();
    }
    let n = rows.len() as f64;
    let cost = n * (scale / n).max(f64::MIN_POSITIVE).ln() + sum;
    if cost.is_finite() { cost } else { f64::MAX }
}

/// Where a function of some numbers is smallest (Nelder and Mead, Comput. J. 7, 1965).
fn smallest(start: [f64; N], of: impl Fn([f64; N]) -> f64) -> [f64; N] {
    let valued = |at: [f64; N]| (of(at), at);
    let mut corners: Vec<(f64, [f64; N])> = vec![valued(start)];
    for (axis, away) in [0.02, 0.5, 1.0, 1.0, 1.0].into_iter().enumerate() {
        let mut at = start;
        at[axis] += away;
        corners.push(valued(at));
    }
    for _ in 0..STEPS {
        corners.sort_by(|a, b| a.0.total_cmp(&b.0));
        let centre: [f64; N] =
            std::array::from_fn(|k| corners[..N].iter().map(|corner| corner.1[k]).sum::<f64>() / N as f64);
        let worst = corners[N];
        let towards =
            |share: f64| valued(std::array::from_fn(|k| centre[k] + share * (worst.1[k] - centre[k])));
        let mirrored = towards(-1.0);
        let next = if mirrored.0 < corners[0].0 {
            let farther = towards(-2.0);
            if farther.0 < mirrored.0 { farther } else { mirrored }
        } else if mirrored.0 < corners[N - 1].0 {
            mirrored
        } else {
            towards(if mirrored.0 < worst.0 { -0.5 } else { 0.5 })
        };
        if next.0 < worst.0 {
            corners[N] = next;
        } else {
            let best = corners[0].1;
            for corner in &mut corners[1..] {
                *corner = valued(std::array::from_fn(|k| f64::midpoint(best[k], corner.1[k])));
            }
        }
    }
    corners.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map_or(start, |corner| corner.1)
}
