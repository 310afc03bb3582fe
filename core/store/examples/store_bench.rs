//! Prints how long the store takes on large projects. `cargo run --release -p honami-store --example store_bench`
//!
//! First what a project of 2,000 tracks x 10,000 frames takes, beside its goals. The numbers are
//! wall clock on this machine's disk; nothing is asserted.
#![expect(clippy::print_stdout, reason = "a benchmark prints")]

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use honami_model::clip::{Clip, FrameTimes};
use honami_model::edit::Transaction;
use honami_model::hierarchy::{Dendrogram, Merge};
use honami_model::history::EntryId;
use honami_model::provenance::Provenance;
use honami_model::track::{Quality, Sample, Source, Status, TrackId};
use honami_store::{Access, ClipRecord, Clustering, Project, RunHead};

type Outcome<T> = Result<T, Box<dyn Error>>;

/// Tracks and frames of the largest project that there are goals for, and the edits in it.
const LARGE: (u32, u32, u32) = (2_000, 10_000, 1_000);
/// Turns of what is measured more than once.
const TURNS: usize = 7;

fn main() -> Outcome<()> {
    // A process of its own, so that its memory is its own, too.
    if let [word, path] = &std::env::args().skip(1).collect::<Vec<_>>()[..] {
        return if word == "write" { large(Path::new(path)) } else { goals(Path::new(path)) };
    }
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("large.honami");
    println!("{} tracks x {} frames", LARGE.0, LARGE.1);
    for word in ["write", "goals"] {
        let done = Command::new(std::env::current_exe()?).arg(word).arg(&path).status()?;
        if !done.success() {
            return Err(format!("{word} ended with {done}").into());
        }
    }
    for (n_tracks, n_frames, n_edits) in [(135, 378, 1000), (10_000, 400, 1000), (2_000, 500, 100_000)] {
        println!("\n{n_tracks} tracks x {n_frames} frames, {n_edits} edits");
        let path = folder.path().join(format!("{n_tracks}.honami"));
        write(&path, n_tracks, n_frames, n_edits)?;
        read(&path)?;
    }
    Ok(())
}

fn write(path: &Path, n_tracks: u32, n_frames: u32, n_edits: u32) -> Outcome<()> {
    let clip = Clip { width: 1280, height: 720, times: FrameTimes::constant(n_frames, 25.0)? };
    let record = ClipRecord { path: "clip.mp4".into(), sha256: String::new(), fps_override: None, clip };
    let mut project = timed("create", || Project::create(path, &record))?;
    let numbers = project.reserve_tracks(n_tracks)?;
    let provenance = provenance();
    let clustering = Clustering {
        provenance: provenance.clone(),
        tracks: numbers.clone().map(TrackId).collect(),
        dendrogram: halves(n_tracks)?,
        cut: 8,
        outlier_frames: Vec::new(),
        notes: Vec::new(),
    };
    let tracks = numbers.clone().map(TrackId).collect();
    let mut writer = project.begin_run(&RunHead { provenance, tracks, frames: 0..n_frames })?;
    let frames: Vec<Vec<_>> = (0..n_frames)
        .map(|frame| numbers.clone().map(|track| (TrackId(track), sample(track, frame))).collect())
        .collect();
    timed("run: append all chunks", || {
        (0..n_frames)
            .step_by(64)
            .zip(frames.chunks(64))
            .try_for_each(|(first, chunk)| writer.append(first, chunk))
    })?;
    let run = timed("run: finish (compact)", || writer.finish())?;
    let found = project.run(run)?.tracks;
    timed("show the run", || project.commit(Transaction::show_run(run, found)))?;
    timed(&format!("commit {n_edits} edits"), || {
        (0..n_edits).try_for_each(|edit| {
            let track = TrackId(edit % n_tracks);
            let key = Transaction::set_key(track, edit * 7 % n_frames, [edit as f32 * 0.37, 2.0], None);
            project.commit(key).map(drop)
        })
    })?;
    let mut all = timed("shown tracks, first time", || project.shown_all())?;
    all.truncate(0);
    let edit = Transaction::set_key(TrackId(0), 3, [1.0, 2.0], None);
    timed("one edit and shown tracks again", || {
        project.commit(edit)?;
        project.shown_all()
    })?;
    timed("undo", || project.undo())?;
    let clustering = project.save_clustering(&clustering)?;
    project.commit(Transaction::show_clustering(clustering, 8))?;
    timed("one cut, tracks and groups again", || {
        project.commit(Transaction::set_cut(9))?;
        project.shown_all()?;
        project.grouping()
    })?;
    println!("{:>34} {:9.1} MB", "file", std::fs::metadata(path)?.len() as f64 / 1e6);
    Ok(())
}

