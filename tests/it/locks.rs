//! Two sessions on one project: one writes, and the others are told who and may look.

use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Child, ChildStdin, Stdio};

use honami_tests::Bench;

/// A session of `honami edit` that holds the project until it is closed.
struct Holder {
    child: Child,
    script: ChildStdin,
}

impl Holder {
    /// Begins a session and makes one edit; when this returns, it holds the project.
    fn new(bench: &Bench) -> Self {
        let mut command = bench.command(["edit", "p.honami"]);
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let mut script = child.stdin.take().unwrap();
        script.write_all(b"key 0 3 20 30\n").unwrap();
        let mut answer = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut answer).unwrap();
        assert!(answer.contains("track 0: key-frame at 3"), "{answer}");
        Self { child, script }
    }

    fn close(mut self) {
        drop(self.script);
        assert!(self.child.wait().unwrap().success());
    }
}

#[test]
fn a_second_writer_is_refused_and_told_who_writes() {
    let bench = Bench::tracked();
    let holder = Holder::new(&bench);
    for line in ["track p.honami", "cluster p.honami", "edit p.honami"] {
        let ran = bench.line(line);
        assert_eq!(ran.code, Some(1), "honami {line}: {ran:?}");
        let pid = format!("(pid {})", holder.child.id());
        assert!(ran.stderr.contains(&pid) && ran.stderr.contains("since"), "honami {line}: {}", ran.stderr);
    }
    holder.close();
    bench.json("cluster p.honami");
}

#[test]
fn readers_see_what_is_committed_while_somebody_writes() {
    let bench = Bench::tracked();
    let holder = Holder::new(&bench);
    let edits = bench.log("p.honami", "edit");
    assert_eq!(
        edits.last().unwrap()["label"].as_str().unwrap().split(" (").next(),
        Some("track 0: key-frame at 3")
    );
    let samples = bench.samples("p.honami");
    let key = samples.iter().find(|row| row["source"] == "key").unwrap();
    assert_eq!(["track", "frame", "x", "y"].map(|column| key[column].as_str()), ["0", "3", "20", "30"]);
    bench.json("spectrum p.honami");
    bench.json("compare p.honami");
    holder.close();
}

#[test]
fn a_lock_of_a_killed_session_is_taken_over() {
    let bench = Bench::tracked();
    let mut holder = Holder::new(&bench);
    holder.child.kill().unwrap();
    holder.child.wait().unwrap();
    bench.json("track p.honami --frames 0..3");
    let left: Vec<_> =
        std::fs::read_dir(bench.path("")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(!left.iter().any(|name| name.to_string_lossy().contains("lock")), "{left:?}");
}
