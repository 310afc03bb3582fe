//! The plugin through its trait: what it finds, what its settings do, what it refuses.

use std::sync::Mutex;

use honami_plugin::Listener;
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

/// Hears what is told, severities aside.
#[derive(Default)]
struct Ear(Mutex<Vec<String>>);

impl Listener for Ear {
    fn progress(&self, _: f64, _: &str) -> bool {
        false
    }

    fn log(&self, _: i32, text: &str) {
        self.0.lock().unwrap().push(text.to_owned());
    }
}

/// What comes of tracks, and all that is told of it.
fn heard_of(settings: &Settings, table: &Samples) -> (Clustering, String) {
    let ear = Ear::default();
    let found = Components::cluster(settings, &table.tracks(), &Cx::new(&ear)).unwrap();
    (found, ear.0.into_inner().unwrap().join("\n"))
}

/// A number that looks like chance, of mean 0 and variance 1 (SplitMix64: Steele, Lea and Flood, OOPSLA 2014).
fn chance(k: u32) -> f64 {
    let mut state = u64::from(k).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    state = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    state = (state ^ (state >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    3.0_f64.sqrt() * (((state ^ (state >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
}

/// Leaves that two swings move, each of which flutters for itself at 30 to 90 cycles of the clip.
fn fluttering(n_tracks: u32) -> Samples {
    Samples::new(n_tracks, 0, 256, |track, frame| {
        let turn = std::f64::consts::TAU * f64::from(frame) / 256.0;
        [0, 1].map(|axis| {
            let series = 2 * track + axis;
            let amount = |k: u32| chance(1000 * series + k);
            let wave = |k: u32| {
                let (sin, cos) = (turn * f64::from(30 + k)).sin_cos();
                0.2 * (amount(2 * k + 2) * sin + amount(2 * k + 3) * cos)
            };
            let swings = amount(0) * (3.0 * turn).sin() + amount(1) * (7.0 * turn + 1.0).sin();
            let noise = 0.1 * chance(1000 * series + 200 + frame);
            let flutter: f64 = (0..60).map(wave).sum();
            100.0 + 7.0 * f64::from(track * (axis + 3) % 41) + 3.0 * swings + flutter + noise
        })
    })
}

#[test]
fn flutter_is_taken_down_kept_or_told_as_it_is_set() {
    let (many, few) = (fluttering(80), fluttering(12));
    let told = |table: &Samples, flutter| heard_of(&Settings { flutter, ..Settings::default() }, table);
    let [count_less, hint, nothing] =
        ["(flutter=keep: as they are)", "flutter=down makes", "nothing was taken down"];
    for (table, flutter, wanted) in [
        (&many, Flutter::Auto, Some(count_less)),
        (&many, Flutter::Keep, Some(hint)),
        (&many, Flutter::TakeDown, None),
        (&few, Flutter::Auto, None),
        (&few, Flutter::Keep, None),
        (&few, Flutter::TakeDown, Some(nothing)),
    ] {
        let said = told(table, flutter).1;
        for words in [count_less, hint, nothing] {
            assert_eq!(said.contains(words), wanted == Some(words), "{flutter:?}: {said}");
        }
    }
    let [auto, keep, down] =
        [Flutter::Auto, Flutter::Keep, Flutter::TakeDown].map(|flutter| told(&many, flutter).0);
    assert!(auto == down && auto != keep);
}

#[test]
fn no_more_components_are_used_than_is_said() {
    let table = three_branches(|_| 1.0);
    let of = |components| heard_of(&Settings { components, position: 0.1, ..Settings::default() }, &table);
    for most in [1, 2] {
        let said = of(most).1;
        assert!(said.contains(&format!(", {most} are used")), "{said}");
    }
    // One component cannot tell three branches apart.
    assert_ne!(three_groups(&of(1).0), branches());
    assert_eq!(three_groups(&of(30).0), branches());
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
