//! PyMatting in a child process that waits for its turn (`tests/peers/matting_pymatting.py`).

use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use honami_matting::Mark;

use super::Failure;

/// The running peer.
pub(super) struct Peer {
    child: Child,
    given: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
    /// As it calls itself.
    pub(super) name: String,
}

impl Peer {
    pub(super) fn start(python: &str) -> Result<Self, Failure> {
        let mut child = Command::new(python)
            .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/peers/matting_pymatting.py"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| format!("{python} does not start: {e}"))?;
        let given = child.stdin.take();
        let answers = BufReader::new(child.stdout.take().ok_or("no standard output")?);
        let mut peer = Self { child, given, answers, name: String::new() };
        peer.name = peer.line()?;
        if peer.name.is_empty() {
            return Err("is PyMatting there (pip install pymatting)?".into());
        }
        Ok(peer)
    }

    pub(super) fn id(&self) -> u32 {
        self.child.id()
    }

    /// Seconds that it says it took, and opacities.
    pub(super) fn matte(
        &mut self,
        [width, height]: [u32; 2],
        rgb: &[[u8; 3]],
        marks: &[Mark],
    ) -> Result<(f64, Vec<f32>), Failure> {
        let given = self.given.as_mut().ok_or("no standard input")?;
        writeln!(given, "{width} {height}")?;
        given.write_all(rgb.as_flattened())?;
        let trimap: Vec<u8> =
            marks.iter().map(|mark| mark.alpha().map_or(128, |a| (a * 255.0) as u8)).collect();
        given.write_all(&trimap)?;
        given.flush()?;
        let line = self.line()?;
        let seconds = line.parse().map_err(|e| format!("the peer answered {line:?}: {e}"))?;
        let mut alpha = vec![0; 4 * rgb.len()];
        self.answers.read_exact(&mut alpha)?;
        let floats = alpha.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
        Ok((seconds, floats.collect()))
    }

    fn line(&mut self) -> Result<String, Failure> {
        let mut line = String::new();
        self.answers.read_line(&mut line)?;
        Ok(line.trim_end().to_owned())
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // End of its input ends the peer.
        self.given = None;
        let ended = self.child.wait();
        debug_assert!(ended.is_ok(), "{ended:?}");
    }
}

/// The most memory that a process has had.
pub(super) fn peak_megabytes(process: &str) -> Option<f64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.split_whitespace().next()?.parse::<f64>().ok()? / 1024.0)
}
