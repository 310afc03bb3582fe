//! The plugin through its trait: what it finds, what it tells of frames, what it refuses.

use honami_plugin::testing::{self, Samples};

use super::*;

const FIRST: u32 = 7;
const N_FRAMES: u32 = 50;

/// Two branches of ten tracks that sway against each other; in frame 20 all jump at random. `noise` is asked for every
/// coordinate.
fn two_branches(mut noise: impl FnMut() -> f64) -> Samples {
    Samples::new(20, FIRST, N_FRAMES, |track, frame| {
        let phase = f64::from(frame) * 0.3;
        let (side, rank) = (f64::from(track % 2), f64::from(track / 2));
        let sway = 4.0 * (phase + 3.0 * side).sin();
        let jump = if frame == 20 { 300.0 * (f64::from(track) * 2.4).sin() } else { 0.0 };
        let at = [200.0 * side + 5.0 * rank + sway + jump, 10.0 * rank + 0.2 * sway - jump];
        at.map(|v| v + noise())
    })
}

#[test]
fn two_branches_are_the_last_to_merge() {
    for linkage in [Linkage::Ward, Linkage::Average] {
        let settings = Settings { linkage, ..Settings::default() };
        let found = testing::cluster::<Movement>(&settings, &two_branches(|| 0.0).tracks()).unwrap();
        assert_eq!(found.merges.len(), 19);
        let side = |side: u32| (0..20).filter(|track| track % 2 == side).collect::<Vec<u32>>();
        assert_eq!(testing::groups(&found, 2), [side(0), side(1)], "{linkage:?}");
    }
}

#[test]
fn outlier_frames_are_told_in_frames_of_the_clip() {
    let outliers = |settings: Settings| -> Vec<i64> {
        let found = testing::cluster::<Movement>(&settings, &two_branches(|| 0.0).tracks()).unwrap();
        assert_eq!(found.frames.len(), N_FRAMES as usize - 1);
        assert!(found.frames.iter().all(|note| note.distance.is_finite()));
        found.frames.iter().filter(|note| note.outlier).map(|note| note.frame).collect()
    };
    // The turning points of the sway, where directions scatter, are outliers too.
    let found = outliers(Settings::default());
    assert!(found.contains(&i64::from(FIRST + 20)) && found.len() < 8, "{found:?}");
    assert_eq!(outliers(Settings { outlier_sd: 4.0, ..Settings::default() }), [i64::from(FIRST + 20)]);
    assert_eq!(outliers(Settings { outliers: false, ..Settings::default() }), [0_i64; 0]);
}

#[test]
fn lost_samples_do_not_count() {
    let settings = Settings::default();
    let mut table = two_branches(|| 0.0);
    table.lose(1, 10..30, [0.0, 0.0]);
    let with_gap = testing::cluster::<Movement>(&settings, &table.tracks()).unwrap();
    table.lose(1, 10..30, [-5e4, 9e4]);
    assert_eq!(testing::cluster::<Movement>(&settings, &table.tracks()).unwrap(), with_gap);
}

#[test]
fn denoised_tracks_are_grouped_where_noise_hides_directions() {
    let mut state = 1_u64;
    // Noise of the size of a step, by a generator of Knuth's.
    let table = two_branches(|| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 24) * 4.0 - 2.0
    });
    let spread = |denoise: bool| {
        let settings = Settings { denoise, position: 0.0, ..Settings::default() };
        let found = testing::cluster::<Movement>(&settings, &table.tracks()).unwrap();
        // The last merge beside the one before it: how far apart the branches are, in terms of themselves.
        found.merges[18].height / found.merges[17].height
    };
    assert!(spread(true) > 1.5 * spread(false), "{} {}", spread(true), spread(false));
}

#[test]
fn one_track_cannot_be_grouped() {
    let table = Samples::new(1, FIRST, 9, |_, _| [0.0; 2]);
    let error = testing::cluster::<Movement>(&Settings::default(), &table.tracks()).unwrap_err();
    assert_eq!(error.to_string(), "grouping needs at least 2 tracks, came 1");
}
