//! Which bones go, by hand; nothing of those that stay is other than it was.

use honami_model::clip::FrameTimes;
use honami_model::skeleton::Joint;
use honami_model::track::TrackId;

use super::*;

/// A trunk with an end of three tracks, a fork with two of one, and one more of one; 6 bones and the root, 4 of them ends.
fn plant() -> Skeleton {
    let joint = |parent: u32, n_tracks: u32, length: f64| Joint {
        parent: Some(parent),
        length,
        tracks: (0..n_tracks).map(TrackId).collect(),
        ..Joint::default()
    };
    let joints = vec![
        Joint::default(),
        joint(0, 0, 9.0),
        joint(1, 3, 1.0),
        joint(1, 0, 9.0),
        joint(3, 1, 2.0),
        joint(3, 1, 1.0),
        joint(1, 1, 1.0),
    ];
    let n = joints.len();
    let times = FrameTimes::constant(1, 25.0).unwrap();
    Skeleton::new([0.0; 3], joints, vec![[0.0, 0.0, 1.0]; n], times).unwrap()
}

#[test]
fn those_that_bear_least_go_first() {
    for (most, rows, bearers) in [
        (100, vec![0, 1, 2, 3, 4, 5, 6], [0, 1, 2, 3, 4, 5, 6]),
        (11, vec![0, 1, 2, 3, 4, 5, 6], [0, 1, 2, 3, 4, 5, 6]),
        // Of one track and as long: the last.
        (10, vec![0, 1, 2, 3, 4, 5], [0, 1, 2, 3, 4, 5, 1]),
        (9, vec![0, 1, 2, 3, 4, 5], [0, 1, 2, 3, 4, 5, 1]),
        (8, vec![0, 1, 2, 3, 4], [0, 1, 2, 3, 4, 3, 1]),
        (7, vec![0, 1, 2, 3, 4], [0, 1, 2, 3, 4, 3, 1]),
        // The fork is an end now, with both tracks: it has a joint there.
        (6, vec![0, 1, 2, 3], [0, 1, 2, 3, 3, 3, 1]),
        (5, vec![0, 1, 2], [0, 1, 2, 1, 1, 1, 1]),
        (4, vec![0, 1, 2], [0, 1, 2, 1, 1, 1, 1]),
        (3, vec![0, 1], [0, 1, 1, 1, 1, 1, 1]),
    ] {
        let fewer = Fewer::of(&plant(), most).unwrap();
        assert_eq!((fewer.rows(), &fewer.bearers[..]), (&rows[..], &bearers[..]), "{most}");
        assert_eq!(fewer.n_left_out(), 7 - rows.len(), "{most}");
    }
    let error = Fewer::of(&plant(), 2).unwrap_err().to_string();
    assert!(error.contains("3 joints at least") && error.contains("not 2"), "{error}");
}

#[test]
fn what_was_carried_goes_with_its_bearer() {
    let fewer = Fewer::of(&plant(), 6).unwrap();
    let bound = |shares: [(u16, f64); 4]| fewer.binding(&Binding::new(shares)).shares().collect::<Vec<_>>();
    assert_eq!(bound([(4, 0.5), (5, 0.25), (2, 0.25), (0, 0.0)]), [(3, 0.75), (2, 0.25)]);
    assert_eq!(bound([(6, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)]), [(1, 1.0)]);
}
