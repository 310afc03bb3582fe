//! Accuracy against hand-counted tables.

use honami_model::track::{Quality, Sample, Source, Span, Status};

use super::{TruePath, accuracy};

/// A track that stands at the origin; an offset of `None` is a lost sample.
fn track(offsets: &[Option<f32>]) -> Span {
    let sample = |offset: &Option<f32>| Sample {
        x: offset.unwrap_or(0.0),
        y: 0.0,
        status: if offset.is_some() { Status::Tracked } else { Status::Lost },
        source: Source::Tracked,
        quality: Quality::default(),
    };
    Span { first_frame: 10, samples: offsets.iter().map(sample).collect() }
}

fn truth(visible: &[bool]) -> TruePath {
    TruePath { first_frame: 10, positions: visible.iter().map(|&v| (0.0, 0.0, v)).collect() }
}

/// Visibility, offsets, and what they give: delta_avg, survival, ok.
type Case<'a> = (&'a [bool], &'a [Option<f32>], f64, f64, f64);

#[test]
fn counts_misses_by_hand() {
    // The first frame is the query and never counts.
    let cases: [Case<'_>; 5] = [
        (&[true, true], &[Some(9.0), Some(0.5)], 1.0, 1.0, 1.0),
        (&[true, true], &[Some(0.0), Some(3.0)], 0.6, 1.0, 1.0),
        (&[true, true, true], &[Some(0.0), Some(0.0), None], 0.5, 0.5, 0.0),
        (&[true, true, true], &[Some(0.0), Some(20.0), Some(0.0)], 0.5, 0.0, 0.0),
        (&[true, true, false], &[Some(0.0), Some(0.0), None], 1.0, 1.0, 1.0),
    ];
    for (visible, offsets, delta_avg, survival, ok) in cases {
        let got = accuracy([(&truth(visible), 10, &track(offsets))]).unwrap();
        assert!((got.delta_avg - delta_avg).abs() < 1e-12, "{offsets:?}: {got:?}");
        assert!((got.survival - survival).abs() < 1e-12, "{offsets:?}: {got:?}");
        assert!((got.ok_tracks - ok).abs() < 1e-12, "{offsets:?}: {got:?}");
    }
}

#[test]
fn nothing_visible_is_no_number() {
    assert_eq!(accuracy([(&truth(&[true, false]), 10, &track(&[Some(0.0), None]))]), None);
    assert_eq!(accuracy([]), None);
}

#[test]
fn a_track_that_ends_early_is_lost_after_its_end() {
    let got = accuracy([(&truth(&[true, true, true]), 10, &track(&[Some(0.0), Some(0.0)]))]).unwrap();
    assert_eq!((got.n_samples, got.n_lost), (2, 1));
}
