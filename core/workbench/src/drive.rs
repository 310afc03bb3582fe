//! Driving a tracker over the frames of a clip: seeds where they are due, detection where it is asked for.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use std::time::{Duration, Instant};

use honami_host::{
    CallContext, DetectRequest, FrameView, HostError, Point, PointRow, Points, StreamInfo, Tracker,
};
use honami_media::{FrameRef, Media};
use honami_model::clip::Clip;
use honami_model::picture::Gray;
use honami_model::track::{Sample, Span, Status, TrackId};
use honami_store::Seam;

use crate::ear::Ear;
use crate::error::WorkbenchError;
use crate::progress::Progress;
use crate::stamp::SEED;

mod areas;
mod board;
mod resume;
mod trial;

pub use areas::Areas;
use board::Board;
use resume::Saved;
use trial::Before;

/// More features than any tracker finds in a frame; a tracker's own parameter sets the real limit.
pub(crate) const MAX_FEATURES: u32 = 100_000;

/// Ids that a tracker may give to points of its own making; numbers of tracks never get that far. Each is given a
/// number when it is born, so that none is set aside for births that never come.
const BIRTHS: Range<u32> = u32::MAX - (1 << 24)..u32::MAX;

/// A feature given to a tracker in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seed {
    /// The frame in which the position holds.
    pub frame: u32,
    /// Its track.
    pub track: TrackId,
    /// Pixels, right.
    pub x: f32,
    /// Pixels, down.
    pub y: f32,
}

/// Gives out that many numbers for new tracks.
pub type Numbers<'a> = &'a mut dyn FnMut(u32) -> Result<Range<u32>, WorkbenchError>;

/// Where and how often a tracker is asked for new features.
#[derive(Clone, Debug, Default)]
pub struct Detect {
    /// Detect in the first frame, and again every so many frames.
    pub every: Option<u32>,
    /// Where features may be.
    pub areas: Areas,
    /// The first frame in which features are looked for, and from which others are counted.
    pub since: u32,
    /// Tracks that are there already: new features keep their distance from these, too.
    pub present: Vec<(TrackId, Arc<Span>)>,
}

/// What a tracker is to do.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Frames to track, in order.
    pub frames: Range<u32>,
    /// Features to follow; those given in other frames are ignored.
    pub seeds: Vec<Seed>,
    /// New features on the way. Whoever lets the tracker find them lets it add points of its own, too: each becomes a
    /// track that begins as newborn.
    pub detect: Option<Detect>,
    /// Threads the tracker may use.
    pub max_threads: u32,
}

/// One row a live track.
pub type Rows = Vec<(TrackId, Sample)>;

/// Takes the rows of a frame; frames come in order.
pub type Sink<'a> = &'a mut dyn FnMut(u32, &Rows) -> Result<(), WorkbenchError>;

/// Who has other trackers for a drive: where one has died, and where its file was rebuilt.
pub trait Relay {
    /// Another like the one that has died, or of a build that is there by now; and whether that one has died in this
    /// frame.
    ///
    /// # Errors
    /// When it has died too often, or cannot be made again.
    fn again(&mut self, seam: &Seam, death: Death) -> Result<(Tracker, Death), WorkbenchError>;

    /// One of a rebuilt file, where there is a new one. It is on trial for a few frames, which no sink is given
    /// meanwhile. Who has none is told nothing of what follows.
    fn rebuilt(&mut self) -> Option<Tracker> {
        None
    }

    /// That one cannot go on from where the other is, which goes on itself.
    fn refused(&mut self, _why: &HostError) {}

    /// That one has taken over; this is the first frame of its own.
    ///
    /// # Errors
    /// When that cannot be kept; the drive ends then.
    fn taken(&mut self, _frame: u32) -> Result<(), WorkbenchError> {
        Ok(())
    }

    /// That one has failed on trial; from this frame on the one before tracks them all.
    ///
    /// # Errors
    /// When that cannot be kept; the drive ends then.
    fn given_up(&mut self, _frame: u32, _why: &str) -> Result<(), WorkbenchError> {
        Ok(())
    }

    /// That one is on trial no more.
    fn proved(&mut self) {}
}

/// So often a tracker may die in one frame, whatever is known of it otherwise.
const MAX_DEATHS: u32 = 3;

