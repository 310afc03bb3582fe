//! What a plugin can do wrong, each through the real program: it is told in one line, what was tracked before is kept, the
//! project is whole, no process is left, and nothing lies where it should not.

use std::collections::BTreeSet;
use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;

use honami_tests::{Bench, ran, root, what_is_built};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::process::{Pid, PidfdFlags, Signal, kill_process, pidfd_open};

use crate::isolated::{compile, has_cc, is_shut_in, project};

/// A plugin, what is said of it, how the program ends, and in which frames a point was seen (1) or lost (0).
type Row = (&'static str, Made, &'static str, i32, &'static str);

/// How a library with a fault is made.
#[derive(Clone, Copy)]
enum Made {
    /// `core/host/tests/bad/bad.c` with these flags.
    C(&'static [&'static str]),
    /// A part of a good one.
    Cut,
    /// In Rust, of the zoo.
    Panics,
}

use Made::{C, Cut, Panics};

/// What is wrong in every frame is so from frame 2 on.
const FROM: &str = "-DFROM=2";
/// What a constructor writes, were it let.
const WRITTEN: &str = "-DCONSTRUCTOR=\"written\"";

/// Those that take longest come first.
const ROWS: &[Row] = &[
    ("infinite loop", C(&["-DFAULT=LOOPS"]), "it was ended after 10 s without a sign of life", 0, "11011111"),
    (
        "endless output",
        C(&["-DFAULT=FLOODS"]),
        "it was ended after 10 s without a sign of life",
        0,
        "11011111",
    ),
    (
        "sleep, from frame 1 on",
        C(&["-DFAULT=SLEEPS"]),
        "it was ended after 10 s without a sign of life",
        0,
        "1011111",
    ),
    ("sleep", C(&["-DFAULT=SLEEPS"]), "it was ended after 10 s without a sign of life", 0, "11011111"),
    ("segfault", C(&["-DFAULT=SEGFAULT"]), "started again at frame 2: it died of SIGSEGV", 0, "11011111"),
    (
        "last words",
        C(&["-DFAULT=SPEAKS"]),
        "it died of SIGSEGV (it used memory that is not its own); it last printed: no weights for level 2",
        0,
        "11011111",
    ),
    ("abort", C(&["-DFAULT=ABORTS"]), "started again at frame 2: it died of SIGABRT", 0, "11011111"),
    ("exit", C(&["-DFAULT=EXITS"]), "frame 2: it ended its process with status 0", 0, "11011111"),
    ("fork", C(&["-DFAULT=FORKS"]), "started again at frame 2: it died of SIGSEGV", 0, "11011111"),
    ("reads past a frame", C(&["-DFAULT=READS_ON"]), "frame 2: it died of SIGSEGV", 0, "11011111"),
    ("dies in every frame", C(&["-DFAULT=WITHERS"]), "has failed three times within ten minutes", 1, "1100"),
    ("panic", Panics, "the wheel came off in push (a fault in the plugin)", 1, ""),
    ("escape codes", C(&["-DFAULT=ESCAPES"]), "2 tracks, frames 0-7", 0, "11111111"),
    ("NaN", C(&["-DFAULT=NAN_POSITION", FROM]), "put point 1 at (20.5, NaN)", 1, "11"),
    ("id not seeded", C(&["-DFAULT=UNKNOWN_ID", FROM]), "committed point 999 in frame 2", 1, "11"),
    ("rows over capacity", C(&["-DFAULT=OVERCOMMIT", FROM]), "committed 3 rows of honami.points/1", 1, "11"),
    ("writes past a column", C(&["-DFAULT=PAST_THE_END", FROM]), "wrote past the end of column x", 1, "11"),
    ("endless rows", C(&["-DFAULT=TOO_MUCH", FROM]), "the host gives nothing (no memory)", 1, "11"),
    ("leak of 1 GB", C(&["-DFAULT=LEAKS"]), "no memory for a gigabyte", 1, "11"),
    ("file", C(&["-DFAULT=FILES"]), "push: no file", 1, "11"),
    ("socket", C(&["-DFAULT=SOCKET"]), "push: no socket", 1, "11"),
    ("local socket", C(&["-DFAULT=CONNECTS"]), "push: no socket", 1, "11"),
    ("file in a constructor", C(&["-DFAULT=CTOR_WRITES", WRITTEN]), "2 tracks, frames 0-7", 0, "11111111"),
    ("exec in a constructor", C(&["-DFAULT=CTOR_EXECS", WRITTEN]), "2 tracks, frames 0-7", 0, "11111111"),
    (
        "dies in a constructor",
        C(&["-DFAULT=CTOR_DIES", WRITTEN]),
        "died of SIGABRT (it gave up) in create",
        1,
        "",
    ),
    ("wrong major", C(&["-DFAULT=NONE", "-DSYMBOL=honami_library_v2"]), "is built for ABI 2", 2, ""),
    ("missing symbol", C(&["-DFAULT=NONE", "-DSYMBOL=other"]), "does not export honami_library_v1", 2, ""),
    ("no note", C(&["-DFAULT=NONE", "-DNO_NOTE"]), "it carries no manifest", 2, ""),
    ("truncated", Cut, "plugin.so: ", 2, ""),
    ("note of another", C(&["-DFAULT=OTHER_MANIFEST"]), "has another manifest than its note", 1, ""),
    (
        "note that lies",
        C(&["-DFAULT=NULL_TABLE"]),
        "its manifest has honami.tracker/1, the instance has none",
        1,
        "",
    ),
];

