//! A comparison as a drawing: bars of the shares, how errors grow, how they are distributed. Pure, from rows to text.

use honami_workbench::compare::{Row, STATIC};

use crate::cli::canvas::{Anchor, Canvas, INK, Pen};

mod bars;
mod plots;

/// Sizes in pixels.
const WIDTH: f64 = 960.0;
const MARGIN: f64 = 28.0;
const ROW: f64 = 24.0;
const PLOT_HEIGHT: f64 = 300.0;
const GAP: f64 = 44.0;

/// Colours of trackers, told apart also by those who see red and green alike (Okabe and Ito 2008, without yellow).
const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#5b4a8a"];
/// When the colours are used up, dashes go on.
const DASHES: [&str; 3] = ["", "7 3", "2 3"];

/// Draws all that was measured, under a title.
pub(super) fn draw(title: &str, rows: &[Row]) -> String {
    let with_truth = rows.iter().any(|row| row.accuracy.is_some());
    let with_drift = rows.iter().any(|row| row.drift.len() > 1);
    let top = 104.0;
    // Without a truth nothing is known of the baseline.
    let n_bars = rows.iter().filter(|row| with_truth || row.tracker != STATIC).count();
    let bars_end = top + ROW * n_bars as f64;
    let height = if with_truth { bars_end + 104.0 + PLOT_HEIGHT + 56.0 } else { bars_end + 60.0 };
    let mut canvas = Canvas::new(WIDTH, height);
    canvas.text([MARGIN, 36.0], Anchor::Start, &Pen::bold(INK, 18.0), title);
    if !with_truth {
        bars::without_truth(&mut canvas, &rows[..n_bars], top);
        return canvas.finish();
    }
    bars::near_truth(&mut canvas, rows, top);
    let y = bars_end + 104.0;
    let half = (WIDTH - 2.0 * MARGIN - GAP) / 2.0;
    let (left, width) = if with_drift {
        plots::drift(&mut canvas, rows, [MARGIN, y], [half, PLOT_HEIGHT]);
        (MARGIN + half + GAP, half)
    } else {
        (MARGIN, WIDTH - 2.0 * MARGIN)
    };
    plots::histogram(&mut canvas, rows, [left, y], [width, PLOT_HEIGHT]);
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
