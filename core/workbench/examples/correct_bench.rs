//! What a correction on a track of 300 frames takes: `cargo xtask bench correct`.
//!
//! The track has key-frames at its ends, and one is placed in the middle: all of it is corrected, and the edit committed.
#![allow(clippy::print_stdout, reason = "a benchmark speaks to a person")]

use std::error::Error;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use honami_model::correct::key_only;
use honami_model::document::Key;
use honami_model::provenance::Value;
use honami_model::track::TrackId;
use honami_workbench::compare::{points_of, read_truth};
use honami_workbench::generate::generate;
use honami_workbench::offer::{self, Granted, Model, Wish};
use honami_workbench::plugins::Values;
use honami_workbench::retrack;
use honami_workbench::session::{Session, SessionOptions};
use honami_workbench::synth::{Level, Settings};
use honami_workbench::track::{self, Area, PointSource, TrackRequest};

const N_FRAMES: u32 = 300;
const N_TRACKS: usize = 9;
/// Longest that a correction may take, milliseconds.
const GOAL_MS: f64 = 100.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let (mut plugin, mut folder) = (PathBuf::from("target/release"), std::env::temp_dir());
    while let Some(word) = words.next() {
        let value = words.next().ok_or_else(|| format!("{word} wants a value"))?;
        match word.as_str() {
            "--plugin" => plugin = value.into(),
            "--folder" => folder = value.into(),
            _ => return Err(format!("unknown option {word}").into()),
        }
    }
    let (mut session, tracks) = scene(&plugin, &folder)?;
    println!(
        "a key-frame in the middle of a track of {N_FRAMES} frames, {N_TRACKS} tracks, goal {GOAL_MS} ms"
    );
    println!("model            median ms  slowest");
    for model in Model::ALL {
        let mut ms = Vec::new();
        for &track in &tracks {
            let begun = Instant::now();
            correct(&mut session, track, model)?;
            ms.push(1e3 * begun.elapsed().as_secs_f64());
            session.project.undo()?;
        }
        print(model.word(), ms);
    }
    let mut ms = Vec::new();
    for &track in &tracks {
        for frame in (30..N_FRAMES - 20).step_by(30) {
            set_key(&mut session, track, frame)?;
        }
        let begun = Instant::now();
        offer::errors(&retrack::study(&session, track)?, N_FRAMES / 2, &())?;
        ms.push(1e3 * begun.elapsed().as_secs_f64());
    }
    print("errors of all", ms);
    Ok(())
}

fn print(name: &str, mut ms: Vec<f64>) {
    ms.sort_by(f64::total_cmp);
    println!("{name:16} {:9.1}  {:7.1}", ms[ms.len() / 2], ms[ms.len() - 1]);
}

/// A project with tracks of two runs, each with key-frames at its ends.
fn scene(
    plugin: &std::path::Path,
    folder: &std::path::Path,
) -> Result<(Session, Vec<TrackId>), Box<dyn Error>> {
    let clip = folder.join("correct.y4m");
    if !clip.exists() {
        generate(&Settings { n_frames: N_FRAMES, ..Settings::benchmark(Level::Calm) }, &clip, &())?;
    }
    let truth = read_truth(&clip.with_extension("truth.csv"), N_FRAMES)?;
    let mut points = points_of(&truth);
    points.retain(|seed| seed.frame == 0 && truth.get(&seed.track).is_some_and(|path| path.positions[0].2));
    points.truncate(N_TRACKS);
    let tracks: Vec<TrackId> = points.iter().map(|seed| seed.track).collect();
    let project = folder.join("correct.honami");
    if project.exists() {
        std::fs::remove_file(&project)?;
    }
    let options = SessionOptions { plugin_paths: vec![plugin.to_owned()], ..SessionOptions::default() };
    let mut session = Session::create(&project, &clip, None, &options)?;
    let wide: Values = [("radius".to_owned(), Value::Int(20))].into_iter().collect();
    for (params, points) in [(wide, PointSource::Given(points)), (Values::default(), PointSource::Existing)] {
        let (plugin, frames, every, area) = ("klt".to_owned(), 0..N_FRAMES, None, Area::Whole);
        let request = TrackRequest { plugin, params, points, frames, every, area };
        let done = track::prepare(&mut session, &request)?.run(&())?;
        track::finish(&mut session, done)?;
    }
    for &track in &tracks {
        set_key(&mut session, track, 0)?;
        set_key(&mut session, track, N_FRAMES - 1)?;
    }
    Ok((session, tracks))
}

/// Where the track is shown, and one pixel beside it.
fn beside(session: &Session, track: TrackId, frame: u32) -> Result<[f32; 2], Box<dyn Error>> {
    let shown = session.project.shown(track)?;
    let sample = shown.as_deref().and_then(|span| span.get(frame)).ok_or("a track that is not shown")?;
    Ok([sample.x + 1.0, sample.y])
}

fn set_key(session: &mut Session, track: TrackId, frame: u32) -> Result<(), Box<dyn Error>> {
    let to = beside(session, track, frame)?;
    at_once(session, track, frame, to, key_only)
}

fn at_once(
    session: &mut Session,
    track: TrackId,
    frame: u32,
    to: [f32; 2],
    correct: offer::AtOnce,
) -> Result<(), Box<dyn Error>> {
    let layers = session.project.layers(track)?.ok_or("a track that is gone")?;
    let correction = correct(&layers.shown(&session.media.clip().times), frame, to)?;
    session.project.commit(correction.transaction)?;
    Ok(())
}

fn correct(session: &mut Session, track: TrackId, model: Model) -> Result<(), Box<dyn Error>> {
    let frame = N_FRAMES / 2;
    let to = beside(session, track, frame)?;
    if let Some(correct) = model.at_once() {
        return at_once(session, track, frame, to, correct);
    }
    let study = Arc::new(retrack::study(session, track)?);
    let wish = Wish { track, frame, model, keys: vec![(frame, Key::set(to[0], to[1]))] };
    match offer::grant(&study, &wish, &())? {
        Granted::Ready(correction) => drop(session.project.commit(correction.transaction)?),
        Granted::Retracked(retracked) => drop(retrack::finish(session, *retracked)?),
    }
    Ok(())
}
