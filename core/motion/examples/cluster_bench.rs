//! Times the composite distance and Ward's linkage of 2,000 tracks over 500 frames, and a cut of the hierarchy; prints one
//! JSON line.

use std::hint::black_box;
use std::time::Instant;

use honami_motion::{Criterion, Positions, composite, linkage};
use rand::{RngExt, SeedableRng};

const N_TRACKS: usize = 2000;
const N_FRAMES: usize = 500;

/// Tracks of 40 branches that sway each at its own frequency, with a little noise and a gap in every tenth.
fn branches() -> Positions {
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(1);
    let mut positions = Positions::new(N_TRACKS, N_FRAMES);
    for track in 0..N_TRACKS {
        let branch = (track % 40) as f32;
        let rest = [rng.random_range(0.0..80.0) + 110.0 * (branch % 8.0), rng.random_range(0.0..700.0)];
        let swing = rng.random_range(4.0..12.0_f32);
        for frame in 0..N_FRAMES {
            if track % 10 == 0 && (100..130).contains(&frame) {
                continue;
            }
            let phase = frame as f32 / 25.0 * (0.5 + 0.05 * branch) * std::f32::consts::TAU + branch;
            let shake: [f32; 2] = [rng.random_range(-0.2..0.2), rng.random_range(-0.2..0.2)];
            let at =
                [rest[0] + swing * phase.sin() + shake[0], rest[1] + swing * 0.3 * phase.cos() + shake[1]];
            positions.set(track, frame, at);
        }
    }
    positions
}

#[expect(clippy::print_stdout, reason = "the result of a benchmark")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let positions = branches();
    let ([mut distance_ms, mut ward_ms, mut cut_ms], mut n_outliers) = ([f64::INFINITY; 3], 0);
    for _ in 0..7 {
        let start = Instant::now();
        let distances = composite(&positions, &Default::default(), &mut |_| true)?;
        distance_ms = distance_ms.min(1e3 * start.elapsed().as_secs_f64());
        n_outliers = distances.outlier_frames.len();
        let start = Instant::now();
        let tree = linkage(distances.condensed, N_TRACKS, Criterion::Ward)?;
        ward_ms = ward_ms.min(1e3 * start.elapsed().as_secs_f64());
        let start = Instant::now();
        black_box(tree.cut(40));
        cut_ms = cut_ms.min(1e3 * start.elapsed().as_secs_f64());
    }
    let line = serde_json::json!({
        "n_tracks": N_TRACKS, "n_frames": N_FRAMES, "threads": rayon::current_num_threads(),
        "distance_ms": distance_ms, "ward_ms": ward_ms, "total_ms": distance_ms + ward_ms,
        "cut_ms": cut_ms, "outlier_frames": n_outliers,
    });
    println!("{line}");
    Ok(())
}
