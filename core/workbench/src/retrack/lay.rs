//! What the passes found, laid over the track; what a person has made stays.

use std::collections::BTreeMap;

use honami_model::clip::FrameTimes;
use honami_model::correct::{Correction, Side, blended};
use honami_model::document::{Key, RunId};
use honami_model::edit::Edit;
use honami_model::over::{Laid, Over};
use honami_model::track::{Source, Span, TrackId};

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
pub(super) fn anchors(ground: &Ground, more: &[(u32, Key)], times: &FrameTimes) -> Anchors {
    let mut keys = ground.track.keys.clone();
    keys.extend(more.iter().copied());
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

/// A path that was laid over a track.
pub(super) struct Paved {
    track: TrackId,
    correction: Correction,
    /// The first and the last frame in which it lies.
    pub(super) frames: (u32, u32),
    /// Frames in which it does not, because a person has made what is there.
    n_kept: usize,
}

/// The correction that lays what was found.
pub(super) fn correction(
    ground: &Ground,
    request: &RetrackRequest,
    tracked: &[Tracked],
    runs: Runs,
    times: &FrameTimes,
) -> Result<Correction, WorkbenchError> {
    let path = tracked.iter().flat_map(|one| one.path(runs, times)).collect();
    let laid = laid(ground, &request.keys, path, times)?;
    let (first, last) = laid.frames;
    let way = match request.way {
        Way::Forward => "forward",
        Way::Backward => "backward",
        Way::Both => "both ways",
    };
    let found = tracked.iter().flat_map(|one| [&one.forward, &one.backward]).flatten();
    let lost: Vec<String> = found.filter_map(|found| found.lost).map(|frame| frame.to_string()).collect();
    let lost = if lost.is_empty() { String::new() } else { format!(", lost at {}", lost.join(" and ")) };
    let differ = tracked.iter().filter_map(Tracked::largest_difference).max_by(|a, b| a.1.total_cmp(&b.1));
    let differ = differ.filter(|(_, px)| *px >= 0.05);
    let differ =
        differ.map_or_else(String::new, |(frame, px)| format!(", ways differ up to {px:.1} px at {frame}"));
    Ok(laid.labelled(&request.keys, &format!("re-tracked {first}-{last} {way}"), &(differ + &lost)))
}

/// Sets key-frames and lays a path over a track, but not over what a person has made of it.
pub(super) fn laid(
    ground: &Ground,
    keys: &[(u32, Key)],
    path: Vec<(u32, Laid)>,
    times: &FrameTimes,
) -> Result<Paved, WorkbenchError> {
    let track = ground.id;
    let under = &ground.track.over;
    let mut new: BTreeMap<u32, Over> = BTreeMap::new();
    let mut n_kept = 0;
    for (frame, laid) in path {
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
    let keys = keys.iter().map(|&(frame, key)| Edit::SetKey { track, frame, key });
    let correction = ground.shown(times).correct(keys.chain([lay]).collect(), "")?;
    Ok(Paved { track, correction, frames: (first, last), n_kept })
}

impl Paved {
    /// Says what was done, in the user's words: `track 42: re-tracked 120-203 both ways, moved up to 6.3 px`,
    /// and then the notes.
    pub(super) fn labelled(self, keys: &[(u32, Key)], what: &str, notes: &str) -> Correction {
        let Self { track, mut correction, n_kept, .. } = self;
        let mut label = format!("track {track}: ");
        keys.iter().for_each(|(frame, _)| label += &format!("key-frame at {frame}, "));
        label += what;
        if correction.largest_px >= 0.05 {
            label += &format!(", moved up to {:.1} px", correction.largest_px);
        }
        label += notes;
        match n_kept {
            0 => {}
            1 => label += ", 1 frame of hand work kept",
            n => label += &format!(", {n} frames of hand work kept"),
        }
        correction.transaction.label = label;
        correction
    }
}

impl Tracked {
    /// The new sample of every frame of the stretch that has one, and the run it counts to.
    pub(super) fn path(&self, runs: Runs, times: &FrameTimes) -> Vec<(u32, Laid)> {
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

    /// The frame in which the two ways are farthest apart, and how far, pixels: there the blended path is least sure, and
    /// a key-frame tells most. `None` where only one way, or neither, has seen the feature.
    fn largest_difference(&self) -> Option<(u32, f32)> {
        let (ahead, back) = (&self.forward.as_ref()?.span, &self.backward.as_ref()?.span);
        let seen = |span: &Span, frame| {
            span.get(frame).filter(|sample| sample.status.is_seen()).map(|sample| [sample.x, sample.y])
        };
        let apart = |frame| {
            let ([ax, ay], [bx, by]) = (seen(ahead, frame)?, seen(back, frame)?);
            Some((frame, (ax - bx).hypot(ay - by)))
        };
        self.stretch.frames.clone().filter_map(apart).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    fn alone(&self, found: &Found, run: Option<RunId>) -> Vec<(u32, Laid)> {
        let samples = found.span.frames().zip(&found.span.samples);
        let inside = samples.filter(|(frame, _)| self.stretch.frames.contains(frame));
        inside.map(|(frame, &sample)| (frame, Laid { sample, run })).collect()
    }
}
