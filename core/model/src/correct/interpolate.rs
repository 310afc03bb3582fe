//! Key-frames with a curve through them, laid over what a tracker found between them (Diener 2009, 3.4.1).

use std::collections::BTreeMap;

use super::{Correction, Refused, Shown, moved, position};
use crate::curve::{Knot, Segment, through};
use crate::document::Key;
use crate::over::{Laid, Over};
use crate::track::{Quality, Sample, Source, Status};

/// How near to the curve a sample is on it, pixels: what f32 keeps of a position in a large picture.
const ON_CURVE_PX: f64 = 1e-3;

/// Moves one sample and draws the Hermite curve through the key-frames on both sides of it.
///
/// The speeds at key-frames are weighted by time, one-sided at the ends (errata E9; exact for quadratics).
/// They depend on the key-frames beside them, so that the next segments change too: where they are
/// interpolated, not where a tracker has seen the feature. Frames that a person has marked keep their
/// status. On a side without a key-frame nothing changes: no curve goes there.
///
/// # Errors
/// What the document refuses: a frame beyond the clip, a position that is not finite.
pub fn hermite(shown: &Shown<'_>, frame: u32, to: [f32; 2]) -> Result<Correction, Refused> {
    let mut keys = shown.track.keys.clone();
    let old = curve(shown, &keys, frame);
    keys.insert(frame, Key::set(to[0], to[1]));
    let new = curve(shown, &keys, frame);
    let here = new.iter().position(|piece| piece.frames.1 == frame).map_or(0, |before| before + 1);
    let mut edits = vec![shown.key(frame, to)];
    for piece in &new[here.saturating_sub(2)..new.len().min(here + 2)] {
        let touches = piece.frames.0 == frame || piece.frames.1 == frame;
        edits.extend(shown.relay(piece.inner(), |at| {
            let t_s = shown.time(at);
            if touches {
                return Some(shown.between(at, piece.segment.at(t_s), true));
            }
            let Some(Over::Sample(laid)) = shown.track.over.get(&at) else { return None };
            let was = old.iter().find(|piece| piece.inner().contains(&at))?.segment.at(t_s);
            let [x, y] = position(&laid.sample);
            let is_on_it =
                laid.sample.source == Source::Interpolated && (x - was[0]).hypot(y - was[1]) < ON_CURVE_PX;
            let sample = moved(&laid.sample, piece.segment.at(t_s));
            is_on_it.then_some(Some(Over::Sample(Laid { sample, run: None })))
        }));
    }
    shown.correct(edits, "drawn through key-frames")
}

/// Moves one sample and draws straight lines to the key-frames on both sides of it, at an even pace.
///
/// On a side without a key-frame nothing changes. Frames that a person has marked keep their status.
///
/// # Errors
/// What the document refuses: a frame beyond the clip, a position that is not finite.
pub fn linear(shown: &Shown<'_>, frame: u32, to: [f32; 2]) -> Result<Correction, Refused> {
    let mut keys = shown.track.keys.clone();
    keys.insert(frame, Key::set(to[0], to[1]));
    let mut edits = vec![shown.key(frame, to)];
    for piece in curve(shown, &keys, frame) {
        if piece.frames.0 == frame || piece.frames.1 == frame {
            let (from, to) = (piece.segment.from, piece.segment.to);
            let line = |t_s: f64| {
                let tau = (t_s - from.t_s) / (to.t_s - from.t_s);
                [0, 1].map(|axis| from.at[axis] + tau * (to.at[axis] - from.at[axis]))
            };
            edits.extend(
                shown.relay(piece.inner(), |at| Some(shown.between(at, line(shown.time(at)), false))),
            );
        }
    }
    shown.correct(edits, "drawn straight between key-frames")
}

/// The curve between two consecutive key-frames.
struct Piece {
    frames: (u32, u32),
    segment: Segment,
}

impl Piece {
    /// The frames between the two.
    fn inner(&self) -> std::ops::Range<u32> {
        self.frames.0 + 1..self.frames.1
    }
}

/// The curve through the placed key-frames around a frame, up to those at which the feature is lost.
fn curve(shown: &Shown<'_>, keys: &BTreeMap<u32, Key>, frame: u32) -> Vec<Piece> {
    let before = keys.range(..=frame).rev().take_while(|(_, key)| key.is_placed());
    let after = keys.range(frame.saturating_add(1)..).take_while(|(_, key)| key.is_placed());
    let mut placed: Vec<(u32, Knot)> = before
        .chain(after)
        .filter_map(|(&frame, key)| {
            let t_s = shown.times.get(frame)?;
            Some((frame, Knot { t_s, at: [f64::from(key.x), f64::from(key.y)] }))
        })
        .collect();
    placed.sort_unstable_by_key(|(frame, _)| *frame);
    let knots: Vec<Knot> = placed.iter().map(|(_, knot)| *knot).collect();
    let frames = placed.windows(2).map(|pair| (pair[0].0, pair[1].0));
    frames.zip(through(&knots)).map(|(frames, segment)| Piece { frames, segment }).collect()
}

impl Shown<'_> {
    /// What lies at a frame between two key-frames once the curve goes through `at`; nothing where the
    /// composition draws the same curve of itself (`is_live`) because no run has seen the feature.
    fn between(&self, frame: u32, at: [f64; 2], is_live: bool) -> Option<Over> {
        let marked = self.track.over.get(&frame).and_then(Over::sample).map(|sample| sample.status);
        let run = self.runs.iter().rev().find_map(|(_, span)| span.get(frame)).map(|sample| sample.status);
        let status = match (marked, run) {
            (Some(marked), _) if !marked.is_seen() => marked,
            (_, run) if is_live && !run.is_some_and(Status::is_seen) => return None,
            (_, Some(Status::Occluded)) => Status::Occluded,
            _ => Status::Tracked,
        };
        let (source, quality) = (Source::Interpolated, Quality::default());
        let sample = Sample { x: at[0] as f32, y: at[1] as f32, status, source, quality };
        Some(Over::Sample(Laid { sample, run: None }))
    }
}
