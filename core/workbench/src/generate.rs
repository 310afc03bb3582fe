//! Clips with known truth, written to disk.

mod stage;

use std::path::{Path, PathBuf};

use honami_exchange::{TruthRow, Writer};
use honami_media::write as movie;
use honami_media::write::Format;
use honami_model::picture::Range;
use honami_synth::{Moving, Scene, Settings};

pub use self::stage::{Staged, stage};

use crate::error::WorkbenchError;
use crate::progress::{Flow, Progress};

/// What was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Generated {
    /// The clip.
    pub clip: PathBuf,
    /// The true positions, a table beside it.
    pub truth: PathBuf,
    /// Leaves, each a point of the truth.
    pub n_leaves: usize,
    /// Branches they hang on.
    pub n_branches: usize,
    /// Mean displacement of a leaf, pixels a frame.
    pub step_px: f64,
}

/// Renders a scene into a clip, and its truth into `NAME.truth.csv` beside it.
///
/// # Errors
/// [`WorkbenchError::Stopped`], and what the disk or the settings say; nothing is left behind then.
pub fn generate(
    settings: &Settings,
    clip: &Path,
    progress: &dyn Progress,
) -> Result<Generated, WorkbenchError> {
    write(&Scene::new(settings)?, clip, progress)
}

/// Films a plant that moves by itself as [`generate`] does its own.
///
/// # Errors
/// As [`generate`].
pub fn film(
    settings: &Settings,
    moving: &Moving,
    clip: &Path,
    progress: &dyn Progress,
) -> Result<Generated, WorkbenchError> {
    write(&Scene::of(settings, moving)?, clip, progress)
}

fn write(scene: &Scene, clip: &Path, progress: &dyn Progress) -> Result<Generated, WorkbenchError> {
    let settings = scene.settings();
    let truth = truth_beside(clip);
    let mut table = Writer::create(&truth)?;
    for row in rows(scene) {
        table.write(&row)?;
    }
    let mut movie = movie::create(clip, &format(settings))?;
    for frame in 0..settings.n_frames {
        if progress.report(u64::from(frame), u64::from(settings.n_frames), "frame") == Flow::Stop {
            return Err(WorkbenchError::Stopped);
        }
        movie.push(&scene.render(frame).planes())?;
    }
    // The truth first: a clip without its truth would look finished; and no truth without its clip.
    table.finish()?;
    if let Err(error) = movie.finish() {
        std::fs::remove_file(&truth).unwrap_or_default();
        return Err(error.into());
    }
    Ok(Generated {
        clip: clip.to_owned(),
        truth,
        n_leaves: scene.truth().leaves.len(),
        n_branches: scene.truth().branches.len(),
        step_px: scene.mean_step_px(),
    })
}

fn format(settings: &Settings) -> Format {
    let Settings { width, height, fps, .. } = *settings;
    Format { width, height, fps, colour: true, range: Range::Full }
}

/// Where the truth of a clip lies: `storm.y4m` → `storm.truth.csv`.
#[must_use]
pub fn truth_beside(clip: &Path) -> PathBuf {
    clip.with_extension("truth.csv")
}

fn rows(scene: &Scene) -> impl Iterator<Item = TruthRow> {
    scene.truth().leaves.iter().flat_map(|leaf| {
        (0_u32..).zip(&leaf.path).map(|(frame, at)| TruthRow {
            track: leaf.id,
            frame,
            x: at.x as f32,
            y: at.y as f32,
            visible: at.visible,
            branch: leaf.branch,
        })
    })
}
