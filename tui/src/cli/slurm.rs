//! Many clips by Slurm: one array job, whose tasks follow the recipe with some clips each. Nothing of honami stays running:
//! what is known of them lies in `DIR/slurm`, and the rest is asked of Slurm.

mod engine;
mod status;
mod submit;
mod task;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::recipe::plan::Clip;

pub(super) use status::{cancel, status};
pub(super) use submit::submit;
pub(super) use task::task;

/// What lies in the folder of all clips, and so no clip can be called.
const FOLDER: &str = "slurm";

/// What was handed to Slurm: `slurm/submission.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Submission {
    /// Version of the honami that has written it.
    honami: String,
    /// The program that tasks start, on all nodes.
    program: PathBuf,
    recipe: PathBuf,
    /// Hash of the recipe: all tasks follow the same.
    recipe_sha256: String,
    cpus: u16,
    over_edits: bool,
    /// What was named with `--plugin` and `--dev`.
    plugins: Vec<PathBuf>,
    dev: Vec<PathBuf>,
    /// The clips, by name.
    clips: Vec<(String, PathBuf)>,
    /// Of every task the numbers of its clips.
    tasks: Vec<Vec<usize>>,
    /// The array job; `None` until Slurm has taken it.
    job: Option<u64>,
}

/// How a clip has ended in a task: `slurm/clips/NAME.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Ended {
    /// The node, and how often Slurm had begun the task anew.
    node: String,
    restarts: u32,
    /// Steps that stood as they were, and those that were done: number, seconds, what they said.
    fresh: usize,
    done: Vec<(usize, f64, Value)>,
    /// The step that failed, and why.
    failed: Option<(usize, String)>,
    /// Whether it was asked to end before it was through.
    stopped: bool,
    /// The most memory that was seen, bytes.
    peak_bytes: u64,
}

fn folder(into: &Path) -> PathBuf {
    into.join(FOLDER)
}

fn log(into: &Path, clip: &str) -> PathBuf {
    folder(into).join("logs").join(format!("{clip}.log"))
}

fn ended(into: &Path, clip: &str) -> PathBuf {
    folder(into).join("clips").join(format!("{clip}.json"))
}

impl Submission {
    fn file(into: &Path) -> PathBuf {
        folder(into).join("submission.json")
    }

    fn read(into: &Path) -> anyhow::Result<Self> {
        let file = Self::file(into);
        let shown = file.display();
        let text = fs::read(&file)
            .with_context(|| format!("nothing was submitted into {}: there is no {shown}", into.display()))?;
        serde_json::from_slice(&text).with_context(|| format!("{shown} is not what honami submit writes"))
    }

    fn clip(&self, number: usize, into: &Path) -> anyhow::Result<Clip> {
        let (name, path) = self.clips.get(number).with_context(|| format!("there is no clip {number}"))?;
        Ok(Clip { name: name.clone(), path: path.clone(), folder: into.join(name) })
    }
}

/// Writes a file of JSON beside its place and renames it, so that who reads it never meets half of it.
fn write(file: &Path, content: &impl Serialize) -> anyhow::Result<()> {
    let wrong = || format!("cannot write {}", file.display());
    let part = file.with_file_name(format!(
        ".{}.{}.part",
        file.file_name().unwrap_or_default().to_string_lossy(),
        std::process::id()
    ));
    let text = serde_json::to_vec_pretty(content)?;
    fs::write(&part, text).and_then(|()| fs::rename(&part, file)).with_context(wrong)
}
