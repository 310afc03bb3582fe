//! Composition: the track a person sees, from immutable runs and the hand work over them.
//!
//! In every frame, the first of these that exists:
//! 1. the key-frame there (source `key`): a person's word, which no tracker changes;
//! 2. between two key-frames, where no run has *seen* the feature: the Hermite curve through all key-frames
//!    (source `interpolated`), still `occluded` where a run says so, else `tracked`;
//! 3. the sample of the topmost shown run that has one there: a later run over some frames overrides those
//!    frames and no others;
//! 4. the last position before, `lost`: a track has no gaps from its first sample to its last.

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
    let mut shown: Vec<Option<Sample>> = vec![None; (end - first_frame) as usize];
    for span in runs {
        let samples = span.frames().zip(&span.samples).filter(|(frame, _)| *frame < end);
        for (frame, sample) in samples {
            shown[(frame - first_frame) as usize] = Some(*sample);
        }
    }
    let keys: Vec<(u32, Key)> = track.keys.range(..end).map(|(&frame, &key)| (frame, key)).collect();
    for (pair, curve) in keys.windows(2).zip(curve(&keys, times)) {
        for frame in pair[0].0 + 1..pair[1].0 {
            let slot = &mut shown[(frame - first_frame) as usize];
            if !slot.is_some_and(|sample| sample.status.is_seen()) {
                let hidden = slot.is_some_and(|sample| sample.status == Status::Occluded);
                let status = if hidden { Status::Occluded } else { Status::Tracked };
                *slot = times.get(frame).map(|t_s| interpolated(&curve, t_s, status));
            }
        }
    }
    for (frame, key) in keys {
        shown[(frame - first_frame) as usize] = Some(Sample {
            x: key.x,
            y: key.y,
            status: Status::Tracked,
            source: Source::Key,
            quality: Quality::default(),
        });
    }
    Span { first_frame, samples: hold(shown) }
}

/// First frame and one past the last that anything is known of, within the clip.
fn extent(track: &Track, runs: &[&Span], n_frames: u32) -> Option<(u32, u32)> {
    let runs = runs.iter().map(|span| span.frames()).filter(|frames| !frames.is_empty());
    let keys = track.keys.keys().map(|&frame| frame..frame + 1);
    let first = runs.clone().chain(keys.clone()).map(|frames| frames.start).min()?;
    let end = runs.chain(keys).map(|frames| frames.end).max()?.min(n_frames);
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

/// Fills gaps with the sample before, lost.
fn hold(shown: Vec<Option<Sample>>) -> Vec<Sample> {
    let mut last = None;
    shown
        .into_iter()
        .filter_map(|slot| {
            last = slot.or_else(|| {
                last.map(|sample: Sample| Sample {
                    status: Status::Lost,
                    source: Source::Interpolated,
                    quality: Quality::default(),
                    ..sample
                })
            });
            last
        })
        .collect()
}

#[cfg(test)]
mod tests;
