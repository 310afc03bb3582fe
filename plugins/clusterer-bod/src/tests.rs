//! The plugin through its trait: what it finds, what its settings do, what it refuses.

use honami_plugin::testing::{self, Samples};

use super::*;

const N_FRAMES: u32 = 80;
const N_TRACKS: u32 = 24;

/// Three branches, whose tracks take turns and are far from each other, at frequencies of their own; `ways` says which
/// way a track goes.
fn three_branches(ways: impl Fn(u32) -> f64) -> Samples {
    let position = |track: u32, frame: u32| {
        let (branch, rank) = (f64::from(track % 3), f64::from(track / 3));
        let sway = ways(track) * (3.0 + rank) * (f64::from(frame) * (0.2 + 0.17 * branch) + branch).sin();
        [90.0 * rank + 7.0 * branch + sway, 40.0 + 0.4 * sway]
    };
    Samples::new(N_TRACKS, 5, N_FRAMES, position)
}

fn three_groups(found: &Clustering) -> Vec<Vec<u32>> {
    testing::groups(found, 3)
}

fn branches() -> Vec<Vec<u32>> {
    (0..3).map(|branch| (0..N_TRACKS).filter(|track| track % 3 == branch).collect()).collect()
}

#[test]
fn branches_are_the_last_to_merge_by_every_likeness_in_every_hierarchy() {
    let table = three_branches(|_| 1.0);
    for likeness in [Likeness::Loadings, Likeness::Turned, Likeness::Steps] {
        for (hierarchy, smooth) in
            [Hierarchy::Cuts, Hierarchy::Ward, Hierarchy::Average].into_iter().zip([8, 8, 0])
        {
            let settings = Settings { likeness, hierarchy, smooth, position: 0.1, ..Settings::default() };
            let found = testing::cluster::<Components>(&settings, &table.tracks()).unwrap();
            assert_eq!(found.merges.len(), N_TRACKS as usize - 1);
            assert_eq!(three_groups(&found), branches(), "{likeness:?} {hierarchy:?}");
            assert!(found.frames.is_empty());
        }
    }
}

#[test]
fn tracks_that_go_the_other_way_belong_together_by_likenesses_that_do_not_ask_which_way() {
    let table = three_branches(|track| if track % 2 == 0 { 1.0 } else { -1.0 });
    let groups = |likeness| {
        let settings = Settings { likeness, position: 0.0, ..Settings::default() };
        three_groups(&testing::cluster::<Components>(&settings, &table.tracks()).unwrap())
    };
    assert_eq!(groups(Likeness::Turned), branches());
    assert_eq!(groups(Likeness::Steps), branches());
    assert_ne!(groups(Likeness::Loadings), branches());
}

#[test]
fn lost_samples_do_not_count_and_gaps_do_not_part_a_branch() {
    let settings = Settings { position: 0.1, ..Settings::default() };
    let mut table = three_branches(|_| 1.0);
    let lose = |table: &mut Samples, x: f32| {
        for track in [4, 9, 17] {
            table.lose(track, 0..35, [x, -x]);
        }
    };
    lose(&mut table, 0.0);
    let found = testing::cluster::<Components>(&settings, &table.tracks()).unwrap();
    assert_eq!(three_groups(&found), branches());
    lose(&mut table, 9e4);
    assert_eq!(testing::cluster::<Components>(&settings, &table.tracks()).unwrap(), found);
}

#[test]
fn one_track_cannot_be_grouped() {
    let table = Samples::new(1, 5, 9, |_, _| [0.0; 2]);
    let error = testing::cluster::<Components>(&Settings::default(), &table.tracks()).unwrap_err();
    assert_eq!(error.to_string(), "grouping needs at least 2 tracks, came 1");
}
