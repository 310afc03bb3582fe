//! Composition: the track a person sees, from immutable runs and the hand work over them.
//!
//! In every frame, the first of these that exists:
//! 1. the key-frame there (source `key`): a person's word, which no tracker changes;
//! 2. what a correction has laid there, which may be nothing at all;
//! 3. between two key-frames, where no run has *seen* the feature: the Hermite curve through the key-frames
//!    (source `interpolated`), still `occluded` where a run says so, else `tracked`; no curve goes through a
//!    key-frame at which the feature is lost or outside;
//! 4. the sample of the topmost shown run that has one there: a later run over some frames overrides those
//!    frames and no others;
//! 5. the last position before, `lost`: a track has no gaps from its first sample to its last.

use crate::clip::FrameTimes;
use crate::curve::{Knot, Segment, through};
use crate::document::{Key, Track};
use crate::track::{Quality, Sample, Source, Span, Status};

/// The shown track; empty when it has neither samples nor key-frames, or is deleted.
///
/// `runs` are the spans of the shown runs, the topmost last, several of one run in any order. Frames beyond
/// `times` are left out. O(frames + spans), each sample looked at once.
#[must_use]
pub fn compose(track: &Track, runs: &[&Span], times: &FrameTimes) -> Span {
    if track.deleted {
        return Span::default();
    }
    let Some((first_frame, end)) = extent(track, runs, times.len()) else { return Span::default() };
    let at = |frame: u32| (frame - first_frame) as usize;
    let mut shown: Vec<Option<Sample>> = vec![None; at(end)];
    for span in runs {
        let samples = span.frames().zip(&span.samples).filter(|(frame, _)| *frame < end);
        for (frame, sample) in samples {
            shown[at(frame)] = Some(*sample);
        }
    }
    let keys: Vec<(u32, Key)> = track.keys.range(..end).map(|(&frame, &key)| (frame, key)).collect();
    for placed in keys.chunk_by(|(_, a), (_, b)| a.is_placed() && b.is_placed()) {
        for (pair, curve) in placed.windows(2).zip(curve(placed, times)) {
            for frame in pair[0].0 + 1..pair[1].0 {
                let slot = &mut shown[at(frame)];
                if !slot.is_some_and(|sample| sample.status.is_seen()) {
                    let hidden = slot.is_some_and(|sample| sample.status == Status::Occluded);
                    let status = if hidden { Status::Occluded } else { Status::Tracked };
                    *slot = times.get(frame).map(|t_s| interpolated(&curve, t_s, status));
                }
            }
        }
    }
    for (&frame, over) in track.over.range(..end) {
        shown[at(frame)] = over.sample().copied();
    }
    for (frame, Key { x, y, status, .. }) in keys {
        let quality = Quality::default();
        shown[at(frame)] = Some(Sample { x, y, status, source: Source::Key, quality });
    }
    hold(first_frame, &shown)
}

/// First frame and one past the last that anything is known of, within the clip.
fn extent(track: &Track, runs: &[&Span], n_frames: u32) -> Option<(u32, u32)> {
    let runs = runs.iter().map(|span| span.frames()).filter(|frames| !frames.is_empty());
    let work = track.keys.keys().chain(track.over.keys()).map(|&frame| frame..frame + 1);
    let first = runs.clone().chain(work.clone()).map(|frames| frames.start).min()?;
    let end = runs.chain(work).map(|frames| frames.end).max()?.min(n_frames);
    (first < end).then_some((first, end))
}

fn curve(keys: &[(u32, Key)], times: &FrameTimes) -> Vec<Segment> {
    let knots: Vec<Knot> = keys
        .iter()
        .filter_map(|(frame, key)| {
            times.get(*frame).map(|t_s| Knot { t_s, at: [f64::from(key.x), f64::from(key.y)] })
        })
        .collect();
    through(&knots)
}

fn interpolated(curve: &Segment, t_s: f64, status: Status) -> Sample {
    let [x, y] = curve.at(t_s);
    Sample { x: x as f32, y: y as f32, status, source: Source::Interpolated, quality: Quality::default() }
}

/// From the first sample to the last, gaps filled with the sample before, lost.
fn hold(first_frame: u32, shown: &[Option<Sample>]) -> Span {
    let n_before = shown.iter().take_while(|slot| slot.is_none()).count();
    let n_after = shown.iter().rev().take_while(|slot| slot.is_none()).count();
    let mut last = None;
    let held = shown[..shown.len() - n_after].iter().skip(n_before).filter_map(|slot| {
        last = slot.or_else(|| {
            last.map(|sample: Sample| Sample {
                status: Status::Lost,
                source: Source::Interpolated,
                quality: Quality::default(),
                ..sample
            })
        });
        last
    });
    let samples: Vec<Sample> = held.collect();
    let first_frame = if samples.is_empty() { 0 } else { first_frame + u32::try_from(n_before).unwrap_or(0) };
    Span { first_frame, samples }
}

#[cfg(test)]
mod tests;
