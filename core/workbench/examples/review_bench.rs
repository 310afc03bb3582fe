//! Keys per track that a simulated reviewer needs, a row a correction; `cargo xtask bench review`.
//!
//! `[--tracks N] [--seed S] [--level calm|wind|storm] [--tolerance PX] [--frames T] [--with TRACKER]… [--model MODEL]…
//! [--pick worst|first] [--json]`; each model works in a copy of the same project, on the same tracks, with the same
//! trembling hand. The tracker named first is reviewed; what the others found are candidates, too.
#![allow(clippy::print_stdout, reason = "a benchmark speaks to a person")]

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use honami_model::edit::Transaction;
use honami_model::track::TrackId;
use honami_motion::accuracy::TruePath;
use honami_workbench::compare::{Truth, points_of, read_truth};
use honami_workbench::generate::generate;
use honami_workbench::offer;
use honami_workbench::plugins::Values;
use honami_workbench::session::{Session, SessionOptions};
use honami_workbench::simulate::{Habits, Model, Pick, Taken, review};
use honami_workbench::synth::{Level, Settings};
use honami_workbench::track::{self, Area, PointSource, TrackRequest};

/// More key-frames than anybody places on one track.
const MAX_KEYS: u32 = 61;

/// The tracker that is reviewed, and those whose runs are candidates beside it.
const TRACKERS: [&str; 3] = ["anchored", "klt", "lucas-kanade"];

/// What is asked for.
struct Asked {
    tracks: usize,
    seed: u64,
    levels: Vec<Level>,
    tolerance_px: f64,
    n_frames: u32,
    with: Vec<String>,
    /// Those of the models that are tried; empty: all.
    models: Vec<String>,
    picks: Vec<Pick>,
    json: bool,
    plugin: PathBuf,
    folder: PathBuf,
}

fn asked() -> Result<Asked, Box<dyn Error>> {
    let mut asked = Asked {
        tracks: 100,
        seed: 1,
        levels: vec![Level::Calm, Level::Wind],
        tolerance_px: 4.0,
        n_frames: 150,
        with: Vec::new(),
        models: Vec::new(),
        picks: vec![Pick::Worst, Pick::First],
        json: false,
        plugin: PathBuf::from("target/release"),
        folder: std::env::temp_dir(),
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("{word} wants a value"));
        match word.as_str() {
            "--tracks" => asked.tracks = value()?.parse()?,
            "--seed" => asked.seed = value()?.parse()?,
            "--level" => asked.levels = vec![value()?.parse()?],
            "--tolerance" => asked.tolerance_px = value()?.parse()?,
            "--frames" => asked.n_frames = value()?.parse()?,
            "--with" => asked.with.push(value()?),
            "--model" => asked.models.push(value()?),
            "--pick" => {
                asked.picks = vec![if value()? == "first" { Pick::First } else { Pick::Worst }];
            }
            "--plugin" => asked.plugin = value()?.into(),
            "--folder" => asked.folder = value()?.into(),
            "--json" => asked.json = true,
            _ => return Err(format!("unknown option {word}").into()),
        }
    }
    if asked.with.is_empty() {
        asked.with = TRACKERS.map(str::to_owned).to_vec();
    }
    Ok(asked)
}

fn main() -> Result<(), Box<dyn Error>> {
    let asked = asked()?;
    for &level in &asked.levels {
        let begun = std::time::Instant::now();
        let scene = scene(&asked, level)?;
        let rows = rows(&asked, &scene)?;
        print(&asked, level, scene.chosen.len(), &rows);
        if !asked.json {
            println!("{:.0} s", begun.elapsed().as_secs_f64());
        }
    }
    Ok(())
}

/// A project with tracks, and the truth of those that are reviewed.
struct Scene {
    project: PathBuf,
    chosen: Vec<(TrackId, TruePath)>,
}

fn options(asked: &Asked) -> SessionOptions {
    SessionOptions { plugin_paths: vec![asked.plugin.clone()], ..SessionOptions::default() }
}

