//! Nothing of a plugin outlives honami, however honami ends.

use std::fs;
use std::process::Stdio;
use std::time::{Duration, Instant};

use honami_tests::Bench;

use crate::python::{with_example, with_method};
use crate::sdk::begun;
use crate::trax::{NEEDED, with_server};

/// Far longer than it takes.
const DEADLINE: Duration = Duration::from_secs(120);

/// Command lines of what runs out of its folder: the process of a plugin, its program, and what that has started.
fn at_work(bench: &Bench) -> Vec<String> {
    let folder = bench.path("").to_string_lossy().into_owned();
    let lines = fs::read_dir("/proc").unwrap().flatten();
    let lines = lines.filter_map(|process| fs::read(process.path().join("cmdline")).ok());
    lines
        .map(|line| String::from_utf8_lossy(&line).replace('\0', " "))
        .filter(|line| line.contains(&folder))
        .collect()
}

#[track_caller]
fn wait_until(what: impl Fn() -> bool, told: impl Fn() -> String) {
    let begun = Instant::now();
    while !what() {
        assert!(begun.elapsed() < DEADLINE, "{}", told());
        std::thread::yield_now();
    }
}

/// Tracks with a plugin that never ends once it has left a file `here`, kills honami then, and waits until all is gone.
#[track_caller]
fn assert_ends_with_honami(bench: &Bench, with: &str) {
    fs::write(bench.path("points.csv"), "id,x,y\n1,60,60\n").unwrap();
    fs::create_dir(bench.path("tmp")).unwrap();
    let _said = bench.text("new p.honami clip.y4m");
    let line = format!("track p.honami --points points.csv {with}");
    let mut command = bench.command(line.split(' '));
    let command = command.env("TMPDIR", bench.path("tmp")).stdout(Stdio::null()).stderr(Stdio::null());
    let mut honami = command.spawn().unwrap();
    let is_here = || {
        let rooms = fs::read_dir(bench.path("tmp")).unwrap().flatten();
        rooms.into_iter().any(|room| room.path().join("here").exists())
    };
    wait_until(is_here, || format!("{with} does not get there: {:?}", at_work(bench)));
    assert!(!at_work(bench).is_empty());
    honami.kill().unwrap();
    honami.wait().unwrap();
    wait_until(|| at_work(bench).is_empty(), || format!("{with} lives on: {:?}", at_work(bench)));
}

#[test]
fn a_python_plugin_that_lets_no_thread_run_ends_with_a_killed_honami() {
    let hang = "open(os.environ['TMPDIR'] + '/here', 'w').close(); ctypes.PyDLL(None).pause()";
    let push = format!("    def push(self, frame):\n        import ctypes, os; {hang}\n");
    let Some(bench) = with_example(|text| with_method(&text, &push)) else { return };
    assert_ends_with_honami(&bench, "--with template --plugin template.py");
}

#[test]
fn a_trax_server_at_work_ends_with_a_killed_honami() {
    let bench = with_server();
    let line = "hangs --lang trax -- python3 theirs/server.py memory 4 hangs";
    let Some(plugin) = begun(&bench, line, &NEEDED) else { return };
    assert_ends_with_honami(&bench, &format!("--with hangs --plugin {plugin} --set patience_s=600"));
}
