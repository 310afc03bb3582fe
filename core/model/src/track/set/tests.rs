//! Ranges are a way of writing a set: nothing a set answers may depend on them.

use std::collections::BTreeSet;

use proptest::prelude::*;

use super::{TrackId, TrackSet};

proptest! {
    #[test]
    fn answers_like_a_set(numbers in prop::collection::vec(0_u32..40, 0..60)) {
        let want: BTreeSet<u32> = numbers.iter().copied().collect();
        let set: TrackSet = numbers.iter().copied().map(TrackId).collect();
        prop_assert_eq!(set.iter().map(|track| track.0).collect::<BTreeSet<_>>(), want.clone());
        prop_assert_eq!(set.len(), want.len());
        prop_assert_eq!(set.is_empty(), want.is_empty());
        for number in 0..40 {
            prop_assert_eq!(set.contains(TrackId(number)), want.contains(&number));
        }
        let json = serde_json::to_string(&set).unwrap();
        prop_assert_eq!(serde_json::from_str::<TrackSet>(&json).unwrap(), set);
    }
}

#[test]
fn the_last_number_is_a_track_like_any_other() {
    let set: TrackSet = [u32::MAX, 0, u32::MAX - 1].map(TrackId).into_iter().collect();
    assert_eq!(set.iter().map(|track| track.0).collect::<Vec<_>>(), [0, u32::MAX - 1, u32::MAX]);
    assert!(set.contains(TrackId(u32::MAX)) && set.len() == 3);
    let json = serde_json::to_string(&set).unwrap();
    assert_eq!(json, "[[0,1],[4294967294,4294967296]]");
    assert_eq!(serde_json::from_str::<TrackSet>(&json).unwrap(), set);
    let error = serde_json::from_str::<TrackSet>("[[7,4294967297]]").unwrap_err();
    assert!(error.to_string().contains("tracks 7 to 4294967297"), "{error}");
}

#[test]
fn many_tracks_are_written_in_few_characters() {
    let set: TrackSet = (5..10_005).map(TrackId).collect();
    assert_eq!(serde_json::to_string(&set).unwrap(), "[[5,10005]]");
    assert_eq!(set.to_string(), "10000 tracks");
    assert_eq!(TrackSet::from(TrackId(42)).to_string(), "track 42");
}
