//! How fast something swings and how soon it comes to rest, from a series of where it was.
//!
//! What was pulled and let go is a sum of damped sines on a straight line, and is fitted by least squares (`free`):
//! no method is more exact where noise is white, and it tells a steady sine and one that grows as what they are. Where
//! it was let go within the series is found (`release`). What the wind drives has no shape but that of its spectrum,
//! which is fitted by Whittle's likelihood (`driven`). Which of the two it is, or noise alone, is told by the Bayesian
//! information criterion (Schwarz, Ann. Stat. 6, 1978) of all three on the same frequencies.

mod driven;
mod free;
mod periodogram;
mod release;
#[cfg(test)]
mod tests;

use std::f64::consts::TAU;
use std::ops::Range;

use periodogram::Periodogram;
pub(crate) use periodogram::straightened;

/// Fewer samples than this are no swing.
pub const FEWEST: usize = 12;
/// The band that is fitted, in shares of the strongest frequency.
const BAND: [f64; 2] = [0.6, 1.5];
/// And so many frequencies to either side of the strongest, at least.
const BESIDE: usize = 3;
/// A damping or growth within so many standard errors of none is none.
const SURE: f64 = 3.0;
/// A free swing is told from a driven one by so much of the criterion: brief records of wind look like either.
const MARGIN: f64 = 6.0;
/// What is known no better than this, of damping and in shares of the frequency, is not known.
const VAGUE: f64 = 0.05;
/// Rounding, in shares of what moves: nothing is more exact.
const ROUNDING: f64 = 1e-6;

/// A number and its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told {
    /// The number.
    pub value: f64,
    /// Its standard error, 0 or more.
    pub error: f64,
}

/// What keeps it swinging.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Manner {
    /// Nothing: it was let go and comes to rest.
    LetGo,
    /// It goes on as it is: its damping is none within twice the standard error.
    Steady,
    /// It swings farther each time: its damping is negative.
    Growing,
    /// The wind, or something else that has all frequencies.
    Driven,
}

/// How something swings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// What keeps it swinging.
    pub manner: Manner,
    /// Natural frequency, hertz: that without damping.
    pub hz: Told,
    /// Damping, of critical; below 0 it grows.
    pub ratio: Told,
    /// Swings from the first sample that was used to where it is no larger than the noise, or to the last.
    pub n_cycles: f64,
    /// The first sample that was used.
    pub first: usize,
}

/// Why nothing swings.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoSwing {
    /// Too few samples.
    #[error("too short: {came} samples, wanted {FEWEST} or more")]
    Short {
        /// Samples there are.
        came: usize,
    },
    /// A sample is no number.
    #[error("sample {sample} is no number")]
    NoNumber {
        /// The first of them, from 0.
        sample: usize,
    },
    /// All samples are on a straight line.
    #[error("stands still")]
    Still,
    /// No frequency of the series is in the band.
    #[error("too short for the band: its frequencies are {step_hz:.3} Hz apart")]
    Band {
        /// From one to the next, hertz.
        step_hz: f64,
    },
    /// Nothing stands out.
    #[error("nothing stands out of the noise")]
    Noise,
    /// A fit tells next to nothing: too few swings, or too much noise.
    #[error("too vague: {hz:.3} Hz, and a damping off by {:.0} %", 100.0 * error)]
    Vague {
        /// Natural frequency, hertz.
        hz: f64,
        /// Standard error of the damping, of critical.
        error: f64,
    },
}

impl Swing {
    /// Frequency of the damped swing, hertz: what is counted in the series, f sqrt(1 - zeta^2).
    #[must_use]
    pub fn damped_hz(&self) -> f64 {
        self.hz.value * (1.0 - self.ratio.value.powi(2)).max(0.0).sqrt()
    }

    /// Logarithm of how much smaller each swing is than the one before, 2 pi zeta / sqrt(1 - zeta^2).
    #[must_use]
    pub fn log_decrement(&self) -> Told {
        let rest = (1.0 - self.ratio.value.powi(2)).max(f64::MIN_POSITIVE);
        Told { value: TAU * self.ratio.value / rest.sqrt(), error: TAU * self.ratio.error / rest.powf(1.5) }
    }
}

