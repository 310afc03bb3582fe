//! Targets on bars that are carried round the plant (thesis 2.3.2), as tracks of projects have seen them.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use honami_cameras::{Pixel, Sighting, Target};
use honami_model::track::{Span, TrackId};
use honami_store::Project;
use serde::Deserialize;

use super::{Side, Unit};
use crate::error::{CamerasError, WorkbenchError};

/// More views than these add little: targets that are carried about stand still from frame to frame.
const MOST_VIEWS: usize = 100;
/// A view with fewer targets says nothing of how they stand.
const FEWEST: usize = 4;

/// Targets on a plane, by a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// Where they are.
    pub target: Target,
    /// Names of the tracks that follow them, in order; without names they are the tracks with the lowest numbers.
    pub names: Option<Vec<String>>,
    /// The unit of their places.
    pub unit: Option<Unit>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Contents {
    unit: Option<Unit>,
    targets: Vec<[f64; 2]>,
    names: Option<Vec<String>>,
}

/// Reads where the targets of a rig are: `targets = [[x, y], …]`, `unit = "m"` and, where tracks have names, `names = […]`.
///
/// # Errors
/// [`CamerasError::File`] with what is wrong: no TOML, other keys, names that are not as many or not all different, targets that
/// span no plane.
pub fn read(path: &Path) -> Result<Rig, WorkbenchError> {
    let wrong = |why: String| CamerasError::File { path: path.to_owned(), why };
    let text = fs::read_to_string(path).map_err(|error| wrong(error.to_string()))?;
    let Contents { unit, targets, names } =
        toml::from_str(&text).map_err(|error| wrong(error.to_string().trim_end().to_owned()))?;
    let n_targets = targets.len();
    if let Some(names) = &names
        && (names.len() != n_targets || names.iter().collect::<BTreeSet<_>>().len() != n_targets)
    {
        return Err(wrong(format!(
            "wanted {n_targets} different names, one for each target, came {}",
            names.len()
        ))
        .into());
    }
    if targets.iter().flatten().any(|c| !c.is_finite()) {
        return Err(wrong("the places of targets must be finite numbers".to_owned()).into());
    }
    let target = Target::new(targets, true).map_err(|error| wrong(error.to_string()))?;
    Ok(Rig { target, names, unit })
}

/// What a project's tracks saw of the targets: one view for each frame, left empty where fewer than four are seen.
pub(super) fn seen(project: &Project, rig: &Rig) -> Result<Side, WorkbenchError> {
    let shown = project.shown_all()?;
    let spans = followed(project, rig, &shown)?;
    let clip = &project.clip().clip;
    let sightings = (0..clip.n_frames()).map(|frame| {
        let at = |(target, span): (usize, &Arc<Span>)| {
            let sample = span.get(frame).filter(|sample| sample.status.is_seen())?;
            Some((target, Pixel::new(f64::from(sample.x), f64::from(sample.y))))
        };
        let seen: Sighting = spans.iter().copied().enumerate().filter_map(at).collect();
        let n_seen = seen.len();
        let sighting = if n_seen < FEWEST {
            Err(format!("{n_seen} targets are seen, {FEWEST} are wanted"))
        } else {
            Ok(seen)
        };
        (format!("frame {frame}"), sighting)
    });
    Ok(Side { size: [clip.width, clip.height], sightings: sightings.collect() })
}

/// The track of each target.
fn followed<'a>(
    project: &Project,
    rig: &Rig,
    shown: &'a [(TrackId, Arc<Span>)],
) -> Result<Vec<&'a Arc<Span>>, WorkbenchError> {
    let wrong = |why: String| CamerasError::File { path: project.path().to_owned(), why };
    let n_targets = rig.target.len();
    let Some(names) = &rig.names else {
        if shown.len() < n_targets {
            let came = shown.len();
            let why = format!(
                "wanted {n_targets} tracks, one for each target in the order of the rig's file, came {came}: place them in the terminal \
                 with a click each, and track them"
            );
            return Err(wrong(why).into());
        }
        return Ok(shown[..n_targets].iter().map(|(_, span)| span).collect());
    };
    let called = |id: TrackId| project.document().track(id).and_then(|track| track.name.as_deref());
    let of = |name: &String| {
        let found = shown.iter().find(|(id, _)| called(*id) == Some(name));
        found
            .map(|(_, span)| span)
            .ok_or_else(|| wrong(format!("no track is called {name}, as a target is")).into())
    };
    names.iter().map(of).collect()
}

/// Few enough of the views, evenly in time, in which any camera saw the targets.
pub(super) fn thinned(sides: &mut [Side]) {
    let n = sides.iter().map(|side| side.sightings.len()).max().unwrap_or(0);
    let is_seen =
        |view: usize| sides.iter().any(|side| side.sightings.get(view).is_some_and(|(_, seen)| seen.is_ok()));
    let seen: Vec<usize> = (0..n).filter(|&view| is_seen(view)).collect();
    let n_kept = seen.len().min(MOST_VIEWS);
    let kept: BTreeSet<usize> = (0..n_kept).map(|k| seen[k * seen.len() / n_kept]).collect();
    for side in sides {
        let mut view = 0;
        side.sightings.retain(|_| {
            view += 1;
            kept.contains(&(view - 1))
        });
    }
}
