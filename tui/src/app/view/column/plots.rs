//! Curves over the clip, and how it sways: braille dots, with the numbers of the current frame.

use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::{Line, Span};

use honami_workbench::plots::{Series, Sway};

use super::style;
use crate::app::layout::{column_of, frame_at};
use crate::app::plotted::{Plotted, Subject};
use crate::app::state::State;
use crate::app::view::lines::wrapped;
use crate::app::view::put;
use crate::braille::{DOTS, braille};
use crate::term::encode::Frame;

/// Frequencies are shown up to this many times that of the peak, if that is less than all.
const BEYOND_PEAK: f64 = 5.0;

pub(super) fn draw(state: &State, area: Rect, frame: &mut Frame) {
    let what = match Plotted::subject(state) {
        None => "no track is selected".to_owned(),
        Some(Subject::Track(track)) => format!("track {track}    P G its group"),
        Some(Subject::Group(group)) => format!("group {}    P G the track", group + 1),
    };
    let Some(plots) = Plotted::shown(state) else {
        return put(frame, area, 0, &Line::styled(what, style::DIM));
    };
    let apart: Series = versus_px(state);
    let n_tracks = plots.n_tracks;
    let mean = if n_tracks > 1 { format!("  mean of {n_tracks} tracks") } else { String::new() };
    put(frame, area, 0, &Line::styled(format!("{what}{mean}"), style::DIM));
    let parts: Vec<(&str, &Series, &str, usize)> = [
        ("A–B", &apart, "px", 2),
        ("x", &plots.x_px, "px", 1),
        ("y", &plots.y_px, "px", 1),
        ("speed", &plots.speed_px_s, "px/s", 1),
        ("FB", &plots.fb_px, "px", 3),
        ("NCC", &plots.ncc, "", 3),
    ]
    .into_iter()
    .filter(|(_, series, ..)| series.iter().any(Option::is_some))
    .collect();
    // Of the rows that are left each curve takes alike, the spectrum twice as many; one more is its axis.
    let n = parts.len() as u16 + 2;
    let rows = (area.height.saturating_sub(2) / n).saturating_sub(1).clamp(1, 8);
    let mut y = 1;
    for (name, series, unit, digits) in parts {
        let part = Rect { y: area.y + y, height: (rows + 1).min(area.height.saturating_sub(y)), ..area };
        curve(state, part, (name, unit, digits), series, frame);
        y += rows + 1;
    }
    let rest = Rect { y: area.y + y.min(area.height), height: area.height.saturating_sub(y), ..area };
    match &plots.sway {
        Ok(sway) => spectrum(sway, rest, frame),
        Err(why) => {
            for (row, line) in (0..).zip(wrapped(&format!("no spectrum: {why}"), usize::from(area.width))) {
                put(frame, rest, row, &Line::styled(line, style::DIM));
            }
        }
    }
}

/// How far apart two runs beside each other are on the plotted track; nothing where none are, or of a group.
fn versus_px(state: &State) -> Series {
    let compared = state.versus.as_ref().and_then(|versus| versus.compared.as_ref());
    let track = match Plotted::subject(state) {
        Some(Subject::Track(track)) => compared.and_then(|compared| compared.track(track)),
        _ => None,
    };
    track.map(|paired| paired.distances_px(state.clip.n_frames())).unwrap_or_default()
}

/// A curve over the clip under a line with its value in the current frame and its range.
fn curve(
    state: &State,
    area: Rect,
    (name, unit, digits): (&str, &str, usize),
    series: &Series,
    frame: &mut Frame,
) {
    let (least, most) = range(series.iter().flatten().copied());
    let here = series.get(state.frame as usize).copied().flatten();
    let here = here.map_or_else(|| "—".to_owned(), |value| format!("{value:.digits$} {unit}"));
    let head = Line::from(vec![
        Span::styled(format!("{name:<6}"), style::DIM),
        Span::styled(format!("{here:<13}"), style::BOLD),
        Span::styled(format!("{least:.digits$} to {most:.digits$}"), style::DIM),
    ]);
    put(frame, area, 0, &head);
    let plot = Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area };
    let n = series.len();
    let columns = 2 * usize::from(plot.width);
    let values = (0..columns).map(|i| {
        let frames = i * n / columns..((i + 1) * n / columns).max(i * n / columns + 1);
        let seen: Vec<f64> = series.get(frames).unwrap_or_default().iter().flatten().copied().collect();
        (!seen.is_empty()).then(|| range(seen.into_iter()))
    });
    let n_frames = u32::try_from(n).unwrap_or(u32::MAX);
    let keys = state.selected_row().filter(|_| !state.plotted.of_group).map_or(&[][..], |row| &row.keys);
    let style_of = |x: u16| {
        let frames =
            frame_at(plot, n_frames, x)..frame_at(plot, n_frames, x + 1).max(frame_at(plot, n_frames, x) + 1);
        match () {
            () if x == column_of(plot, n_frames, state.frame) => (style::ACCENT, Some('│')),
            () if keys.iter().any(|key| frames.contains(key)) => (style::KEY, Some('◆')),
            () => (Style::new(), None),
        }
    };
    dots(plot, &values.collect::<Vec<_>>(), (least, most), style_of, frame);
}

