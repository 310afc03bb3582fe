//! The generalised Lomb-Scargle periodogram (Zechmeister and Kürster 2009): sines fitted to uneven samples.

use std::f64::consts::TAU;

/// Weighted sums over the samples at one frequency; c and s are cosine and sine.
#[derive(Clone, Copy, Default)]
struct Sums {
    c: f64,
    s: f64,
    cc: f64,
    cs: f64,
    yc: f64,
    ys: f64,
}

/// Twice the variance that a sine and a constant explain at k * step_hz, k = 0..n_bins: its squared amplitude.
///
/// `weights` need not add up to 1. O(samples x bins).
pub(super) fn power(
    times_s: &[f64],
    values: &[f64],
    weights: &[f64],
    step_hz: f64,
    n_bins: usize,
) -> Vec<f64> {
    let total: f64 = weights.iter().sum();
    let mean = values.iter().zip(weights).map(|(y, w)| y * w).sum::<f64>() / total;
    let mut bins = vec![Sums::default(); n_bins];
    for ((&t, &value), &weight) in times_s.iter().zip(values).zip(weights) {
        let (w, y) = (weight / total, value - mean);
        // The phase grows by the same angle from bin to bin: one rotation instead of a sine and a cosine.
        let (turn_s, turn_c) = (TAU * step_hz * (t - times_s[0])).sin_cos();
        let (mut c, mut s) = (1.0, 0.0);
        for bin in &mut bins {
            bin.c += w * c;
            bin.s += w * s;
            bin.cc += w * c * c;
            bin.cs += w * c * s;
            bin.yc += w * y * c;
            bin.ys += w * y * s;
            (c, s) = (c * turn_c - s * turn_s, s * turn_c + c * turn_s);
        }
    }
    let of_bin = |bin: &Sums| {
        let cc = bin.cc - bin.c * bin.c;
        let ss = (1.0 - bin.cc) - bin.s * bin.s;
        let cs = bin.cs - bin.c * bin.s;
        let d = cc * ss - cs * cs;
        let explained = (ss * bin.yc * bin.yc + cc * bin.ys * bin.ys - 2.0 * cs * bin.yc * bin.ys) / d;
        // d vanishes where sine or cosine is the constant itself: at 0 and, for even samples, at Nyquist.
        if d > 1e-4 { 2.0 * explained.max(0.0) } else { 0.0 }
    };
    bins.iter().map(of_bin).collect()
}