/// Some of them wait for the watch-dog: they do so beside the others.
const AT_ONCE: usize = 4;

#[test]
fn what_a_plugin_does_wrong_is_told_and_costs_no_more_than_it_must() {
    if !has_cc() {
        return;
    }
    let left = Mutex::new(ROWS.iter());
    let next = || left.lock().unwrap().next();
    std::thread::scope(|scope| {
        for _ in 0..AT_ONCE {
            scope.spawn(|| {
                while let Some(row) = next() {
                    check(row);
                }
            });
        }
    });
}

fn check(&(name, made, wanted, code, seen): &Row) {
    if name.starts_with("file") && !is_shut_in() {
        return;
    }
    let bench = Bench::new();
    project(&bench);
    let with = make(&bench, made);
    let before = files(&bench);
    let mut frames = "";
    if name.ends_with("from frame 1 on") {
        fs::write(bench.path("points.csv"), "id,x,y,frame\n1,20.5,30,1\n2,60,40.25,1\n").unwrap();
        frames = " --frames 1..";
    }
    let line = format!("track p.honami --plugin plugin.so --with {with} --points points.csv{frames}");
    let ran = ran(tracking(&bench, &line).output().unwrap());
    let said = format!("{}{}", ran.stdout, ran.stderr);
    assert!(ran.code == Some(code) && said.contains(wanted), "{name}: {ran:?}");
    // Who is silent is told of at once, and then again.
    let (silent, told): (Vec<&str>, Vec<&str>) =
        said.lines().partition(|line| line.starts_with("bad, frame 2: no sign of life for "));
    assert_eq!(!silent.is_empty(), wanted.contains("without a sign of life"), "{name}: {ran:?}");
    // A frame that was given up is told of beside the reason.
    let (given_up, told): (Vec<&str>, Vec<&str>) =
        told.into_iter().partition(|line| line.starts_with("warning: frame 2 is left out: "));
    assert_eq!(given_up.len(), usize::from(seen.contains("01")), "{name}: {ran:?}");
    assert!(!said.contains('\u{1b}') && told.len() == 1, "{name}: {ran:?}");
    assert_whole(&bench, name, seen);
    assert_eq!(files(&bench), before, "{name}");
}

/// A command whose temporary files lie in its folder, too; the memory of plugins is limited.
fn tracking(bench: &Bench, line: &str) -> Command {
    let mut command = bench.command(line.split(' '));
    fs::create_dir_all(bench.path("tmp")).unwrap();
    command.env("TMPDIR", bench.path("tmp")).env("HONAMI_PLUGIN_MEMORY", (1 << 29).to_string());
    command
}

/// Makes `plugin.so`; the name of its tracker.
fn make(bench: &Bench, made: Made) -> &'static str {
    let library = bench.path("plugin.so");
    match made {
        C(flags) => drop(compile(bench, "plugin.so", flags)),
        Cut => {
            let whole = fs::read(compile(bench, "plugin.so", &["-DFAULT=NONE"])).unwrap();
            fs::write(library, &whole[..whole.len() / 3]).unwrap();
        }
        Panics => {
            fs::copy(zoo(), library).unwrap();
            return "panics";
        }
    }
    "bad"
}

