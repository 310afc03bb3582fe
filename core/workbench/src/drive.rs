//! Driving a tracker over the frames of a clip: seeds where they are due, detection where it is asked for.

use std::collections::BTreeMap;
use std::ops::Range;

use honami_host::{CallContext, DetectInput, FrameView, Point, PointRow, StreamInfo, Tracker};
use honami_media::Media;
use honami_model::picture::Gray;
use honami_model::track::{Quality, Sample, Source, Status, TrackId};

use crate::error::WorkbenchError;
use crate::progress::{Control, Progress};

/// A feature given to a tracker in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seed {
    /// The frame in which the position holds.
    pub frame: u32,
    /// Its track.
    pub track: TrackId,
    /// Pixels, right.
    pub x: f32,
    /// Pixels, down.
    pub y: f32,
}

/// Where and how often a tracker is asked for new features.
#[derive(Clone, Debug)]
pub struct Detect {
    /// Detect in the first frame, and again every so many frames.
    pub every: Option<u32>,
    /// A byte a pixel, non-zero where features may be; `None`: everywhere.
    pub mask: Option<Vec<u8>>,
    /// Numbers for the features found; when they are used up, detection ends.
    pub ids: Range<u32>,
}

/// What a tracker is to do.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Frames to track, in order.
    pub frames: Range<u32>,
    /// Features to follow; those given in other frames are ignored.
    pub seeds: Vec<Seed>,
    /// New features on the way.
    pub detect: Option<Detect>,
    /// Threads the tracker may use.
    pub max_threads: u32,
}

/// One row a live track.
pub type Rows = Vec<(TrackId, Sample)>;

/// Follows the plan and hands every frame's rows to `sink`, in order. Returns the first frame not tracked.
///
/// Where a person stops it, or the tracker fails, the frames before are with the sink already.
///
/// # Errors
/// What the clip, the tracker or the sink met.
pub fn drive(
    media: &Media,
    tracker: &mut Tracker,
    mut plan: Plan,
    sink: &mut dyn FnMut(u32, &Rows) -> Result<(), WorkbenchError>,
    progress: &dyn Progress,
) -> Result<u32, WorkbenchError> {
    let clip = media.clip();
    let call = CallContext::default();
    tracker.begin(
        &StreamInfo {
            width: clip.width,
            height: clip.height,
            fps: clip.times.nominal_fps(),
            n_frames: Some(u64::from(plan.frames.end - plan.frames.start)),
            reversed: false,
            max_threads: plan.max_threads,
            seed: 0,
            births: 0..0,
        },
        &call,
    )?;
    plan.seeds.sort_by_key(|seed| (seed.frame, seed.track));
    let total = u64::from(plan.frames.end - plan.frames.start);
    let mut late = Late::default();
    for frame in plan.frames.clone() {
        let done = u64::from(frame - plan.frames.start);
        if progress.report(done, total, "frame") == Control::Stop {
            late.flush(tracker, &call, sink)?;
            return Ok(frame);
        }
        let picture = media.frame(frame)?;
        let view = FrameView {
            gray: picture.planes().y,
            index: i64::from(frame),
            time_s: clip.times.get(frame).unwrap_or(0.0),
        };
        let first = frame == plan.frames.start;
        let mut rows = if first { Vec::new() } else { late.push(tracker, &view, &call)? };
        let mut new = due(&plan.seeds, frame);
        if let Some(detect) = &mut plan.detect {
            let again = detect.every.is_some_and(|every| (frame - plan.frames.start).is_multiple_of(every));
            if first || again {
                new.extend(find(tracker, &view, detect, &rows, &new, plan.max_threads, &call)?);
            }
        }
        if !new.is_empty() {
            tracker.seed(&new, &call)?;
        }
        if first {
            rows = late.push(tracker, &view, &call)?;
        } else {
            place(&mut rows, &new);
        }
        sink(frame, &rows)?;
    }
    progress.report(total, total, "frame");
    tracker.end(&call)?;
    Ok(plan.frames.end)
}
