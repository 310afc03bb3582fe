//! Figure 2.11: where markers are over time, by cameras and by sensors, and their spectra; how coherent both are, and the wind.

use honami_workbench::sensors::{Axis, Compared, Marker, Wind};

use super::AXES;
use crate::cli::canvas::{Anchor, Canvas, Field, INK, Pen, QUIET};

/// Sizes in pixels.
const WIDTH: f64 = 1200.0;
const MARGIN: f64 = 28.0;
const TOP: f64 = 96.0;
const HEIGHT: f64 = 110.0;
const ROW: f64 = 186.0;
const LEFT: f64 = MARGIN + 24.0;
const TIME: f64 = 520.0;
const SPECTRUM: f64 = 280.0;
const GAP: f64 = 40.0;
/// What is fainter than so many decades below the strongest is not shown.
const DECADES: f64 = 6.0;
/// Frequencies are shown up to so many times the strongest.
const BEYOND_PEAK: f64 = 6.0;
/// No more points to a curve than the eye tells apart.
const POINTS: usize = 2000;

const TRACK: &str = "#0072b2";
const SENSOR: &str = "#d55e00";
const WIND: &str = "#009e73";

/// Draws three rows for each marker, and one for each column of the wind, under a title.
pub(super) fn draw(title: &str, found: &Compared, wind: &[Wind]) -> String {
    let n_rows = 3 * found.markers.len() + wind.len();
    let mut canvas = Canvas::new(WIDTH, TOP + ROW * n_rows as f64 + MARGIN);
    canvas.text([MARGIN, 34.0], Anchor::Start, &Pen::bold(INK, 16.0), title);
    canvas.text([MARGIN, 56.0], Anchor::Start, &Pen::text(TRACK, 12.0), "by cameras");
    canvas.text([MARGIN + 90.0, 56.0], Anchor::Start, &Pen::text(SENSOR, 12.0), "by the sensor");
    let times = || found.markers.iter().flat_map(|marker| marker.times_s.iter().copied());
    let span = [times().fold(f64::INFINITY, f64::min), times().fold(f64::NEG_INFINITY, f64::max)];
    let mut top = TOP;
    for marker in &found.markers {
        for axis in 0..3 {
            row(&mut canvas, marker, axis, span, top);
            top += ROW;
        }
    }
    for wind in wind {
        // By the tracks' clock, as all that is above.
        let values = wind.times_s.iter().map(|t| t - found.offset_s).zip(wind.values.iter().copied());
        let curve: Vec<(f64, f64)> = values.filter(|(t, _)| (span[0]..=span[1]).contains(t)).collect();
        over_time(&mut canvas, &wind.name, span, top, &[(WIND, &curve)]);
        top += ROW;
    }
    canvas.finish()
}

fn row(canvas: &mut Canvas, marker: &Marker, axis: usize, span: [f64; 2], top: f64) {
    let curve = |places: &[_]| -> Vec<(f64, f64)> { along(&marker.times_s, places, axis) };
    let (tracked, sensed) = (curve(&marker.tracked), curve(&marker.sensed));
    let cell = marker.deviations[axis];
    let title = format!(
        "{} {}, m: RMS {:.4} ({:.4} ± {:.4})",
        marker.name, AXES[axis], cell.rms, cell.mean, cell.std
    );
    over_time(canvas, &title, span, top, &[(SENSOR, &sensed), (TRACK, &tracked)]);
    if let Some(axes) = &marker.axes {
        spectra(canvas, &axes[axis], top);
        coherence(canvas, &axes[axis], top);
    }
}

fn along(times_s: &[f64], places: &[honami_workbench::sensors::Place], axis: usize) -> Vec<(f64, f64)> {
    times_s.iter().copied().zip(places.iter().map(|place| place[axis])).collect()
}