/// The zoo's library; cargo says where it lies.
fn zoo() -> PathBuf {
    let mut build = Command::new(env!("CARGO"));
    build.args(["build", "--quiet", "--example", "zoo", "--message-format=json"]);
    let output = build.args(what_is_built().split_whitespace()).current_dir(root()).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let parsed = text.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
    let mut files = parsed.filter(|what| what["target"]["name"] == "zoo");
    PathBuf::from(files.next_back().unwrap()["filenames"][0].as_str().unwrap())
}

/// The project can be read, its tracks are as they must be, and no process works for anybody in this folder.
fn assert_whole(bench: &Bench, name: &str, seen: &str) {
    let runs = bench.log("p.honami", "run");
    assert_eq!(runs.len(), usize::from(!seen.is_empty()), "{name}");
    if !seen.is_empty() {
        let samples = bench.samples("p.honami");
        let statuses: String =
            samples.iter().filter(|row| row["track"] == "1").map(|row| row["status"].as_str()).collect();
        assert_eq!(statuses, seen, "{name}");
        fs::remove_file(bench.path("p.honami.csv")).unwrap();
    }
    for (pid, process) in processes(&bench.path("")) {
        // What was killed takes its time to be gone.
        assert!(ends(pid), "{name}: {process} is left");
    }
}

/// Whether a process ends, which is no child of this one.
fn ends(pid: Pid) -> bool {
    let Ok(process) = pidfd_open(pid, PidfdFlags::empty()) else { return true };
    let mut wanted = [PollFd::new(&process, PollFlags::IN)];
    poll(&mut wanted, Some(&Timespec { tv_sec: 60, tv_nsec: 0 })).unwrap() > 0
}

/// The files in the folder, and whatever lies in that for temporary files.
fn files(bench: &Bench) -> BTreeSet<PathBuf> {
    let of = |folder: PathBuf| fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    of(bench.path("")).filter(|path| path.is_file()).chain(of(bench.path("tmp"))).collect()
}

/// Processes that have this folder in their arguments, with their names.
fn processes(folder: &Path) -> Vec<(Pid, String)> {
    let is_in = |place: &PathBuf| {
        let arguments = fs::read(place.join("cmdline")).unwrap_or_default();
        String::from_utf8_lossy(&arguments).contains(&*folder.to_string_lossy())
    };
    let places = fs::read_dir("/proc").unwrap().flatten().map(|entry| entry.path()).filter(is_in);
    let named = |place: PathBuf| {
        let pid = Pid::from_raw(place.file_name()?.to_str()?.parse().ok()?)?;
        Some((pid, fs::read_to_string(place.join("comm")).ok()?))
    };
    places.filter_map(named).collect()
}

/// What becomes of the library's file while the plugin is at work in frame 2.
#[derive(Clone, Copy, Debug)]
enum Act {
    /// Another one takes its place.
    Replaced,
    /// Another one is written over it.
    Overwritten,
    /// What is no library is written over it.
    Spoilt,
    /// It goes.
    Removed,
}

