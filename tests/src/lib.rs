//! What the end-to-end tests share: the built program, a fresh folder, the real data.
#![expect(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    clippy::print_stderr,
    reason = "a failed step of a test is a failed test, and a skipped one says so"
)]

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use serde_json::Value;
use tempfile::TempDir;

/// The program as cargo built it, with the shipped plugins beside it.
///
/// cargo is asked, because the target folder may lie anywhere and a guessed path may be stale.
#[must_use]
#[track_caller]
pub fn program() -> &'static Path {
    static PROGRAM: OnceLock<Option<PathBuf>> = OnceLock::new();
    PROGRAM.get_or_init(build).as_deref().expect("the workspace builds")
}

fn build() -> Option<PathBuf> {
    let output = Command::new(env!("CARGO"))
        .args(["build", "--message-format=json", "--quiet"])
        .args(what_is_built().split_whitespace())
        .current_dir(root())
        .stderr(Stdio::inherit())
        .output()
        .unwrap();
    let messages = String::from_utf8(output.stdout).unwrap();
    let executable = |line: &str| {
        let message: Value = serde_json::from_str(line).ok()?;
        let is_it = message["target"]["name"] == "honami";
        message["executable"].as_str().filter(|_| is_it).map(PathBuf::from)
    };
    messages.lines().filter(|_| output.status.success()).find_map(executable)
}

/// The packages that are built, in cargo's words: `HONAMI_BUILD`, where all are tested together, else those that
/// everybody builds. Others than were built before would have what they share built once more, with other features.
#[must_use]
pub fn what_is_built() -> String {
    std::env::var("HONAMI_BUILD").unwrap_or_default()
}

/// The root of the workspace.
#[must_use]
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// A file of the real data; says what is skipped and returns `None` where there is none.
///
/// `HONAMI_DATA` names the folder. Where it is set, a missing file is a failure.
#[must_use]
pub fn data(name: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("HONAMI_DATA") else {
        skipped(&format!("HONAMI_DATA ({name})"));
        return None;
    };
    let path = Path::new(&folder).join(name);
    assert!(path.exists(), "HONAMI_DATA has no {name}");
    Some(path)
}

/// Says that a test, or a part of it, is skipped for want of something.
pub fn skipped(wanted: &str) {
    eprintln!("skipped: needs {wanted}");
}

/// Says that something is skipped for want of what `cargo xtask test` installs, which `HONAMI_SKIP=never` forbids.
#[track_caller]
pub fn missing(wanted: &str) {
    let never = std::env::var_os("HONAMI_SKIP").is_some_and(|value| value == "never");
    assert!(!never, "there is no {wanted}, and HONAMI_SKIP=never forbids to do without");
    skipped(wanted);
}

/// The Python that `HONAMI_PYTHON` names, or the usual one, if it has a module.
#[must_use]
#[track_caller]
pub fn python_with(module: &str) -> Option<String> {
    let python = std::env::var("HONAMI_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let tried = Command::new(&python).args(["-c", &format!("import {module}")]).output();
    if tried.is_ok_and(|output| output.status.success()) {
        return Some(python);
    }
    missing(&format!("{module} for Python (cargo xtask peers)"));
    None
}

/// Whether there is a compiler of this name; says what is skipped if not, which `HONAMI_SKIP=never` forbids.
#[must_use]
#[track_caller]
pub fn has_compiler(name: &str) -> bool {
    let is_there = Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success());
    if !is_there {
        missing(&format!("compiler ({name})"));
    }
    is_there
}

/// What a run of the program printed and how it ended.
#[derive(Debug)]
pub struct Ran {
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
    /// Exit status; `None` when a signal ended it.
    pub code: Option<i32>,
}

impl Ran {
    /// Its standard output; it must have succeeded.
    #[must_use]
    #[track_caller]
    pub fn text(self) -> String {
        assert_eq!(self.code, Some(0), "{self:?}");
        self.stdout
    }

    /// Its standard output as JSON; it must have succeeded.
    #[must_use]
    #[track_caller]
    pub fn json(self) -> Value {
        let text = self.text();
        serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"))
    }
}

/// A folder of its own for one test, in which the program runs with its own home.
pub struct Bench {
    folder: TempDir,
}

