//! OpenCV in a child process that waits for its turn (`tests/peers/klt_opencv.py`).

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use honami_vision::{Point, klt};
use serde_json::{Value, json};

use super::{Failure, Frames};

/// The running peer and the folder that frames, points and positions are handed over in.
pub(super) struct Peer {
    child: Child,
    commands: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
    folder: PathBuf,
    name: String,
    n_points: usize,
}

/// Milliseconds of every pair.
pub(super) struct PeerTimes {
    pub(super) full: Vec<f64>,
    pub(super) pyramids: Vec<f64>,
}

impl Peer {
    pub(super) fn start(
        python: &str,
        frames: &Frames,
        points: &[Vec<Point>],
        params: &klt::Params,
    ) -> Result<Self, Failure> {
        let folder = std::env::temp_dir().join(format!("honami-klt-bench-{}", std::process::id()));
        std::fs::create_dir_all(&folder)?;
        frames.write(&folder)?;
        let settings = json!({ "radius_px": params.radius_px, "levels": params.levels });
        std::fs::write(folder.join("settings.json"), settings.to_string())?;
        write_points(&folder.join("points.npy"), points)?;
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/peers/klt_opencv.py");
        let mut child = Command::new(python)
            .arg(script)
            .arg("bench")
            .arg(&folder)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| format!("{python} does not start: {e}"))?;
        let commands = child.stdin.take();
        let answers = BufReader::new(child.stdout.take().ok_or("no standard output")?);
        let n_points = points.first().map_or(0, Vec::len);
        let mut peer = Self { child, commands, answers, folder, name: String::new(), n_points };
        let hello = peer
            .answer()
            .map_err(|e| format!("is OpenCV there (pip install opencv-python-headless numpy)? {e}"))?;
        peer.name = hello["peer"].as_str().unwrap_or("OpenCV").into();
        Ok(peer)
    }

    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// One turn over all pairs.
    pub(super) fn time(&mut self) -> Result<PeerTimes, Failure> {
        let answer = self.ask("time")?;
        let list =
            |key: &str| answer[key].as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
        Ok(PeerTimes { full: list("full_ms"), pyramids: list("pyramids_ms") })
    }

    /// Where the points went, `None` where they were lost.
    pub(super) fn positions(&mut self) -> Result<Vec<Vec<Option<Point>>>, Failure> {
        self.ask("positions")?;
        let file = std::fs::read(self.folder.join("opencv.npy"))?;
        // Version 1 of the format: 10 bytes, of which the last two are the length of the header.
        let header = 10 + usize::from(u16::from_le_bytes([file[8], file[9]]));
        let floats: Vec<f32> =
            file[header..].chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        let points: Vec<Option<Point>> =
            floats.chunks_exact(3).map(|p| (p[2] > 0.5).then_some([p[0], p[1]])).collect();
        Ok(points.chunks(self.n_points).map(<[_]>::to_vec).collect())
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
        let removed = std::fs::remove_dir_all(&self.folder);
        debug_assert!(ended.is_ok() && removed.is_ok(), "{ended:?} {removed:?}");
    }
}

/// `(pairs, n, 2)` float32 as NumPy reads it.
fn write_points(path: &Path, points: &[Vec<Point>]) -> Result<(), Failure> {
    let shape = format!("({}, {}, 2)", points.len(), points.first().map_or(0, Vec::len));
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}");
    let header = format!("{header:<117}\n");
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.as_bytes());
    file.extend(points.iter().flatten().flatten().flat_map(|c| c.to_le_bytes()));
    Ok(std::fs::write(path, file)?)
}
