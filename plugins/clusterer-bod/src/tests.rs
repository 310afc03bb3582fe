//! The plugin through its trait: what it finds, what its settings do, what it refuses.

use honami_plugin::testing;

use super::*;

const N_FRAMES: u32 = 80;
const N_TRACKS: u32 = 24;

/// Samples of tracks, all over the same frames.
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

/// Three branches, whose tracks take turns and are far from each other, at frequencies of their own; `ways` says which
/// way a track goes.
fn three_branches(ways: impl Fn(u32) -> f64) -> Table {
    let position = |track: u32, frame: u32| {
        let (branch, rank) = (f64::from(track % 3), f64::from(track / 3));
        let sway = ways(track) * (3.0 + rank) * (f64::from(frame) * (0.2 + 0.17 * branch) + branch).sin();
        [(90.0 * rank + 7.0 * branch + sway) as f32, (40.0 + 0.4 * sway) as f32]
    };
    let samples: Vec<[f32; 2]> = (0..N_TRACKS)
        .flat_map(|track| (0..N_FRAMES).map(|frame| position(track, frame)).collect::<Vec<_>>())
        .collect();
    Table {
        ids: (100..100 + N_TRACKS).collect(),
        first_frames: vec![5; N_TRACKS as usize],
        lens: vec![N_FRAMES; N_TRACKS as usize],
        offsets: (0..N_TRACKS).map(|k| u64::from(k * N_FRAMES)).collect(),
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
            width: 800,
            height: 360,
            max_threads: 2,
            seed: 0,
        }
    }
}

/// The leaves of each of the last three clusters, sorted.
fn three_groups(found: &Clustering) -> Vec<Vec<u32>> {
    let leaves = |cluster: u32| {
        let (mut open, mut leaves) = (vec![cluster], Vec::new());
        while let Some(cluster) = open.pop() {
            match cluster.checked_sub(N_TRACKS).map(|row| found.merges[row as usize]) {
                Some(merge) => open.extend([merge.a, merge.b]),
                None => leaves.push(cluster),
            }
        }
        leaves.sort_unstable();
        leaves
    };
    let last = &found.merges[found.merges.len() - 2..];
    let top = 2 * N_TRACKS - 2;
    let tops = last.iter().flat_map(|merge| [merge.a, merge.b]).filter(|&cluster| cluster != top - 1);
    let mut groups: Vec<Vec<u32>> = tops.map(leaves).collect();
    groups.sort();
    groups
}

fn branches() -> Vec<Vec<u32>> {
    (0..3).map(|branch| (0..N_TRACKS).filter(|track| track % 3 == branch).collect()).collect()
}

#[test]
fn branches_are_the_last_to_merge_by_every_likeness_and_linkage() {
    let table = three_branches(|_| 1.0);
    for likeness in [Likeness::Loadings, Likeness::Turned, Likeness::Steps] {
        for linkage in [Linkage::Ward, Linkage::Average] {
            let settings = Settings { likeness, linkage, position: 0.1, ..Settings::default() };
            let found = testing::cluster::<Components>(&settings, &table.tracks()).unwrap();
            assert_eq!(found.merges.len(), N_TRACKS as usize - 1);
            assert_eq!(three_groups(&found), branches(), "{likeness:?} {linkage:?}");
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
    let lose = |table: &mut Table, x: f32| {
        for track in [4, 9, 17] {
            let start = track * N_FRAMES as usize;
            for k in start..start + 35 {
                (table.x[k], table.y[k], table.status[k]) = (x, -x, 0);
            }
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
    let whole = three_branches(|_| 1.0);
    let table = Table { ids: vec![1], first_frames: vec![5], lens: vec![9], offsets: vec![0], ..whole };
    let error = testing::cluster::<Components>(&Settings::default(), &table.tracks()).unwrap_err();
    assert_eq!(error.to_string(), "grouping needs at least 2 tracks, came 1");
}
