//! What a comparison tells machines.

use std::ops::Range;

use honami_workbench::compare::{Accuracy, Comparison, Drift, Histogram, Row};
use serde_json::{Value, json};

pub(super) fn answer(found: &Comparison, n_unseen: usize, frames: &Range<u32>) -> Value {
    let missing = found.missing.iter();
    let missing = missing.map(|(name, error)| json!({ "tracker": name, "error": error.to_string() }));
    json!({
        "points": found.n_points,
        "points_never_visible": n_unseen,
        "points_in_other_frames": found.n_outside,
        "frames": [frames.start, frames.end],
        "trackers": found.rows.iter().map(entry).collect::<Vec<_>>(),
        "missing": missing.collect::<Vec<_>>(),
    })
}

fn entry(row: &Row) -> Value {
    let mut entry = json!({
        "tracker": row.tracker,
        "kept": row.kept,
        "ms_per_frame": row.time.map(|time| time.mean_ms),
        "ms_median": row.time.map(|time| time.median_ms),
        "ms_p95": row.time.map(|time| time.p95_ms),
        "peak_bytes": row.peak_bytes,
        "deaths": row.n_deaths,
        "back": row.back.map(|back| json!({
            "median_px": back.median_px,
            "within_1px": back.within_1px,
        })),
        "left_out": row.left_out.map(|out| json!({
            "key_frames": out.n,
            "found": out.n_found,
            "median_px": out.median_px,
        })),
        "field": row.field.map(|field| json!({
            "mean_px": field.mean_px,
            "median_px": field.median_px,
            "rms_px": field.rms_px,
            "over_1px": field.over_1px,
            "reached": field.reached,
        })),
    });
    if let (Some(accuracy), Some(errors), Value::Object(entry)) = (&row.accuracy, &row.errors, &mut entry) {
        entry.extend(against_truth(accuracy));
        entry.insert("drift".to_owned(), row.drift.iter().map(point).collect());
        entry.insert("histogram".to_owned(), histogram(errors));
    }
    entry
}

fn against_truth(accuracy: &Accuracy) -> serde_json::Map<String, Value> {
    let members = [
        ("delta_avg", json!(accuracy.delta_avg)),
        ("within", json!(accuracy.within)),
        ("within_1px", json!(accuracy.within[0])),
        ("median_px", json!(accuracy.median_px)),
        ("trajectory_px", json!(accuracy.trajectory_px)),
        ("mean_px", json!(accuracy.mean_px)),
        ("rms_px", json!(accuracy.rms_px)),
        ("axis_rms_px", json!(accuracy.axis_rms_px)),
        ("bias_px", json!(accuracy.bias_px)),
        ("survival", json!(accuracy.survival)),
        ("ok_tracks", json!(accuracy.ok_tracks)),
        ("visibility", json!(accuracy.visibility)),
        ("precision", json!(accuracy.precision)),
        ("recall", json!(accuracy.recall)),
        ("samples", json!(accuracy.n_samples)),
        ("lost", json!(accuracy.n_lost)),
    ];
    members.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

fn point(drift: &Drift) -> Value {
    json!({
        "first": drift.first,
        "last": drift.last,
        "median_px": drift.median_px,
        "lost": drift.lost,
        "samples": drift.n_samples,
    })
}

/// Each bin with its lower edge.
fn histogram(errors: &Histogram) -> Value {
    let bins = errors.shares.iter().enumerate();
    let bins: Vec<Value> =
        bins.map(|(bin, share)| json!({ "from_px": Histogram::edge_px(bin), "share": share })).collect();
    json!({ "bins": bins, "lost": errors.lost() })
}
