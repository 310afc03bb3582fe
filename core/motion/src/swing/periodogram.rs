//! Power over frequency of a series, without a window: what likelihoods are taken of.

use std::ops::Range;

use realfft::RealFftPlanner;

/// Power at each frequency from 0 to half the rate; of white noise its mean is the variance.
pub(super) struct Periodogram {
    pub(super) power: Vec<f64>,
    /// From one frequency to the next, hertz.
    pub(super) step_hz: f64,
}

impl Periodogram {
    pub(super) fn new(series: &[f64], fps: f64) -> Self {
        Self::padded(series, fps, 1)
    }

    /// On so many times as many frequencies.
    pub(super) fn padded(series: &[f64], fps: f64, times: usize) -> Self {
        let n = series.len() * times;
        let forward = RealFftPlanner::<f64>::new().plan_fft_forward(n);
        let (mut input, mut output) = (series.to_vec(), forward.make_output_vec());
        input.resize(n, 0.0);
        // Lengths are the plan's own; a failure would leave no power at all.
        let is_done = forward.process(&mut input, &mut output).is_ok();
        let scale = if is_done { 1.0 / series.len() as f64 } else { 0.0 };
        Self { power: output.iter().map(|v| v.norm_sqr() * scale).collect(), step_hz: fps / n as f64 }
    }

    /// The frequencies between two, hertz, without 0.
    pub(super) fn within(&self, [lowest, highest]: [f64; 2]) -> Range<usize> {
        let first = (lowest / self.step_hz).ceil().max(1.0) as usize;
        first..((highest / self.step_hz).floor() as usize + 1).min(self.power.len())
    }

    /// The strongest between two, hertz.
    pub(super) fn strongest(&self, hz: [f64; 2]) -> Option<usize> {
        self.within(hz).max_by(|a, b| self.power[*a].total_cmp(&self.power[*b]))
    }
}

/// Less its mean and its straight line.
pub(crate) fn straightened(series: &[f64]) -> Vec<f64> {
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
