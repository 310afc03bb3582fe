//! What the end-to-end tests share: the built program, a fresh folder, the real data.
#![expect(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    clippy::print_stderr,
    reason = "a failed step of a test is a failed test, and a skipped one says so"
)]

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use serde_json::Value;
use tempfile::TempDir;

/// The program as cargo built it, with the shipped plugins beside it.
///
/// cargo is asked, because the target folder may lie anywhere and a guessed path may be stale.
#[must_use]
pub fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        let output = Command::new(env!("CARGO"))
            .args(["build", "--workspace", "--message-format=json", "--quiet"])
            .current_dir(root())
            .stderr(Stdio::inherit())
            .output()
            .unwrap();
        assert!(output.status.success(), "the workspace does not build");
        let messages = String::from_utf8(output.stdout).unwrap();
        let executable = |line: &str| {
            let message: Value = serde_json::from_str(line).ok()?;
            let is_it = message["target"]["name"] == "honami";
            message["executable"].as_str().filter(|_| is_it).map(PathBuf::from)
        };
        messages.lines().find_map(executable).unwrap()
    })
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
        eprintln!("skipped: needs HONAMI_DATA ({name})");
        return None;
    };
    let path = Path::new(&folder).join(name);
    assert!(path.exists(), "HONAMI_DATA has no {name}");
    Some(path)
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
    /// Its standard output as JSON; it must have succeeded.
    #[must_use]
    #[track_caller]
    pub fn json(&self) -> Value {
        assert_eq!(self.code, Some(0), "{self:?}");
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error}: {self:?}"))
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

    /// A path in it.
    #[must_use]
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The program with these arguments, not yet started; caches and state stay inside the folder.
    pub fn command(&self, args: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Command {
        let mut command = Command::new(program());
        command.args(args).current_dir(self.folder.path()).stdin(Stdio::null());
        for name in ["XDG_CACHE_HOME", "XDG_DATA_HOME", "XDG_STATE_HOME", "XDG_CONFIG_HOME"] {
            command.env(name, self.path(name));
        }
        command.env_remove("HONAMI_PLUGIN_PATH");
        command
    }

    /// Runs the program to its end.
    pub fn run(&self, args: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Ran {
        let output = self.command(args).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Ran { stdout: text(output.stdout), stderr: text(output.stderr), code: output.status.code() }
    }

    /// Runs a command line that must succeed, given as words, and returns its `--json` answer.
    #[track_caller]
    pub fn json(&self, line: &str) -> Value {
        self.run(line.split_whitespace().chain(["--json"])).json()
    }
}

impl Default for Bench {
    fn default() -> Self {
        Self::new()
    }
}
