//! Where points truly are: a table, or a flow from one picture to the next.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use honami_exchange::TruthRow;
use honami_exchange::flo::{self, Flow};
use honami_model::clip::Clip;
use honami_model::track::TrackId;
use honami_motion::accuracy::TruePath;

use crate::drive::Seed;
use crate::error::WorkbenchError;

/// A visible position may lie so far outside the picture, pixels: whoever made the truth may count edges otherwise.
const MARGIN_PX: f64 = 1.0;

/// True positions of points, by their number.
pub type Truth = BTreeMap<TrackId, TruePath>;

/// Reads a table of true positions of a clip of `n_frames` frames, its rows in any order.
///
/// A frame between a point's first and last that has no row is one in which it is hidden, where it was before.
/// Of two rows for the same point and frame the later one counts.
///
/// # Errors
/// [`WorkbenchError::TruthFrame`] for a row beyond the clip; what the table says of its lines.
pub fn read_truth(path: &Path, n_frames: u32) -> Result<Truth, WorkbenchError> {
    let mut rows = BTreeMap::<TrackId, BTreeMap<u32, (f64, f64, bool)>>::new();
    for row in honami_exchange::read::<TruthRow>(path)? {
        let TruthRow { track, frame, x, y, visible, .. } = row?;
        if frame >= n_frames {
            return Err(WorkbenchError::TruthFrame { track, frame, n_frames });
        }
        rows.entry(TrackId(track)).or_default().insert(frame, (f64::from(x), f64::from(y), visible));
    }
    Ok(rows.into_iter().filter_map(|(track, rows)| Some((track, path_of(&rows)?))).collect())
}

fn path_of(rows: &BTreeMap<u32, (f64, f64, bool)>) -> Option<TruePath> {
    let (&first_frame, &first) = rows.first_key_value()?;
    let (&last_frame, _) = rows.last_key_value()?;
    let mut at = first;
    let positions = (first_frame..=last_frame).map(|frame| {
        at = rows.get(&frame).copied().unwrap_or((at.0, at.1, false));
        at
    });
    Some(TruePath { first_frame, positions: positions.collect() })
}

/// Refuses a truth that shows a point where the clip has no picture, or that ends before the frames do that are
/// compared.
///
/// # Errors
/// [`WorkbenchError::TruthEnd`], and [`WorkbenchError::TruthPoint`] for the first such position.
pub fn check_truth(truth: &Truth, clip: &Clip, frames: &Range<u32>) -> Result<(), WorkbenchError> {
    let ends = truth.values().map(|path| path.first_frame.saturating_add(path.positions.len() as u32));
    let end = ends.max().unwrap_or(0);
    if end < frames.end {
        return Err(WorkbenchError::TruthEnd { end, start: frames.start, wanted: frames.end });
    }
    check_inside(truth, clip)
}

/// Refuses a truth that shows a point where the clip has no picture.
///
/// # Errors
/// [`WorkbenchError::TruthPoint`] for the first such position.
pub(crate) fn check_inside(truth: &Truth, clip: &Clip) -> Result<(), WorkbenchError> {
    let (width, height) = (clip.width, clip.height);
    let inside = |v: f64, size: u32| (-0.5 - MARGIN_PX..f64::from(size) - 0.5 + MARGIN_PX).contains(&v);
    for (track, path) in truth {
        let mut positions = (path.first_frame..).zip(&path.positions);
        let stray = positions.find(|(_, (x, y, seen))| *seen && !(inside(*x, width) && inside(*y, height)));
        if let Some((frame, &(x, y, _))) = stray {
            return Err(WorkbenchError::TruthPoint { track: track.0, frame, x, y, width, height });
        }
    }
    Ok(())
}

/// Reads the true flow from one frame of the clip to the next.
///
/// # Errors
/// [`WorkbenchError::FlowSize`] when it is not as large as the clip, and what the file is if it is none.
pub fn read_flow(path: &Path, clip: &Clip) -> Result<Flow, WorkbenchError> {
    let flow = flo::read(path)?;
    let (came, wanted) = ([flow.width, flow.height], [clip.width, clip.height]);
    if came != wanted {
        return Err(WorkbenchError::FlowSize { path: path.to_owned(), came, wanted });
    }
    Ok(flow)
}

/// The truth of points as a flow tells it, in the first of `n_frames` frames and the next; points of which it knows
/// nothing are left out. A point that leaves the picture is hidden then.
///
/// # Errors
/// [`WorkbenchError::FlowFrames`] unless there are two frames.
pub fn truth_of_flow(flow: &Flow, points: &[Seed], n_frames: u32) -> Result<Truth, WorkbenchError> {
    if n_frames != 2 {
        return Err(WorkbenchError::FlowFrames { n_frames });
    }
    let path = |seed: &Seed| {
        let [u, v] = flow.at([seed.x, seed.y])?.map(f64::from);
        let (x, y) = (f64::from(seed.x), f64::from(seed.y));
        let inside = |v: f64, size: u32| (-0.5..f64::from(size) - 0.5).contains(&v);
        let visible = inside(x + u, flow.width) && inside(y + v, flow.height);
        Some((
            seed.track,
            TruePath { first_frame: seed.frame, positions: vec![(x, y, true), (x + u, y + v, visible)] },
        ))
    };
    Ok(points.iter().filter_map(path).collect())
}

/// Leaves out what comes after the frames that are compared.
pub(super) fn cut(truth: &mut Truth, end: u32) {
    for path in truth.values_mut() {
        path.positions.truncate(end.saturating_sub(path.first_frame) as usize);
    }
}
