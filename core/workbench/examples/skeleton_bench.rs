//! Times the way from 2,000 tracks over 500 frames to a skeleton, step by step: distances and Ward's hierarchy or components
//! of motion, skeletons in the picture and in depth, a loop, and siblings; prints a JSON line each.
//!
//! `cargo xtask bench skeleton`

#![expect(clippy::print_stdout, reason = "a program to be read by whoever measures")]

use std::time::Instant;

use honami_model::clip::FrameTimes;
use honami_model::track::TrackId;
use honami_motion::{Criterion, Positions, composite, grouped, likeness, linkage};
use honami_structure::follow::Path;
use honami_structure::repeat::repeat;
use honami_structure::siblings::{self, Siblings};
use honami_structure::tree::tree;
use honami_structure::{diener, zeng};
use rand::{RngExt, SeedableRng};

const N_TRACKS: usize = 2000;
const N_FRAMES: usize = 500;
const N_GROUPS: u32 = 32;
/// Times that each step is taken.
const ROUNDS: usize = 7;

type Failure = Box<dyn std::error::Error>;

/// Tracks of 40 branches that sway each at its own frequency, with a little noise.
fn branches() -> Positions {
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(1);
    let mut positions = Positions::new(N_TRACKS, N_FRAMES);
    for track in 0..N_TRACKS {
        let branch = (track % 40) as f32;
        let rest = [rng.random_range(0.0..80.0) + 110.0 * (branch % 8.0), rng.random_range(0.0..700.0)];
        let swing = rng.random_range(4.0..12.0_f32);
        for frame in 0..N_FRAMES {
            let phase = frame as f32 / 25.0 * (0.5 + 0.05 * branch) * std::f32::consts::TAU + branch;
            let shake: [f32; 2] = [rng.random_range(-0.2..0.2), rng.random_range(-0.2..0.2)];
            let at = [swing * phase.sin() + shake[0], swing * 0.3 * phase.cos() + shake[1]];
            positions.set(track, frame, [rest[0] + at[0], rest[1] + at[1]]);
        }
    }
    positions
}

/// Takes a step again and again, prints what it took, and returns what came of the last time.
fn timed<T>(what: &str, mut step: impl FnMut() -> Result<T, Failure>) -> Result<T, Failure> {
    let (mut taken, mut last) = (Vec::new(), step()?);
    for _ in 0..ROUNDS {
        let begun = Instant::now();
        last = step()?;
        taken.push(1e3 * begun.elapsed().as_secs_f64());
    }
    taken.sort_by(f64::total_cmp);
    let line = serde_json::json!({
        "step": what, "median_ms": taken[ROUNDS / 2], "least_ms": taken[0], "most_ms": taken[ROUNDS - 1],
        "tracks": N_TRACKS, "frames": N_FRAMES, "threads": rayon::current_num_threads(),
    });
    println!("{line}");
    Ok(last)
}

fn main() -> Result<(), Failure> {
    let positions = branches();
    let merged = timed("distances and Ward's hierarchy", || {
        let distances = composite(&positions, &Default::default(), &mut |_| true)?;
        Ok(linkage(distances.condensed, N_TRACKS, Criterion::Ward)?)
    })?;
    timed("components and cuts", || {
        Ok(grouped(&positions, &likeness::Options::default(), &mut |_| true)?.tree)
    })?;
    let path = |k: usize| {
        let at = |frame| positions.get(k, frame).map(|at| at.map(f64::from));
        Path { track: TrackId(k as u32), at: (0..N_FRAMES).map(at).collect() }
    };
    let paths: Vec<Path> = (0..N_TRACKS).map(path).collect();
    let groups = tree(&merged, N_GROUPS, &[true; N_TRACKS]);
    let times = FrameTimes::constant(N_FRAMES as u32, 25.0)?;
    for is_flat in [true, false] {
        let seen = if is_flat { "in the picture" } else { "in depth" };
        let settings = diener::Settings { root: None, is_flat };
        let grown =
            timed(&format!("diener {seen}"), || Ok(diener::grow(&paths, &groups, &times, settings)?))?;
        let settings = zeng::Settings { is_flat, ..zeng::Settings::default() };
        timed(&format!("zeng {seen}"), || Ok(zeng::grow(&paths, &groups, &times, &settings)?))?;
        timed(&format!("loop {seen}"), || Ok(repeat(&grown.skeleton, 0..N_FRAMES as u32)?))?;
        let siblings = Siblings::of(&grown.skeleton, siblings::Settings::default())?;
        let mut number = 0;
        timed(&format!("sibling {seen}"), || {
            number += 1;
            Ok(siblings.draw(1, number)?)
        })?;
    }
    Ok(())
}
