//! Forward-backward error of a whole run (Kalal et al. 2010): how far from its start a point ends that is tracked to
//! the last frame and back.
//!
//! It needs no truth, and tells less than one: a tracker that sticks to the wrong leaf comes back, too.

use std::collections::BTreeMap;

use honami_host::{CallContext, Point, Points, StreamInfo, Tracker};
use honami_model::track::{Span, TrackId};
use honami_motion::accuracy::median;

use super::Bench;
use crate::drive::view;
use crate::ear::Ear;
use crate::error::WorkbenchError;
use crate::progress::{Flow, Progress as _};
use crate::stamp::SEED;

/// How near points came to where they were given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Back {
    /// Median distance, pixels, a point that was lost on the way being farther off than any other; `None` when half of
    /// them were.
    pub median_px: Option<f64>,
    /// Share of the points that came back to within a pixel.
    pub within_1px: f64,
}

impl Back {
    /// Of the distances of all points, those that were lost being infinitely far.
    fn of(distances: Vec<f64>) -> Self {
        let n = distances.len().max(1) as f64;
        let near = distances.iter().filter(|px| **px < 1.0).count() as f64;
        Self { within_1px: near / n, median_px: median(distances).filter(|px| px.is_finite()) }
    }
}

impl Bench<'_> {
    /// Tracks the points that are seen in the last frame back to where they were given.
    pub(super) fn there_and_back(
        &self,
        tracker: &mut Tracker,
        spans: &BTreeMap<TrackId, Span>,
    ) -> Result<Back, WorkbenchError> {
        let given: BTreeMap<u32, (u32, [f32; 2])> =
            self.question.points.iter().map(|seed| (seed.track.0, (seed.frame, [seed.x, seed.y]))).collect();
        let last = self.question.frames.end - 1;
        let ends = spans.iter().filter_map(|(track, span)| {
            let end = span.get(last).filter(|sample| sample.status.is_seen())?;
            Some(Point { id: track.0, x: end.x, y: end.y })
        });
        let ends: Vec<Point> = ends.collect();
        // A point that was given in the last frame is back already.
        let mut far_px: BTreeMap<u32, f64> = given
            .iter()
            .map(|(&id, (frame, _))| (id, if *frame == last { 0.0 } else { f64::INFINITY }))
            .collect();
        let mut take = |points: &Points| {
            for row in points.rows.iter().filter(|row| row.status.is_seen()) {
                if let Some((frame, [x, y])) = given.get(&row.id)
                    && i64::from(*frame) == points.frame
                {
                    far_px.insert(row.id, f64::from(row.x - x).hypot(f64::from(row.y - y)));
                }
            }
        };
        if !ends.is_empty() {
            self.ride_back(tracker, &ends, &mut take)?;
        }
        Ok(Back::of(far_px.into_values().collect()))
    }

    /// Pushes the frames against time, down to the first in which a point was given.
    fn ride_back(
        &self,
        tracker: &mut Tracker,
        ends: &[Point],
        take: &mut dyn FnMut(&Points),
    ) -> Result<(), WorkbenchError> {
        let first = self.question.points.iter().map(|seed| seed.frame).min().unwrap_or_default();
        let frames = first..self.question.frames.end;
        let clip = self.media.clip();
        let info = StreamInfo {
            width: clip.width,
            height: clip.height,
            fps: clip.times.nominal_fps(),
            n_frames: Some(frames.len() as u64),
            reversed: true,
            max_threads: 1,
            seed: SEED,
            births: 0..0,
        };
        let watch = self.pass(", there and back");
        let ear = Ear::new(tracker.plugin(), &watch);
        let total = frames.len() as u64;
        let silent = CallContext::silent();
        tracker.begin(info, &silent)?;
        tracker.seed(ends, &silent)?;
        for (done, frame) in (0..).zip(frames.rev()) {
            if watch.report(done, total, "frame") == Flow::Stop {
                return Err(WorkbenchError::Stopped);
            }
            ear.at(frame);
            let picture = self.media.frame(frame)?;
            let view = view(self.media, &picture, frame);
            ear.call(done, total, |call| tracker.push(&view, call))?.iter().for_each(&mut *take);
        }
        tracker.end(&silent)?.iter().for_each(take);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::Back;

    #[test]
    fn a_lost_point_is_farther_off_than_any_other() {
        let lost = f64::INFINITY;
        for (distances, median_px, within_1px) in [
            (vec![0.5, 0.9, 3.0], Some(0.9), 2.0 / 3.0),
            (vec![0.5, 4.0, lost], Some(4.0), 1.0 / 3.0),
            (vec![0.5, lost, lost], None, 1.0 / 3.0),
            (vec![1.0], Some(1.0), 0.0),
        ] {
            assert_eq!(Back::of(distances), Back { median_px, within_1px });
        }
    }
}