/// The strongest swing of a series, evenly sampled at `fps`, between `lowest` and `highest` hertz.
///
/// # Errors
/// [`NoSwing`].
pub fn swing(series: &[f64], fps: f64, [lowest, highest]: [f64; 2]) -> Result<Swing, NoSwing> {
    if let Some(sample) = series.iter().position(|v| !v.is_finite()) {
        return Err(NoSwing::NoNumber { sample });
    }
    if series.len() < FEWEST {
        return Err(NoSwing::Short { came: series.len() });
    }
    let seen = Seen::new(series, fps, [lowest, highest])?;
    let whole = free::Fit::new(&seen);
    let first = release::find(series, fps, &seen, &whole);
    if first > 0
        && let Ok(after) = Seen::new(&series[first..], fps, [lowest, highest])
        && let Ok(swing) = told(&after, &free::Fit::new(&after))
        && swing.manner != Manner::Driven
    {
        return Ok(Swing { first, ..swing });
    }
    told(&seen, &whole)
}

/// A series less its straight line, and the frequencies about its strongest.
struct Seen {
    /// Less its mean and its straight line.
    series: Vec<f64>,
    fps: f64,
    /// Where a swing is looked for, hertz.
    within_hz: [f64; 2],
    periodogram: Periodogram,
    /// The strongest frequency of the periodogram there.
    peak: usize,
    /// Frequencies of the periodogram that are fitted.
    band: Range<usize>,
    /// What is less than this, on average of its squares, is rounding.
    rounding: f64,
}

impl Seen {
    fn new(series: &[f64], fps: f64, within_hz: [f64; 2]) -> Result<Self, NoSwing> {
        if series.len() < FEWEST {
            return Err(NoSwing::Short { came: series.len() });
        }
        // A series that stands still is straight but for rounding.
        let size = series.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let series = straightened(series);
        let mean_square = series.iter().map(|v| v * v).sum::<f64>() / series.len() as f64;
        if mean_square <= (16.0 * f64::EPSILON * size).powi(2) {
            return Err(NoSwing::Still);
        }
        let periodogram = Periodogram::new(&series, fps);
        let step_hz = periodogram.step_hz;
        let peak = periodogram.strongest(within_hz).ok_or(NoSwing::Band { step_hz })?;
        let hz = peak as f64 * step_hz;
        let band = periodogram.within(BAND.map(|share| share * hz));
        let first = band.start.min(peak.saturating_sub(BESIDE)).max(1);
        let end = band.end.max(peak + BESIDE + 1).min(periodogram.power.len());
        let rounding = ROUNDING * ROUNDING * mean_square;
        Ok(Self { series, fps, within_hz, periodogram, peak, band: first..end, rounding })
    }

    /// The band's frequencies, hertz, and their power.
    fn rows(&self) -> Vec<(f64, f64)> {
        let step_hz = self.periodogram.step_hz;
        self.band.clone().map(|k| (k as f64 * step_hz, self.periodogram.power[k])).collect()
    }
}

/// The likeliest of a free swing, a driven one, and noise.
fn told(seen: &Seen, fit: &free::Fit) -> Result<Swing, NoSwing> {
    let rows = seen.rows();
    // Real and imaginary parts are what is seen; a frequency was chosen of all there are.
    let (a_number, a_peak) =
        ((2.0 * rows.len() as f64).ln(), 2.0 * (seen.periodogram.power.len() as f64).ln());
    let noise = 2.0 * driven::noise(&rows) + 2.0 * a_number;
    let by_wind = driven::Fit::new(&rows, seen.peak as f64 * seen.periodogram.step_hz);
    let of_wind = 2.0 * by_wind.misfit + 5.0 * a_number + a_peak;
    let of_free = 2.0 * fit.misfit(seen) + (1.0 + 4.0 * fit.n_within(seen) as f64) * a_number + a_peak;
    let n_cycles = |hz: f64| hz * seen.series.len() as f64 / seen.fps;
    let by_itself = fit.strongest(seen).filter(|_| of_free + MARGIN < of_wind.min(noise));
    let driven = || {
        let swing = by_wind.swing().filter(|_| of_wind < noise)?;
        Some(Swing { n_cycles: n_cycles(swing.damped_hz()), ..swing })
    };
    let swing = by_itself.or_else(driven).ok_or(NoSwing::Noise)?;
    let (hz, error) = (swing.hz.value, swing.ratio.error);
    if error < VAGUE && swing.hz.error < VAGUE * hz { Ok(swing) } else { Err(NoSwing::Vague { hz, error }) }
}
