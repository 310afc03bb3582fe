//! The plugin through its trait: what it finds, what its settings do, what it refuses.

use honami_plugin::testing::{self, Samples};

use super::*;

const N_TRACKS: u32 = 32;

/// Four branches in turn, side by side, each of a frequency of its own; every other track goes the other way. `noise` is
/// asked for every coordinate.
fn four_branches(mut noise: impl FnMut() -> f64) -> Samples {
    Samples::new(N_TRACKS, 5, 80, |track, frame| {
        let (branch, rank) = (f64::from(track % 4), f64::from(track / 4));
        let way = if (track / 4) % 2 == 0 { 1.0 } else { -1.0 };
        let sway = way * (3.0 + rank) * (f64::from(frame) * (0.2 + 0.17 * branch) + branch).sin();
        [90.0 * rank + 7.0 * branch + sway, 40.0 + 0.4 * sway].map(|v| v + noise())
    })
}

fn branches() -> Vec<Vec<u32>> {
    (0..4).map(|branch| (0..N_TRACKS).filter(|track| track % 4 == branch).collect()).collect()
}

fn groups(settings: &Settings, samples: &Samples) -> Vec<Vec<u32>> {
    testing::groups(&testing::cluster::<Cuts>(settings, &samples.tracks()).unwrap(), 4)
}

fn by_movement() -> Settings {
    Settings { position: 0.1, ..Settings::default() }
}

#[test]
fn branches_are_the_quarters_with_all_neighbours_and_few_and_with_more_levels_below() {
    let samples = four_branches(|| 0.0);
    let cases = [
        (2, Order::Levels, 100, false),
        (6, Order::Levels, 100, false),
        (2, Order::Levels, 5, false),
        (12, Order::Cuts, 50, false),
        (3, Order::Cuts, 31, true),
    ];
    for (levels, order, neighbours, denoise) in cases {
        let settings = Settings { levels, order, neighbours, denoise, ..by_movement() };
        assert_eq!(groups(&settings, &samples), branches(), "{levels} {order:?} {neighbours} {denoise}");
    }
    // By place alone they are mixed: tracks of one rank stand side by side.
    assert_ne!(groups(&Settings { position: 100.0, ..Settings::default() }, &samples), branches());
}

#[test]
fn noise_is_taken_off_where_it_hides_branches() {
    let mut state = 1_u64;
    // By a generator of Knuth's.
    let noisy = four_branches(|| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 24) * 8.0 - 4.0
    });
    let with = |denoise| groups(&Settings { denoise, order: Order::Cuts, ..by_movement() }, &noisy);
    assert_ne!(with(false), branches());
    assert_eq!(with(true), branches());
}

#[test]
fn lost_samples_do_not_count_and_gaps_do_not_part_a_branch() {
    let mut samples = four_branches(|| 0.0);
    [4, 9, 17].into_iter().for_each(|track| samples.lose(track, 0..35, [0.0, 0.0]));
    assert_eq!(groups(&by_movement(), &samples), branches());
    let found = testing::cluster::<Cuts>(&by_movement(), &samples.tracks()).unwrap();
    [4, 9, 17].into_iter().for_each(|track| samples.lose(track, 0..35, [9e4, -9e4]));
    assert_eq!(testing::cluster::<Cuts>(&by_movement(), &samples.tracks()).unwrap(), found);
}

/// Groups on a circle, each of a frequency and a direction of its own: one, two and three cuts find them.
#[test]
fn two_three_and_four_groups_are_what_one_two_and_three_cuts_find() {
    let mut state = 7_u64;
    let mut near = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 20) - 8.0
    };
    for n_groups in [2, 3, 4] {
        let places: Vec<[f64; 2]> = (0..8 * n_groups).map(|_| [near(), near()]).collect();
        let samples = Samples::new(8 * n_groups, 0, 40, |track, frame| {
            let angle = std::f64::consts::TAU * f64::from(track % n_groups) / f64::from(n_groups);
            let hz = [0.7, 1.9, 1.2, 2.6][(track % n_groups) as usize];
            let sway = 9.0 * (std::f64::consts::TAU * hz * f64::from(frame) / 25.0 + angle).sin();
            let [x, y] = places[track as usize];
            let (sin, cos) = angle.sin_cos();
            [160.0 + 90.0 * cos + x + sway * cos - 0.3 * sway * sin, 120.0 + 70.0 * sin + y + sway * sin]
        });
        let found = testing::cluster::<Cuts>(&Settings::default(), &samples.tracks()).unwrap();
        let group = |group: u32| (0..8 * n_groups).filter(|track| track % n_groups == group).collect();
        let wanted: Vec<Vec<u32>> = (0..n_groups).map(group).collect();
        assert_eq!(testing::groups(&found, n_groups as usize), wanted);
        assert!(found.merges.is_sorted_by(|a, b| a.height <= b.height));
    }
}

#[test]
fn one_track_cannot_be_grouped() {
    let samples = Samples::new(1, 5, 9, |_, _| [0.0; 2]);
    let error = testing::cluster::<Cuts>(&Settings::default(), &samples.tracks()).unwrap_err();
    assert_eq!(error.to_string(), "grouping needs at least 2 tracks, came 1");
}