/// Renders the clip, gives the tracker the leaves that can be seen at first, and chooses evenly among them.
fn scene(asked: &Asked, level: Level) -> Result<Scene, Box<dyn Error>> {
    let folder = asked.folder.join(format!("{level}-{}-{}", asked.seed, asked.n_frames));
    fs::create_dir_all(&folder)?;
    let clip = folder.join("clip.y4m");
    let settings = Settings { seed: asked.seed, n_frames: asked.n_frames, ..Settings::benchmark(level) };
    if !clip.exists() {
        generate(&settings, &clip, &())?;
    }
    let truth: Truth = read_truth(&clip.with_extension("truth.csv"), asked.n_frames)?;
    let at_first = |track: TrackId| truth.get(&track).filter(|path| path.positions[0].2);
    let mut points = points_of(&truth);
    points.retain(|seed| seed.frame == 0 && at_first(seed.track).is_some());
    let step = (points.len() as f64 / asked.tracks.max(1) as f64).max(1.0);
    let chosen = (0..asked.tracks).map(|k| (k as f64 * step) as usize).filter_map(|k| points.get(k).copied());
    let seeds: Vec<_> = chosen.collect();
    let project = folder.join("review.honami");
    remove(&project)?;
    let mut session = Session::create(&project, &clip, None, &options(asked))?;
    // What is shown is the topmost run.
    for (k, plugin) in asked.with.iter().rev().enumerate() {
        let points = if k == 0 { PointSource::Given(seeds.clone()) } else { PointSource::Existing };
        let (plugin, params) = (plugin.clone(), Values::default());
        let (frames, every, area) = (0..asked.n_frames, None, Area::Whole);
        let request = TrackRequest { plugin, params, points, frames, every, area };
        let done = track::prepare(&mut session, &request)?.run(&())?;
        track::finish(&mut session, done)?;
    }
    let chosen = seeds.iter().filter_map(|seed| Some((seed.track, truth.get(&seed.track)?.clone())));
    Ok(Scene { project, chosen: chosen.collect() })
}

fn remove(project: &Path) -> std::io::Result<()> {
    if project.exists() { fs::remove_file(project) } else { Ok(()) }
}

/// What one way of working has taken on every track.
struct Row {
    model: Model,
    pick: Pick,
    /// From what a tracker had found, or from nothing but key-frames.
    tracked: bool,
    taken: Vec<Taken>,
}

/// Every model with every pick; key-frames with lines and curves also where nobody has tracked.
fn rows(asked: &Asked, scene: &Scene) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut rows = Vec::new();
    for &pick in &asked.picks {
        let bare = [Model::Linear, Model::Offered(offer::Model::Hermite)].map(|model| (model, false));
        let all = bare.into_iter().chain(Model::ALL.map(|model| (model, true)));
        let is_wanted =
            |model: Model| asked.models.is_empty() || asked.models.iter().any(|name| name == model.name());
        for (model, tracked) in all.filter(|(model, _)| is_wanted(*model)) {
            rows.push(row(asked, scene, model, pick, tracked)?);
        }
    }
    Ok(rows)
}

fn row(asked: &Asked, scene: &Scene, model: Model, pick: Pick, tracked: bool) -> Result<Row, Box<dyn Error>> {
    let copy = scene.project.with_file_name("copy.honami");
    remove(&copy)?;
    fs::copy(&scene.project, &copy)?;
    let mut session = Session::open(&copy, &options(asked))?;
    if !tracked {
        let runs: Vec<_> = session.project.document().runs().iter().map(|shown| shown.run).collect();
        for run in runs {
            session.project.commit(Transaction::hide_run(run))?;
        }
    }
    let habits = Habits {
        model,
        pick,
        tolerance_px: asked.tolerance_px,
        noise_px: 0.5,
        max_keys: MAX_KEYS,
        seed: asked.seed,
    };
    let taken = scene.chosen.iter().map(|(track, truth)| review(&mut session, *track, truth, &habits));
    Ok(Row { model, pick, tracked, taken: taken.collect::<Result<_, _>>()? })
}

