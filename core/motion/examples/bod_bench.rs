//! Times what groups 2,000 tracks by their components, over 300 and 500 frames, and by normalised cuts of the tracks
//! themselves, both also 20,000; prints a JSON line each.

use std::time::Instant;

use honami_motion::likeness::{Likeness, Making, Options, grouped};
use honami_motion::{Bod, Criterion, Positions, Table, ncut};
use rand::{RngExt, SeedableRng};

const N_TRACKS: usize = 2000;

/// Tracks of 40 branches that sway each at its own frequency, with a little noise; one in ten starts late if there are gaps.
fn branches(n_tracks: usize, n_frames: usize, has_gaps: bool) -> Positions {
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(1);
    let mut positions = Positions::new(n_tracks, n_frames);
    for track in 0..n_tracks {
        let branch = (track % 40) as f32;
        let rest = [rng.random_range(0.0..80.0) + 110.0 * (branch % 8.0), rng.random_range(0.0..700.0)];
        let swing = rng.random_range(4.0..12.0_f32);
        for frame in 0..n_frames {
            let phase = frame as f32 / 25.0 * (0.5 + 0.05 * branch) * std::f32::consts::TAU + branch;
            let shake: [f32; 2] = [rng.random_range(-0.2..0.2), rng.random_range(-0.2..0.2)];
            if !(has_gaps && track % 10 == 0 && frame < 100) {
                let at = [
                    rest[0] + swing * phase.sin() + shake[0],
                    rest[1] + swing * 0.3 * phase.cos() + shake[1],
                ];
                positions.set(track, frame, at);
            }
        }
    }
    positions
}

#[expect(clippy::print_stdout, reason = "the result of a benchmark")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Merged by Ward's criterion, and not smoothed.
    let making = Making::Merges(Criterion::Ward);
    let r1 = Options { likeness: Likeness::Loadings, n_neighbours: 0, making, ..Options::default() };
    for (n_frames, has_gaps) in [(300, false), (500, false), (300, true)] {
        let positions = branches(N_TRACKS, n_frames, has_gaps);
        let [mut table_ms, mut bod_ms, mut cuts_ms, mut r1_ms] = [f64::INFINITY; 4];
        let mut n_above = 0;
        for _ in 0..3 {
            let start = Instant::now();
            let lap =
                |least: &mut f64, start: Instant| *least = least.min(1e3 * start.elapsed().as_secs_f64());
            let table = Table::new(&positions, &mut |_| true)?;
            lap(&mut table_ms, start);
            let start = Instant::now();
            n_above = Bod::new(&table).n_above();
            lap(&mut bod_ms, start);
            let start = Instant::now();
            grouped(&positions, &Options::default(), &mut |_| true)?;
            lap(&mut cuts_ms, start);
            let start = Instant::now();
            grouped(&positions, &r1, &mut |_| true)?;
            lap(&mut r1_ms, start);
        }
        let line = serde_json::json!({
            "n_tracks": N_TRACKS, "n_frames": n_frames, "gaps": has_gaps, "threads": rayon::current_num_threads(),
            "components": n_above, "table_ms": table_ms, "decomposition_ms": bod_ms,
            "grouped_ms": cuts_ms, "r1_ms": r1_ms,
        });
        println!("{line}");
    }
    for (n_tracks, n_frames) in [(N_TRACKS, 500), (10 * N_TRACKS, 150)] {
        let positions = branches(n_tracks, n_frames, false);
        let start = Instant::now();
        let grouped = grouped(&positions, &Options::default(), &mut |_| true)?;
        let line = serde_json::json!({
            "n_tracks": n_tracks, "n_frames": n_frames, "threads": rayon::current_num_threads(),
            "components": grouped.n_used, "grouped_s": start.elapsed().as_secs_f64(), "residual": grouped.residual,
        });
        println!("{line}");
        let start = Instant::now();
        let mut graph_s = 0.0;
        let found = ncut(&positions, &ncut::Options::default(), &mut |done| {
            if done <= 0.5 {
                graph_s = start.elapsed().as_secs_f64();
            }
            true
        })?;
        let line = serde_json::json!({
            "n_tracks": n_tracks, "n_frames": n_frames, "threads": rayon::current_num_threads(),
            "graph_s": graph_s, "cuts_s": start.elapsed().as_secs_f64() - graph_s,
            "groups": found.n_groups, "residual": found.residual,
        });
        println!("{line}");
    }
    Ok(())
}
