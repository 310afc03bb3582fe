//! Densities as a drawing: each on its axes with its band, decades upwards. Pure, from numbers to text.

use super::curves::{Curve, Curves, band};
use crate::cli::canvas::{Anchor, Canvas, Field, INK, Pen, QUIET};

/// Sizes in pixels.
const WIDTH: f64 = 960.0;
const MARGIN: f64 = 28.0;
const TOP: f64 = 92.0;
const HEIGHT: f64 = 190.0;
const ROW: f64 = 280.0;
/// What is fainter than so many decades below the strongest is not shown.
const DECADES: f64 = 6.0;
/// Frequencies are shown up to so many times that of the peak, if that is less than all.
const BEYOND_PEAK: f64 = 8.0;
/// About so many numbers are under an axis.
const TICKS: f64 = 8.0;

const LINE: &str = "#0072b2";
const BAND: &str = "#cfe3f1";
const MARK: &str = "#d55e00";

/// Draws the curves that are told, one below the other, under a title.
pub(super) fn draw(title: &str, curves: &Curves<'_>) -> String {
    let mut canvas = Canvas::new(WIDTH, TOP + ROW * curves.told.len().max(1) as f64);
    canvas.text([MARGIN, 36.0], Anchor::Start, &Pen::bold(INK, 16.0), title);
    for (k, curve) in curves.told.iter().enumerate() {
        plot(&mut canvas, curve, &curves.density_unit(), TOP + ROW * k as f64);
    }
    canvas.finish()
}

fn plot(canvas: &mut Canvas, curve: &Curve<'_>, unit: &str, top: f64) {
    let density = curve.density;
    let peak = curve.peak.map(|peak| {
        format!(
            ", {:.3} Hz, half-power width {:.3} Hz (the window {:.3} Hz)",
            peak.hz, peak.width_hz, peak.window_hz
        )
    });
    let title = format!("{}, {unit}{}", curve.name, peak.unwrap_or_default());
    let field = Field::new(canvas, &title, [MARGIN + 20.0, top], [WIDTH - 2.0 * MARGIN - 20.0, HEIGHT]);
    let nyquist = (density.per_hz.len() - 1) as f64 * density.step_hz;
    let top_hz = curve.peak.map_or(nyquist, |peak| (BEYOND_PEAK * peak.hz).min(nyquist));
    let shown = &density.per_hz[..=((top_hz / density.step_hz) as usize).min(density.per_hz.len() - 1)];
    let [low, high] = band(density);
    let most = high * shown.iter().copied().fold(0.0, f64::max);
    if most <= 0.0 {
        canvas.text(field.at(0.5, 0.5), Anchor::Middle, &Pen::text(QUIET, 12.0), "nothing moves");
        return;
    }
    let faint = low * shown[1..].iter().copied().filter(|v| *v > 0.0).fold(most, f64::min);
    let [least, most] = [faint.max(most / 10_f64.powf(DECADES)).log10().floor(), most.log10().ceil()];
    let up = |value: f64| ((value.max(f64::MIN_POSITIVE).log10() - least) / (most - least)).clamp(0.0, 1.0);
    for decade in least as i32..=most as i32 {
        field.level(canvas, (f64::from(decade) - least) / (most - least), &format!("1e{decade}"));
    }
    let at = |k: usize, value: f64| field.at((k as f64 * density.step_hz / top_hz).min(1.0), up(value));
    let ends = |times: f64| shown.iter().enumerate().map(move |(k, value)| at(k, times * value));
    canvas.area(&ends(low).chain(ends(high).rev()).collect::<Vec<_>>(), BAND);
    canvas.path(&ends(1.0).collect::<Vec<_>>(), &Pen::line(LINE, 1.6, ""));
    if let Some(peak) = curve.peak {
        let across = (peak.hz / top_hz).min(1.0);
        canvas.line(field.at(across, 0.0), field.at(across, 1.0), &Pen::line(MARK, 1.0, "4 3"));
    }
    let step = round_above(top_hz / TICKS);
    let digits = (-step.log10().floor()).max(0.0) as usize;
    for k in 0..=(top_hz / step) as u32 {
        let hz = f64::from(k) * step;
        field.tick(canvas, hz / top_hz, &format!("{hz:.digits$}"));
    }
    field.caption(canvas, "Hz; the band has the truth in 95 of 100 cases");
}

/// The smallest of 1, 2, 5 times a power of ten that is not below.
fn round_above(least: f64) -> f64 {
    let decade = 10_f64.powf(least.max(f64::MIN_POSITIVE).log10().floor());
    [1.0, 2.0, 5.0].map(|k| k * decade).into_iter().find(|step| *step >= least).unwrap_or(10.0 * decade)
}
