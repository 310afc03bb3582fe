//! Peaks of a spectrum: where, how strong, how far above the noise, and what they may be instead.

use super::Spectrum;

/// Below this many resolution cells a peak is what detrending left of the drift.
const LOWEST_CELLS: f64 = 1.5;
/// A Hann window's first side lobe is at 0.027 of the amplitude: what is weaker may be leakage.
const LEAKAGE: f64 = 0.03;
/// The noise floor is taken from this many resolution cells on both sides …
const FLOOR_CELLS: f64 = 12.0;
/// … less the main lobe.
const LOBE_CELLS: f64 = 2.0;
/// How many aliases are named.
const N_ALIASES: u32 = 3;
/// Above this share of the band a peak is likely to come from beyond it.
const TOP_OF_BAND: f64 = 0.8;

/// A sway that stands out of a spectrum.
#[derive(Clone, Debug, PartialEq)]
pub struct Peak {
    /// Frequency, interpolated between the grid points.
    pub hz: f64,
    /// Amplitude of the sway, pixels; over several tracks the root of their mean power.
    pub amplitude_px: f64,
    /// Power over that of the noise around it.
    pub over_floor: f64,
    /// True frequencies that would show up here as well, |k fps ± hz|, lowest first; empty where frames are
    /// unevenly timed, which gives aliases away.
    pub aliases_hz: Vec<f64>,
    /// Whether it lies in the top fifth of the band, where a sway beyond the band shows up first: the peak
    /// may well be an alias.
    pub near_nyquist: bool,
}

pub(super) fn find(spectrum: &Spectrum, n_max: usize, over_floor: f64) -> Vec<Peak> {
    let power = &spectrum.power_px2;
    let cell = (spectrum.resolution_hz / spectrum.step_hz).max(1.0);
    let lowest = (LOWEST_CELLS * cell).ceil() as usize;
    let is_local_maximum = |&k: &usize| {
        let around = k.saturating_sub(cell as usize)..(k + cell as usize + 1).min(power.len());
        power[k] > 0.0 && around.into_iter().all(|other| power[other] < power[k] || other == k)
    };
    let mut tops: Vec<usize> =
        (lowest.max(1)..power.len().saturating_sub(1)).filter(is_local_maximum).collect();
    tops.sort_by(|&a, &b| power[b].total_cmp(&power[a]).then(a.cmp(&b)));
    let weakest = tops.first().map_or(0.0, |&top| power[top] * LEAKAGE * LEAKAGE);
    tops.into_iter()
        .filter(|&top| power[top] > weakest)
        .map(|top| peak_at(spectrum, top, cell))
        .filter(|peak| peak.over_floor >= over_floor)
        .take(n_max)
        .collect()
}

pub(super) fn width_hz(spectrum: &Spectrum, peak: &Peak) -> f64 {
    let power = &spectrum.power_px2;
    let half = 0.5 * peak.amplitude_px.powi(2);
    let top = ((peak.hz / spectrum.step_hz).round() as usize).min(power.len() - 1);
    // Between the last above and the first below, on a straight line; at the end of the band, the end.
    let crossing = |inner: usize, outer: usize| {
        let share = (power[inner] - half) / (power[inner] - power[outer]);
        inner as f64 + share.clamp(0.0, 1.0) * (outer as f64 - inner as f64)
    };
    let below = (0..top).rev().find(|&k| power[k] < half).map_or(0.0, |k| crossing(k + 1, k));
    let end = (power.len() - 1) as f64;
    let above = (top + 1..power.len()).find(|&k| power[k] < half).map_or(end, |k| crossing(k - 1, k));
    (above - below) * spectrum.step_hz
}

fn peak_at(spectrum: &Spectrum, top: usize, cell: f64) -> Peak {
    let power = &spectrum.power_px2;
    // A Hann peak is nearly a parabola in log power.
    let [before, at, after] = [top - 1, top, top + 1].map(|k| power[k].max(f64::MIN_POSITIVE).ln());
    let bend = before - 2.0 * at + after;
    let shift = if bend < 0.0 { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) } else { 0.0 };
    let hz = (top as f64 + shift) * spectrum.step_hz;
    let log_power = at - 0.25 * (before - after) * shift;
    Peak {
        hz,
        amplitude_px: (0.5 * log_power).exp(),
        over_floor: log_power.exp() / floor(spectrum, top, cell),
        aliases_hz: spectrum.even_fps.map(|fps| aliases_hz(hz, fps)).unwrap_or_default(),
        near_nyquist: may_be_alias(hz, spectrum.nyquist_hz),
    }
}

/// Mean power of the noise around a bin, from the median, which peaks do not move.
///
/// Power of noise in x and y of n tracks has a gamma distribution of shape 2n, whose median is its mean times
/// 1 - 1/(6n), nearly.
fn floor(spectrum: &Spectrum, top: usize, cell: f64) -> f64 {
    let power = &spectrum.power_px2;
    let (lobe, reach) = ((LOBE_CELLS * cell).ceil() as usize, (FLOOR_CELLS * cell).ceil() as usize);
    let below = top.saturating_sub(reach).max(1)..top.saturating_sub(lobe).max(1);
    let above = (top + lobe + 1).min(power.len())..(top + reach + 1).min(power.len());
    let mut around: Vec<f64> = below.chain(above).map(|k| power[k]).collect();
    around.sort_by(f64::total_cmp);
    let median = around.get(around.len() / 2).copied().unwrap_or(0.0);
    // Noise-free data has a floor of rounding.
    (median / (1.0 - 1.0 / (6.0 * spectrum.n_tracks as f64))).max(power[top] * 1e-12)
}

/// True frequencies that show up at `hz` as well where there are `fps` samples a second, |k fps ± hz|: the three lowest, hertz.
#[must_use]
pub fn aliases_hz(hz: f64, fps: f64) -> Vec<f64> {
    let folds = (1..=N_ALIASES).flat_map(|k| [f64::from(k) * fps - hz, f64::from(k) * fps + hz]);
    folds.take(N_ALIASES as usize).collect()
}

/// Whether a peak lies in the top fifth of the band, where what is faster than the band shows up first.
#[must_use]
pub fn may_be_alias(hz: f64, nyquist_hz: f64) -> bool {
    hz > TOP_OF_BAND * nyquist_hz
}
