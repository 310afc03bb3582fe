//! Kills a working session at 200 seeded instants: whatever it acknowledged is there afterwards.
//!
//! The victim is this test program itself, started again: it edits, undoes and redoes while a run writes in
//! another thread, and prints a line for each thing that is done. SIGKILL is what `Child::kill` sends.
#![expect(clippy::unwrap_used, reason = "a test program")]

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use honami_model::clip::{Clip, FrameTimes};
use honami_model::document::RunId;
use honami_model::edit::Transaction;
use honami_model::provenance::Provenance;
use honami_model::track::{Quality, Sample, Source, Status, TrackId};
use honami_store::{Access, ClipRecord, Project, RunHead, RunState, RunWriter};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

const KILLS: u64 = 200;
const N_FRAMES: u32 = 4096;
const VICTIM: &str = "HONAMI_CRASH_VICTIM";

/// What the victim said was done.
#[derive(Debug, Default)]
struct Acknowledged {
    /// Label of every entry committed.
    entries: BTreeMap<u32, String>,
    /// Where commits, undos and redos have left the head.
    head: Option<u32>,
    /// Frames appended to its run.
    run: Option<(RunId, u32)>,
}

#[test]
fn what_was_acknowledged_survives_a_kill() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plant.honami");
    let times = FrameTimes::constant(N_FRAMES, 25.0).unwrap();
    let clip = Clip { width: 64, height: 48, times };
    let record = ClipRecord { path: "clip.mp4".into(), sha256: "00".to_owned(), fps_override: None, clip };
    let mut project = Project::create(&path, &record).unwrap();
    project.reserve_tracks(1).unwrap();
    project.commit(Transaction::add_track(TrackId(0), 0, 0.0, 0.0)).unwrap();
    drop(project);
    let mut rng = Pcg32::seed_from_u64(11);
    let mut n_acknowledged = 0;
    for kill in 0..KILLS {
        let acknowledged = kill_one(&path, kill, rng.random_range(0..12), rng.random_range(0..2500));
        n_acknowledged += acknowledged.entries.len();
        check(&path, &acknowledged);
    }
    assert!(n_acknowledged > 500, "the victims worked: {n_acknowledged} edits");
}

/// Starts a victim, waits for so many acknowledgements and a moment, and kills it.
fn kill_one(path: &Path, seed: u64, n_lines: usize, moment_micros: u64) -> Acknowledged {
    let mut victim = Command::new(std::env::current_exe().unwrap())
        .args(["victim", "--exact", "--nocapture", "--test-threads=1"])
        .env(VICTIM, format!("{seed} {}", path.display()))
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut acknowledged = Acknowledged::default();
    let mut lines = BufReader::new(victim.stdout.take().unwrap()).lines();
    let mut said = 0;
    while said <= n_lines {
        said += usize::from(acknowledged.note(&lines.next().unwrap().unwrap()));
    }
    let start = Instant::now();
    while start.elapsed() < Duration::from_micros(moment_micros) {
        std::hint::spin_loop();
    }
    victim.kill().unwrap();
    victim.wait().unwrap();
    // What it had said before it died is in the pipe still; the last line may be cut.
    for line in lines.map_while(Result::ok) {
        acknowledged.note(&line);
    }
    acknowledged
}

impl Acknowledged {
    /// Takes a line down; whether it was an acknowledgement, ended by its full stop.
    fn note(&mut self, line: &str) -> bool {
        let Some(words) = line.strip_suffix('.') else { return false };
        match words.split(' ').collect::<Vec<_>>()[..] {
            ["edit", id, label] => {
                let id = id.parse().unwrap();
                self.entries.insert(id, label.to_owned());
                self.head = Some(id);
            }
            ["head", id] => self.head = Some(id.parse().unwrap()),
            ["run", id, frames] => self.run = Some((RunId(id.parse().unwrap()), frames.parse().unwrap())),
            _ => return false,
        }
        true
    }
}

