//! A skeleton beside the truth of a generated clip: how far its tips are from where their groups truly are.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::Path;

use honami_model::skeleton::seen;
use honami_model::track::TrackId;
use honami_motion::accuracy::median;
use honami_store::Project;
use honami_structure::follow::follow;

use super::Growth;
use super::gather::path;
use crate::compare::{Truth, check_inside, read_truth};
use crate::error::WorkbenchError;

/// A track follows the true point that is this near when it begins, pixels.
const NEAR: f64 = 8.0;

/// How far a skeleton is from the truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// Groups with a track that follows a true point.
    pub n_groups: usize,
    /// Such tracks.
    pub n_tracks: usize,
    /// Frames that are compared: those that the truth and the skeleton both have.
    pub frames: Range<u32>,
    /// Median over groups and frames of the distance in the picture from the joint of a group to where its true points say
    /// that it is, pixels.
    pub median_px: f64,
    /// The same of a skeleton that stands still, each joint where it is in the mean: how much there was to find.
    pub still_px: f64,
    /// The same distance, less what it is in the mean over frames: how far the motion is off, wherever joints are.
    pub motion_px: f64,
}

/// Where the true point of a track is, less what lies between it and the centre of the track's group: the frame it begins
/// with, and the places from there on.
type Told = (u32, Vec<[f64; 2]>);

/// Holds a skeleton against a table of true positions, as `synth` writes it.
///
/// # Errors
/// [`WorkbenchError::TruthApart`] where no frame is of both; [`WorkbenchError::NoTruth`] where no track begins near a true point, and what is wrong with the table.
pub fn judge(growth: &Growth, project: &Project, truth: &Path) -> Result<Judged, WorkbenchError> {
    let clip = &project.clip().clip;
    let truth = read_truth(truth, clip.n_frames())?;
    check_inside(&truth, clip)?;
    let compared = both(&truth, &growth.frames)?;
    let mut told = BTreeMap::new();
    for tracks in &growth.groups {
        for (track, place) in places(project, tracks)? {
            if let Some(of_track) = told_of(project, &truth, track, place)? {
                told.insert(track, of_track);
            }
        }
    }
    let frames = (0..).zip(growth.frames.clone());
    let poses: Vec<(u32, Vec<[f64; 2]>)> = frames
        .filter(|(_, frame)| compared.contains(frame))
        .map(|(row, frame)| {
            let places = growth.skeleton.places(growth.skeleton.directions(row));
            (frame, places.into_iter().map(seen).collect())
        })
        .collect();
    let (mut moving, mut still, mut motion, mut n_groups) = (Vec::new(), Vec::new(), Vec::new(), 0);
    // Copies and mirror images bear the same tracks again, in planes that the camera has not seen.
    let mut is_known = BTreeSet::new();
    for (row, joint) in growth.skeleton.joints().iter().enumerate() {
        let new = joint.tracks.iter().filter(|track| is_known.insert(**track));
        let of_joint: Vec<&Told> = new.filter_map(|track| told.get(track)).collect();
        n_groups += usize::from(!of_joint.is_empty());
        let Some(usual) = mean(poses.iter().map(|(_, at)| at[row])) else { continue };
        let wanted = poses.iter().filter_map(|(frame, at)| {
            let now = of_joint.iter().filter_map(|(first, at)| at.get(frame.checked_sub(*first)? as usize));
            Some((at[row], mean(now.copied())?))
        });
        let pairs: Vec<([f64; 2], [f64; 2])> = wanted.collect();
        let beside = pairs.iter().map(|(at, wanted)| [at[0] - wanted[0], at[1] - wanted[1]]);
        let offset = mean(beside.clone()).unwrap_or_default();
        moving.extend(pairs.iter().map(|(at, wanted)| apart(*at, *wanted)));
        still.extend(pairs.iter().map(|(_, wanted)| apart(usual, *wanted)));
        motion.extend(beside.map(|by| apart(by, offset)));
    }
    let median = |values| median(values).ok_or(WorkbenchError::NoTruth);
    let (median_px, still_px, motion_px) = (median(moving)?, median(still)?, median(motion)?);
    Ok(Judged { n_groups, n_tracks: told.len(), frames: compared, median_px, still_px, motion_px })
}

/// The frames that the truth and a skeleton both have.
fn both(truth: &Truth, grown: &Range<u32>) -> Result<Range<u32>, WorkbenchError> {
    let first = truth.values().map(|path| path.first_frame).min().unwrap_or(0);
    let ends = truth.values().map(|path| path.first_frame.saturating_add(path.positions.len() as u32));
    let end = ends.max().unwrap_or(0);
    let compared = first.max(grown.start)..end.min(grown.end);
    if compared.is_empty() {
        return Err(WorkbenchError::TruthApart { truth: first..end, grown: grown.clone() });
    }
    Ok(compared)
}

/// From the centre of a group to where each of its tracks usually is, pixels (right, down).
fn places(project: &Project, tracks: &[TrackId]) -> Result<Vec<(TrackId, [f64; 2])>, WorkbenchError> {
    let n_frames = project.clip().clip.times.len();
    let mut paths = Vec::with_capacity(tracks.len());
    for &track in tracks {
        paths.push(path(track, project.shown(track)?.as_deref(), 0..n_frames));
    }
    let followed = follow(&paths.iter().collect::<Vec<_>>());
    let places = followed.into_iter().flat_map(|followed| followed.places);
    Ok(tracks.iter().copied().zip(places).collect())
}

/// What the truth says of the centre of a track's group; `None` where no true point is near when the track begins.
fn told_of(
    project: &Project,
    truth: &Truth,
    track: TrackId,
    place: [f64; 2],
) -> Result<Option<Told>, WorkbenchError> {
    let Some(span) = project.shown(track)? else { return Ok(None) };
    let Some((frame, sample)) = span.frames().zip(&span.samples).find(|(_, sample)| sample.status.is_seen())
    else {
        return Ok(None);
    };
    let begins = [f64::from(sample.x), f64::from(sample.y)];
    let there = truth.values().filter_map(|path| {
        let (x, y, is_visible) = *path.positions.get(frame.checked_sub(path.first_frame)? as usize)?;
        is_visible.then_some((apart([x, y], begins), [x, y], path))
    });
    let nearest = there.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(far, ..)| *far <= NEAR);
    // The feature lies beside the point, and the centre beside the feature.
    Ok(nearest.map(|(_, from, path)| {
        let by = [begins[0] - from[0] - place[0], begins[1] - from[1] - place[1]];
        (path.first_frame, path.positions.iter().map(|(x, y, _)| [x + by[0], y + by[1]]).collect())
    }))
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn mean(places: impl Iterator<Item = [f64; 2]>) -> Option<[f64; 2]> {
    let (mut n, mut sum) = (0.0, [0.0; 2]);
    for [x, y] in places {
        (n, sum) = (n + 1.0, [sum[0] + x, sum[1] + y]);
    }
    (n > 0.0).then(|| sum.map(|v| v / n))
}
