//! A comparison as a drawing: bars of the shares, how errors grow, how they are distributed. Pure, from rows to text.

use honami_workbench::compare::{Row, STATIC};

use canvas::{Anchor, Canvas, INK, Pen, QUIET};

mod canvas;
mod plots;

/// Sizes in pixels.
const WIDTH: f64 = 960.0;
const MARGIN: f64 = 28.0;
const LABELS: f64 = 150.0;
const VALUES: f64 = 56.0;
const ROW: f64 = 24.0;
const BAR: f64 = 15.0;
const PLOT_HEIGHT: f64 = 300.0;
const GAP: f64 = 44.0;

/// Colours of trackers, told apart also by those who see red and green alike (Okabe and Ito 2008, without yellow).
const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#5b4a8a"];
/// When the colours are used up, dashes go on.
const DASHES: [&str; 3] = ["", "7 3", "2 3"];
/// Shades from the widest share to the narrowest.
const SHADES: [&str; 5] = ["#dfe9f2", "#bfd3e6", "#8cb4d6", "#4f8dbf", "#1d5f99"];

/// Draws all that was measured, under a title.
pub(super) fn draw(title: &str, rows: &[Row]) -> String {
    let with_truth = rows.iter().any(|row| row.accuracy.is_some());
    let with_drift = rows.iter().any(|row| row.drift.len() > 1);
    let top = 104.0;
    let bars_end = top + ROW * rows.len() as f64;
    let height = if with_truth { bars_end + 84.0 + PLOT_HEIGHT + 56.0 } else { bars_end + 48.0 };
    let mut canvas = Canvas::new(WIDTH, height);
    canvas.text([MARGIN, 36.0], Anchor::Start, &Pen::bold(INK, 18.0), title);
    bars(&mut canvas, rows, top, with_truth);
    if with_truth {
        let y = bars_end + 84.0;
        let half = (WIDTH - 2.0 * MARGIN - GAP) / 2.0;
        let (left, width) = if with_drift {
            plots::drift(&mut canvas, rows, [MARGIN, y], [half, PLOT_HEIGHT]);
            (MARGIN + half + GAP, half)
        } else {
            (MARGIN, WIDTH - 2.0 * MARGIN)
        };
        plots::histogram(&mut canvas, rows, [left, y], [width, PLOT_HEIGHT]);
    }
    canvas.finish()
}

/// Each tracker's line: the colour and the dashes by which it is known.
fn pen(rows: &[Row], number: usize) -> Pen {
    if rows[number].tracker == STATIC {
        return Pen::line("#777777", 1.5, "3 3");
    }
    let turn = (number / COLOURS.len()).min(DASHES.len() - 1);
    Pen::line(COLOURS[number % COLOURS.len()], 2.0, DASHES[turn])
}

/// One line a tracker: who it is, its shares one over the other, and their mean.
fn bars(canvas: &mut Canvas, rows: &[Row], top: f64, with_truth: bool) {
    let (left, right) = (MARGIN + LABELS, WIDTH - MARGIN - VALUES);
    let scale = |share: f64| left + share * (right - left);
    let (head, names): (&str, &[&str]) = match with_truth {
        true => ("Share of visible samples within", &["16 px", "8 px", "4 px", "2 px", "1 px"]),
        false => ("Share of points", &["seen in every frame", "back within 1 px"]),
    };
    let shades = if with_truth { &SHADES[..] } else { &[SHADES[1], SHADES[4]] };
    canvas.text([MARGIN, 72.0], Anchor::Start, &Pen::bold(INK, 13.0), head);
    let mut x = left + if with_truth { 90.0 } else { 0.0 };
    for (name, shade) in names.iter().zip(shades) {
        canvas.rect([x, 62.0], [12.0, 12.0], shade);
        canvas.text([x + 17.0, 72.0], Anchor::Start, &Pen::text(QUIET, 12.0), name);
        x += 36.0 + 7.0 * name.chars().count() as f64;
    }
    let value = if with_truth { "δavg" } else { "kept" };
    canvas.text([WIDTH - MARGIN, 72.0], Anchor::End, &Pen::bold(INK, 13.0), value);
    let bottom = top + ROW * rows.len() as f64;
    for tick in [0.0, 0.25, 0.5, 0.75, 1.0] {
        canvas.line([scale(tick), top - 8.0], [scale(tick), bottom], &Pen::grid());
        canvas.text([scale(tick), bottom + 16.0], Anchor::Middle, &Pen::text(QUIET, 11.0), &tick.to_string());
    }
    for (number, row) in rows.iter().enumerate() {
        let y = top + ROW * number as f64;
        let middle = y + BAR / 2.0;
        canvas.line([MARGIN, middle], [MARGIN + 26.0, middle], &pen(rows, number));
        canvas.text([MARGIN + 34.0, middle + 4.0], Anchor::Start, &Pen::text(INK, 12.0), &row.tracker);
        let (shares, value) = match &row.accuracy {
            Some(accuracy) => (accuracy.within.into_iter().rev().collect(), accuracy.delta_avg),
            None => (vec![row.kept, row.back.map_or(0.0, |back| back.within_1px)], row.kept),
        };
        for (share, shade) in shares.iter().zip(shades) {
            canvas.rect([left, y], [scale(*share) - left, BAR], shade);
        }
        canvas.line([scale(value), y - 2.0], [scale(value), y + BAR + 2.0], &Pen::line(INK, 1.5, ""));
        let text = format!("{value:.3}");
        canvas.text([WIDTH - MARGIN, middle + 4.0], Anchor::End, &Pen::text(INK, 12.0), &text);
    }
}
