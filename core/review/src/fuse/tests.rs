//! Paths through candidates that go wrong at known places.

use honami_model::track::{Quality, Source, Status};

use super::*;

/// A feature that stays at (10, 5), as a tracker follows it that is off by `off(frame)` to the right.
fn span(frames: Range<u32>, off: impl Fn(u32) -> f32) -> Span {
    let sample = |frame| Sample {
        x: 10.0 + off(frame),
        y: 5.0,
        status: Status::Tracked,
        source: Source::Tracked,
        quality: Quality { fb_px: Some(0.05), ncc: None },
    };
    Span { first_frame: frames.start, samples: frames.map(sample).collect() }
}

const KEYS: Ends = Ends { before: Some([10.0, 5.0]), after: Some([10.0, 5.0]) };

fn path(ends: &Ends, spans: &[Span]) -> Option<Vec<(usize, f32)>> {
    let picked = fuse(1..9, ends, &spans.iter().collect::<Vec<_>>())?;
    Some(picked.iter().map(|p| (p.candidate, p.sample.x)).collect())
}

#[test]
fn it_leaves_a_tracker_before_it_drifts_for_one_that_comes_back() {
    // Right until frame 4, then it drifts; the other, tracked backwards, is right from frame 3 on.
    let forward = span(0..10, |frame| if frame > 4 { 3.0 * (frame - 4) as f32 } else { 0.0 });
    let backward = span(0..10, |frame| if frame < 3 { 3.0 * (3 - frame) as f32 } else { 0.0 });
    let got = path(&KEYS, &[forward, backward]).unwrap_or_default();
    assert!(got.iter().all(|(_, x)| (x - 10.0).abs() < 1e-5), "{got:?}");
    assert_eq!((got[0].0, got[7].0), (0, 1));
}

#[test]
fn a_path_goes_through_the_key_frames() {
    // Two pixels off at the second key-frame: eased in, half of it half-way.
    let only = span(0..10, |_| 2.0);
    let got =
        path(&Ends { before: Some([12.0, 5.0]), after: Some([10.0, 5.0]) }, &[only]).unwrap_or_default();
    assert!(got.windows(2).all(|pair| pair[0].1 > pair[1].1), "{got:?}");
    assert!((got[3].1 + got[4].1 - 22.0).abs() < 0.1 && got[0].1 > 11.9 && got[7].1 < 10.2, "{got:?}");
}

#[test]
fn the_forward_backward_error_decides_between_two_that_fit_alike() {
    let (sure, mut doubtful) = (span(0..10, |_| 0.0), span(0..10, |_| 0.0));
    doubtful.samples.iter_mut().for_each(|sample| sample.quality.fb_px = Some(3.0));
    for (candidates, want) in [([&sure, &doubtful], 0), ([&doubtful, &sure], 1), ([&sure, &sure], 0)] {
        let picked = fuse(1..9, &KEYS, &candidates).unwrap_or_default();
        assert!(!picked.is_empty() && picked.iter().all(|p| p.candidate == want), "{picked:?}");
    }
}

#[test]
fn nothing_where_no_candidate_has_a_sample() {
    assert_eq!(path(&KEYS, &[]), None);
    assert_eq!(path(&KEYS, &[span(0..5, |_| 0.0)]), None);
    assert_eq!(fuse(4..4, &KEYS, &[]), None);
    // Together they reach.
    let got = path(&KEYS, &[span(0..5, |_| 0.0), span(4..10, |_| 0.0)]).unwrap_or_default();
    assert_eq!(got.iter().map(|p| p.0).collect::<Vec<_>>(), [0, 0, 0, 0, 1, 1, 1, 1]);
}
