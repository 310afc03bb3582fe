//! Targets on bars that are carried round the plant (thesis 2.3.2), as tracks of projects have seen them.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use honami_cameras::homography::homography;
use honami_cameras::{Pixel, Sighting, Target};
use honami_media::Media;
use honami_model::track::{Span, TrackId};
use honami_store::Project;
use honami_vision::meeting::middle;
use serde::Deserialize;

use super::Unit;
use super::side::{Side, Source, View, file_name};
use crate::error::{CamerasError, WorkbenchError};
use crate::progress::{Flow, Progress};

/// More views than these add little: targets that are carried about stand still from frame to frame.
pub(super) const MOST_VIEWS: usize = 100;
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
    /// Of round targets how wide they are: their middles are looked for in every picture that is used, about the tracks.
    pub diameter: Option<f64>,
    /// The name of the file.
    pub name: String,
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Contents {
    unit: Option<Unit>,
    targets: Vec<[f64; 2]>,
    names: Option<Vec<String>>,
    diameter: Option<f64>,
}

/// Reads where the targets of a rig are: `targets = [[x, y], …]`, `unit = "m"` and, where tracks have names,
/// `names = […]`; `diameter = 0.16` of round targets.
///
/// # Errors
/// [`CamerasError::File`] with what is wrong: no TOML, other keys, names that are not as many or not all different, targets that
/// span no plane.
pub fn read(path: &Path) -> Result<Rig, WorkbenchError> {
    let wrong = |why: String| CamerasError::File { path: path.to_owned(), why };
    let text = fs::read_to_string(path).map_err(|error| wrong(error.to_string()))?;
    let Contents { unit, targets, names, diameter } =
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
    if diameter.is_some_and(|wide| !(wide.is_finite() && wide > 0.0)) {
        return Err(wrong("the diameter of targets must be above 0".to_owned()).into());
    }
    let target = Target::new(targets, true).map_err(|error| wrong(error.to_string()))?;
    let sha256 = honami_media::sha256_of_file(path)?;
    Ok(Rig { target, names, unit, diameter, name: file_name(path), sha256 })
}

/// What a project's tracks saw of the targets: one view for each frame, left empty where fewer than four are seen.
pub(super) fn seen(project: &Project, rig: &Rig) -> Result<Side, WorkbenchError> {
    let shown = project.shown_all()?;
    let spans = followed(project, rig, &shown)?;
    let clip = &project.clip().clip;
    let views = (0..clip.n_frames()).map(|frame| {
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
        View { frame, name: format!("frame {frame}"), seen: sighting }
    });
    let source = Source {
        name: file_name(project.path()),
        sha256: project.clip().sha256.clone(),
        revision: Some(project.revision().0),
    };
    Ok(Side::new([clip.width, clip.height], views.collect(), source))
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

/// Of the moments that all cameras filmed few enough, evenly in time, in which any saw the targets.
pub(super) fn thinned(sides: &mut [Side], n_most: usize) {
    let n = sides.iter().map(|side| side.views.len()).min().unwrap_or(0);
    let is_seen = |view: usize| sides.iter().any(|side| side.views[view].seen.is_ok());
    let seen: Vec<usize> = (0..n).filter(|&view| is_seen(view)).collect();
    let n_kept = seen.len().min(n_most);
    let kept: BTreeSet<usize> = (0..n_kept).map(|k| seen[k * seen.len() / n_kept]).collect();
    sides.iter_mut().for_each(|side| side.keep(&kept));
}

/// The middles of round targets in place of where tracks have them, and how many there were of either.
pub(super) fn refined(
    side: &mut Side,
    rig: &Rig,
    media: &Media,
    progress: &dyn Progress,
) -> Result<(), WorkbenchError> {
    let Some(diameter) = rig.diameter else { return Ok(()) };
    let (mut n_measured, mut n_targets, n_views) = (0, 0, side.views.len() as u64);
    for (k, View { frame, seen, .. }) in (0..).zip(&mut side.views) {
        if progress.report(k, n_views, "picture") == Flow::Stop {
            return Err(WorkbenchError::Stopped);
        }
        let Ok(sighting) = seen else { continue };
        n_targets += sighting.len();
        let Some(widths) = widths(sighting, rig, diameter) else { continue };
        let picture = media.frame(*frame)?;
        for ((_, at), wide) in sighting.iter_mut().zip(widths) {
            if let Some(found) = middle(&picture.planes().y, (*at).into(), wide / 2.0) {
                *at = found.into();
                n_measured += 1;
            }
        }
    }
    side.middles = Some([n_measured, n_targets - n_measured]);
    Ok(())
}

/// How wide each target looks, where it does most, pixels; none where what was seen is no plane.
fn widths(sighting: &Sighting, rig: &Rig, diameter: f64) -> Option<Vec<f64>> {
    let on_plane: Vec<Pixel> = sighting.iter().map(|&(point, _)| rig.target.place(point).xy()).collect();
    let seen: Vec<Pixel> = sighting.iter().map(|&(_, at)| at).collect();
    let h = homography(&on_plane, &seen).ok()?;
    let wide = |at: &Pixel| {
        let ends = (0..16).map(|k| {
            let (sin, cos) = (f64::from(k) * std::f64::consts::PI / 16.0).sin_cos();
            let half = Pixel::new(cos, sin) * (diameter / 2.0);
            let [a, b] = [at + half, at - half].map(|end| h * end.push(1.0));
            // Its horizon goes through the target: a track that is on something else bends the plane so.
            if a.z * b.z > 0.0 { (a.xy() / a.z - b.xy() / b.z).norm() } else { f64::INFINITY }
        });
        ends.fold(0.0, f64::max)
    };
    Some(on_plane.iter().map(wide).collect())
}