/// Whether a tracker has died in this frame before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Death {
    /// It has not: the frame is tried again.
    First,
    /// It has: the frame is left out.
    Again,
}

/// How far it came.
#[derive(Clone, Debug, PartialEq)]
pub struct Driven {
    /// The first frame that was not tracked.
    pub end: u32,
    /// Time spent in the tracker on each frame, seconds, decoding and keeping aside, also what is written while a tracker
    /// in this process waits for that; what the end of the stream took is with the last.
    pub step_secs: Vec<f64>,
    /// What the tracker warned of.
    pub warnings: Vec<String>,
}

/// Refuses points that are not in the clip.
///
/// # Errors
/// [`WorkbenchError::NoFeatures`] for none, [`WorkbenchError::Point`] for the first outside.
pub fn check_seeds(seeds: &[Seed], clip: &Clip) -> Result<(), WorkbenchError> {
    let (width, height, n_frames) = (clip.width, clip.height, clip.n_frames());
    match seeds.iter().find(|seed| !is_inside(seed, clip)) {
        _ if seeds.is_empty() => Err(WorkbenchError::NoFeatures),
        Some(&Seed { frame, track, x, y }) => {
            Err(WorkbenchError::Point { id: track.0, x, y, frame, width, height, n_frames })
        }
        None => Ok(()),
    }
}

/// Whether a point is in the clip.
pub(crate) fn is_inside(seed: &Seed, clip: &Clip) -> bool {
    let inside = |v: f32, size: u32| (-0.5..size as f32 - 0.5).contains(&v);
    inside(seed.x, clip.width) && inside(seed.y, clip.height) && seed.frame < clip.n_frames()
}

/// Follows the plan and hands every frame's rows to `sink`.
///
/// When the tracker's process dies another one goes on with what it carried when it was asked last, by the same way to the
/// same bits; or, where it saves nothing, with the features that were seen in the frame before. A frame in which that dies,
/// too, is left out, and all are lost there. Where a person stops it, or the tracker fails, the frames before are
/// with the sink already. A tracker that was rebuilt meanwhile goes on in the same way, and has the other waiting until
/// it has done some frames.
///
/// # Errors
/// What the clip, the tracker or the sink met.
pub fn drive(
    media: &Media,
    tracker: &mut Tracker,
    mut plan: Plan,
    numbers: Numbers<'_>,
    sink: Sink<'_>,
    mut relay: Option<&mut dyn Relay>,
    progress: &dyn Progress,
) -> Result<Driven, WorkbenchError> {
    plan.seeds.sort_by_key(|seed| (seed.frame, seed.track));
    let Range { start: first, end } = plan.frames;
    let total = u64::from(end - first);
    let ear = Ear::new(tracker.plugin(), progress);
    let mut ride = Ride {
        media,
        ear: &ear,
        tracker,
        plan: &plan,
        board: Board::new(first),
        born: BTreeMap::new(),
        saved: Saved::default(),
        step_secs: Vec::new(),
        before: None,
    };
    ear.at(first);
    let mut outcome = ear.call(0, total, |call| ride.begin(call));
    let mut frame = first;
    // After the last frame comes the end, which may have answers, too.
    while frame <= end && outcome.is_ok() {
        let done = u64::from(frame - first);
        ear.at(frame.min(end - 1));
        outcome = if ear.is_told_to_stop(done, total) && frame < end {
            Err(WorkbenchError::Stopped)
        } else {
            ear.call(done, total, |call| ride.advance(frame, relay.as_deref_mut(), numbers, call))
        };
        if let Some(relay) = &mut relay {
            if let Some(back) = ride.give_up(&mut outcome, &mut **relay)? {
                frame = back;
                continue;
            }
            if frame < end {
                outcome = ride.revive(frame, outcome, &mut **relay, numbers);
            }
            if outcome.is_ok() {
                ride.settle(frame, &mut **relay);
            }
        }
        if ride.before.is_none() {
            ride.board.flush(sink)?;
        }
        frame += 1;
    }
    match outcome {
        // What was tracked is kept; that it was stopped shows in how far it came.
        Ok(()) => {
            if let Some(relay) = relay.filter(|_| ride.before.is_some()) {
                relay.proved();
            }
        }
        Err(WorkbenchError::Stopped | WorkbenchError::Plugin(HostError::Cancelled { .. })) => {
            ride.stop(relay)?;
        }
        Err(error) => return Err(error),
    }
    ride.board.flush(sink)?;
    Ok(Driven { end: ride.board.end, step_secs: ride.step_secs, warnings: ear.warnings() })
}

