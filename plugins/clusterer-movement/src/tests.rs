//! The plugin through its trait: what it finds, what it tells of frames, what it refuses.

use honami_plugin::testing;

use super::*;

/// Tracks of one sample list each, all from `first_frame`; a NaN marks a lost sample at 0, 0.
struct Table {
    ids: Vec<u32>,
    first_frames: Vec<i64>,
    lens: Vec<u32>,
    offsets: Vec<u64>,
    x: Vec<f32>,
    y: Vec<f32>,
    status: Vec<u8>,
    times_s: Vec<f64>,
}

const FIRST: i64 = 7;
const N_FRAMES: u32 = 50;

/// Two branches of ten tracks that sway against each other; in frame 20 all jump at random.
fn two_branches() -> Table {
    let position = |track: u32, frame: u32| {
        let phase = f64::from(frame) * 0.3;
        let (side, rank) = (f64::from(track % 2), f64::from(track / 2));
        let sway = 4.0 * (phase + 3.0 * side).sin();
        let jump = if frame == 20 { 300.0 * (f64::from(track) * 2.4).sin() } else { 0.0 };
        [(200.0 * side + 5.0 * rank + sway + jump) as f32, (10.0 * rank + 0.2 * sway - jump) as f32]
    };
    let samples: Vec<[f32; 2]> =
        (0..20).flat_map(|track| (0..N_FRAMES).map(move |frame| position(track, frame))).collect();
    Table {
        ids: (100..120).collect(),
        first_frames: vec![FIRST; 20],
        lens: vec![N_FRAMES; 20],
        offsets: (0..20).map(|k| k * u64::from(N_FRAMES)).collect(),
        x: samples.iter().map(|p| p[0]).collect(),
        y: samples.iter().map(|p| p[1]).collect(),
        status: vec![1; samples.len()],
        times_s: (0..100).map(|k| f64::from(k) / 25.0).collect(),
    }
}

impl Table {
    fn tracks(&self) -> Tracks<'_> {
        Tracks {
            ids: &self.ids,
            first_frames: &self.first_frames,
            lens: &self.lens,
            offsets: &self.offsets,
            x: &self.x,
            y: &self.y,
            status: &self.status,
            first_time: 0,
            times_s: &self.times_s,
            width: 640,
            height: 360,
            max_threads: 2,
            seed: 0,
        }
    }
}

#[test]
fn two_branches_are_the_last_to_merge() {
    for linkage in [Linkage::Ward, Linkage::Average] {
        let table = two_branches();
        let settings = Settings { linkage, ..Settings::default() };
        let found = testing::cluster::<Movement>(&settings, &table.tracks()).unwrap();
        assert_eq!(found.merges.len(), 19);
        let last = found.merges[18];
        let leaves = |cluster: u32| {
            let mut open = vec![cluster];
            let mut leaves = Vec::new();
            while let Some(cluster) = open.pop() {
                match found.merges.get((cluster as usize).wrapping_sub(20)) {
                    Some(merge) => open.extend([merge.a, merge.b]),
                    None => leaves.push(cluster),
                }
            }
            leaves
        };
        for side in [last.a, last.b] {
            let branch = leaves(side);
            assert_eq!(branch.len(), 10);
            assert!(branch.iter().all(|leaf| leaf % 2 == branch[0] % 2), "{branch:?}");
        }
    }
}

#[test]
fn outlier_frames_are_told_in_frames_of_the_clip() {
    let outliers = |settings: Settings| -> Vec<i64> {
        let found = testing::cluster::<Movement>(&settings, &two_branches().tracks()).unwrap();
        assert_eq!(found.frames.len(), N_FRAMES as usize - 1);
        assert!(found.frames.iter().all(|note| note.distance.is_finite()));
        found.frames.iter().filter(|note| note.outlier).map(|note| note.frame).collect()
    };
    // The turning points of the sway, where directions scatter, are outliers too.
    let found = outliers(Settings::default());
    assert!(found.contains(&(FIRST + 20)) && found.len() < 8, "{found:?}");
    assert_eq!(outliers(Settings { outlier_sd: 4.0, ..Settings::default() }), [FIRST + 20]);
    assert_eq!(outliers(Settings { outliers: false, ..Settings::default() }), [0_i64; 0]);
}

#[test]
fn lost_samples_do_not_count() {
    let settings = Settings::default();
    let mut table = two_branches();
    for k in 60..80 {
        (table.x[k], table.y[k], table.status[k]) = (0.0, 0.0, 0);
    }
    let with_gap = testing::cluster::<Movement>(&settings, &table.tracks()).unwrap();
    for k in 60..80 {
        (table.x[k], table.y[k]) = (-5e4, 9e4);
    }
    assert_eq!(testing::cluster::<Movement>(&settings, &table.tracks()).unwrap(), with_gap);
}

#[test]
fn denoised_tracks_are_grouped_where_noise_hides_directions() {
    let mut table = two_branches();
    let mut state = 1_u64;
    // Noise of the size of a step, by a generator of Knuth's.
    for at in table.x.iter_mut().chain(&mut table.y) {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        *at += (state >> 40) as f32 / (1 << 24) as f32 * 4.0 - 2.0;
    }
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
    let table =
        Table { ids: vec![1], first_frames: vec![FIRST], lens: vec![9], offsets: vec![0], ..two_branches() };
    let error = testing::cluster::<Movement>(&Settings::default(), &table.tracks()).unwrap_err();
    assert_eq!(error.to_string(), "grouping needs at least 2 tracks, came 1");
}
