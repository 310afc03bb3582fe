//! Tracks as they come in, merges as they go out, and whose fault an error is.

use honami_plugin::testing::{self, Samples};

use super::*;

#[test]
fn tracks_are_where_they_were_seen_and_nowhere_else() {
    let mut samples = Samples::new(3, 7, 5, |track, frame| [f64::from(10 * track), f64::from(frame)]);
    samples.lose(1, 2..4, [9e4, -9e4]);
    let (first, positions) = positions(&samples.tracks());
    assert_eq!((first, positions.n_tracks(), positions.n_frames()), (7, 3, 5));
    for (track, frame) in (0..3).flat_map(|track| (0..5).map(move |frame| (track, frame))) {
        let wanted = [10.0 * track as f32, frame as f32];
        let is_lost = track == 1 && (2..4).contains(&frame);
        assert_eq!(positions.get(track, frame), (!is_lost).then_some(wanted), "{track} {frame}");
    }
}

#[test]
fn merges_are_those_of_the_linkage() {
    // Tracks at 0, 1, 5 and 8 on a line.
    let apart = vec![1.0, 5.0, 8.0, 4.0, 7.0, 3.0];
    let heights = |by| -> Vec<f64> {
        let found = linked(apart.clone(), 4, by, &testing::cx()).unwrap();
        assert_eq!(
            found.iter().map(|m| (m.a, m.b, m.size)).collect::<Vec<_>>(),
            [(0, 1, 2), (2, 3, 2), (4, 5, 4)]
        );
        found.iter().map(|m| m.height).collect()
    };
    assert_eq!(heights(Linkage::Average), [1.0, 3.0, 6.0]);
    let ward = heights(Linkage::Ward);
    // Centres 0.5 and 6.5 of two tracks each: an increase of 6^2 of inertia.
    assert!((ward[2] - 72.0_f64.sqrt()).abs() < 1e-12, "{ward:?}");
}

#[test]
fn what_tracks_lack_is_the_fault_of_the_data_and_the_rest_is_not() {
    let cases = [
        (MotionError::TooFewTracks(1), true),
        (MotionError::TooFewFrames(0), true),
        (MotionError::NeverTogether, true),
        (MotionError::Memory { n_tracks: 9, bytes: 9 }, false),
    ];
    let code = |error: &Error| error.code();
    for (fault, of_data) in cases {
        let found = heard(&testing::cx(), 1.0, "", |_| Err::<(), _>(fault.clone())).unwrap_err();
        assert_eq!(found.to_string(), fault.to_string());
        assert_eq!(code(&found) == code(&Error::data("")), of_data, "{found}");
    }
}