/// Measures what a tracker takes.
struct Watch {
    begun: Instant,
    /// How busy whoever watches had been before.
    busy: Duration,
}

impl Watch {
    fn start(ear: &Ear<'_>) -> Self {
        Self { begun: Instant::now(), busy: ear.busy() }
    }

    /// Seconds since then. A tracker in a process of its own goes on while whoever watches is busy, one in this process
    /// waits for them.
    fn seconds(&self, ride: &Ride<'_>) -> f64 {
        let waited = if ride.tracker.can_end() { Duration::ZERO } else { ride.ear.busy() - self.busy };
        self.begun.elapsed().saturating_sub(waited).as_secs_f64()
    }
}

/// A tracker on its way through the clip.
struct Ride<'a> {
    media: &'a Media,
    ear: &'a Ear<'a>,
    tracker: &'a mut Tracker,
    plan: &'a Plan,
    board: Board,
    /// Numbers of the tracks that points of the tracker's own making have become.
    born: BTreeMap<u32, u32>,
    /// For another tracker, should this one die.
    saved: Saved,
    step_secs: Vec<f64>,
    /// What waits while the tracker is on trial.
    before: Option<Before>,
}

impl Ride<'_> {
    /// Does a frame, with a rebuilt tracker where there is one; after the last frame, ends the stream.
    fn advance(
        &mut self,
        frame: u32,
        relay: Option<&mut (dyn Relay + '_)>,
        numbers: Numbers<'_>,
        call: &CallContext<'_>,
    ) -> Result<(), WorkbenchError> {
        if frame == self.plan.frames.end {
            return self.end(numbers, call);
        }
        if let Some(relay) = relay {
            self.relieve(frame, relay, numbers, call)?;
        }
        self.keep(frame, call)?;
        self.step(frame, numbers, call)
    }

    fn begin(&mut self, call: &CallContext<'_>) -> Result<(), WorkbenchError> {
        let clip = self.media.clip();
        let info = StreamInfo {
            width: clip.width,
            height: clip.height,
            fps: clip.times.nominal_fps(),
            n_frames: Some(u64::from(self.plan.frames.end - self.plan.frames.start)),
            reversed: false,
            max_threads: self.plan.max_threads,
            seed: SEED,
            births: if self.plan.detect.is_some() { BIRTHS } else { 0..0 },
        };
        Ok(self.tracker.begin(info, call)?)
    }

    /// Pushes one frame and seeds what is due in it.
    fn step(
        &mut self,
        frame: u32,
        numbers: Numbers<'_>,
        call: &CallContext<'_>,
    ) -> Result<(), WorkbenchError> {
        let picture = self.media.frame(frame)?;
        let view = view(self.media, &picture, frame);
        // Another tracker may do earlier frames again.
        self.ear.at(frame);
        let watch = Watch::start(self.ear);
        let first = frame == self.plan.frames.start;
        // Seeds hold in the frame pushed last; only those of the first frame come before it.
        if !first {
            let answers = self.tracker.push(&view, call)?;
            self.take(answers, numbers)?;
        }
        let placed = self.board.placed.get(&frame).or(self.saved.given(frame)).cloned();
        let is_again = placed.is_some();
        let mut new: Vec<Point> = placed.unwrap_or_else(|| due(&self.plan.seeds, frame).collect());
        if let Some(detect) = self.plan.detect.as_ref().filter(|_| !is_again) {
            // What was found where a resumed run begins is known.
            let since = frame.checked_sub(detect.since);
            let again = |n: u32| !first && since.is_some_and(|since| n > 0 && since.is_multiple_of(n));
            if since == Some(0) || detect.every.is_some_and(again) {
                let found = self.find(detect, &view, &new, numbers, call)?;
                new.extend(found);
            }
        }
        self.saved.give(frame, &new);
        if !new.is_empty() {
            self.tracker.seed(&new, call)?;
        }
        if first {
            let answers = self.tracker.push(&view, call)?;
            self.take(answers, numbers)?;
        } else {
            self.board.place(frame, &new);
        }
        let seconds = watch.seconds(self);
        self.saved.worked(seconds);
        self.step_secs.push(seconds);
        Ok(())
    }

    /// Keeps answers. Points of the tracker's own making become tracks where features may be found; elsewhere nobody
    /// has asked for them.
    fn take(&mut self, mut answers: Vec<Points>, numbers: Numbers<'_>) -> Result<(), WorkbenchError> {
        let (width, height) = (self.media.clip().width as usize, self.media.clip().height as usize);
        for answer in &mut answers {
            let frame = u32::try_from(answer.frame).unwrap_or(0);
            let mask = self.plan.detect.as_ref().and_then(|detect| detect.areas.at(frame));
            let is_wanted = |row: &PointRow| {
                let [x, y] = [row.x, row.y].map(|c| c.round().max(0.0) as usize);
                x < width && y < height && mask.is_none_or(|mask| mask[y * width + x] != 0)
            };
            let newborn = answer.rows.iter().filter(|row| row.status == Status::Newborn && is_wanted(row));
            // Those of frames that are tracked again after a death have theirs.
            let ids: Vec<u32> = newborn.map(|row| row.id).filter(|id| !self.born.contains_key(id)).collect();
            if !ids.is_empty() {
                let numbers = numbers(u32::try_from(ids.len()).unwrap_or(u32::MAX))?;
                self.born.extend(ids.into_iter().zip(numbers));
            }
            answer.rows.retain(|row| !BIRTHS.contains(&row.id) || self.born.contains_key(&row.id));
            for row in &mut answer.rows {
                row.id = self.born.get(&row.id).copied().unwrap_or(row.id);
            }
        }
        self.board.take(answers);
        Ok(())
    }

    /// New features away from those there are.
    fn find(
        &mut self,
        detect: &Detect,
        view: &FrameView<'_>,
        due: &[Point],
        numbers: Numbers<'_>,
        call: &CallContext<'_>,
    ) -> Result<Vec<Point>, WorkbenchError> {
        let present = detect.present.iter().filter_map(|(track, span)| {
            let sample = span.get(frame_of(view)).filter(|sample| sample.status.is_seen())?;
            Some(Point { id: track.0, x: sample.x, y: sample.y })
        });
        let points: Vec<Point> = self.board.seen().chain(due.iter().copied()).chain(present).collect();
        let (width, height) = (view.gray.width, view.gray.height);
        let mask = detect.areas.at(frame_of(view));
        let mask = mask.map(|data| Gray { data, width, height, stride: width as usize });
        let wanted = DetectRequest {
            frame: *view,
            max_features: MAX_FEATURES,
            mask,
            points: &points,
            max_threads: self.plan.max_threads,
            seed: SEED,
        };
        let features = self.tracker.detect(&wanted, call)?;
        let ids = numbers(u32::try_from(features.len()).unwrap_or(MAX_FEATURES))?;
        Ok(ids.zip(features).map(|(id, feature)| Point { id, x: feature.x, y: feature.y }).collect())
    }

    fn end(&mut self, numbers: Numbers<'_>, call: &CallContext<'_>) -> Result<(), WorkbenchError> {
        let watch = Watch::start(self.ear);
        let answers = self.tracker.end(call)?;
        self.take(answers, numbers)?;
        let secs = watch.seconds(self);
        self.step_secs.last_mut().into_iter().for_each(|last| *last += secs);
        Ok(())
    }
}

/// A frame of a clip as plugins are given it.
pub(crate) fn view<'a>(media: &Media, picture: &'a FrameRef, frame: u32) -> FrameView<'a> {
    let time_s = media.clip().times.get(frame).unwrap_or_default();
    let planes = picture.planes();
    let (chroma, range) = (planes.chroma(), Some(planes.range));
    FrameView { gray: planes.y, chroma, range, index: i64::from(frame), time_s }
}

fn frame_of(view: &FrameView<'_>) -> u32 {
    u32::try_from(view.index).unwrap_or(u32::MAX)
}

/// The seeds of a frame; `seeds` is sorted by frame.
fn due(seeds: &[Seed], frame: u32) -> impl Iterator<Item = Point> {
    let start = seeds.partition_point(|seed| seed.frame < frame);
    let seeds = seeds[start..].iter().take_while(move |seed| seed.frame == frame);
    seeds.map(|seed| Point { id: seed.track.0, x: seed.x, y: seed.y })
}
