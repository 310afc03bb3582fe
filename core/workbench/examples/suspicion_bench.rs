//! How well suspicion tells bad samples and tracks, by tracker and wind, on generated clips that it was not fitted on;
//! `cargo xtask bench suspicion`.
//!
//! `[--seed N] [--tracks N] [--fit] [--json]`: tracks of every tracker, each with the others' runs beside some of them,
//! without key-frames and with exact ones every 40 frames; before they were clustered, and after. With `--fit` the
//! weights are fitted first, on the seeds of fitting, and printed as they belong in
//! `core/review/src/suspicion/weights.rs`.
#![allow(clippy::print_stdout, reason = "a benchmark speaks to a person")]

use std::error::Error;
use std::path::PathBuf;

use honami_review::evidence::{Kind, Parts};
use honami_review::suspicion::{Weights, fit, weights};
use honami_workbench::synth::Level;
use scores::Tally;
use serde_json::{Value, json};

#[path = "suspicion_bench/follow.rs"]
mod follow;
#[path = "suspicion_bench/scores.rs"]
mod scores;

use follow::{Case, Place, TRACKERS};

/// Seeds of the clips that the weights are fitted on.
const FIT_SEEDS: [u64; 2] = [101, 102];
/// The clips that they are measured on by default.
const TEST_SEED: u64 = 201;

/// What is asked for.
struct Asked {
    seed: u64,
    fit: bool,
    json: bool,
    place: Place,
}

fn asked() -> Result<Asked, Box<dyn Error>> {
    let place = Place { plugin: PathBuf::from("target/release"), folder: std::env::temp_dir(), tracks: 250 };
    let mut asked = Asked { seed: TEST_SEED, fit: false, json: false, place };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("{word} wants a value"));
        match word.as_str() {
            "--seed" => asked.seed = value()?.parse()?,
            "--tracks" => asked.place.tracks = value()?.parse()?,
            "--fit" => asked.fit = true,
            "--json" => asked.json = true,
            "--plugin" => asked.place.plugin = value()?.into(),
            "--folder" => asked.place.folder = value()?.into(),
            _ => return Err(format!("unknown option {word}").into()),
        }
    }
    if FIT_SEEDS.contains(&asked.seed) {
        return Err(format!("the weights were fitted on clip {}: take another seed", asked.seed).into());
    }
    Ok(asked)
}

fn main() -> Result<(), Box<dyn Error>> {
    let asked = asked()?;
    let mut model = [Kind::Stepwise, Kind::Anchored].map(|kind| *weights(kind));
    if asked.fit {
        let cases = cases(&FIT_SEEDS, &asked.place)?;
        model = [fitted(&cases, Kind::Stepwise), fitted(&cases, Kind::Anchored)];
        for (name, weights) in ["STEPWISE", "ANCHORED"].iter().zip(&model) {
            println!("{}", source(name, weights));
        }
    }
    let mut cases = cases(&[asked.seed], &asked.place)?;
    let grouped = tallies(&cases, &model);
    let samples = cases.iter_mut().flat_map(|case| &mut case.tracks).flat_map(|track| &mut track.samples);
    samples.flatten().for_each(|(parts, _)| parts.group_px = None);
    for (what, tallies) in [("before they are grouped", tallies(&cases, &model)), ("grouped", grouped)] {
        print(&asked, what, &tallies);
    }
    Ok(())
}

/// The scores of every case, by the weights of stepwise and of anchored trackers.
fn tallies(cases: &[Case], model: &[Weights; 2]) -> Vec<(Level, &'static str, Tally)> {
    let of = |case: &Case| Tally::of(case, &model[usize::from(case.kind() == Kind::Anchored)]);
    cases.iter().map(|case| (case.level, case.tracker, of(case))).collect()
}

fn cases(seeds: &[u64], place: &Place) -> Result<Vec<Case>, Box<dyn Error>> {
    let mut cases = Vec::new();
    for &seed in seeds {
        for level in Level::ALL {
            cases.extend(follow::cases(level, seed, place)?);
        }
    }
    Ok(cases)
}

