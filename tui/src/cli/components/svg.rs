//! Components as a drawing: beside each map of where tracks go, how it goes in time and its spectrum. Pure, from numbers to text.

use honami_model::brief::counted;
use honami_workbench::components::{Component, Components};

use super::{band, degrees};
use crate::cli::canvas::{Anchor, Canvas, Field, INK, Pen, QUIET};

/// Sizes in pixels.
const WIDTH: f64 = 960.0;
const MARGIN: f64 = 28.0;
const TOP: f64 = 64.0;
const MAP: f64 = 420.0;
const ROW: f64 = 400.0;
const PLOT_LEFT: f64 = 490.0;
const PLOT_HEIGHT: f64 = 110.0;
/// Side of the dot where a track is.
const DOT: f64 = 1.6;
/// How long all but the longest strokes of a map are at most.
const STROKE: f64 = 30.0;

/// The two ways along the line of a component (Okabe and Ito 2008).
const ONE_WAY: &str = "#0072b2";
const OTHER_WAY: &str = "#d55e00";

/// Draws the components, one below the other, under a title.
pub(super) fn draw(title: &str, found: &Components) -> String {
    let mut canvas = Canvas::new(WIDTH, TOP + ROW * found.list.len() as f64 + MARGIN);
    canvas.text([MARGIN, 36.0], Anchor::Start, &Pen::bold(INK, 16.0), title);
    for (k, component) in found.list.iter().enumerate() {
        let top = TOP + ROW * k as f64;
        let hz = component.peak.as_ref().map_or("no peak".to_owned(), |peak| format!("{:.3} Hz", peak.hz));
        let head = format!(
            "{}: {:.1} % of all motion, {hz}, along {:.0}°, half of it in {}",
            k + 1,
            100.0 * component.share,
            degrees(component),
            counted(component.n_half, "track")
        );
        canvas.text([MARGIN, top + 14.0], Anchor::Start, &Pen::bold(INK, 13.0), &head);
        map(&mut canvas, found, component, top + 28.0);
        curve(&mut canvas, found, component, top + 58.0);
        spectrum(&mut canvas, component, top + 58.0 + PLOT_HEIGHT + 86.0);
    }
    canvas.finish()
}

/// Dots where tracks are, and strokes from there to as far as they go with a component, coloured by which way along its line.
fn map(canvas: &mut Canvas, found: &Components, component: &Component, top: f64) {
    let edge = |axis: usize, pick: fn(f64, f64) -> f64, start| {
        found.places.iter().map(|(_, at)| at[axis]).fold(start, pick)
    };
    let low = [0, 1].map(|axis| edge(axis, f64::min, f64::INFINITY));
    let high = [0, 1].map(|axis| edge(axis, f64::max, f64::NEG_INFINITY));
    let (width, height) = (high[0] - low[0], high[1] - low[1]);
    // Room for strokes on all sides, and for the legend below.
    let [across, down] = [MAP - 2.0 * STROKE, ROW - 92.0 - 2.0 * STROKE];
    let scale = (across / width.max(1.0)).min(down / height.max(1.0));
    let left = MARGIN + STROKE + (across - scale * width) / 2.0;
    let upper = top + STROKE + (down - scale * height) / 2.0;
    let place = |at: [f64; 2]| [left + scale * (at[0] - low[0]), upper + scale * (at[1] - low[1])];
    canvas.rect([MARGIN, top], [MAP, down + 2.0 * STROKE], "#f7f7f7");
    let length = stretch(component);
    let (sin, cos) = component.axis.angle_rad.sin_cos();
    for ((_, at), [dx, dy]) in found.places.iter().zip(&component.topos_px) {
        let [x, y] = place(*at);
        canvas.rect([x - DOT / 2.0, y - DOT / 2.0], [DOT, DOT], QUIET);
        // y is down, the line's angle as seen.
        let colour = if dx * cos - dy * sin >= 0.0 { ONE_WAY } else { OTHER_WAY };
        canvas.line([x, y], [x + length * dx, y + length * dy], &Pen::line(colour, 1.2, ""));
    }
    let px = round_below(STROKE / length);
    let y = top + down + 2.0 * STROKE + 18.0;
    let end = MARGIN + length * px;
    canvas.line([MARGIN, y], [end, y], &Pen::line(ONE_WAY, 2.0, ""));
    let words = format!("{px} px, root mean square over frames; blue and orange go opposite ways");
    canvas.text([end + 8.0, y + 4.0], Anchor::Start, &Pen::text(QUIET, 11.0), &words);
}

