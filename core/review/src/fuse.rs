//! The best path through the candidates of several trackers between two key-frames: Viterbi's algorithm.
//!
//! In every frame the path is on one candidate. It costs what speaks against the samples on it, and every pixel that
//! it jumps: from one candidate to another, and at the key-frames.

use std::ops::Range;

use honami_model::track::{Sample, Span};

use crate::evidence::Parts;
use crate::suspicion::{LOST, probability};

/// A jump of so many pixels is as unlikely as a factor e.
const JUMP_PX: f64 = 2.0;
/// No sample is surer to be bad than this: one wrong frame must not cut a candidate in two.
const SUREST: f64 = 0.999;

/// The key-frames at the ends of the stretch, image pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ends {
    /// In the frame before the first.
    pub before: Option<[f32; 2]>,
    /// In the frame after the last.
    pub after: Option<[f32; 2]>,
}

/// A sample of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picked {
    /// Index of the candidate it is from.
    pub candidate: usize,
    /// The sample, shifted so that the path goes through the key-frames.
    pub sample: Sample,
}

/// The cheapest path, one sample a frame; `None` where the stretch is empty or no candidate has a sample in some
/// frame. Of equal ones that of the candidate named first. A candidate that has samples in the key-frames' frames tells
/// there how far it is off. O(frames · candidates²).
#[must_use]
pub fn fuse(frames: Range<u32>, ends: &Ends, candidates: &[&Span]) -> Option<Vec<Picked>> {
    if frames.is_empty() {
        return None;
    }
    // (frames, candidates): which candidate the cheapest path to this one comes from.
    let mut from: Vec<Vec<usize>> = Vec::with_capacity(frames.len());
    let mut cost: Vec<f64> = candidates
        .iter()
        .map(|c| cost_of(c, frames.start) + gap(c, frames.start, frames.start.checked_sub(1), ends.before))
        .collect();
    for frame in frames.start + 1..frames.end {
        let arrive = |to: &&Span| {
            let step = |k: usize| cost[k] + jump(candidates[k], to, frame);
            let best = (0..candidates.len()).min_by(|&a, &b| step(a).total_cmp(&step(b))).unwrap_or(0);
            (best, step(best) + cost_of(to, frame))
        };
        let (best, next) = candidates.iter().map(arrive).unzip();
        from.push(best);
        cost = next;
    }
    let last = frames.end - 1;
    let total = |k: usize| cost[k] + gap(candidates[k], last, Some(frames.end), ends.after);
    let mut on = (0..candidates.len()).min_by(|&a, &b| total(a).total_cmp(&total(b)))?;
    if !total(on).is_finite() {
        return None;
    }
    let mut path = vec![on];
    for from in from.iter().rev() {
        on = from[on];
        path.push(on);
    }
    path.reverse();
    let picked = frames.clone().zip(path).map(|(frame, k)| candidates[k].get(frame).map(|s| (k, *s)));
    through_ends(&frames, ends, candidates, &picked.collect::<Option<Vec<_>>>()?)
}

/// Shifts the path so that it goes through the key-frames: by what it misses them, eased over the stretch (E11).
fn through_ends(
    frames: &Range<u32>,
    ends: &Ends,
    candidates: &[&Span],
    path: &[(usize, Sample)],
) -> Option<Vec<Picked>> {
    let miss = |k: usize, frame: Option<u32>, key: Option<[f32; 2]>| {
        let there = frame.and_then(|frame| candidates[k].get(frame));
        there.zip(key).map_or([0.0; 2], |(s, key)| [key[0] - s.x, key[1] - s.y])
    };
    let (first, last) = (path.first()?.0, path.last()?.0);
    let at_start = miss(first, frames.start.checked_sub(1), ends.before);
    let at_end = miss(last, Some(frames.end), ends.after);
    let n = path.len() as f32 + 1.0;
    let shifted = path.iter().zip(1..).map(|(&(candidate, sample), k)| {
        let s = k as f32 / n;
        let ease = s * s * (3.0 - 2.0 * s);
        let shift = |axis: usize| at_start[axis] * (1.0 - ease) + at_end[axis] * ease;
        Picked { candidate, sample: Sample { x: sample.x + shift(0), y: sample.y + shift(1), ..sample } }
    });
    Some(shifted.collect())
}

/// What speaks against a candidate's sample: `-ln(1 - p)`; infinite where it has none.
fn cost_of(candidate: &Span, frame: u32) -> f64 {
    let Some(sample) = candidate.get(frame) else { return f64::INFINITY };
    let p = if sample.status.is_seen() {
        probability(&Parts { fb_px: sample.quality.fb_px, ..Parts::default() })
    } else {
        f64::from(LOST)
    };
    -(1.0 - p.clamp(0.0, SUREST)).ln()
}

/// Cost of the jump to a key-frame beside the stretch: measured in the key-frame's frame where the candidate has a
/// sample there, else from its sample next to it.
fn gap(candidate: &Span, inner: u32, outer: Option<u32>, key: Option<[f32; 2]>) -> f64 {
    let sample = outer.and_then(|outer| candidate.get(outer)).or_else(|| candidate.get(inner));
    let distance = |(sample, key): (&Sample, [f32; 2])| (sample.x - key[0]).hypot(sample.y - key[1]);
    sample.zip(key).map_or(0.0, |at| f64::from(distance(at)) / JUMP_PX)
}

/// Cost of going from one candidate to another between a frame and the one before: their distance in the frame before,
/// or where the second has no sample there, in this one.
fn jump(from: &Span, to: &Span, frame: u32) -> f64 {
    if std::ptr::eq(from, to) {
        return 0.0;
    }
    let both = |frame: u32| from.get(frame).zip(to.get(frame));
    let left = || from.get(frame - 1).zip(to.get(frame));
    let Some((a, b)) = both(frame - 1).or_else(|| both(frame)).or_else(left) else { return f64::INFINITY };
    f64::from((a.x - b.x).hypot(a.y - b.y)) / JUMP_PX
}

#[cfg(test)]
mod tests;