#[test]
fn what_becomes_of_a_file_during_a_run_is_met_when_the_plugin_starts_again() {
    if !has_cc() {
        return;
    }
    for (act, signal, wanted, code, seen) in [
        (Act::Replaced, Signal::USR1, "2 tracks, frames 0-7", 0, "11111111"),
        (Act::Overwritten, Signal::USR1, "2 tracks, frames 0-7", 0, "11111111"),
        (Act::Spoilt, Signal::USR1, "2 tracks, frames 0-7", 0, "11111111"),
        (Act::Removed, Signal::USR1, "2 tracks, frames 0-7", 0, "11111111"),
        // The new one goes on where the old one was: no frame is lost.
        (Act::Replaced, Signal::KILL, "started again at frame 2: it died of SIGKILL", 0, "11111111"),
        (Act::Overwritten, Signal::KILL, "started again at frame 2: it died of SIGKILL", 0, "11111111"),
        // The old one goes on, and waits there again until it is ended.
        (Act::Spoilt, Signal::KILL, "started again at frame 2: it died of SIGKILL", 0, "11011111"),
        (Act::Removed, Signal::KILL, "started again at frame 2: it died of SIGKILL", 0, "11011111"),
    ] {
        let bench = Bench::new();
        project(&bench);
        let library = compile(&bench, "plugin.so", &["-DFAULT=WAITS"]);
        let good = compile(&bench, "good.so", &["-DFAULT=NONE"]);
        let line = "track p.honami --plugin plugin.so --with bad --points points.csv -v";
        let mut child = tracking(&bench, line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let plugin = waiting(&bench, &mut child);
        match act {
            Act::Replaced => fs::rename(good, library).unwrap(),
            Act::Overwritten => fs::write(library, fs::read(good).unwrap()).unwrap(),
            Act::Spoilt => fs::write(library, "no library").unwrap(),
            Act::Removed => fs::remove_file(library).unwrap(),
        }
        kill_process(plugin, signal).unwrap();
        let ran = ran(child.wait_with_output().unwrap());
        let said = format!("{}{}", ran.stdout, ran.stderr);
        assert!(ran.code == Some(code) && said.contains(wanted), "{act:?} {signal:?}: {ran:?}");
        assert_eq!(said.contains("started again"), wanted.contains("started again"), "{act:?}: {ran:?}");
        assert_whole(&bench, &format!("{act:?} {signal:?}"), seen);
    }
}

/// The plugin's process, once it has said that it waits in frame 2.
fn waiting(bench: &Bench, child: &mut Child) -> Pid {
    let said = child.stderr.as_mut().unwrap();
    let mut heard = Vec::new();
    while !heard.ends_with(b"bad: waits\n") {
        // A byte at a time: what comes afterwards is for others.
        let mut byte = [0];
        let n = said.read(&mut byte).unwrap();
        assert_eq!(n, 1, "it does not come to frame 2: {}", String::from_utf8_lossy(&heard));
        heard.extend(byte);
    }
    let found = processes(&bench.path("")).into_iter().find(|(_, name)| name.trim() == "waits");
    found.unwrap().0
}

#[test]
fn what_a_plugin_prints_is_told_where_that_is_asked_for() {
    if !has_cc() {
        return;
    }
    let bench = Bench::new();
    project(&bench);
    let with = make(&bench, C(&["-DFAULT=SPEAKS"]));
    let line = format!("track p.honami --plugin plugin.so --with {with} --points points.csv");
    let said = ran(tracking(&bench, &format!("{line} -v")).output().unwrap());
    // It dies twice in frame 2.
    let died = "bad: error: died of SIGSEGV (it used memory that is not its own); it last printed: no weights for level 2, in frame 2";
    let wanted = [
        "bad: read weights",
        "bad: no weights for level 2",
        died,
        "bad: warning: started again at frame 2",
        "bad: read weights",
        "bad: no weights for level 2",
        died,
        "bad: warning: started again, and frame 2 is left out",
    ];
    assert_eq!(said.stderr.lines().collect::<Vec<_>>(), wanted, "{said:?}");
    // The reason stays with the run.
    let run = bench.log("p.honami", "run")[0].clone();
    let why = run["started_again"][0]["why"].as_str().unwrap();
    assert!(why.ends_with("; it last printed: no weights for level 2"), "{run}");
    let log = bench.text("log p.honami");
    assert!(log.contains(why), "{log}");
}

#[test]
fn what_was_hidden_when_a_run_failed_is_so_in_the_frame_that_it_goes_on_from() {
    if !has_cc() {
        return;
    }
    let bench = Bench::new();
    project(&bench);
    compile(&bench, "plugin.so", &["-DFAULT=NEGATIVE", "-DFROM=4", "-DHIDES=2"]);
    let line = "track p.honami --plugin plugin.so --with bad --points points.csv";
    let ran = bench.line(line);
    assert!(ran.code == Some(1) && ran.stderr.contains("failed at frame 4"), "{ran:?}");
    let statuses = |bench: &Bench| {
        let samples = bench.samples("p.honami");
        ["1", "2"].map(|track| {
            let of = samples.iter().filter(|row| row["track"] == track);
            of.map(|row| row["status"].as_str()).collect::<String>()
        })
    };
    assert_eq!(statuses(&bench), ["1111", "1122"]);
    // Rebuilt, it sees both; in frame 3 it was told where they are, and has looked at nothing.
    compile(&bench, "plugin.so", &["-DFAULT=NONE"]);
    let said = bench.text("track p.honami --plugin plugin.so --resume");
    assert!(said.contains("frames 3-7"), "{said}");
    assert_eq!(statuses(&bench), ["11111111", "11221111"]);
}
