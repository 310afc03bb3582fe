//! Disagreement with the neighbours: leaves on one twig move together.

use std::collections::BTreeMap;
use std::ops::Range;

use honami_model::track::{Span, TrackId};

use super::anchors::{Anchor, Anchors};
use super::steps::median;

/// So many neighbours are asked. Measured on wind: AUC .929 with 4, .947 with 8, .953 with 12, .955 with 20.
const N_NEIGHBOURS: usize = 12;
/// With fewer that are seen, nothing is said.
const FEWEST: usize = 3;
/// Added before the geometric mean, so that one perfect agreement does not hide the other, pixels.
const FLOOR_PX: f32 = 0.5;

/// All shown tracks, to look for neighbours in.
pub(super) struct Crowd<'a>(BTreeMap<TrackId, &'a Span>);

impl<'a> Crowd<'a> {
    pub(super) fn of(spans: impl Iterator<Item = (TrackId, &'a Span)>) -> Self {
        Self(spans.collect())
    }

    /// The nearest other tracks that are seen in the anchor's frame, nearest first; of equally near ones that with
    /// the smaller number.
    fn nearest(&self, track: TrackId, (frame, at): Anchor) -> Vec<(f32, TrackId)> {
        let others = self.0.iter().filter(|(id, _)| **id != track);
        let mut near: Vec<(f32, TrackId)> =
            others.filter_map(|(&id, span)| Some((distance(seen(span, frame)?, at), id))).collect();
        let order = |a: &(f32, TrackId), b: &(f32, TrackId)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        if near.len() > N_NEIGHBOURS {
            near.select_nth_unstable_by(N_NEIGHBOURS, order);
            near.truncate(N_NEIGHBOURS);
        }
        near.sort_by(order);
        near
    }
}

/// The neighbours of a track, and how far it strays from them.
#[derive(Clone, Debug, Default)]
pub(super) struct Neighbourhood {
    /// Of every anchor.
    of: Vec<Vec<(f32, TrackId)>>,
    /// Deviation of every sample, pixels; NaN where nothing is said.
    deviation_px: Vec<f32>,
}

impl Neighbourhood {
    pub(super) fn new(track: TrackId, span: &Span, anchors: &Anchors, crowd: &Crowd<'_>) -> Self {
        let of = anchors.as_slice().iter().map(|&anchor| crowd.nearest(track, anchor)).collect();
        let mut new = Self { of, deviation_px: vec![f32::NAN; span.samples.len()] };
        new.measure(span.frames(), span, anchors, crowd);
        new
    }

    /// Deviation of the sample with this index, pixels.
    pub(super) fn deviation_px(&self, at: usize) -> Option<f32> {
        self.deviation_px.get(at).copied().filter(|px| px.is_finite())
    }

    /// Whether it matters here that another track has moved in some frames.
    pub(super) fn is_touched(
        &self,
        moved: (TrackId, &Range<u32>),
        anchors: &Anchors,
        crowd: &Crowd<'_>,
    ) -> bool {
        anchors
            .as_slice()
            .iter()
            .zip(&self.of)
            .any(|(&anchor, near)| touch(moved, anchor, near, crowd) != Touch::None)
    }

    /// Another track has moved in some frames: measures anew what that changes.
    pub(super) fn moved(
        &mut self,
        moved: (TrackId, &Range<u32>),
        (track, span, anchors): (TrackId, &Span, &Anchors),
        crowd: &Crowd<'_>,
    ) {
        let mut again: Option<Range<u32>> = None;
        for (&anchor, near) in anchors.as_slice().iter().zip(&mut self.of) {
            let more = match touch(moved, anchor, near, crowd) {
                Touch::None => continue,
                Touch::Circle => {
                    *near = crowd.nearest(track, anchor);
                    span.frames()
                }
                Touch::Path => moved.1.clone(),
            };
            let old = again.unwrap_or_else(|| more.clone());
            again = Some(old.start.min(more.start)..old.end.max(more.end));
        }
        if let Some(frames) = again {
            self.measure(frames, span, anchors, crowd);
        }
    }