fn check(path: &Path, acknowledged: &Acknowledged) {
    let project = Project::open(path, Access::Write).unwrap();
    assert_eq!(project.integrity().unwrap(), Vec::<String>::new());
    let history = project.history();
    for (id, label) in &acknowledged.entries {
        assert_eq!(&history.entries()[*id as usize].label, label);
    }
    if let Some(head) = acknowledged.head {
        // At most one more step was committed and not told any more.
        let near = history.path(project.revision(), honami_model::history::EntryId(head)).unwrap();
        assert!(near.len() <= 1, "head is {}, acknowledged was {head}", project.revision());
    }
    // The document is what the entries on the way to the head say.
    let keys = &project.document().track(TrackId(0)).unwrap().keys;
    let mut at = project.revision();
    while let Some(parent) = history.get(at).unwrap().parent {
        assert!(parent.0 == 0 || keys.contains_key(&(at.0 % N_FRAMES)), "entry {at} is in the document");
        at = parent;
    }
    if let Some((run, frames)) = acknowledged.run {
        let info = project.run(run).unwrap();
        assert_eq!(info.state, RunState::Interrupted);
        assert!(info.found.end >= frames, "run {run}: {:?}, acknowledged {frames}", info.found);
        for (track, span) in project.run_tracks(run).unwrap() {
            assert_eq!(span.samples.len(), info.found.len(), "{track} is whole");
        }
    }
}

/// Not a test but the victim: works until it is killed. Without its variable it does nothing.
#[test]
fn victim() {
    let Ok(order) = std::env::var(VICTIM) else { return };
    let (seed, path) = order.split_once(' ').unwrap();
    let mut rng = Pcg32::seed_from_u64(seed.parse().unwrap());
    let mut project = Project::open(Path::new(path), Access::Write).unwrap();
    let writer = project.begin_run(&head(&project)).unwrap();
    let (edits, turn) = (Arc::new(AtomicU32::new(0)), rng.random_range(1..4));
    let watched = Arc::clone(&edits);
    let tracker = std::thread::Builder::new()
        .name("tracker".to_owned())
        .spawn(move || track(writer, || watched.load(Ordering::SeqCst) % turn == 0));
    while !tracker.as_ref().unwrap().is_finished() {
        edits.fetch_add(1, Ordering::SeqCst);
        match rng.random_range(0..8) {
            // The first entry placed the track: it stays.
            0 if project.revision().0 > 1 => {
                drop(project.undo().unwrap());
                say(format_args!("head {}", project.revision()));
            }
            1 => {
                drop(project.redo().unwrap());
                say(format_args!("head {}", project.revision()));
            }
            _ => {
                let frame = project.history().next_id().0 % N_FRAMES;
                let mut edit = Transaction::set_key(TrackId(0), frame, [rng.random(), 1.0], None);
                edit.label = format!("key-{}", rng.random::<u32>());
                let label = edit.label.clone();
                let id = project.commit(edit).unwrap();
                say(format_args!("edit {id} {label}"));
            }
        }
    }
}

fn head(project: &Project) -> RunHead {
    let provenance = Provenance {
        what: "track".to_owned(),
        plugin_id: "org.honami.test".to_owned(),
        plugin_version: "0.1.0".to_owned(),
        plugin_sha256: String::new(),
        abi: (1, 0),
        params: BTreeMap::new(),
        seed: 0,
        input_revision: project.revision().0,
        sandbox: "in process".to_owned(),
        simd: "none".to_owned(),
        date: honami_store::now(),
        honami_version: "0.1.0".to_owned(),
    };
    RunHead { provenance, tracks: [TrackId(0), TrackId(1)].into_iter().collect(), frames: 0..N_FRAMES }
}

/// Appends a chunk whenever the editor is at a turn of ours, up to the end of the clip.
fn track(mut writer: RunWriter, at_turn: impl Fn() -> bool) {
    let sample = Sample {
        x: 1.0,
        y: 2.0,
        status: Status::Tracked,
        source: Source::Tracked,
        quality: Quality::default(),
    };
    let chunk = vec![vec![(TrackId(0), sample), (TrackId(1), sample)]; 16];
    for first in (0..N_FRAMES).step_by(16) {
        while !at_turn() {
            std::thread::yield_now();
        }
        writer.append(first, &chunk).unwrap();
        say(format_args!("run {} {}", writer.run(), first + 16));
    }
    // Left unended: the victim dies with it.
}

/// One line, written at once: two threads acknowledge.
fn say(line: std::fmt::Arguments<'_>) {
    let mut out = std::io::stdout().lock();
    out.write_all(format!("\n{line}.\n").as_bytes()).unwrap();
    out.flush().unwrap();
}
