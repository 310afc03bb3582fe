//! How well suspicion tells bad samples and tracks, on generated clips that it was not fitted on; prints JSON.
//!
//! `suspicion_bench [--seed N] [--fit]`: with `--fit` the weights are fitted first, on the seeds of fitting, and
//! printed as they belong in `suspicion/weights.rs`.

use std::error::Error;

use honami_review::evidence::Parts;
use honami_review::suspicion::{WEIGHTS, Weights, fit};
use honami_synth::Level;
use serde_json::{Value, json};

#[path = "suspicion_bench/follow.rs"]
mod follow;
#[path = "suspicion_bench/scores.rs"]
mod scores;

/// Seeds of the clips that the weights are fitted on.
const FIT_SEEDS: [u64; 2] = [101, 102];
/// The clips that they are measured on by default.
const TEST_SEED: u64 = 201;
/// Without key-frames, and with one every so many frames.
const KEYED: [Option<u32>; 2] = [None, Some(40)];

#[expect(clippy::print_stdout, reason = "the result of a benchmark")]
fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let seed = match args.iter().position(|arg| arg == "--seed") {
        Some(at) => args.get(at + 1).ok_or("--seed wants a number")?.parse()?,
        None => TEST_SEED,
    };
    if FIT_SEEDS.contains(&seed) {
        return Err(format!("the weights were fitted on clip {seed}: take another seed").into());
    }
    let fitted = if args.iter().any(|arg| arg == "--fit") { Some(fitted()?) } else { None };
    let weights = fitted.unwrap_or(WEIGHTS);
    let (mut rows, mut pooled) = (Vec::new(), scores::Tally::default());
    for level in Level::ALL {
        for case in follow::cases(level, seed, &KEYED)? {
            let tally = scores::Tally::of(&case, &weights);
            rows.push(json!({
                "level": level.to_string(), "seed": seed, "key_every": case.key_every, "scores": tally.json(),
                "single": scores::singles(&case),
            }));
            pooled.add(tally);
        }
    }
    let weights: Option<Value> = fitted.map(|weights| format!("{weights:#?}").lines().collect());
    println!("{}", json!({ "fitted": weights, "levels": rows, "all": pooled.json() }));
    Ok(())
}

/// Fits the weights. So that a missing part is worth what it should be, parts are hidden from some tracks.
fn fitted() -> Result<Weights, Box<dyn Error>> {
    let mut cases = Vec::new();
    for seed in FIT_SEEDS {
        for level in Level::ALL {
            cases.extend(follow::cases(level, seed, &KEYED)?);
        }
    }
    let mut samples = Vec::new();
    for (k, track) in cases.iter().flat_map(|case| case.tracks.iter().enumerate()) {
        let judged = track.samples.iter().flatten().step_by(3);
        samples.extend(judged.map(|&(parts, is_bad)| (hide(parts, k), is_bad)));
    }
    let (base, parts) = fit::parts(&samples);
    let weights = Weights { base, parts, track: [0.0, 1.0] };
    let worst: Vec<(f64, bool)> = cases.iter().flat_map(|case| scores::worst(case, &weights)).collect();
    Ok(Weights { track: fit::track(&worst), ..weights })
}

/// What a track with this index is allowed to know.
fn hide(mut parts: Parts, k: usize) -> Parts {
    match k % 16 {
        3 | 4 => parts.fb_px = None,
        7 | 8 => parts.ncc = None,
        11 => parts.nbr_px = None,
        12 => parts.jump = None,
        13 => parts = Parts { fb_px: None, jump: None, ..parts },
        _ => {}
    }
    parts
}