/// Pixels of the drawing for a pixel of motion: 95 % of the strokes are no longer than they may be.
fn stretch(component: &Component) -> f64 {
    let mut lengths: Vec<f64> = component.topos_px.iter().map(|[dx, dy]| dx.hypot(*dy)).collect();
    lengths.sort_by(f64::total_cmp);
    let longest = lengths.last().copied().unwrap_or(0.0);
    let most = lengths.get(lengths.len() * 95 / 100).copied().unwrap_or(longest);
    // Where few tracks have all of it, these.
    STROKE / most.max(longest / 4.0).max(f64::MIN_POSITIVE)
}

/// The largest of 1, 2 and 5 times a power of ten that is no larger.
fn round_below(value: f64) -> f64 {
    let power = 10.0_f64.powf(value.log10().floor());
    let fits = |times: &f64| times * power <= value * (1.0 + 1e-9);
    [5.0, 2.0, 1.0].into_iter().find(fits).unwrap_or(1.0) * power
}

/// The chronos against time; where too few tracks are seen it is broken.
fn curve(canvas: &mut Canvas, found: &Components, component: &Component, top: f64) {
    let size = [WIDTH - MARGIN - PLOT_LEFT, PLOT_HEIGHT];
    let field = Field::new(canvas, "In time, of mean square 1", [PLOT_LEFT, top], size);
    let most = component.chronos.iter().flatten().fold(1.0_f64, |most, v| most.max(v.abs()));
    for level in [-1.0, 0.0, 1.0] {
        field.level(canvas, 0.5 + 0.5 * level / most, &format!("{level}"));
    }
    let (Some(&first), Some(&last)) = (found.times_s.first(), found.times_s.last()) else { return };
    for quarter in 0..=4 {
        let share = f64::from(quarter) / 4.0;
        field.tick(canvas, share, &format!("{:.1}", first + share * (last - first)));
    }
    field.caption(canvas, "s");
    let at = |frame: usize, value: f64| {
        field.at((found.times_s[frame] - first) / (last - first), 0.5 + 0.5 * value / most)
    };
    let mut run = Vec::new();
    for (frame, value) in component.chronos.iter().enumerate() {
        match value {
            Some(value) => run.push(at(frame, *value)),
            None => canvas.path(&std::mem::take(&mut run), &Pen::line(INK, 1.2, "")),
        }
    }
    canvas.path(&run, &Pen::line(INK, 1.2, ""));
}

/// Amplitude over frequency.
fn spectrum(canvas: &mut Canvas, component: &Component, top: f64) {
    let size = [WIDTH - MARGIN - PLOT_LEFT, PLOT_HEIGHT];
    let field = Field::new(canvas, "Amplitude of that by frequency", [PLOT_LEFT, top], size);
    let band = band(component);
    let most = band.iter().copied().fold(f64::MIN_POSITIVE, f64::max).sqrt();
    for share in [0.0, 0.5, 1.0] {
        field.level(canvas, share, &format!("{:.2}", share * most));
    }
    let nyquist = component.spectrum.nyquist_hz;
    for quarter in 0..=4 {
        let share = f64::from(quarter) / 4.0;
        field.tick(canvas, share, &format!("{:.2}", share * nyquist));
    }
    field.caption(canvas, "Hz");
    let point = |(k, power): (usize, &f64)| {
        field.at((k as f64 * component.spectrum.step_hz / nyquist).min(1.0), power.sqrt() / most)
    };
    let points: Vec<[f64; 2]> = band.iter().enumerate().map(point).collect();
    canvas.path(&points, &Pen::line(INK, 1.2, ""));
    if let Some(peak) = &component.peak {
        canvas.dot(field.at(peak.hz / nyquist, peak.amplitude_px / most), &Pen::line(OTHER_WAY, 1.0, ""));
    }
}
