//! One pass: a tracker follows a feature from a key-frame, forward or backward, through crops of the frames.

use std::sync::atomic::{AtomicU64, Ordering};

use honami_host::{CallContext, FrameView, HostError, Point, PointRow, Points, StreamInfo, Tracker};
use honami_media::Media;
use honami_model::track::{Quality, Sample, Source, Span, Status, TrackId};

use super::crop::{Bounds, Crop};
use super::plan::Pass;
use crate::drive::view;
use crate::ear::Ear;
use crate::error::WorkbenchError;
use crate::progress::{Flow, Progress};
use crate::stamp::SEED;

/// What was found: samples in the order of the clip, the key-frame's own among them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Found {
    /// From the key-frame to the last frame in which the feature was found, or back to it.
    pub(super) span: Span,
    /// The frame in which it was lost.
    pub(super) lost: Option<u32>,
}

/// Frames that several passes have done together.
pub(super) struct Meter<'a> {
    pub(super) progress: &'a dyn Progress,
    pub(super) done: AtomicU64,
    pub(super) total: u64,
}

impl Meter<'_> {
    /// One more frame is done.
    fn tick(&self) -> Result<(), WorkbenchError> {
        // A crop that had to be widened is tracked again: never more than all.
        let done = (self.done.fetch_add(1, Ordering::Relaxed) + 1).min(self.total);
        match self.progress.report(done, self.total, "frame") {
            Flow::Continue => Ok(()),
            Flow::Stop => Err(WorkbenchError::Stopped),
        }
    }

    fn call<R>(&self, ear: &Ear<'_>, work: impl FnOnce(&CallContext<'_>) -> R) -> R {
        ear.call(self.done.load(Ordering::Relaxed).min(self.total), self.total, work)
    }
}

/// What the passes of all directions have in common.
pub(super) struct Scene<'a> {
    pub(super) media: &'a Media,
    pub(super) track: TrackId,
    /// Where the feature was thought to go, as far as that is known.
    pub(super) path: &'a Span,
    /// How much of the picture a tracker is given round the path, pixels.
    pub(super) margin_px: u32,
    pub(super) meter: &'a Meter<'a>,
}

/// A tracker that makes passes of one direction, one after the other.
pub(super) struct Rider<'a> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) tracker: &'a mut Tracker,
}

/// How one try with one crop ended.
enum Try {
    Found(Found),
    /// It came too near the crop's edge there.
    Near([f32; 2]),
}