/// Fits the weights of a kind. So that a missing part is worth what it should be, parts are hidden from some tracks.
fn fitted(cases: &[Case], kind: Kind) -> Weights {
    let of_kind = || cases.iter().filter(|case| case.kind() == kind);
    let mut samples = Vec::new();
    for (k, track) in of_kind().flat_map(|case| case.tracks.iter().enumerate()) {
        let judged = track.samples.iter().flatten().step_by(3);
        samples.extend(judged.map(|&(parts, is_bad)| (hide(parts, k), is_bad)));
    }
    let (base, parts) = fit::parts(&samples);
    let weights = Weights { base, parts, track: [0.0, 1.0] };
    let worst: Vec<(f64, bool)> = of_kind().flat_map(|case| scores::worst(case, &weights)).collect();
    Weights { track: fit::track(&worst), ..weights }
}

/// What a track with this index is allowed to know; every other one is in no group, as before clustering.
fn hide(mut parts: Parts, k: usize) -> Parts {
    parts.group_px = parts.group_px.filter(|_| k.is_multiple_of(2));
    match k % 16 {
        3 => parts.fb_px = None,
        7 | 8 => parts.ncc = None,
        9 => parts.own_ncc = None,
        11 => parts.nbr_px = None,
        12 => parts.jump = None,
        13 => parts = Parts { fb_px: None, jump: None, ..parts },
        _ => {}
    }
    parts
}

/// Weights as they are written in the program.
fn source(name: &str, weights: &Weights) -> String {
    let part = |part: &honami_review::suspicion::Weight| {
        format!("        weight({:.4}, {:.4}, {:.4}),\n", part.slope, part.missing, part.ordinary)
    };
    let parts: String = weights.parts.iter().map(part).collect();
    let [offset, slope] = weights.track;
    format!(
        "pub(super) const {name}: Weights = Weights {{\n    base: {:.4},\n    parts: [\n{parts}    ],\n    \
         track: [{offset:.4}, {slope:.4}],\n}};",
        weights.base
    )
}

/// A row for every tracker in every wind, for every wind, for every tracker, and for all.
fn print(asked: &Asked, what: &str, tallies: &[(Level, &str, Tally)]) {
    let sum = |level: Option<Level>, tracker: Option<&str>| {
        let mut sum = Tally::default();
        let is_it = |of: &&(Level, &str, Tally)| {
            level.is_none_or(|level| of.0 == level) && tracker.is_none_or(|tracker| of.1 == tracker)
        };
        tallies.iter().filter(is_it).for_each(|(_, _, tally)| sum.add(tally));
        sum
    };
    let levels = || Level::ALL.into_iter().map(Some);
    let trackers = || TRACKERS.into_iter().map(Some);
    let each = trackers().flat_map(|tracker| levels().map(move |level| (level, tracker)));
    let rows = each.chain(levels().map(|level| (level, None))).chain(trackers().map(|t| (None, t)));
    let rows: Vec<Value> = rows
        .chain([(None, None)])
        .map(|(level, tracker)| {
            let wind = level.map_or_else(|| "all".to_owned(), |level| level.to_string());
            json!({ "tracker": tracker.unwrap_or("all"), "wind": wind, "scores": sum(level, tracker).json() })
        })
        .collect();
    let (opened, ideal) = sum(None, None).opened_where(scores::BAD_SHARE);
    if asked.json {
        println!(
            "{}",
            json!({ "seed": asked.seed, "tracks": what, "rows": rows, "opened_for_95_where_43": [opened, ideal] })
        );
        return;
    }
    println!("seed {}, tracks {what}; one is bad when a visible sample is more than 8 px off", asked.seed);
    println!(
        "tracker       wind   tracks   bad | AUC sample  track | calibration error | to see 95 % of the bad"
    );
    for row in &rows {
        let word = |key: &str| row[key].as_str().unwrap_or_default().to_owned();
        let of = |key: &str| row["scores"][key].as_f64().unwrap_or(f64::NAN);
        println!(
            "{:13} {:6} {:6} {:3.0} % | {:10.3} {:6.3} | {:8.3} {:8.3} | open {:3.0} %, at best {:3.0} %",
            word("tracker"),
            word("wind"),
            of("n_tracks"),
            100.0 * of("bad_tracks"),
            of("sample_auc"),
            of("track_auc"),
            of("sample_ece"),
            of("track_ece"),
            100.0 * of("opened_for_95"),
            100.0 * of("opened_for_95_ideal")
        );
    }
    println!(
        "all tracks, weighted so that {:.0} % are bad: to see 95 % of the bad open {:.1} %, at best {:.1} %",
        100.0 * scores::BAD_SHARE,
        100.0 * opened,
        100.0 * ideal
    );
}
