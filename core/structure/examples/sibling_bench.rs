//! How long a sibling takes: 2000 tracks in 32 groups over 500 frames, in the picture and in depth.
//!
//! `cargo run --release -p honami-structure --example sibling_bench`

#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "a program to be read by whoever measures")]

use std::time::Instant;

use honami_model::clip::FrameTimes;
use honami_model::hierarchy::{Dendrogram, Merge};
use honami_model::track::TrackId;
use honami_structure::diener::{Settings, grow};
use honami_structure::follow::Path;
use honami_structure::siblings::{self, Siblings};
use honami_structure::tree::tree;

const N_TRACKS: u32 = 2048;
const N_FRAMES: u32 = 500;
const N_GROUPS: u32 = 32;
const N_SIBLINGS: u32 = 50;

fn main() {
    let path = |k: u32| {
        let (x, y) = (f64::from(k % 64) * 10.0, f64::from(k / 64) * 9.0);
        let sway = |t: u32| 3.0 * (f64::from(t) * 0.3 + f64::from(k / 32)).sin();
        Path { track: TrackId(k), at: (0..N_FRAMES).map(|t| Some([x + sway(t), y])).collect() }
    };
    let paths: Vec<Path> = (0..N_TRACKS).map(path).collect();
    // Neighbours are merged, then pairs of them, and so on.
    let (mut merges, mut row) = (Vec::new(), 0);
    for level in 1..=N_TRACKS.ilog2() {
        for _ in 0..N_TRACKS >> level {
            let (height, size) = (f64::from(level), 1 << level);
            merges.push(Merge { a: row, b: row + 1, height, size });
            row += 2;
        }
    }
    let dendrogram = Dendrogram::new(N_TRACKS, merges).unwrap();
    let groups = tree(&dendrogram, N_GROUPS, &vec![true; N_TRACKS as usize]);
    let times = FrameTimes::constant(N_FRAMES, 25.0).unwrap();
    for is_flat in [true, false] {
        let begun = Instant::now();
        let grown = grow(&paths, &groups, &times, Settings { root: None, is_flat }).unwrap();
        let growing = begun.elapsed().as_secs_f64();
        let siblings = Siblings::of(&grown.skeleton, siblings::Settings::default()).unwrap();
        let mut taken: Vec<f64> = (0..N_SIBLINGS)
            .map(|number| {
                let begun = Instant::now();
                std::hint::black_box(siblings.draw(1, number).unwrap());
                begun.elapsed().as_secs_f64() * 1e3
            })
            .collect();
        taken.sort_by(f64::total_cmp);
        println!(
            "{}: {} joints, {} leaves, grown in {growing:.3} s; a sibling in {:.1} ms (median), {:.1} ms at most",
            if is_flat { "in the picture" } else { "in depth" },
            grown.skeleton.joints().len(),
            grown.skeleton.leaves().len(),
            taken[taken.len() / 2],
            taken[taken.len() - 1]
        );
    }
}
