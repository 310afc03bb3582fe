//! What the passes found, laid over the track; what a person has made stays.

use std::collections::BTreeMap;

use honami_model::clip::FrameTimes;
use honami_model::correct::{Correction, Side, blended};
use honami_model::document::{Key, RunId};
use honami_model::edit::Edit;
use honami_model::over::{Laid, Over};
use honami_model::track::Source;

use super::pass::Found;
use super::plan::{self, Anchors, Stretch};
use super::{RetrackRequest, Way};
use crate::error::WorkbenchError;
use crate::ground::Ground;

/// What both directions found of one stretch.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tracked {
    pub(super) stretch: Stretch,
    pub(super) forward: Option<Found>,
    pub(super) backward: Option<Found>,
}

/// Numbers of the two runs, where there are two.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Runs {
    pub(super) forward: Option<RunId>,
    pub(super) backward: Option<RunId>,
}

/// Where a person, or the track's birth, says where the feature is; with a key-frame that is still to be set.
pub(super) fn anchors(ground: &Ground, key: Option<(u32, Key)>, times: &FrameTimes) -> Anchors {
    let mut keys = ground.track.keys.clone();
    keys.extend(key);
    plan::anchors(&keys, ground.shown(times).span())
}

/// Whether a person made what lies there: took a sample away, drew it, or said something else of the feature than the
/// run in which it was found.
fn is_hand(ground: &Ground, frame: u32, over: &Over) -> bool {
    let Over::Sample(Laid { sample, run }) = over else { return true };
    let found = run.and_then(|run| ground.found(run, frame));
    let is_marked = !sample.status.is_seen() && found.is_none_or(|found| found.status != sample.status);
    matches!(sample.source, Source::Key | Source::Sketch) || is_marked
}

/// The correction that lays what was found.
pub(super) fn correction(
    ground: &Ground,
    request: &RetrackRequest,
    tracked: &[Tracked],
    runs: Runs,
    times: &FrameTimes,
) -> Result<Correction, WorkbenchError> {
    let track = request.track;
    let under = &ground.track.over;
    let mut new: BTreeMap<u32, Over> = BTreeMap::new();
    let mut n_kept = 0;
    for (frame, laid) in tracked.iter().flat_map(|one| one.path(runs, times)) {
        if under.get(&frame).is_some_and(|over| is_hand(ground, frame, over)) {
            n_kept += 1;
        } else {
            new.insert(frame, Over::Sample(laid));
        }
    }
    let (Some((&first, _)), Some((&last, _))) = (new.first_key_value(), new.last_key_value()) else {
        return Err(WorkbenchError::LostAtOnce { track });
    };
    let over = |frame| new.get(&frame).or_else(|| under.get(&frame)).copied();
    let lay = Edit::Lay { track, first_frame: first, over: (first..=last).map(over).collect() };
    let key = request.key.map(|(frame, key)| Edit::SetKey { track, frame, key });
    let edits = key.into_iter().chain([lay]).collect();
    let mut correction = ground.shown(times).correct(edits, "")?;
    correction.transaction.label = label(request, tracked, (first, last), n_kept, correction.largest_px);
    Ok(correction)
}

/// What was done, in the user's words: `track 42: re-tracked 120-203 both ways, up to 6.3 px`.
fn label(
    request: &RetrackRequest,
    tracked: &[Tracked],
    (first, last): (u32, u32),
    n_kept: usize,
    largest_px: f32,
) -> String {
    let way = match request.way {
        Way::Forward => "forward",
        Way::Backward => "backward",
        Way::Both => "both ways",
    };
    let mut label = format!("track {}: ", request.track);
    if let Some((frame, _)) = request.key {
        label += &format!("key-frame at {frame}, ");
    }
    label += &format!("re-tracked {first}-{last} {way}");
    if largest_px >= 0.05 {
        label += &format!(", up to {largest_px:.1} px");
    }
    let found = tracked.iter().flat_map(|one| [&one.forward, &one.backward]).flatten();
    let lost: Vec<String> = found.filter_map(|found| found.lost).map(|frame| frame.to_string()).collect();
    if !lost.is_empty() {
        label += &format!(", lost at {}", lost.join(" and "));
    }
    match n_kept {
        0 => {}
        1 => label += ", 1 frame of hand work kept",
        n => label += &format!(", {n} frames of hand work kept"),
    }
    label
}

impl Tracked {
    /// The new sample of every frame of the stretch that has one, and the run it counts to.
    fn path(&self, runs: Runs, times: &FrameTimes) -> Vec<(u32, Laid)> {
        let Stretch { frames, before, after } = &self.stretch;
        match (&self.forward, &self.backward, before.zip(*after)) {
            (Some(ahead), Some(back), Some((before, after))) => {
                let keys = [(frames.start - 1, before.map(f64::from)), (frames.end, after.map(f64::from))];
                let run = |side| match side {
                    Side::Forward => runs.forward,
                    Side::Backward => runs.backward,
                };
                let path = blended(&ahead.span, &back.span, keys, times).into_iter();
                path.map(|at| (at.frame, Laid { sample: at.sample, run: at.side.and_then(run) })).collect()
            }
            (Some(one), None, _) => self.alone(one, runs.forward),
            (_, Some(one), _) => self.alone(one, runs.backward),
            (None, None, _) => Vec::new(),
        }
    }

    fn alone(&self, found: &Found, run: Option<RunId>) -> Vec<(u32, Laid)> {
        let samples = found.span.frames().zip(&found.span.samples);
        let inside = samples.filter(|(frame, _)| self.stretch.frames.contains(frame));
        inside.map(|(frame, &sample)| (frame, Laid { sample, run })).collect()
    }
}