/// Amplitude over frequency, its axis in Hz, and the strongest sway with its uncertainty.
fn spectrum(sway: &Sway, area: Rect, frame: &mut Frame) {
    let spectrum = &sway.spectrum;
    let top = sway
        .peak
        .as_ref()
        .map_or(spectrum.nyquist_hz, |peak| (BEYOND_PEAK * peak.hz).min(spectrum.nyquist_hz));
    let (unit, per_hz) = unit(top);
    let said = match &sway.peak {
        Some(peak) => {
            let [at, plus_minus] = [peak.hz, spectrum.resolution_hz / 2.0].map(|hz| hz * per_hz);
            format!("{at:.2} {unit} ± {plus_minus:.2}  {:.1} px", peak.amplitude_px)
        }
        None => "no sway stands out".to_owned(),
    };
    let head = Line::from(vec![Span::styled("sway  ", style::DIM), Span::styled(said, style::BOLD)]);
    put(frame, area, 0, &head);
    let plot = Rect { y: area.y + 1, height: area.height.saturating_sub(2), ..area };
    if plot.height == 0 || plot.width < 8 {
        return;
    }
    let columns = 2 * usize::from(plot.width);
    let hz_of = |i: usize| top * i as f64 / columns as f64;
    let amplitude = |i: usize| {
        let bin = |hz: f64| (hz / spectrum.step_hz).round() as usize;
        let bins = bin(hz_of(i))..bin(hz_of(i + 1)).max(bin(hz_of(i)) + 1);
        let power = spectrum.power_px2.get(bins)?.iter().copied().reduce(f64::max)?;
        Some((0.0, power.sqrt()))
    };
    let values: Vec<Option<(f64, f64)>> = (0..columns).map(amplitude).collect();
    let most = values.iter().flatten().map(|v| v.1).fold(f64::MIN_POSITIVE, f64::max);
    let column_of_hz = |hz: f64| plot.x + ((hz / top * f64::from(plot.width)) as u16).min(plot.width - 1);
    let peak = sway.peak.as_ref().map(|peak| column_of_hz(peak.hz));
    let style_of = |x: u16| (if peak == Some(x) { style::ACCENT } else { Style::new() }, None);
    dots(plot, &values, (0.0, most), style_of, frame);
    let axis = plot.bottom();
    let unit_at = plot.right() - unit.len() as u16;
    for (hz, label) in ticks(top, u32::from(plot.width / 7)) {
        let x = column_of_hz(hz);
        if x + label.len() as u16 + 1 > unit_at {
            break;
        }
        frame.cells.set_string(x, axis, label, style::DIM);
    }
    frame.cells.set_string(unit_at, axis, unit, style::DIM);
}

/// The unit of an axis up to so many hertz, and how many of it are one hertz: a clip with a picture a minute sways by
/// the hour.
pub(super) fn unit(top_hz: f64) -> (&'static str, f64) {
    match top_hz {
        hz if hz >= 0.1 => ("Hz", 1.0),
        hz if hz >= 1e-3 => ("mHz", 1e3),
        _ => ("/h", 3600.0),
    }
}

/// Round frequencies up to `top_hz`, about so many, Hz, each with its number in the unit of the axis.
fn ticks(top_hz: f64, n: u32) -> Vec<(f64, String)> {
    let (_, per_hz) = unit(top_hz);
    let top = top_hz * per_hz;
    let step = tick(top / f64::from(n.max(1)));
    let digits = (-step.log10().floor()).max(0.0) as usize;
    let values = (0_u32..).map(|k| f64::from(k) * step).take_while(|value| *value <= top).take(1000);
    values.map(|value| (value / per_hz, format!("{value:.digits$}"))).collect()
}

/// The smallest of 1, 2, 5 times a power of ten that is not below.
fn tick(least: f64) -> f64 {
    let decade = 10.0_f64.powf(least.max(f64::MIN_POSITIVE).log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|k| k * decade).into_iter().find(|step| *step >= least).unwrap_or(10.0 * decade)
}

/// Least and most, apart even where they are one.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), v| (least.min(v), most.max(v)))
}

/// Dots from the least to the most of each half column. What stands in columns without dots is said by `style_of`.
fn dots(
    area: Rect,
    values: &[Option<(f64, f64)>],
    (least, most): (f64, f64),
    style_of: impl Fn(u16) -> (Style, Option<char>),
    frame: &mut Frame,
) {
    if area.is_empty() {
        return;
    }
    let rows = 4 * usize::from(area.height);
    let row_of = |value: f64| {
        let part = if most > least { (value - least) / (most - least) } else { 0.5 };
        ((1.0 - part.clamp(0.0, 1.0)) * rows.saturating_sub(1) as f64).round() as usize
    };
    let mut bits = vec![0_u8; usize::from(area.width) * usize::from(area.height)];
    let mut before: Option<(usize, usize)> = None;
    for (i, value) in values.iter().enumerate() {
        let reach = value.map(|(low, high)| (row_of(high), row_of(low)));
        if let Some((mut top, mut bottom)) = reach {
            // Joined to its neighbour, so that a steep curve has no holes.
            if let Some((last_top, last_bottom)) = before {
                top = top.min(last_bottom.saturating_add(1));
                bottom = bottom.max(last_top.saturating_sub(1));
            }
            for row in top..=bottom.min(rows.saturating_sub(1)) {
                bits[row / 4 * usize::from(area.width) + i / 2] |= DOTS[row % 4][i % 2];
            }
        }
        before = reach;
    }
    for (i, bits) in bits.into_iter().enumerate() {
        let (x, y) =
            (area.x + (i % usize::from(area.width)) as u16, area.y + (i / usize::from(area.width)) as u16);
        let (style, alone) = style_of(x);
        let is_lowest = y + 1 == area.bottom();
        let alone = alone.filter(|mark| *mark == '│' || is_lowest);
        let glyph = match (bits, alone) {
            (0, Some(mark)) => mark,
            (0, None) => ' ',
            (bits, _) => braille(bits),
        };
        let at = frame.cells.index_of(x, y);
        frame.cells.content[at].set_char(glyph).set_style(style);
    }
}

#[cfg(test)]
mod tests;
