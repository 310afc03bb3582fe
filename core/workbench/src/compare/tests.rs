//! What is made of rows, truths and flows before anything is measured.

use honami_exchange::flo::Flow;
use honami_model::clip::{Clip, FrameTimes};
use honami_model::track::{Quality, Sample, Source, Status, TrackId};
use honami_motion::accuracy::TruePath;

use super::{STATIC, Time, check_truth, gather, points_of, standing, truth, truth_of_flow};
use crate::drive::Seed;

fn path(first_frame: u32, positions: &[(f64, f64, bool)]) -> TruePath {
    TruePath { first_frame, positions: positions.to_vec() }
}

fn seed(track: u32, x: f32, y: f32) -> Seed {
    Seed { frame: 0, track: TrackId(track), x, y }
}

#[test]
fn a_flow_is_a_truth_of_two_frames() {
    // The left pixel moves by (1.5, 0), the middle one out of the picture, of the right one nothing is known.
    let flow = Flow { width: 3, height: 1, vectors: vec![Some([1.5, 0.0]), Some([0.0, -2.0]), None] };
    let points = [seed(0, 0.0, 0.0), seed(1, 1.0, 0.0), seed(2, 2.0, 0.0), seed(3, 0.5, 0.0)];
    let truth = truth_of_flow(&flow, &points, 2).unwrap();
    let told: Vec<_> = truth.iter().map(|(track, path)| (track.0, path.positions[1])).collect();
    assert_eq!(told, [(0, (1.5, 0.0, true)), (1, (1.0, -2.0, false)), (3, (1.25, -1.0, false))]);
    let error = truth_of_flow(&flow, &points, 40).unwrap_err().to_string();
    assert!(error.contains("there are 40 frames"), "{error}");
}

#[test]
fn a_truth_of_a_larger_clip_is_refused() {
    let clip = Clip { width: 100, height: 50, times: FrameTimes::constant(3, 25.0).unwrap() };
    for (x, y, visible, said) in [
        (99.0, 49.0, true, None),
        (-1.0, 0.0, true, None),
        (120.0, 0.0, false, None),
        (120.0, 0.0, true, Some("point 7 at (120, 0) in frame 2")),
        (0.0, -2.0, true, Some("100x50 pixels")),
    ] {
        let truth = [(TrackId(7), path(1, &[(0.0, 0.0, true), (x, y, visible)]))].into();
        let error = check_truth(&truth, &clip, &(0..3)).err().map(|error| error.to_string());
        match said {
            Some(said) => assert!(error.as_ref().is_some_and(|e| e.contains(said)), "{error:?}"),
            None => assert_eq!(error, None),
        }
    }
}

#[test]
fn a_truth_of_a_shorter_clip_is_refused() {
    let clip = Clip { width: 100, height: 50, times: FrameTimes::constant(9, 25.0).unwrap() };
    let truth = [(TrackId(7), path(1, &[(0.0, 0.0, true); 4]))].into();
    assert!(check_truth(&truth, &clip, &(2..5)).is_ok());
    let error = check_truth(&truth, &clip, &(2..9)).unwrap_err().to_string();
    assert!(error.contains("ends with frame 4") && error.contains("--frames 2..5"), "{error}");
}

#[test]
fn a_truth_is_cut_where_the_frames_end() {
    let mut all =
        [(TrackId(0), path(2, &[(0.0, 0.0, true); 9])), (TrackId(1), path(8, &[(0.0, 0.0, true); 2]))].into();
    truth::cut(&mut all, 5);
    assert_eq!(all.values().map(|path| path.positions.len()).collect::<Vec<_>>(), [3, 0]);
    assert_eq!(points_of(&all).len(), 1, "nothing is seen of the other");
}

#[test]
fn a_frame_that_a_tracker_leaves_out_is_lost() {
    let (quality, source) = (Quality::default(), Source::Tracked);
    let sample = Sample { x: 1.0, y: 2.0, status: Status::Tracked, source, quality };
    let mut spans = std::collections::BTreeMap::new();
    for frame in [3, 6] {
        gather(&mut spans, frame, &vec![(TrackId(0), sample)]);
    }
    let statuses: Vec<_> = spans[&TrackId(0)].samples.iter().map(|sample| sample.status).collect();
    assert_eq!(statuses, [Status::Tracked, Status::Lost, Status::Lost, Status::Tracked]);
    assert_eq!(standing(&seed(0, 1.0, 2.0), 4).samples, [sample; 4], "{STATIC}");
}

#[test]
fn times_by_hand() {
    assert_eq!(Time::of(&[]), None);
    let time = Time::of(&[0.002, 0.001, 0.009]).unwrap();
    let wanted = Time { mean_ms: 4.0, median_ms: 2.0, p95_ms: 9.0 };
    for (got, wanted) in
        [(time.mean_ms, wanted.mean_ms), (time.median_ms, wanted.median_ms), (time.p95_ms, wanted.p95_ms)]
    {
        assert!((got - wanted).abs() < 1e-9, "{time:?}");
    }
}