/// Makes the large project, a chunk of frames at a time.
fn large(path: &Path) -> Outcome<()> {
    let (n_tracks, n_frames, n_edits) = LARGE;
    let clip = Clip { width: 1280, height: 720, times: FrameTimes::constant(n_frames, 25.0)? };
    let record = ClipRecord { path: "clip.mp4".into(), sha256: String::new(), fps_override: None, clip };
    let mut project = Project::create(path, &record)?;
    let numbers = project.reserve_tracks(n_tracks)?;
    let tracks = numbers.clone().map(TrackId).collect();
    let mut writer = project.begin_run(&RunHead { provenance: provenance(), tracks, frames: 0..n_frames })?;
    for first in (0..n_frames).step_by(50) {
        let frames = first..n_frames.min(first + 50);
        let row = |frame| numbers.clone().map(|track| (TrackId(track), sample(track, frame))).collect();
        writer.append(first, &frames.map(row).collect::<Vec<_>>())?;
    }
    let run = timed("run: finish (compact)", || writer.finish())?;
    let found = project.run(run)?.tracks;
    project.commit(Transaction::show_run(run, found))?;
    (0..n_edits).try_for_each(|edit| project.commit(key(edit, n_tracks, n_frames)).map(drop))?;
    println!("{:>34} {:9.1} MB", "file", std::fs::metadata(path)?.len() as f64 / 1e6);
    println!("{:>34} {:9.1} MB", "peak memory of who wrote it", peak_mb()?);
    Ok(())
}

/// What there are goals for: to open it, to commit an edit, and the memory of it all.
fn goals(path: &Path) -> Outcome<()> {
    let ms = |start: Instant| start.elapsed().as_secs_f64() * 1e3;
    let mut open = Vec::new();
    for _ in 0..TURNS {
        let start = Instant::now();
        drop(Project::open(path, Access::Write)?);
        open.push(ms(start));
    }
    let mut project = Project::open(path, Access::Write)?;
    let mut commit = Vec::new();
    for edit in 0..1_000 {
        let start = Instant::now();
        project.commit(key(edit + 7, LARGE.0, LARGE.1))?;
        // What the screen shows next.
        project.shown(TrackId((edit + 7) % LARGE.0))?;
        commit.push(ms(start));
    }
    println!("{:>34} {:>10} {:>10} {:>10} {:>10}   goal", "", "least", "p50", "p99", "most");
    for (what, times, goal) in
        [("open, ms", &mut open, "1500"), ("commit and show a track, ms", &mut commit, "p99 20")]
    {
        times.sort_by(f64::total_cmp);
        let at = |share: f64| times[((times.len() - 1) as f64 * share).round() as usize];
        println!("{what:>34} {:10.2} {:10.2} {:10.2} {:10.2}   {goal}", at(0.0), at(0.5), at(0.99), at(1.0));
    }
    println!("{:>34} {:10.1} MB, goal 500", "peak memory of both", peak_mb()?);
    let shown = project.shown_all()?;
    println!("{:>34} {:10.1} MB, {} tracks", "peak memory, all tracks shown", peak_mb()?, shown.len());
    Ok(())
}

fn key(edit: u32, n_tracks: u32, n_frames: u32) -> Transaction {
    Transaction::set_key(TrackId(edit % n_tracks), edit * 7 % n_frames, [edit as f32 * 0.37, 2.0], None)
}

/// The most memory that this process ever had, megabytes.
fn peak_mb() -> Outcome<f64> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes: f64 = peak.ok_or("no VmHWM")?.trim().trim_end_matches(" kB").parse()?;
    Ok(kilobytes * 1.024e-3)
}

fn read(path: &Path) -> Outcome<()> {
    let mut project = timed("open", || Project::open(path, Access::Write))?;
    timed("open for reading", || Project::open(path, Access::Read))?;
    timed("one shown track", || project.shown(TrackId(7)))?;
    timed("shown tracks, first time", || project.shown_all())?;
    timed("shown tracks again", || project.shown_all())?;
    timed("undo everything", || project.jump(EntryId::ROOT))?;
    Ok(())
}

/// Where the run is from.
fn provenance() -> Provenance {
    Provenance {
        what: "track".to_owned(),
        plugin_id: "org.honami.klt".to_owned(),
        plugin_version: "0.1.0".to_owned(),
        plugin_sha256: String::new(),
        abi: (1, 0),
        params: BTreeMap::new(),
        seed: 0,
        input_revision: 0,
        sandbox: "in process".to_owned(),
        simd: "none".to_owned(),
        date: honami_store::now(),
        honami_version: "0.1.0".to_owned(),
    }
}

/// A hierarchy in which the first two that are left join, again and again.
fn halves(n_leaves: u32) -> Outcome<Dendrogram> {
    let mut sizes = vec![1; n_leaves as usize];
    let mut merges = Vec::new();
    for row in 0..n_leaves - 1 {
        let [a, b] = [2 * row, 2 * row + 1];
        let size = sizes[a as usize] + sizes[b as usize];
        sizes.push(size);
        merges.push(Merge { a, b, height: f64::from(row), size });
    }
    Ok(Dendrogram::new(n_leaves, merges)?)
}

fn sample(track: u32, frame: u32) -> Sample {
    let quality = Quality { fb_px: Some(0.25), ncc: Some(0.9) };
    let (x, y) = ((track * 7 % 1280) as f32 + (frame as f32 * 0.1).sin(), (track * 3 % 720) as f32);
    Sample { x, y, status: Status::Tracked, source: Source::Tracked, quality }
}

fn timed<T, E>(what: &str, work: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
    let start = Instant::now();
    let done = work();
    println!("{what:>34} {:9.2} ms", start.elapsed().as_secs_f64() * 1e3);
    done
}
