//! What a comparison tells people: tables of at most 80 columns.

use honami_workbench::compare::{Accuracy, Row};

use super::super::report;

mod legend;

/// Points of a drift curve in the table.
const N_DRIFT: usize = 6;

/// All that was measured.
pub(super) fn all(rows: &[Row]) -> String {
    let with_field = rows.iter().any(|row| row.field.is_some());
    let with_truth = rows.iter().any(|row| row.accuracy.is_some());
    let mut tables = Vec::new();
    if with_truth {
        tables.push(accuracy(rows));
    }
    tables.push(costs(rows, with_truth));
    // Of two frames there is no growth, but an end.
    if rows.iter().any(|row| row.drift.len() > 1) {
        tables.push(drift(rows));
    } else if with_truth {
        tables.push(end_points(rows, with_field));
    }
    tables.push(legend::of(rows));
    tables.join("\n\n")
}

/// A table whose first column is the tracker.
fn table(head: &[&str], rows: &[Row], cells: impl Fn(&Row) -> Vec<String>) -> String {
    let mut table = vec![std::iter::once("tracker").chain(head.iter().copied()).map(str::to_owned).collect()];
    table.extend(rows.iter().map(|row| std::iter::once(row.tracker.clone()).chain(cells(row)).collect()));
    report::table(&table)
}

fn accuracy(rows: &[Row]) -> String {
    let head = ["δavg", "<1 px", "<2", "<4", "<8", "<16", "median", "track", "surv", "ok"];
    table(&head, rows, |row| {
        let of = |part: fn(&Accuracy) -> f64| share(row.accuracy.as_ref().map(part));
        let px = |part: fn(&Accuracy) -> Option<f64>| px(row.accuracy.as_ref().and_then(part));
        let within = (0..5).map(|k| share(row.accuracy.map(|a| a.within[k])));
        let mut cells = vec![of(|a| a.delta_avg)];
        cells.extend(within);
        cells.extend([px(|a| a.median_px), px(|a| a.trajectory_px), of(|a| a.survival), of(|a| a.ok_tracks)]);
        cells
    })
}

fn costs(rows: &[Row], with_truth: bool) -> String {
    let of_truth: &[&str] = if with_truth { &["vis", "prec", "rec", "lost"] } else { &[] };
    let with_keys = rows.iter().any(|row| row.left_out.is_some());
    let keys: &[&str] = if with_keys { &["keys"] } else { &[] };
    let with_deaths = rows.iter().any(|row| row.n_deaths > 0);
    let deaths: &[&str] = if with_deaths { &["died"] } else { &[] };
    let head = [of_truth, &["kept", "back", "home"], keys, &["ms", "ms95", "MB"], deaths].concat();
    table(&head, rows, |row| {
        let mut cells = Vec::new();
        if with_truth {
            let of = |part: fn(&Accuracy) -> f64| share(row.accuracy.as_ref().map(part));
            let precision = share(row.accuracy.and_then(|a| a.precision));
            let lost = of(|a| a.n_lost as f64 / a.n_samples as f64);
            cells.extend([of(|a| a.visibility), precision, of(|a| a.recall), lost]);
        }
        cells.push(share(Some(row.kept)));
        cells.push(row.back.map_or_else(none, |back| px_or_lost(back.median_px)));
        cells.push(share(row.back.map(|back| back.within_1px)));
        if with_keys {
            cells.push(row.left_out.map_or_else(none, |out| px_or_lost(out.median_px)));
        }
        cells.push(ms(row.time.map(|time| time.mean_ms)));
        cells.push(ms(row.time.map(|time| time.p95_ms)));
        cells.push(row.peak_bytes.map_or_else(none, |bytes| format!("{:.0}", bytes as f64 / 1e6)));
        if with_deaths {
            cells.push(row.n_deaths.to_string());
        }
        cells
    })
}

/// Median error against frames since the query.
fn drift(rows: &[Row]) -> String {
    // All rows have the same stretches of time, for they have the same truth.
    let drift = rows.iter().map(|row| &row.drift).find(|drift| !drift.is_empty());
    let n = drift.map_or(0, Vec::len);
    let chosen: Vec<usize> = (1..=N_DRIFT.min(n)).map(|k| n * k / N_DRIFT.min(n) - 1).collect();
    let heads = chosen.iter().filter_map(|&k| drift?.get(k)).map(|d| match d.first == d.last {
        true => d.first.to_string(),
        false => format!("{}-{}", d.first, d.last),
    });
    let heads: Vec<String> = heads.collect();
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    let table = table(&heads, rows, |row| {
        chosen.iter().map(|&k| row.drift.get(k).map_or_else(none, |d| px_or_lost(d.median_px))).collect()
    });
    format!("median error, px, so many frames after the start:\n{table}")
}

/// Errors in the second of two pictures.
fn end_points(rows: &[Row], with_field: bool) -> String {
    let of_points = ["mean", "rms x", "rms y", "bias x", "bias y"];
    let of_field = ["dense", ">1 px", "known"];
    let head = if with_field { [&of_points[..], &of_field[..]].concat() } else { of_points.to_vec() };
    let table = table(&head, rows, |row| {
        let rms = |axis: usize| fine_px(row.accuracy.and_then(|a| Some(a.axis_rms_px?[axis])));
        let bias = |axis: usize| fine_px(row.accuracy.and_then(|a| Some(a.bias_px?[axis])));
        let mean = fine_px(row.accuracy.and_then(|a| a.mean_px));
        let mut cells = vec![mean, rms(0), rms(1), bias(0), bias(1)];
        if with_field {
            let field = row.field.as_ref();
            cells.push(px(field.map(|f| f.mean_px)));
            cells.extend([share(field.map(|f| f.over_1px)), share(field.map(|f| f.reached))]);
        }
        cells
    });
    let dense = if with_field { "; dense: mean over all pixels, and of these" } else { "" };
    format!("end-point error at the points, px{dense}:\n{table}")
}

fn none() -> String {
    "–".to_owned()
}

/// A share without the nought before the point.
fn share(value: Option<f64>) -> String {
    value.map_or_else(none, |v| match format!("{v:.3}") {
        text if text.starts_with("0.") => text[1..].to_owned(),
        _ => format!("{v:.2}"),
    })
}

fn px(value: Option<f64>) -> String {
    value.map_or_else(none, |v| if v < 9.995 { format!("{v:.2}") } else { format!("{v:.1}") })
}

fn px_or_lost(value: Option<f64>) -> String {
    value.map_or_else(|| "lost".to_owned(), |v| px(Some(v)))
}

fn fine_px(value: Option<f64>) -> String {
    value.map_or_else(none, |v| format!("{v:.4}"))
}

fn ms(value: Option<f64>) -> String {
    px(value)
}
