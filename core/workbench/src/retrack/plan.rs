//! Which frames are tracked anew, and from which key-frames.

use std::collections::BTreeMap;
use std::ops::{Range, RangeInclusive};

use honami_model::document::Key;
use honami_model::track::{Source, Span};
use honami_review::loko::Placed;

use super::Way;

/// Consecutive frames that are tracked anew, and where the feature is said to be beside them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stretch {
    /// The frames; those of the key-frames are not among them.
    pub(super) frames: Range<u32>,
    /// Its position in the frame before them.
    pub(super) before: Option<[f32; 2]>,
    /// Its position in the frame after them.
    pub(super) after: Option<[f32; 2]>,
}

/// One direction through a stretch.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pass {
    /// The key-frame's frame.
    pub(super) from: u32,
    /// Its position, pixels.
    pub(super) at: [f32; 2],
    /// The frames to follow it through.
    pub(super) frames: Range<u32>,
    /// Against time.
    pub(super) backward: bool,
}

impl Pass {
    /// All frames in the order of the pass, the key-frame first.
    pub(super) fn order(&self) -> impl Iterator<Item = u32> + use<> {
        let frames = self.frames.clone();
        let turn = self.backward;
        let nth = move |k: u32| if turn { frames.end - 1 - k } else { frames.start + k };
        std::iter::once(self.from).chain((0..self.frames.end - self.frames.start).map(nth))
    }
}

impl Stretch {
    /// The frames between two positions.
    pub(super) fn between([(first, before), (last, after)]: [Placed; 2]) -> Self {
        Self { frames: first + 1..last, before: Some(before), after: Some(after) }
    }

    pub(super) fn forward(&self) -> Option<Pass> {
        let at = self.before?;
        let frames = self.frames.clone();
        Some(Pass { from: frames.start - 1, at, frames, backward: false })
    }

    pub(super) fn backward(&self) -> Option<Pass> {
        let at = self.after?;
        let frames = self.frames.clone();
        Some(Pass { from: frames.end, at, frames, backward: true })
    }
}

/// Frames in which a person, or the birth of the track, says where the feature is; `None`: that it is lost there.
pub(crate) type Anchors = BTreeMap<u32, Option<[f32; 2]>>;

/// The key-frames, and the track's first sample where it was found before the first of them: what the feature is was
/// said there.
pub(super) fn anchors(keys: &BTreeMap<u32, Key>, shown: &Span) -> Anchors {
    let mut anchors: Anchors =
        keys.iter().map(|(&frame, key)| (frame, key.is_placed().then_some([key.x, key.y]))).collect();
    if let Some(birth) = shown.samples.first() {
        let is_found = birth.status.is_seen() && birth.source != Source::Interpolated;
        if is_found && anchors.keys().next().is_none_or(|&first| shown.first_frame < first) {
            anchors.insert(shown.first_frame, Some([birth.x, birth.y]));
        }
    }
    anchors
}

/// The stretches between the anchors in a range of frames that can be tracked in the given direction.
pub(super) fn stretches(anchors: &Anchors, frames: &RangeInclusive<u32>, way: Way) -> Vec<Stretch> {
    let (first, end) = (*frames.start(), *frames.end() + 1);
    let mut stretches = Vec::new();
    let mut start = (first, None);
    let inside = anchors.range(frames.clone()).map(|(&frame, &at)| (frame, at));
    for (frame, at) in inside.chain(std::iter::once((end, None))) {
        let before = start.1.filter(|_| way != Way::Backward);
        let after = at.filter(|_| way != Way::Forward);
        if start.0 < frame && (before.is_some() || after.is_some()) {
            stretches.push(Stretch { frames: start.0..frame, before, after });
        }
        start = (frame + 1, at);
    }
    stretches
}

/// The range that a person means who says `way` with the cursor on `frame`.
///
/// Forward: from the last anchor up to the next; backward: from the next anchor down to the last; both: from the
/// last before to the next after, which are two stretches where the frame is an anchor itself. Where no anchor ends
/// it, it ends with `limits`.
pub(super) fn around(anchors: &Anchors, frame: u32, way: Way, limits: &Limits) -> RangeInclusive<u32> {
    let up_to = |frame: u32| anchors.range(..=frame).next_back().map(|(&at, _)| at);
    let below = |frame: u32| anchors.range(..frame).next_back().map(|(&at, _)| at);
    let from = |frame: u32| anchors.range(frame..).next().map(|(&at, _)| at);
    let above = |frame: u32| anchors.range(frame + 1..).next().map(|(&at, _)| at);
    let (start, end) = match way {
        Way::Forward => {
            let start = up_to(frame);
            (start, above(start.unwrap_or(frame)))
        }
        Way::Backward => {
            let end = from(frame);
            (below(end.unwrap_or(frame)), end)
        }
        Way::Both => (below(frame), above(frame)),
    };
    limits.cut(start, end, (from(frame), up_to(frame)))
}

/// How far a re-tracking goes where no anchor ends it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Limits {
    /// A range that was marked: nothing outside it changes, whatever else there is.
    pub(super) marked: Option<Range<u32>>,
    /// Frames in which the track was followed before.
    pub(super) followed: Range<u32>,
    /// Frames of the clip.
    pub(super) n_frames: u32,
}

impl Limits {
    /// The range between two ends, where there are such; `sides` are the anchors from which a pass leaves the frame,
    /// back and ahead.
    fn cut(
        &self,
        start: Option<u32>,
        end: Option<u32>,
        sides: (Option<u32>, Option<u32>),
    ) -> RangeInclusive<u32> {
        if let Some(marked) = &self.marked {
            // An anchor beside the range is where a pass into it begins.
            let is_beside = |at: &u32| at.saturating_add(1) >= marked.start && *at <= marked.end;
            let start = start.filter(is_beside).unwrap_or(marked.start);
            let end = end.filter(is_beside).unwrap_or(marked.end.saturating_sub(1));
            return start..=end.min(self.n_frames.saturating_sub(1));
        }
        // Who sets a key-frame beyond what was followed wants to go on from there.
        let is_followed = |at: Option<u32>| at.is_some_and(|at| self.followed.contains(&at));
        let first = if is_followed(sides.0) { self.followed.start } else { 0 };
        let end_frame = if is_followed(sides.1) { self.followed.end } else { self.n_frames };
        start.unwrap_or(first)..=end.unwrap_or(end_frame.saturating_sub(1))
    }
}
