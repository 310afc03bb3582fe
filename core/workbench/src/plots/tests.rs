//! Curves of movements that are known.

use super::*;
use honami_model::track::{Quality, Source, Status};

/// A track that sways by 5 px across at 2 Hz round `x`, seen in these frames of 25 per second.
fn track(x: f32, frames: std::ops::Range<u32>, lost: std::ops::Range<u32>, px: f64) -> Arc<Span> {
    let sample = |frame: u32| Sample {
        x: x + (px * (f64::from(frame) / 25.0 * std::f64::consts::TAU * 2.0).sin()) as f32,
        y: 40.0,
        status: if lost.contains(&frame) { Status::Lost } else { Status::Tracked },
        source: Source::Tracked,
        quality: Quality { fb_px: Some(0.5), ncc: None },
    };
    Arc::new(Span { first_frame: frames.start, samples: frames.map(sample).collect() })
}

#[test]
fn one_track_is_where_it_is() {
    let times = FrameTimes::constant(100, 25.0).unwrap();
    let plots = of(&[track(30.0, 10..90, 50..55, 5.0)], &times);
    assert_eq!((plots.x_px[9], plots.y_px[20], plots.x_px[52]), (None, Some(40.0), None));
    assert!((plots.x_px[25].unwrap() - 30.0).abs() < 1e-3);
    assert_eq!((plots.fb_px[20], plots.ncc[20]), (Some(0.5), None));
    // Fastest in the middle: 2 π f A, less what a difference over two frames misses of it.
    let fastest = plots.speed_px_s.iter().flatten().copied().fold(0.0, f64::max);
    assert!((58.0..62.9).contains(&fastest), "{fastest} px/s");
    let peak = plots.sway.unwrap().peak.unwrap();
    assert!((peak.hz - 2.0).abs() < 0.05 && (peak.amplitude_px - 5.0).abs() < 0.3, "{peak:?}");
}

#[test]
fn several_tracks_are_their_mean_from_where_each_is() {
    let times = FrameTimes::constant(100, 25.0).unwrap();
    let tracks =
        [track(30.0, 0..100, 0..0, 4.0), track(200.0, 0..100, 0..0, 8.0), track(90.0, 0..3, 0..0, 1.0)];
    let plots = of(&tracks, &times);
    let widest = plots.x_px.iter().skip(3).flatten().copied().fold(0.0, f64::max);
    assert!((widest - 6.0).abs() < 0.1, "the mean of 4 and 8 px, got {widest}");
    let sway = plots.sway.unwrap();
    assert_eq!((plots.n_tracks, sway.spectrum.n_tracks), (3, 2), "one is too brief for a spectrum");
    assert!((sway.peak.unwrap().hz - 2.0).abs() < 0.05);
}

#[test]
fn what_cannot_be_plotted_says_why() {
    let times = FrameTimes::constant(100, 25.0).unwrap();
    for (tracks, times, why) in [
        (vec![track(3.0, 0..5, 0..0, 1.0)], times.clone(), "at least 8 frames"),
        (vec![track(3.0, 0..100, 0..0, 0.0)], times.clone(), "stands still"),
        (vec![], times, "no tracks"),
        (vec![track(3.0, 0..4, 0..0, 1.0)], FrameTimes::constant(4, 25.0).unwrap(), "at least 8 frames"),
    ] {
        let said = of(&tracks, &times).sway.unwrap_err();
        assert!(said.contains(why), "{said}");
    }
}
