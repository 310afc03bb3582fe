//! A plugin that is built again while it tracks: the run goes on with the new build, or with the old one where the new is
//! no good, and the project says which build tracked which frame.
//!
//! In frame 12 the plugin waits at a pipe. What the program says of the new build comes while it waits there, so that no
//! test depends on time.

use std::fs::{self, File};
use std::io::{BufRead as _, BufReader, Read as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{RecvTimeoutError, SyncSender, sync_channel};
use std::time::Duration;

use honami_tests::{Bench, Ran, root, skipped};
use rustix::fs::{CWD, FileType, Mode, OFlags, mknodat};
use rustix::process::{Pid, Signal, kill_process};

use crate::isolated::has_cc;

/// Compiles `mine.c` to `mine.so` at once, as a linker does not: another file takes the old one's place.
pub(crate) fn build(bench: &Bench, flags: &[&str]) {
    let given = |name: &str| flags.iter().any(|flag| flag.starts_with(&format!("-D{name}=")));
    let usual = ["-DVERSION=\"2\"", "-DWAIT=-1", "-DDIES=1000", "-DSTEP=1", "-DFIRST=0"];
    let usual = usual.iter().filter(|flag| !given(&flag[2..flag.find('=').unwrap()]));
    let output = Command::new("cc")
        .args(["-std=c11", "-O1", "-shared", "-fPIC", "-fvisibility=hidden", "-I"])
        .arg(root().join("core/abi/include"))
        .args(usual)
        .args(flags)
        .arg("-o")
        .arg(bench.path("new.so"))
        .arg(root().join("tests/it/rebuilt/mine.c"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    fs::rename(bench.path("new.so"), bench.path("mine.so")).unwrap();
}

/// A project of 30 frames with three points, and a pipe to wait at.
pub(crate) fn project() -> Bench {
    let bench = Bench::new();
    bench.synth("clip.y4m", 30, "--leaves 20 --wind calm");
    let _said = bench.text("new p.honami clip.y4m");
    fs::write(bench.path("points.csv"), "id,x,y\n1,20,30\n2,60,40\n3,60,80\n").unwrap();
    mknodat(CWD, bench.path("gate"), FileType::Fifo, Mode::RUSR | Mode::WUSR, 0).unwrap();
    bench
}

/// So long the program has for what a test waits for; it never takes so long unless that does not come.
const PATIENCE: Duration = Duration::from_secs(300);

/// Ends a program that says nothing of what is waited for, so that the test ends, too. It ends with this.
pub(crate) struct Within {
    _alive: SyncSender<()>,
}

impl Within {
    pub(crate) fn begin(child: &Child, gate: &Path) -> Self {
        let (alive, end) = sync_channel::<()>(1);
        let (child, gate) = (Pid::from_child(child), gate.to_owned());
        let wait = move || {
            if end.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                kill_process(child, Signal::KILL).unwrap();
                // Whoever waits for a reader of the pipe waits no more.
                let flags = OFlags::NONBLOCK.bits().cast_signed();
                let _reader = File::options().read(true).custom_flags(flags).open(gate).unwrap();
                end.recv().unwrap_err();
            }
        };
        std::thread::Builder::new().name("within".to_owned()).spawn(wait).unwrap();
        Self { _alive: alive }
    }
}

/// Tracks, and when the tracker waits in frame 12 does this; it goes on once the program has said that.
fn track(bench: &Bench, plugin: &str, meanwhile: impl FnOnce(&Bench), until: &str) -> Ran {
    let gate = bench.path("gate");
    let mut command = bench.command("track p.honami --with mine --points points.csv --json".split(' '));
    command.args(["--plugin", plugin, "--set", &format!("gate={}", gate.display())]);
    // The compiler may take its time.
    command.env("HONAMI_NO_WATCHDOG", "1").stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut errors = BufReader::new(child.stderr.take().unwrap());
    let _within = Within::begin(&child, &gate);
    let open = File::options().write(true).open(&gate).unwrap();
    meanwhile(bench);
    let mut stderr = String::new();
    while !stderr.contains(until) {
        assert_ne!(errors.read_line(&mut stderr).unwrap(), 0, "wanted {until:?}, came {stderr}");
    }
    drop(open);
    errors.read_to_string(&mut stderr).unwrap();
    let output = child.wait_with_output().unwrap();
    let stdout = String::from_utf8(output.stdout).unwrap();
    Ran { stdout, stderr, code: output.status.code() }
}

/// How far a point has moved in each frame, half pixels.
fn moved(bench: &Bench) -> Vec<i64> {
    let rows = bench.samples("p.honami");
    let xs: Vec<f64> =
        rows.iter().filter(|row| row["track"] == "2").map(|row| row["x"].parse().unwrap()).collect();
    xs.windows(2).map(|pair| ((pair[1] - pair[0]) * 2.0).round() as i64).collect()
}

/// What becomes of a new build: what is done to the file, what is said before the tracker goes on, whether it takes over,
/// and what is said afterwards.
const ROWS: &[(&str, &[&str], &str, bool, &str)] = &[
    ("it is better", &["-DSTEP=1.5f"], "mine was rebuilt: 2 (", true, "tracks from frame 13 on"),
    (
        "it dies soon",
        &["-DSTEP=1.5f", "-DDIES=16"],
        "was rebuilt: 2 (",
        false,
        "was given up: org.me.mine died of SIGABRT (it gave up) in push of frame 16",
    ),
    (
        "it dies at once",
        &["-DDIES=0"],
        "was rebuilt: 2 (",
        false,
        "cannot take over, and the build before goes on: org.me.mine died of SIGABRT",
    ),
    (
        "another id",
        &["-DID=\"org.me.other\""],
        "holds org.me.other now, and tracker org.me.mine no more",
        false,
        "",
    ),
    (
        "another parameter",
        &["-DGATE=\"bool\\\",\\\"default\\\":false,\\\"doc\\\":\\\"\""],
        "mine was rebuilt, and the build before goes on: gate",
        false,
        "",
    ),
];

#[test]
fn a_rebuilt_plugin_takes_over_at_the_next_frame_unless_it_is_no_good() {
    if !has_cc() {
        return;
    }
    for (name, flags, until, takes_over, afterwards) in ROWS {
        let bench = project();
        build(&bench, &["-DVERSION=\"1\"", "-DWAIT=12"]);
        let ran = track(&bench, "mine.so", |bench| build(bench, flags), until);
        assert!(ran.code == Some(0) && ran.stderr.contains(afterwards), "{name}: {ran:?}");
        let wanted = [vec![2; 12], vec![if *takes_over { 3 } else { 2 }; 17]].concat();
        assert_eq!(moved(&bench), wanted, "{name}: {ran:?}");
        let run = bench.log("p.honami", "run")[0].clone();
        let seams: Vec<(&serde_json::Value, &serde_json::Value)> = run["started_again"]
            .as_array()
            .unwrap()
            .iter()
            .map(|seam| (&seam["frame"], &seam["plugin_version"]))
            .collect();
        let told = format!("{seams:?}");
        let wanted = match *name {
            "it is better" => r#"[(Number(13), String("2"))]"#,
            "it dies soon" => r#"[(Number(13), String("2")), (Number(13), String("1"))]"#,
            _ => "[]",
        };
        assert_eq!(told, wanted, "{name}: {ran:?}");
        let runs = bench.log("p.honami", "run").len();
        assert_eq!(runs, if *takes_over { 2 } else { 1 }, "{name}");
    }
}

#[test]
fn the_frames_before_are_tracked_by_the_new_build_too_and_kept_beside_the_run() {
    if !has_cc() {
        return;
    }
    let bench = project();
    build(&bench, &["-DVERSION=\"1\"", "-DWAIT=12"]);
    let ran =
        track(&bench, "mine.so", |bench| build(bench, &["-DSTEP=1.5f"]), "takes over at the next frame");
    let said = ran.json();
    // Half a pixel more a frame, from the same start: 0.5 to 6 px in frames 1 to 12, of each of three points.
    let rebuilt = &said["rebuilt"];
    assert_eq!((&rebuilt["frame"], &rebuilt["plugin_version"]), (&13.into(), &"2".into()), "{said}");
    let wanted =
        serde_json::json!({"frames": [0, 13], "tracks": 3, "apart": 3, "median_px": 3.25, "unseen": [0, 0]});
    assert_eq!(rebuilt["difference"], wanted, "{said}");
    let runs = bench.log("p.honami", "run");
    assert_eq!((&runs[1]["id"], &runs[1]["frames"]), (&rebuilt["beside"], &serde_json::json!([0, 13])));
    assert_eq!(runs[1]["provenance"]["what"], "rebuilt");
    assert_eq!(runs[1]["provenance"]["plugin_sha256"], rebuilt["plugin_sha256"]);
    let log = bench.text("log p.honami");
    assert!(log.contains("started again at frame 13: it was rebuilt, and goes on as 2 ("), "{log}");
}

#[test]
fn what_is_no_plugin_any_more_changes_nothing() {
    if !has_cc() {
        return;
    }
    let replace = |text: &'static str| {
        move |file: &Path| {
            fs::write(file.with_extension("part"), text)
                .and_then(|()| fs::rename(file.with_extension("part"), file))
                .unwrap()
        }
    };
    type Do = Box<dyn Fn(&Path)>;
    let rows: [(Do, &str); 3] = [
        (Box::new(replace("no library")), "mine was rebuilt, and the build before goes on: "),
        (Box::new(replace("")), "mine was rebuilt, and the build before goes on: "),
        // What is not there is no build: nothing is said of it.
        (Box::new(|file: &Path| fs::remove_file(file).unwrap()), ""),
    ];
    for (change, until) in rows {
        let bench = project();
        build(&bench, &["-DVERSION=\"1\"", "-DWAIT=12"]);
        let ran = track(&bench, "mine.so", |bench| change(&bench.path("mine.so")), until);
        assert_eq!((ran.code, moved(&bench)), (Some(0), vec![2; 29]), "{ran:?}");
    }
}

#[test]
fn watched_it_tracks_again_with_every_build_in_ones_own_tree_until_it_is_stopped() {
    if !has_cc() {
        return;
    }
    let bench = project();
    build(&bench, &["-DVERSION=\"1\""]);
    let line = "track p.honami --with mine --points points.csv --dev . --watch";
    let mut command = bench.command(line.split(' '));
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut errors = BufReader::new(child.stderr.take().unwrap());
    let _within = Within::begin(&child, &bench.path("gate"));
    let mut wait = || {
        let mut said = String::new();
        while !said.contains("waiting for the next build; Ctrl-C ends it") {
            assert_ne!(errors.read_line(&mut said).unwrap(), 0, "{said}");
        }
        said
    };
    wait();
    // What cannot be used is told, and the next build is waited for.
    fs::write(bench.path("new.so"), "no library").unwrap();
    fs::rename(bench.path("new.so"), bench.path("mine.so")).unwrap();
    let complaint = wait();
    assert!(complaint.contains("there is no tracker \"mine\""), "{complaint}");
    build(&bench, &["-DSTEP=1.5f"]);
    wait();
    // One that reports points elsewhere than they were put moves none for those after it.
    build(&bench, &["-DFIRST=5"]);
    wait();
    build(&bench, &["-DVERSION=\"3\"", "-DSTEP=1.5f"]);
    wait();
    kill_process(Pid::from_child(&child), Signal::INT).unwrap();
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    // Half a pixel more a frame: 0 to 14.5 px.
    let wanted = "on frames 0-29 it differs from the build before by 7.25 px in the median, 3 of 3 features by 1 px or more";
    assert!(output.status.success() && said.contains(wanted), "{said}");
    assert_eq!(bench.log("p.honami", "run").len(), 4);
    assert_eq!(moved(&bench), vec![3; 29]);
    let rows = bench.samples("p.honami");
    let first = |track| rows.iter().find(|row| row["track"] == track).map(|row| row["x"].parse());
    assert_eq!(["1", "2", "3"].map(first), [20.0, 60.0, 60.0].map(|x: f64| Some(Ok(x))));
}

/// A tracker in Python that does what `mine.c` does.
const SCRIPT: &str = r#"
import honami
import numpy as np


class Settings(honami.Params):
    gate = honami.File()


@honami.tracker("org.me.mine", "Mine", params=Settings)
class Mine:
    def begin(self, stream):
        self.at = {}

    def seed(self, points):
        self.at.update({int(i): (x, y) for i, x, y in zip(points.id, points.x, points.y)})

    def push(self, frame):
        if frame.index == WAIT:
            open(self.params.gate).read()
        x, y = zip(*self.at.values())
        self.at = {i: (x + STEP, y) for i, (x, y) in self.at.items()}
        return honami.Points(list(self.at), x, y, [honami.TRACKED] * len(x))


honami.run()
"#;

#[test]
fn a_script_that_was_changed_takes_over_and_one_with_other_parameters_wants_its_manifest() {
    let has_numpy = Command::new("python3").args(["-c", "import numpy"]).output();
    if !has_numpy.is_ok_and(|output| output.status.success()) {
        return skipped("python3 with numpy");
    }
    let write = |bench: &Bench, text: &str| fs::write(bench.path("mine.py"), text).unwrap();
    let old = SCRIPT.replace("WAIT", "12").replace("STEP", "1");
    let better = SCRIPT.replace("WAIT", "-1").replace("STEP", "1.5");
    let other = better.replace("gate = honami.File()", "gate = honami.File()\n    more = honami.Bool(True)");
    let rows = [
        (&better, "mine was rebuilt: ", 3),
        (&other, "has other parameters than its manifest: `python3 mine.py --honami-manifest`", 2),
        (&"if".to_owned(), "mine was rebuilt, and the build before goes on: ", 2),
    ];
    for (new, until, step) in rows {
        let bench = project();
        write(&bench, &old);
        let mut python = Command::new("python3");
        let python = python.arg(bench.path("mine.py")).arg("--honami-manifest");
        let written = python.env("PYTHONPATH", root().join("core/plugin/python")).output().unwrap();
        assert!(written.status.success(), "{written:?}");
        let ran = track(&bench, "mine.py", |bench| write(bench, new), until);
        assert_eq!((ran.code, moved(&bench)), (Some(0), [vec![2; 12], vec![step; 17]].concat()), "{ran:?}");
    }
}