    fn measure(&mut self, frames: Range<u32>, span: &Span, anchors: &Anchors, crowd: &Crowd<'_>) {
        let circles: Vec<Circle<'_>> = anchors
            .as_slice()
            .iter()
            .zip(&self.of)
            .map(|(&anchor, near)| Circle::new(anchor, near, crowd))
            .collect();
        let frames = frames.start.max(span.frames().start)..frames.end.min(span.frames().end);
        for frame in frames {
            let after = anchors.as_slice().partition_point(|(at, _)| *at <= frame);
            let around = [after.checked_sub(1), Some(after)].into_iter().flatten();
            let strays = |circle: &Circle<'_>| circle.stray_px(frame, seen(span, frame)?);
            let said = around.filter_map(|k| circles.get(k)).filter_map(strays);
            self.deviation_px[(frame - span.first_frame) as usize] = geometric_mean(said).unwrap_or(f32::NAN);
        }
    }
}

/// What the movement of another track changes for the neighbours of an anchor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Touch {
    None,
    /// Who they are.
    Circle,
    /// Where one of them is.
    Path,
}

fn touch(
    (other, frames): (TrackId, &Range<u32>),
    (frame, at): Anchor,
    near: &[(f32, TrackId)],
    crowd: &Crowd<'_>,
) -> Touch {
    let was_near = near.iter().any(|(_, id)| *id == other);
    if !frames.contains(&frame) {
        return if was_near && !frames.is_empty() { Touch::Path } else { Touch::None };
    }
    let now = crowd.0.get(&other).and_then(|span| seen(span, frame)).map(|to| (distance(to, at), other));
    let comes =
        now.is_some_and(|now| near.len() < N_NEIGHBOURS || near.last().is_some_and(|last| now < *last));
    if was_near || comes { Touch::Circle } else { Touch::None }
}

/// An anchor and its neighbours, with where they are in the anchor's frame.
struct Circle<'a> {
    at: [f32; 2],
    others: Vec<(&'a Span, [f32; 2])>,
}

impl<'a> Circle<'a> {
    fn new((frame, at): Anchor, near: &[(f32, TrackId)], crowd: &Crowd<'a>) -> Self {
        let span = |(_, id): &(f32, TrackId)| crowd.0.get(id).copied();
        let others = near.iter().filter_map(span).filter_map(|span| Some((span, seen(span, frame)?)));
        Self { at, others: others.collect() }
    }

    /// How far the displacement from the anchor to `to` is from the median of the neighbours', pixels.
    fn stray_px(&self, frame: u32, to: [f32; 2]) -> Option<f32> {
        let moved: Vec<[f32; 2]> = self
            .others
            .iter()
            .filter_map(|(span, from)| seen(span, frame).map(|to| [to[0] - from[0], to[1] - from[1]]))
            .collect();
        if moved.len() < FEWEST {
            return None;
        }
        let middle = |axis: usize| median(moved.iter().map(|by| by[axis]));
        Some(distance([to[0] - self.at[0], to[1] - self.at[1]], [middle(0)?, middle(1)?]))
    }
}

/// The geometric mean of what the anchors around a sample say, pixels.
pub(super) fn geometric_mean(said: impl Iterator<Item = f32>) -> Option<f32> {
    let (log_sum, n) = said.fold((0.0, 0.0), |(sum, n), px| (sum + (px + FLOOR_PX).ln(), n + 1.0_f32));
    (n > 0.0).then(|| (log_sum / n).exp() - FLOOR_PX)
}

pub(super) fn seen(span: &Span, frame: u32) -> Option<[f32; 2]> {
    span.get(frame).filter(|sample| sample.status.is_seen()).map(|sample| [sample.x, sample.y])
}

fn distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
