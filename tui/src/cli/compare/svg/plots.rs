//! The two plots below the bars: errors against time, and how they are distributed.

use honami_workbench::compare::{Histogram, Row};

use super::pen;
use crate::cli::canvas::{Canvas, Field};

/// Errors on a logarithmic axis, pixels: what is smaller or larger lies on its ends.
const LOW_PX: f64 = 0.05;
const HIGH_PX: f64 = 200.0;

/// Median error against frames since the start; a curve ends with a dot where half of the samples are lost.
pub(super) fn drift(canvas: &mut Canvas, rows: &[Row], place: [f64; 2], size: [f64; 2]) {
    let field = Field::new(canvas, "Median error, px, by time", place, size);
    let up = |px: f64| (px.clamp(LOW_PX, HIGH_PX) / LOW_PX).ln() / (HIGH_PX / LOW_PX).ln();
    for px in [0.1, 1.0, 10.0, 100.0] {
        field.level(canvas, up(px), &px.to_string());
    }
    let last = rows.iter().flat_map(|row| &row.drift).map(|drift| drift.last).max().unwrap_or(1).max(1);
    for quarter in 0..=4 {
        field.tick(canvas, f64::from(quarter) / 4.0, &(last * quarter / 4).to_string());
    }
    field.caption(canvas, "frames since the start; a dot: from there half are lost");
    for (number, row) in rows.iter().enumerate().rev() {
        let known = row.drift.iter().map_while(|drift| Some((drift, drift.median_px?)));
        let point = |(drift, px): (&honami_workbench::compare::Drift, f64)| {
            let middle = f64::from(drift.first + drift.last) / 2.0;
            field.at(middle / f64::from(last), up(px))
        };
        let curve: Vec<[f64; 2]> = known.map(point).collect();
        let pen = pen(rows, number);
        canvas.path(&curve, &pen);
        if let Some(end) = curve.last().filter(|_| curve.len() < row.drift.len()) {
            canvas.dot(*end, &pen);
        }
    }
}

/// Shares of the visible samples by their error, two steps an octave; what was lost stands beside.
pub(super) fn histogram(canvas: &mut Canvas, rows: &[Row], place: [f64; 2], size: [f64; 2]) {
    let field = Field::new(canvas, "Visible samples by error", place, size);
    let shares = rows.iter().filter_map(|row| row.errors.as_ref());
    let highest = shares.flat_map(|e| e.shares.into_iter().chain([e.lost()])).fold(0.0, f64::max);
    // To the next tenth.
    let top = ((highest * 10.0).ceil() / 10.0).max(0.1);
    for quarter in 0..=4 {
        let share = top * f64::from(quarter) / 4.0;
        field.level(canvas, share / top, &format!("{:.0} %", share * 100.0));
    }
    let n_bins = Histogram::default().shares.len();
    // Behind the last bin a gap, and then the lost ones: each as wide as a bin.
    let n_columns = (n_bins + 3) as f64;
    for bin in (1..n_bins).filter(|bin| (bin - 1).is_multiple_of(4)) {
        let px = Histogram::edge_px(bin);
        let text = if px < 1.0 { format!("1/{}", 1.0 / px) } else { px.to_string() };
        field.tick(canvas, bin as f64 / n_columns, &text);
    }
    field.tick(canvas, (n_bins as f64 + 2.0) / n_columns, "lost");
    field.caption(canvas, "error, px");
    for (number, row) in rows.iter().enumerate().rev() {
        let Some(errors) = &row.errors else { continue };
        let steps = errors.shares.iter().enumerate().flat_map(|(bin, share)| {
            [bin, bin + 1].map(|edge| field.at(edge as f64 / n_columns, share / top))
        });
        let pen = pen(rows, number);
        canvas.path(&steps.collect::<Vec<_>>(), &pen);
        let lost = [1.2, 2.8].map(|x| field.at((n_bins as f64 + x) / n_columns, errors.lost() / top));
        canvas.line(lost[0], lost[1], &pen);
    }
}
