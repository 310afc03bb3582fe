//! OpenCV in a child process that waits for its turn (`tests/peers/box_opencv.py`).

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use serde_json::{Value, json};

use super::Failure;
use super::frames::Frames;

/// A folder that frames and features are handed over in; removed with everything in it.
pub(super) struct Folder(PathBuf);

impl Folder {
    pub(super) fn new(name: &str) -> Result<Self, Failure> {
        let path = std::env::temp_dir().join(format!("honami-box-bench-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path)?;
        Ok(Self(path))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let removed = std::fs::remove_dir_all(&self.0);
        debug_assert!(removed.is_ok(), "{removed:?}");
    }
}

fn script(python: &str) -> Command {
    let mut command = Command::new(python);
    command.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/peers/box_opencv.py"));
    command
}

/// Pairs of consecutive frames, spread over a clip.
pub(super) fn frames(python: &str, clip: &Path, n_pairs: usize) -> Result<Frames, Failure> {
    let folder = Folder::new("frames")?;
    let ran = script(python).arg("frames").arg(clip).arg(&folder.0).arg(n_pairs.to_string()).status()?;
    if !ran.success() {
        return Err(format!("{python} cannot read {}: is OpenCV there?", clip.display()).into());
    }
    Frames::read(&folder.0, usize::MAX)
}

/// The running peer.
pub(super) struct Peer {
    child: Child,
    commands: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
    _folder: Folder,
}

/// Milliseconds of all pairs together.
#[derive(Clone, Copy)]
pub(super) struct PeerTimes {
    pub(super) full: f64,
    /// What its calls take with nothing to search.
    pub(super) calls: f64,
}

impl Peer {
    pub(super) fn start(
        python: &str,
        frames: &Frames,
        features: &[Vec<[i32; 2]>],
        radius_px: u32,
        search_px: u32,
    ) -> Result<Self, Failure> {
        let folder = Folder::new("peer")?;
        frames.write(&folder.0)?;
        let given = json!({ "radius_px": radius_px, "search_px": search_px, "features": features });
        std::fs::write(folder.0.join("features.json"), given.to_string())?;
        let mut child = script(python)
            .arg("bench")
            .arg(&folder.0)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| format!("{python} does not start: {e}"))?;
        let commands = child.stdin.take();
        let answers = BufReader::new(child.stdout.take().ok_or("no standard output")?);
        let mut peer = Self { child, commands, answers, _folder: folder };
        peer.answer()
            .map_err(|e| format!("is OpenCV there (pip install opencv-python-headless numpy)? {e}"))?;
        Ok(peer)
    }

    /// One turn over all pairs.
    pub(super) fn time(&mut self) -> Result<PeerTimes, Failure> {
        let answer = self.ask("time")?;
        let sum = |key: &str| answer[key].as_array().into_iter().flatten().filter_map(Value::as_f64).sum();
        Ok(PeerTimes { full: sum("ms"), calls: sum("calls_ms") })
    }

    /// Best displacement of every feature of every pair.
    pub(super) fn steps(&mut self) -> Result<Vec<Vec<[i32; 2]>>, Failure> {
        let mut answer = self.ask("answers")?;
        Ok(serde_json::from_value(answer["steps"].take())?)
    }

    fn ask(&mut self, command: &str) -> Result<Value, Failure> {
        let commands = self.commands.as_mut().ok_or("no standard input")?;
        writeln!(commands, "{command}")?;
        commands.flush()?;
        self.answer()
    }

    fn answer(&mut self) -> Result<Value, Failure> {
        let mut line = String::new();
        self.answers.read_line(&mut line)?;
        Ok(serde_json::from_str(&line).map_err(|e| format!("the peer answered {line:?}: {e}"))?)
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // End of its input ends the peer.
        self.commands = None;
        let ended = self.child.wait();
        debug_assert!(ended.is_ok(), "{ended:?}");
    }
}