impl Rider<'_> {
    /// Follows the feature. The crop is widened, and the pass made again, until the feature keeps away from the crop's edges.
    pub(super) fn follow(
        &mut self,
        pass: &Pass,
        warnings: &mut Vec<String>,
    ) -> Result<Found, WorkbenchError> {
        let mut bounds = Bounds::of(pass.at);
        let path = self.scene.path;
        let known = path.frames().zip(&path.samples).filter(|(frame, _)| pass.frames.contains(frame));
        known.for_each(|(_, sample)| bounds.add([sample.x, sample.y]));
        let mut margin_px = self.scene.margin_px;
        let ear = Ear::new(self.tracker.plugin(), self.scene.meter.progress);
        let found = loop {
            let crop = Crop::round(&bounds, margin_px, self.scene.media.clip());
            match self.attempt(pass, &crop, margin_px, &ear)? {
                Try::Found(found) => break found,
                Try::Near(point) => {
                    bounds.add(point);
                    margin_px = margin_px.saturating_mul(2);
                }
            }
        };
        for warning in ear.warnings() {
            if !warnings.contains(&warning) {
                warnings.push(warning);
            }
        }
        Ok(found)
    }

    fn attempt(
        &mut self,
        pass: &Pass,
        crop: &Crop,
        margin_px: u32,
        ear: &Ear<'_>,
    ) -> Result<Try, WorkbenchError> {
        let mut way = Way { crop, margin_px, track: self.scene.track, samples: Vec::new(), end: None };
        self.scene.meter.call(ear, |call| self.begin(pass, crop, call))?;
        for frame in pass.order() {
            self.scene.meter.tick()?;
            ear.at(frame);
            let points = self.scene.meter.call(ear, |call| self.push(frame, crop, call))?;
            way.take(points);
            if way.end.is_some() {
                break;
            }
        }
        let rest = self.scene.meter.call(ear, |call| self.tracker.end(call)).map_err(stopped)?;
        way.take(rest);
        Ok(way.outcome(pass))
    }

    fn begin(&mut self, pass: &Pass, crop: &Crop, call: &CallContext<'_>) -> Result<(), WorkbenchError> {
        let info = StreamInfo {
            width: crop.size[0],
            height: crop.size[1],
            fps: self.scene.media.clip().times.nominal_fps(),
            n_frames: Some(u64::from(pass.frames.end - pass.frames.start) + 1),
            reversed: pass.backward,
            max_threads: 1,
            seed: SEED,
            births: 0..0,
        };
        let [x, y] = crop.inward(pass.at);
        self.tracker.begin(info, call)?;
        Ok(self.tracker.seed(&[Point { id: self.scene.track.0, x, y }], call)?)
    }

    fn push(
        &mut self,
        frame: u32,
        crop: &Crop,
        call: &CallContext<'_>,
    ) -> Result<Vec<Points>, WorkbenchError> {
        let picture = self.scene.media.frame(frame)?;
        let whole = view(self.scene.media, &picture, frame);
        let part = FrameView {
            gray: crop.of(whole.gray),
            chroma: whole.chroma.map(|c| crop.of_chroma(&c)),
            ..whole
        };
        self.tracker.push(&part, call).map_err(stopped)
    }
}

fn stopped(error: HostError) -> WorkbenchError {
    match error {
        HostError::Cancelled { .. } => WorkbenchError::Stopped,
        error => error.into(),
    }
}

/// The way of one feature through one crop, as the tracker tells it.
struct Way<'a> {
    crop: &'a Crop,
    margin_px: u32,
    track: TrackId,
    /// In the order of the pass.
    samples: Vec<Sample>,
    end: Option<End>,
}

enum End {
    Lost,
    Near([f32; 2]),
}

impl Way<'_> {
    fn take(&mut self, points: Vec<Points>) {
        for frame in points {
            if self.end.is_none() {
                let row = frame.rows.iter().find(|row| row.id == self.track.0);
                self.end = row.map_or(Some(End::Lost), |row| self.step(row));
            }
        }
    }

    /// Takes one row, unless the way ends with it.
    fn step(&mut self, row: &PointRow) -> Option<End> {
        let at = self.crop.outward([row.x, row.y]);
        // Out of the crop is out of the picture only where the two have the same edge.
        let left = row.status == Status::Outside
            && !self.crop.is_whole()
            && !self.crop.is_clip_edge_near(at, self.margin_px / 2);
        if left || self.crop.is_cut_near(at, self.margin_px * 2 / 3) {
            return Some(End::Near(at));
        }
        match row.status {
            Status::Lost | Status::Outside | Status::Rejected => Some(End::Lost),
            Status::Tracked | Status::Newborn | Status::Occluded => {
                let quality = Quality { fb_px: row.fb, ncc: row.ncc };
                let status = if row.status == Status::Newborn { Status::Tracked } else { row.status };
                self.samples.push(Sample { x: at[0], y: at[1], status, source: Source::Tracked, quality });
                None
            }
        }
    }

    fn outcome(self, pass: &Pass) -> Try {
        if let Some(End::Near(point)) = self.end {
            return Try::Near(point);
        }
        let mut samples = self.samples;
        let lost = pass.order().nth(samples.len());
        let first_frame = if pass.backward {
            samples.reverse();
            (pass.from + 1).saturating_sub(u32::try_from(samples.len()).unwrap_or(u32::MAX))
        } else {
            pass.from
        };
        Try::Found(Found { span: Span { first_frame, samples }, lost })
    }
}
