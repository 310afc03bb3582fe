//! A target before two cameras, filmed: clips, cameras, and where every point of the target is seen.

use std::fs;
use std::path::{Path, PathBuf};

use honami_exchange::{TruthRow, Writer};
use honami_media::write as movie;
use honami_synth::{Carried, Settings, Stage};

use crate::calibrate::{Unit, file};
use crate::error::WorkbenchError;
use crate::export;
use crate::progress::{Flow, Progress};

/// What was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Staged {
    /// All files, in their folder.
    pub files: Vec<PathBuf>,
    /// Points of the target.
    pub n_points: usize,
    /// Distance of the cameras, metres.
    pub baseline_m: f64,
}

/// Films a target by two cameras into a new folder: `left.y4m` and `right.y4m`; `left.truth.csv` and `right.truth.csv`, where the
/// target's points are seen; `cameras.json`, the true cameras; of bars `bars.toml`, where their targets are.
///
/// # Errors
/// [`WorkbenchError::Stopped`], and what the disk or the settings say; the folder is removed then.
pub fn stage(
    carried: Carried,
    settings: &Settings,
    folder: &Path,
    progress: &dyn Progress,
) -> Result<Staged, WorkbenchError> {
    let stage = Stage::new(carried, settings)?;
    fs::create_dir(folder).map_err(|source| WorkbenchError::Io {
        what: "cannot make",
        source,
        path: folder.to_owned(),
    })?;
    let written = write(&stage, carried, settings, folder, progress);
    if written.is_err() {
        fs::remove_dir_all(folder).unwrap_or_default();
    }
    written
}

fn write(
    stage: &Stage,
    carried: Carried,
    settings: &Settings,
    folder: &Path,
    progress: &dyn Progress,
) -> Result<Staged, WorkbenchError> {
    let size = [settings.width, settings.height];
    let mut files = Vec::new();
    let mut named = |name: &str| {
        files.push(folder.join(name));
        folder.join(name)
    };
    for (camera, side) in ["left", "right"].into_iter().enumerate() {
        let path = named(&format!("{side}.y4m"));
        let mut film = movie::create(&path, &super::format(settings))?;
        for frame in 0..settings.n_frames {
            let n_done = u64::from(frame) + camera as u64 * u64::from(settings.n_frames);
            if progress.report(n_done, 2 * u64::from(settings.n_frames), "frame") == Flow::Stop {
                return Err(WorkbenchError::Stopped);
            }
            film.push(&stage.render(camera, frame).planes())?;
        }
        film.finish()?;
        let mut table = Writer::create(&named(&format!("{side}.truth.csv")))?;
        for row in rows(stage, camera, settings.n_frames) {
            table.write(&row)?;
        }
        table.finish()?;
    }
    export::text(&named("cameras.json"), &file::of_pair(stage.pair(), [size; 2], Unit::M))?;
    if carried == Carried::Bars {
        let places: Vec<String> = stage.points().iter().map(|point| format!("{point:?}")).collect();
        let toml =
            format!("unit = \"m\"\ndiameter = {}\ntargets = [{}]\n", stage.diameter(), places.join(", "));
        export::text(&named("bars.toml"), &toml)?;
    }
    let baseline_m = stage.pair().right_from_left.translation.norm();
    Ok(Staged { files, n_points: stage.points().len(), baseline_m })
}

fn rows(stage: &Stage, camera: usize, n_frames: u32) -> impl Iterator<Item = TruthRow> {
    let points = (0_u32..).zip(stage.points());
    points.flat_map(move |(point, place)| {
        (0..n_frames).map(move |frame| {
            let at = stage.seen(camera, frame, place);
            TruthRow {
                track: point,
                frame,
                x: at.map_or(-1.0, |at| at.x as f32),
                y: at.map_or(-1.0, |at| at.y as f32),
                visible: at.is_some(),
                branch: 0,
            }
        })
    })
}