/// Curves over time on one scale.
fn over_time(
    canvas: &mut Canvas,
    title: &str,
    [from, to]: [f64; 2],
    top: f64,
    curves: &[(&'static str, &[(f64, f64)])],
) {
    let field = Field::new(canvas, title, [LEFT, top], [TIME, HEIGHT]);
    let values = || curves.iter().flat_map(|(_, curve)| curve.iter().map(|(_, value)| *value));
    let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    if !(least.is_finite() && to > from) {
        canvas.text(field.at(0.5, 0.5), Anchor::Middle, &Pen::text(QUIET, 12.0), "nothing at these times");
        return;
    }
    let room = (most - least).max(1e-9);
    for up in [0.0, 0.5, 1.0] {
        field.level(canvas, up, &format!("{:.3}", least + up * room));
    }
    for (colour, curve) in curves {
        let every = curve.len().div_ceil(POINTS).max(1);
        let at = |(t, value): &(f64, f64)| field.at((t - from) / (to - from), (value - least) / room);
        canvas.path(&curve.iter().step_by(every).map(at).collect::<Vec<_>>(), &Pen::line(colour, 1.2, ""));
    }
    for k in 0..=5 {
        let across = f64::from(k) / 5.0;
        field.tick(canvas, across, &format!("{:.1}", from + across * (to - from)));
    }
    field.caption(canvas, "s");
}

/// The frequency up to which an axis is drawn.
fn top_hz(axis: &Axis) -> f64 {
    let density = &axis.densities[1];
    let nyquist = (density.per_hz.len() - 1) as f64 * density.step_hz;
    axis.strongest.map_or(nyquist, |at| (BEYOND_PEAK * at.hz).min(nyquist))
}

fn ticks(canvas: &mut Canvas, field: &Field, top_hz: f64, caption: &str) {
    for k in 0..=4 {
        field.tick(canvas, f64::from(k) / 4.0, &format!("{:.2}", f64::from(k) / 4.0 * top_hz));
    }
    field.caption(canvas, caption);
}

fn spectra(canvas: &mut Canvas, axis: &Axis, top: f64) {
    let field = Field::new(canvas, "m²/Hz", [LEFT + TIME + GAP, top], [SPECTRUM, HEIGHT]);
    let top_hz = top_hz(axis);
    let shown = axis.densities.each_ref().map(|density| {
        &density.per_hz[..=((top_hz / density.step_hz) as usize).min(density.per_hz.len() - 1)]
    });
    let values = || shown.iter().flat_map(|values| values.iter().copied()).filter(|v| *v > 0.0);
    let most = values().fold(0.0, f64::max);
    if most > 0.0 {
        let most = most.log10().ceil();
        let least =
            values().fold(f64::INFINITY, f64::min).log10().floor().max(most - DECADES).min(most - 1.0);
        let up =
            |value: f64| ((value.max(f64::MIN_POSITIVE).log10() - least) / (most - least)).clamp(0.0, 1.0);
        for decade in (least as i32..=most as i32).step_by(2) {
            field.level(canvas, (f64::from(decade) - least) / (most - least), &format!("1e{decade}"));
        }
        for (k, colour) in [(1, SENSOR), (0, TRACK)] {
            let step_hz = axis.densities[k].step_hz;
            let at =
                |(bin, value): (usize, &f64)| field.at((bin as f64 * step_hz / top_hz).min(1.0), up(*value));
            canvas
                .path(&shown[k].iter().enumerate().map(at).collect::<Vec<_>>(), &Pen::line(colour, 1.2, ""));
        }
    }
    ticks(canvas, &field, top_hz, "Hz");
}

fn coherence(canvas: &mut Canvas, axis: &Axis, top: f64) {
    let Some(cross) = &axis.cross else { return };
    let title = axis.strongest.map_or_else(String::new, |at| {
        let [phase, error] = [at.phase_rad, at.phase_error_rad].map(f64::to_degrees);
        format!("coherence {:.3}, phase {phase:.1} ± {error:.1}°", at.coherence)
    });
    let left = LEFT + TIME + SPECTRUM + 2.0 * GAP;
    let field = Field::new(canvas, &title, [left, top], [WIDTH - MARGIN - left, HEIGHT]);
    for up in [0.0, 0.5, 1.0] {
        field.level(canvas, up, &format!("{up:.1}"));
    }
    let chance = cross.chance(0.95);
    canvas.line(field.at(0.0, chance), field.at(1.0, chance), &Pen::line(QUIET, 1.0, "4 3"));
    let top_hz = top_hz(axis);
    let shown = cross.coherence.iter().take((top_hz / cross.step_hz) as usize + 1).enumerate();
    let at = |(bin, value): (usize, &f64)| field.at((bin as f64 * cross.step_hz / top_hz).min(1.0), *value);
    canvas.path(&shown.map(at).collect::<Vec<_>>(), &Pen::line(INK, 1.2, ""));
    ticks(canvas, &field, top_hz, "Hz; below the dashes it may be chance");
}
