//! Kills the real program at seeded instants while it edits: whatever it answered is there afterwards.
//!
//! The test keeps its own book of the undo tree. After each kill the project must stand where the answers left
//! it, or one edit further: that one was done, and the program died before it could say so.

use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader, Write as _};
use std::process::Stdio;
use std::time::Duration;

use honami_tests::Bench;
use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg32;
use serde_json::Value;

use super::{Plan, assert_whole, spin};

const N_FRAMES: u32 = 40;
/// More edits than are done before the kill.
const SCRIPT: usize = 60;

/// The undo tree as it must be; entry 0 is its root.
#[derive(Clone, Debug, PartialEq)]
struct Book {
    entries: Vec<Entry>,
    head: usize,
}

/// A key-frame of track 0, and its place in the tree.
#[derive(Clone, Debug, PartialEq)]
struct Entry {
    parent: usize,
    /// The child visited last.
    next: Option<usize>,
    frame: u32,
    at: [u32; 2],
}

#[derive(Clone, Copy, Debug)]
enum Step {
    Key { frame: u32, at: [u32; 2] },
    Undo,
    Redo,
}

impl Book {
    /// A project whose only edits placed track 0.
    fn new() -> Self {
        let entry = |parent, next| Entry { parent, next, frame: 0, at: [5, 5] };
        Self { entries: vec![entry(0, Some(1)), entry(0, None)], head: 1 }
    }

    /// A step that can be done; the first entry placed the track and stays.
    fn any_step(&self, rng: &mut Pcg32) -> Step {
        match rng.random_range(0..8) {
            0 | 1 if self.head > 1 => Step::Undo,
            2 if self.entries[self.head].next.is_some() => Step::Redo,
            _ => {
                let at = [rng.random_range(0..160), rng.random_range(0..120)];
                Step::Key { frame: rng.random_range(0..N_FRAMES), at }
            }
        }
    }

    fn take(&mut self, step: Step) {
        match step {
            Step::Undo => self.head = self.entries[self.head].parent,
            Step::Redo => self.head = self.entries[self.head].next.unwrap(),
            Step::Key { frame, at } => {
                let new = self.entries.len();
                self.entries[self.head].next = Some(new);
                self.entries.push(Entry { parent: self.head, next: None, frame, at });
                self.head = new;
            }
        }
    }

    /// The key-frames of track 0.
    fn keys(&self) -> BTreeMap<u32, [u32; 2]> {
        let mut keys = BTreeMap::new();
        let mut at = self.head;
        while at > 0 {
            let entry = &self.entries[at];
            keys.entry(entry.frame).or_insert(entry.at);
            at = entry.parent;
        }
        keys
    }
}

impl Step {
    fn line(self) -> String {
        match self {
            Self::Key { frame, at: [x, y] } => format!("key 0 {frame} {x} {y}\n"),
            Self::Undo => "undo\n".to_owned(),
            Self::Redo => "redo\n".to_owned(),
        }
    }
}

/// Gives a script to the program, kills it so long after so many answers, and returns all that it answered.
fn kill_one(bench: &Bench, script: &str, n_answers: usize, moment: Duration) -> Vec<Value> {
    let mut command = bench.command(["edit", "p.honami", "--json"]);
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut answers = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
    child.stdin.take().unwrap().write_all(script.as_bytes()).unwrap();
    let mut lines: Vec<String> = answers.by_ref().take(n_answers).collect();
    spin(moment);
    child.kill().unwrap();
    child.wait().unwrap();
    // What it had answered before it died is in the pipe still.
    lines.extend(answers);
    lines.iter().filter_map(|line| serde_json::from_str(line).ok()).collect()
}

/// The project as its log and its database have it: labels of all entries, and the head.
fn reopened(bench: &Bench) -> (Vec<String>, usize) {
    let log = bench.json("log p.honami");
    let entries = log["log"].as_array().unwrap().iter().filter(|line| line["what"] == "edit");
    let label = |entry: &Value| entry["label"].as_str().unwrap().to_owned();
    let labels: BTreeMap<u64, String> =
        entries.map(|entry| (entry["id"].as_u64().unwrap(), label(entry))).collect();
    assert_whole(bench, "p.honami");
    (labels.into_values().collect(), log["revision"].as_u64().unwrap() as usize)
}

#[test]
fn what_was_answered_survives_a_kill() {
    let bench = Bench::new();
    bench.synth("clip.y4m", N_FRAMES, "");
    bench.json("new p.honami clip.y4m");
    assert_eq!(bench.edit("p.honami", "add 0 5 5").code, Some(0));
    let plan = Plan::asked(200, 18);
    let (mut book, mut rng) = (Book::new(), Pcg32::seed_from_u64(plan.seed));
    let (mut labels, head) = reopened(&bench);
    assert_eq!((labels.len(), head), (2, 1));
    let (mut n_answered, mut kill) = (0, 0);
    while plan.goes_on(kill) {
        // The book as it is before the first step, after it, and so on.
        let mut books = vec![book.clone()];
        let mut script = String::new();
        for _ in 0..SCRIPT {
            let step = book.any_step(&mut rng);
            book.take(step);
            books.push(book.clone());
            script += &step.line();
        }
        // Some die while they open the project, some while they edit.
        let (n_answers, micros) = match rng.random_range(0..4) {
            0 => (0, rng.random_range(0..30_000)),
            _ => (rng.random_range(1..12), rng.random_range(0..4000)),
        };
        let answers = kill_one(&bench, &script, n_answers, Duration::from_micros(micros));
        n_answered += answers.len();
        for (answer, book) in answers.iter().zip(&books[1..]) {
            assert_eq!(answer["revision"], book.head, "kill {kill}");
        }
        let (found, head) = reopened(&bench);
        let stands_at = |book: &&Book| book.head == head && book.entries.len() == found.len();
        let reached = books[answers.len()..].iter().take(2).find(stands_at);
        book =
            reached.unwrap_or_else(|| panic!("kill {kill}: {} answers, head {head}", answers.len())).clone();
        assert_eq!(found[..labels.len()], labels[..], "kill {kill}: what was there before");
        for answer in answers.iter().filter(|answer| answer["what"] == "edit") {
            assert_eq!(answer["label"], found[answer["id"].as_u64().unwrap() as usize], "kill {kill}");
        }
        labels = found;
        kill += 1;
    }
    plan.tell("editing", kill, n_answered);
    assert!(n_answered > 2 * kill as usize, "the program worked: {n_answered} edits");
    assert_keys(&bench, &book);
}

/// The document is what the edits on the way to the head say.
fn assert_keys(bench: &Bench, book: &Book) {
    let samples = bench.samples("p.honami");
    let number = |row: &honami_tests::Row, column: &str| row[column].parse::<u32>().unwrap();
    let keys = samples.iter().filter(|row| row["source"] == "key");
    let keys = keys.map(|row| (number(row, "frame"), [number(row, "x"), number(row, "y")]));
    assert_eq!(keys.collect::<BTreeMap<_, _>>(), book.keys());
}
