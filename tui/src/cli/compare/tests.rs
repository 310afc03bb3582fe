//! Comparisons as people read them, against files of what is expected; `REGENERATE=1` accepts what is drawn.

use std::path::PathBuf;

use honami_workbench::compare::{
    Accuracy, Back, Comparison, Drift, FieldError, Histogram, LeftOut, Row, STATIC, Time,
};

use super::{entry, svg, tables};

/// A tracker that is as good as `skill` says, from 0 to 1, measured on as many stretches of time.
fn row(tracker: &str, skill: f64, n_drift: u32) -> Row {
    let within = [0.5, 0.6, 0.75, 0.9, 1.0].map(|share: f64| share * skill);
    let accuracy = Accuracy {
        delta_avg: within.iter().sum::<f64>() / 5.0,
        within,
        survival: skill,
        ok_tracks: skill / 2.0,
        median_px: Some(1.0 / skill),
        trajectory_px: Some(1.5 / skill),
        mean_px: Some(2.0 / skill),
        rms_px: Some(3.0 / skill),
        axis_rms_px: Some([1.5 / skill, 2.5 / skill]),
        bias_px: Some([0.1, -0.2]),
        visibility: 0.75,
        precision: Some(1.0),
        recall: 0.6 * skill,
        n_samples: 1000,
        n_lost: 100,
    };
    let drift = (0..n_drift).map(|k| Drift {
        first: 12 * k + 1,
        last: 12 * k + 12,
        median_px: (f64::from(k) < 14.0 * skill).then_some(0.2 * f64::from(k + 1) / skill.powi(2)),
        lost: 0.05 * f64::from(k),
        n_samples: 80,
    });
    let mut errors = Histogram::default();
    for (bin, share) in errors.shares.iter_mut().enumerate() {
        *share = 0.9 * (-0.5 * ((bin as f64 - 16.0 + 8.0 * skill) / 3.0).powi(2)).exp() / 7.52;
    }
    Row {
        tracker: tracker.to_owned(),
        accuracy: Some(accuracy),
        drift: drift.collect(),
        errors: Some(errors),
        field: None,
        kept: skill,
        back: Some(Back { median_px: Some(0.3 / skill), within_1px: skill }),
        left_out: None,
        time: Some(Time { mean_ms: 3.25, median_ms: 3.0, p95_ms: 12.5 }),
        peak_bytes: Some(7_654_321),
        n_deaths: 0,
    }
}

fn still(n_drift: u32) -> Row {
    Row { back: None, time: None, peak_bytes: None, ..row(STATIC, 0.3, n_drift) }
}

fn truth() -> Vec<Row> {
    vec![row("anchored", 0.95, 12), row("klt", 0.7, 12), row("a<b&c", 0.5, 12), still(12)]
}

/// Without a truth, with key-frames.
fn clip() -> Vec<Row> {
    let lost = Some(Back { median_px: None, within_1px: 0.25 });
    let rows = [row("anchored", 0.9, 0), Row { back: lost, ..row("klt", 0.5, 0) }, still(0)];
    let out = |median_px| Some(LeftOut { n: 14, n_found: 9, median_px });
    let bare = |row: Row| Row { accuracy: None, errors: None, left_out: out(Some(2.25)), ..row };
    let mut rows: Vec<Row> = rows.into_iter().map(bare).collect();
    rows[0].n_deaths = 2;
    rows[1].left_out = out(None);
    rows
}

/// Two pictures and a flow.
fn pair() -> Vec<Row> {
    let field = FieldError { mean_px: 0.312, median_px: 0.08, rms_px: 0.9, over_1px: 0.05, reached: 0.998 };
    vec![Row { field: Some(field), ..row("lk", 0.9, 1) }, row("klt", 0.8, 1), still(1)]
}

#[track_caller]
fn check(name: &str, seen: &str) {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("src/cli/compare/expected").join(name);
    if std::env::var_os("REGENERATE").is_some() {
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(&file, seen).unwrap();
    }
    let wanted = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(seen == wanted, "{} differs (REGENERATE=1 accepts it):\n{seen}", file.display());
}

#[test]
fn tables_fit_into_80_columns() {
    for (name, rows) in [("truth.txt", truth()), ("clip.txt", clip()), ("pair.txt", pair())] {
        let text = tables::all(&rows);
        for line in text.lines() {
            assert!(line.chars().count() <= 80, "{name}: {line}");
        }
        check(name, &text);
    }
}

#[test]
fn drawings() {
    for (name, rows) in [("truth.svg", truth()), ("clip.svg", clip()), ("pair.svg", pair())] {
        let drawn = svg::draw("plant <1>.mp4: 400 points, 150 frames", &rows);
        assert!(!drawn.contains("NaN") && !drawn.contains("inf"), "{name}");
        assert!(drawn.contains("plant &lt;1&gt;.mp4"), "{name}: names are escaped");
        check(name, &drawn);
    }
}

#[test]
fn machines_are_told_everything() {
    let found = |rows| Comparison { rows, n_points: 400, ..Comparison::default() };
    let told = entry::answer(&found(truth()), 0, &(10..160));
    assert_eq!((&told["points"], &told["frames"]), (&400.into(), &serde_json::json!([10, 160])));
    let first = &told["trackers"][0];
    assert_eq!(first["within"].as_array().unwrap().len(), 5);
    assert_eq!(first["within"][0], first["within_1px"]);
    assert_eq!(first["drift"].as_array().unwrap().len(), 12);
    assert_eq!(first["histogram"]["bins"].as_array().unwrap().len(), 24);
    assert_eq!(told["trackers"][3]["ms_per_frame"], serde_json::Value::Null);
    // Without a truth there are no such members, as before.
    assert_eq!(entry::answer(&found(clip()), 0, &(0..2))["trackers"][0].get("delta_avg"), None);
}