impl Bench {
    /// An empty folder.
    #[must_use]
    pub fn new() -> Self {
        Self { folder: TempDir::new().unwrap() }
    }

    /// A path in it; of the folder itself for an empty name.
    #[must_use]
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The program with these arguments, not yet started; caches and state stay inside the folder.
    #[must_use]
    pub fn command(&self, args: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Command {
        let mut command = Command::new(program());
        command.args(args).current_dir(self.folder.path()).stdin(Stdio::null());
        for name in ["HOME", "XDG_CACHE_HOME", "XDG_DATA_HOME", "XDG_STATE_HOME", "XDG_CONFIG_HOME"] {
            command.env(name, self.path(name));
        }
        command.env_remove("HONAMI_PLUGIN_PATH");
        command
    }

    /// Runs the program to its end.
    #[must_use]
    pub fn run(&self, args: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Ran {
        ran(self.command(args).output().unwrap())
    }

    /// Runs a command line, given as words; whether it succeeds is the caller's question.
    #[must_use]
    pub fn line(&self, line: &str) -> Ran {
        self.run(line.split_whitespace())
    }

    /// Runs a command line that must succeed and returns what it says to people.
    #[track_caller]
    pub fn text(&self, line: &str) -> String {
        self.line(line).text()
    }

    /// Runs a command line that must succeed and returns what it says to machines.
    #[track_caller]
    pub fn json(&self, line: &str) -> Value {
        self.run(line.split_whitespace().chain(["--json"])).json()
    }

    /// Gives a script to `honami edit`.
    #[must_use]
    pub fn edit(&self, project: &str, script: &str) -> Ran {
        let mut command = self.command(["edit", project]);
        let piped = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = piped.spawn().unwrap();
        // Answers are shorter than what a pipe holds: nobody waits for the other.
        child.stdin.take().unwrap().write_all(script.as_bytes()).unwrap();
        ran(child.wait_with_output().unwrap())
    }

    /// Renders a clip with its truth: 160x120 pixels unless `more` says otherwise.
    #[track_caller]
    pub fn synth(&self, clip: &str, n_frames: u32, more: &str) -> Value {
        self.json(&format!("synth {clip} --size 160x120 --frames {n_frames} {more}"))
    }

    /// A project `p.honami` of a small generated clip `clip.y4m`, with tracks.
    #[must_use]
    #[track_caller]
    pub fn tracked() -> Self {
        let bench = Self::new();
        bench.synth("clip.y4m", 40, "");
        bench.json("new p.honami clip.y4m");
        bench.json("track p.honami --with klt");
        bench
    }

    /// The exported tracks of a project, a row a sample.
    #[must_use]
    #[track_caller]
    pub fn samples(&self, project: &str) -> Vec<Row> {
        let table = format!("{project}.csv");
        self.json(&format!("export {project} tracks {table}"));
        rows(&self.path(&table))
    }

    /// What the log says of runs, edits or clusterings.
    #[must_use]
    #[track_caller]
    pub fn log(&self, project: &str, what: &str) -> Vec<Value> {
        let log = self.json(&format!("log {project}"));
        log["log"].as_array().unwrap().iter().filter(|line| line["what"] == what).cloned().collect()
    }
}

impl Default for Bench {
    fn default() -> Self {
        Self::new()
    }
}

/// What a command that has ended did.
#[must_use]
pub fn ran(output: Output) -> Ran {
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Ran { stdout: text(output.stdout), stderr: text(output.stderr), code: output.status.code() }
}

/// A row of a table: its cells by the names of their columns.
pub type Row = BTreeMap<String, String>;

/// The rows of a table of numbers and plain words, separated by commas.
#[must_use]
pub fn rows(table: &Path) -> Vec<Row> {
    let text = std::fs::read_to_string(table).unwrap();
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let row =
        |line: &str| head.iter().map(ToString::to_string).zip(line.split(',').map(str::to_owned)).collect();
    lines.map(row).collect()
}

/// The rows of each track, in the order of the table.
#[must_use]
pub fn by_track(rows: &[Row]) -> BTreeMap<u32, Vec<&Row>> {
    let mut tracks = BTreeMap::<u32, Vec<&Row>>::new();
    for row in rows {
        tracks.entry(row["track"].parse().unwrap()).or_default().push(row);
    }
    tracks
}
