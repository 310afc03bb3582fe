//! Bars, one line a tracker: how near it is to the truth, or what is known without one.

use honami_workbench::compare::Row;

use super::{MARGIN, ROW, WIDTH, pen};
use crate::cli::canvas::{Anchor, Canvas, INK, Pen, QUIET};

/// Sizes in pixels.
const LABELS: f64 = 180.0;
const VALUE: f64 = 66.0;
const BAR: f64 = 15.0;
const HALF_BAR: f64 = 8.0;

/// Shades from the widest share to the narrowest.
const SHADES: [&str; 5] = ["#dfe9f2", "#bfd3e6", "#8cb4d6", "#4f8dbf", "#1d5f99"];

/// Bars from 0 to 1 between names and values.
struct Chart {
    top: f64,
    left: f64,
    right: f64,
}

impl Chart {
    /// With a head, the names of its shades, and so many values behind each bar.
    fn new(canvas: &mut Canvas, top: f64, head: &str, shades: &[(&str, &str)], values: &[&str]) -> Self {
        let chart = Self { top, left: MARGIN + LABELS, right: WIDTH - MARGIN - VALUE * values.len() as f64 };
        canvas.text([MARGIN, 72.0], Anchor::Start, &Pen::bold(INK, 13.0), head);
        let mut x = chart.left;
        for (name, shade) in shades {
            canvas.rect([x, 62.0], [12.0, 12.0], shade);
            canvas.text([x + 17.0, 72.0], Anchor::Start, &Pen::text(QUIET, 12.0), name);
            x += 36.0 + 7.0 * name.chars().count() as f64;
        }
        chart.values(canvas, 72.0, &Pen::bold(INK, 13.0), values.iter().copied());
        chart
    }

    fn x(&self, share: f64) -> f64 {
        self.left + share * (self.right - self.left)
    }

    /// What is written behind a bar; empty places stay so.
    fn values<'a>(
        &self,
        canvas: &mut Canvas,
        y: f64,
        pen: &Pen,
        values: impl ExactSizeIterator<Item = &'a str>,
    ) {
        let n = values.len();
        for (k, value) in values.enumerate() {
            let x = WIDTH - MARGIN - VALUE * (n - 1 - k) as f64;
            canvas.text([x, y], Anchor::End, pen, value);
        }
    }

    /// Lines at quarters, over so many bars, and what they are shares of.
    fn axis(&self, canvas: &mut Canvas, n_bars: usize, what: &str) {
        let bottom = self.top + ROW * n_bars as f64;
        for tick in [0.0, 0.25, 0.5, 0.75, 1.0] {
            canvas.line([self.x(tick), self.top - 8.0], [self.x(tick), bottom], &Pen::grid());
            let quiet = Pen::text(QUIET, 11.0);
            canvas.text([self.x(tick), bottom + 16.0], Anchor::Middle, &quiet, &tick.to_string());
        }
        canvas.text([self.x(0.5), bottom + 36.0], Anchor::Middle, &Pen::text(QUIET, 12.0), what);
    }

    fn bar(&self, canvas: &mut Canvas, y: f64, height: f64, share: f64, shade: &str) {
        canvas.rect([self.left, y], [self.x(share) - self.left, height], shade);
    }
}

/// How many samples are how near, one share over the other, and their mean.
pub(super) fn near_truth(canvas: &mut Canvas, rows: &[Row], top: f64) {
    let names = ["16 px", "8 px", "4 px", "2 px", "1 px"];
    let shades: Vec<(&str, &str)> = names.into_iter().zip(SHADES).collect();
    let chart = Chart::new(canvas, top, "Visible samples within", &shades, &["δavg"]);
    chart.axis(canvas, rows.len(), "share of the truly visible samples; the mark: their mean, δavg");
    for (number, row) in rows.iter().enumerate() {
        let y = top + ROW * number as f64;
        let middle = y + BAR / 2.0;
        canvas.line([MARGIN, middle], [MARGIN + 26.0, middle], &pen(rows, number));
        canvas.text([MARGIN + 34.0, middle + 4.0], Anchor::Start, &Pen::text(INK, 12.0), &row.tracker);
        let Some(accuracy) = &row.accuracy else { continue };
        for (share, shade) in accuracy.within.iter().rev().zip(SHADES) {
            chart.bar(canvas, y, BAR, *share, shade);
        }
        let mean = chart.x(accuracy.delta_avg);
        canvas.line([mean, y - 2.0], [mean, y + BAR + 2.0], &Pen::line(INK, 1.5, ""));
        let text = format!("{:.3}", accuracy.delta_avg);
        chart.values(canvas, middle + 4.0, &Pen::text(INK, 12.0), [text.as_str()].into_iter());
    }
}

/// How many points come home, and how many are seen all the time: none of it says how far off they are.
pub(super) fn without_truth(canvas: &mut Canvas, rows: &[Row], top: f64) {
    let with_back = rows.iter().any(|row| row.back.is_some());
    let with_keys = rows.iter().any(|row| row.left_out.is_some());
    let mut shades = vec![("kept: seen in every frame", SHADES[2])];
    let mut heads = vec!["kept"];
    if with_back {
        shades.insert(0, ("home: there and back to within 1 px", SHADES[4]));
        heads.splice(0..0, ["home", "back px"]);
    }
    if with_keys {
        heads.push("keys px");
    }
    let chart = Chart::new(canvas, top, "Without a truth", &shades, &heads);
    chart.axis(canvas, rows.len(), "share of the points");
    for (number, row) in rows.iter().enumerate() {
        let y = top + ROW * number as f64;
        let base = y + HALF_BAR + 4.0;
        canvas.text([MARGIN, base], Anchor::Start, &Pen::text(INK, 12.0), &row.tracker);
        let px = |px: Option<f64>| px.map_or_else(|| "lost".to_owned(), |px| format!("{px:.2}"));
        let none = || "–".to_owned();
        let mut values = vec![format!("{:.3}", row.kept)];
        if with_back {
            let home = row.back.map(|back| back.within_1px);
            home.into_iter().for_each(|home| chart.bar(canvas, y, HALF_BAR, home, SHADES[4]));
            let back = row.back.map_or_else(none, |back| px(back.median_px));
            values.splice(0..0, [home.map_or_else(none, |home| format!("{home:.3}")), back]);
        }
        chart.bar(canvas, y + HALF_BAR, HALF_BAR, row.kept, SHADES[2]);
        if with_keys {
            values.push(row.left_out.map_or_else(none, |out| px(out.median_px)));
        }
        chart.values(canvas, base, &Pen::text(INK, 12.0), values.iter().map(String::as_str));
    }
}
