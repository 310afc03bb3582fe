//! SciPy in a child process that waits for its turn (`tests/peers/modes_scipy.py`).

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use honami_mechanics::{Beams, TreeMatrix};
use serde::Deserialize;

use super::Failure;

/// The running peer.
pub(super) struct Peer {
    child: Child,
    commands: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
    _folder: tempfile::TempDir,
}

/// How long its turn took, and what it found.
#[derive(Deserialize)]
pub(super) struct Turn {
    pub(super) ms: f64,
    pub(super) hz: Vec<f64>,
}

impl Peer {
    pub(super) fn start(python: &str, beams: &Beams, n_modes: usize) -> Result<Self, Failure> {
        let folder = tempfile::tempdir()?;
        write(folder.path(), beams)?;
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/peers/modes_scipy.py");
        let mut child = Command::new(python)
            .arg(script)
            .arg(folder.path())
            .arg(n_modes.to_string())
            .envs(["OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"].map(|name| (name, "1")))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| format!("{python} does not start: {e}"))?;
        let commands = child.stdin.take();
        let answers = BufReader::new(child.stdout.take().ok_or("no standard output")?);
        let mut peer = Self { child, commands, answers, _folder: folder };
        peer.answer().map_err(|e| format!("is SciPy there (pip install scipy)? {e}"))?;
        Ok(peer)
    }

    pub(super) fn turn(&mut self) -> Result<Turn, Failure> {
        let commands = self.commands.as_mut().ok_or("no standard input")?;
        writeln!(commands)?;
        commands.flush()?;
        Ok(serde_json::from_str(&self.answer()?)?)
    }

    fn answer(&mut self) -> Result<String, Failure> {
        let mut line = String::new();
        self.answers.read_line(&mut line)?;
        if line.is_empty() { Err("the peer ended".into()) } else { Ok(line) }
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

/// Writes both matrices as the peer reads them.
fn write(folder: &Path, beams: &Beams) -> Result<(), Failure> {
    for (name, matrix) in [("stiffness", beams.stiffness()), ("mass", beams.mass())] {
        let bytes = |part: &dyn Fn([[[f64; 6]; 6]; 2]) -> [[f64; 6]; 6]| -> Vec<u8> {
            let blocks = matrix.blocks().map(|(_, blocks)| part(blocks));
            blocks.flat_map(|block| block.into_iter().flatten()).flat_map(f64::to_ne_bytes).collect()
        };
        std::fs::write(folder.join(format!("{name}.own.f64")), bytes(&|[own, _]| own))?;
        std::fs::write(folder.join(format!("{name}.link.f64")), bytes(&|[_, link]| link))?;
        std::fs::write(folder.join("parents.i32"), parents(&matrix)?)?;
    }
    Ok(())
}

fn parents(matrix: &TreeMatrix) -> Result<Vec<u8>, Failure> {
    let parents = matrix.blocks().map(|(parent, _)| parent.map_or(Ok(-1), i32::try_from));
    let parents = parents.collect::<Result<Vec<i32>, _>>()?;
    Ok(parents.into_iter().flat_map(i32::to_ne_bytes).collect())
}
