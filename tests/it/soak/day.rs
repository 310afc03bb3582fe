//! A long day in one session: 10,000 undos and redos, and thousands of corrections; what it takes stays bounded.

use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

use honami_tests::Bench;

use super::{assert_whole, is_long, told};

/// What a session may have grown by from its first hundred steps to its end.
const MORE_KB: u64 = 64 * 1024;
/// Bytes of the file that one correction may take.
const BYTES_AN_EDIT: u64 = 1500;

/// A session of `honami edit`, one step after the other.
struct Session {
    child: Child,
    script: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Session {
    fn begin(bench: &Bench) -> Self {
        let mut command = bench.command(["edit", "p.honami"]);
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let (script, answers) = (child.stdin.take().unwrap(), child.stdout.take().unwrap());
        Self { child, script, answers: BufReader::new(answers) }
    }

    /// Does a step, and waits until it is done.
    #[track_caller]
    fn step(&mut self, line: &str) {
        self.script.write_all(format!("{line}\n").as_bytes()).unwrap();
        let mut answer = String::new();
        self.answers.read_line(&mut answer).unwrap();
        assert!(!answer.is_empty(), "no answer to {line}");
    }

    /// Memory that it has, kB, and descriptors that are open.
    fn takes(&self) -> (u64, usize) {
        let process = format!("/proc/{}", self.child.id());
        let status = fs::read_to_string(format!("{process}/status")).unwrap();
        let resident = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
        let kilobytes = resident.trim().trim_end_matches(" kB").parse().unwrap();
        (kilobytes, fs::read_dir(format!("{process}/fd")).unwrap().count())
    }

    fn end(mut self) {
        drop(self.script);
        assert!(self.child.wait().unwrap().success());
    }
}

#[test]
fn a_long_day_takes_bounded_memory_descriptors_and_disk() {
    let (n_edits, n_turns) = if is_long() { (20_000, 5_000) } else { (1_000, 500) };
    let bench = Bench::tracked();
    let size = || fs::metadata(bench.path("p.honami")).unwrap().len();
    let mut session = Session::begin(&bench);
    let correct = |session: &mut Session, k: u32| {
        session.step(&format!("key {} {} {} {}", k % 5, k * 7 % 40, 10 + k % 140, 10 + k % 100));
    };
    (0..100).for_each(|k| correct(&mut session, k));
    let (begun, begun_bytes) = (session.takes(), size());
    (100..n_edits).for_each(|k| correct(&mut session, k));
    let (edited, edited_bytes) = (session.takes(), size());
    for step in ["undo", "redo"].into_iter().cycle().take(2 * n_turns) {
        session.step(step);
    }
    let (ended, ended_bytes) = (session.takes(), size());
    session.end();
    let per_edit = (edited_bytes - begun_bytes) / u64::from(n_edits - 100);
    told(&format!(
        "a day: {n_edits} corrections, {} undos and redos: resident {} kB after 100, {} kB after all, {} kB at the \
         end; descriptors {} to {}; {per_edit} bytes of file a correction, {} for all undos and redos",
        2 * n_turns,
        begun.0,
        edited.0,
        ended.0,
        begun.1,
        ended.1,
        ended_bytes - edited_bytes
    ));
    assert!(ended.0 < begun.0 + MORE_KB, "{begun:?} to {ended:?}");
    assert_eq!((begun.1, begun.1), (edited.1, ended.1), "descriptors");
    assert!(
        per_edit < BYTES_AN_EDIT && ended_bytes == edited_bytes,
        "{per_edit}, {edited_bytes} to {ended_bytes}"
    );
    assert_whole(&bench, "p.honami");
}