/// Numbers of a column.
struct Told {
    mean: f64,
    median: u32,
    p90: u32,
    unfinished: f64,
    at_once: f64,
    ms: f64,
    /// Keys pressed a track that was not right at once, median: with the mouse, and with nudges.
    strokes: [u32; 2],
}

fn told(row: &Row) -> Told {
    let n = row.taken.len().max(1) as f64;
    let mut keys: Vec<u32> = row.taken.iter().map(|taken| taken.n_keys).collect();
    keys.sort_unstable();
    let at =
        |share: f64| keys.get(((keys.len() as f64 - 1.0) * share).round() as usize).copied().unwrap_or(0);
    let total: u32 = keys.iter().sum();
    let share = |what: fn(&Taken) -> bool| row.taken.iter().filter(|taken| what(taken)).count() as f64 / n;
    let seconds: f64 = row.taken.iter().map(|taken| taken.seconds).sum();
    let corrected = &keys[keys.partition_point(|n| *n == 0)..];
    let median = corrected.get(corrected.len() / 2).copied().unwrap_or(0);
    // The jump is the program's; `m`, a click or at most 6 nudges, Enter; at the end one Enter accepts.
    let strokes = [1, 6].map(|place| median * (2 + place) + 1);
    Told {
        mean: f64::from(total) / n,
        median: at(0.5),
        p90: at(0.9),
        unfinished: share(|taken| !taken.is_right),
        at_once: share(|taken| taken.is_right && taken.n_keys == 0),
        ms: 1e3 * seconds / f64::from(total.max(1)),
        strokes,
    }
}

fn print(asked: &Asked, level: Level, n_tracks: usize, rows: &[Row]) {
    let linear = |pick: Pick| {
        let is_it = |row: &&Row| row.model == Model::Linear && row.pick == pick && !row.tracked;
        rows.iter().find(is_it).map_or(1.0, |row| told(row).mean)
    };
    if asked.json {
        for row in rows {
            let told = told(row);
            println!(
                "{{\"level\":\"{level}\",\"seed\":{},\"tracks\":{n_tracks},\"tolerance_px\":{},\"from\":\"{}\",\
                 \"model\":\"{}\",\"pick\":\"{:?}\",\"mean\":{:.3},\"median\":{},\"p90\":{},\"of_linear\":{:.3},\"unfinished\":{:.3},\
                 \"at_once\":{:.3},\"ms\":{:.2},\"strokes_mouse\":{},\"strokes_nudges\":{}}}",
                asked.seed,
                asked.tolerance_px,
                if row.tracked { "runs" } else { "keys" },
                row.model.name(),
                row.pick,
                told.mean,
                told.median,
                told.p90,
                told.mean / linear(row.pick),
                told.unfinished,
                told.at_once,
                told.ms,
                told.strokes[0],
                told.strokes[1]
            );
        }
        return;
    }
    println!(
        "{level}, seed {}: {n_tracks} tracks of {} frames, tolerance {} px, hand 0.5 px; trackers, the one reviewed first: {}",
        asked.seed,
        asked.n_frames,
        asked.tolerance_px,
        asked.with.join(", ")
    );
    println!(
        "from  model      frame   mean median  p90  of linear  unfinished  at once  ms/corr  strokes mouse|nudges"
    );
    for row in rows {
        let told = told(row);
        println!(
            "{:5} {:10} {:5} {:6.1} {:6} {:4} {:10.2} {:10.0} % {:6.0} % {:8.1} {:10} | {}",
            if row.tracked { "runs" } else { "keys" },
            row.model.name(),
            format!("{:?}", row.pick).to_lowercase(),
            told.mean,
            told.median,
            told.p90,
            told.mean / linear(row.pick),
            100.0 * told.unfinished,
            100.0 * told.at_once,
            told.ms,
            told.strokes[0],
            told.strokes[1]
        );
    }
}
