//! Trackers side by side on the same clip and the same points: one measure for all of them.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;

use honami_exchange::flo::Flow;
use honami_host::{Host, HostError, Kind, Registry, Values};
use honami_media::Media;
use honami_model::track::{Quality, Sample, Source, Span, Status, TrackId};
use honami_motion::accuracy::{Pair, accuracy, drift, histogram};

pub use field::FieldError;
pub use honami_motion::accuracy::{Accuracy, Compared, Drift, Histogram, THRESHOLDS_PX, TruePath, compared};
pub use keys::{KeyPaths, LeftOut, key_paths};
pub use meter::Time;
pub use points::{detect, points_of, read_points};
pub use there_and_back::Back;
pub(crate) use truth::check_inside;
pub use truth::{Truth, check_truth, read_flow, read_truth, truth_of_flow};

use crate::drive::{self, Plan, Rows, Seed};
use crate::error::WorkbenchError;
use crate::progress::{Named, Progress};
use meter::Memory;
use racer::Racer;

mod field;
mod keys;
mod meter;
mod points;
mod racer;
mod there_and_back;
mod truth;

/// The name of the row that tracks nothing: every point stays where it was given.
pub const STATIC: &str = "static";

/// How one tracker did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Short name of the tracker, or [`STATIC`].
    pub tracker: String,
    /// Against the truth, where there is one.
    pub accuracy: Option<Accuracy>,
    /// How errors grow with time; empty without a truth.
    pub drift: Vec<Drift>,
    /// How errors are distributed, where there is a truth.
    pub errors: Option<Histogram>,
    /// Dense motion against a true flow, where the tracker measures it.
    pub field: Option<FieldError>,
    /// Share of the points that are seen in every frame after theirs.
    pub kept: f64,
    /// How near the points come to where they were given when they are tracked back.
    pub back: Option<Back>,
    /// How well key-frames are found from the ones before, where there are such.
    pub left_out: Option<LeftOut>,
    /// Time in the tracker, one thread; decoding is not in it.
    pub time: Option<Time>,
    /// By how much memory has grown at most while the tracker was at work, bytes; where the system tells.
    ///
    /// Memory that an earlier tracker of the same comparison gave back only to this program does not grow again: to be
    /// exact a tracker is compared alone.
    pub peak_bytes: Option<u64>,
    /// How often its process has died, and another one has gone on: a frame in which it died twice is lost, and what it
    /// died of beside the run is not measured.
    pub n_deaths: u32,
}

/// How trackers did on the same points.
#[derive(Debug, Default)]
pub struct Comparison {
    /// One a tracker that came to its end; the last is the baseline that tracks nothing.
    pub rows: Vec<Row>,
    /// Points that were tracked.
    pub n_points: usize,
    /// Points of the question that were given in no frame that was compared.
    pub n_outside: usize,
    /// Trackers of which nothing is known, and why: stopped, or failed.
    pub missing: Vec<(String, WorkbenchError)>,
}

/// Who is compared.
pub enum Contestant {
    /// A tracker: short name or full id, and its parameters.
    Tracker(String, Values),
    /// What another program made of the same points: its name, and its table of tracks.
    Foreign(String, PathBuf),
}

impl Contestant {
    /// What its row is called.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Tracker(name, _) | Self::Foreign(name, _) => name,
        }
    }
}

/// What they are given, and what is known of the answer.
#[derive(Clone, Debug)]
pub struct Question {
    /// The points; those given outside the frames are left out.
    pub points: Vec<Seed>,
    /// The frames.
    pub frames: Range<u32>,
    /// Where the points truly are.
    pub truth: Option<Truth>,
    /// Where every pixel of the first frame truly is in the second.
    pub flow: Option<Flow>,
    /// Key-frames, each of which is left out in turn.
    pub keys: KeyPaths,
    /// Whether the points are tracked back, too, and key-frames left out: both take passes of their own.
    pub passes: bool,
}

/// Runs each tracker over the frames. Where it is stopped the trackers that have come to their end are told of, and
/// where one fails the others.
///
/// # Errors
/// [`WorkbenchError::NoFeatures`], [`WorkbenchError::NoTruth`], what the clip met, and where no tracker came to its end
/// what the first of them met, such as [`WorkbenchError::Stopped`].
pub fn compare(
    media: &Media,
    registry: &Registry,
    host: &Host,
    contestants: &[Contestant],
    mut question: Question,
    progress: &dyn Progress,
) -> Result<Comparison, WorkbenchError> {
    drive::check_seeds(&question.points, media.clip())?;
    let n_given = question.points.len();
    question.points.retain(|seed| question.frames.contains(&seed.frame));
    let n_points = question.points.len();
    if question.points.is_empty() {
        return Err(WorkbenchError::NoFeatures);
    }
    if let Some(truth) = &mut question.truth {
        truth::cut(truth, question.frames.end);
    }
    let bench = Bench { media, host, question: &question, progress, turn: String::new() };
    // First, for it costs nothing and finds a truth that tells nothing.
    let still = bench.still()?;
    meter::warm(media, question.frames.clone(), progress)?;
    let mut found = Comparison { n_points, n_outside: n_given - n_points, ..Comparison::default() };
    for (number, contestant) in (1..).zip(contestants) {
        let name = contestant.name();
        if matches!(found.missing.last(), Some((_, WorkbenchError::Stopped))) {
            found.missing.push((name.to_owned(), WorkbenchError::Stopped));
            continue;
        }
        let turn = format!("{name} {number} of {}", contestants.len());
        progress.part(&turn);
        match (Bench { turn, ..bench }).row(registry, contestant) {
            Ok(row) => found.rows.push(row),
            Err(error) => found.missing.push((name.to_owned(), of_stop(error))),
        }
    }
    if found.rows.is_empty() && !found.missing.is_empty() {
        return Err(found.missing.swap_remove(0).1);
    }
    found.rows.push(still);
    Ok(found)
}

/// What all contestants meet.
struct Bench<'a> {
    media: &'a Media,
    host: &'a Host,
    question: &'a Question,
    progress: &'a dyn Progress,
    /// Whose turn it is: `klt 2 of 3`.
    turn: String,
}

impl Bench<'_> {
    /// Whoever watches, told of the steps of one pass.
    fn pass(&self, name: &str) -> Named<'_> {
        Named { progress: self.progress, name: format!("{}{name}", self.turn) }
    }

    fn row(&self, registry: &Registry, contestant: &Contestant) -> Result<Row, WorkbenchError> {
        match contestant {
            Contestant::Tracker(name, params) => self.tracker(registry, name, params),
            Contestant::Foreign(name, path) => {
                let n_frames = self.media.clip().n_frames();
                self.judge(name, &honami_exchange::spans(honami_exchange::read(path)?, n_frames)?)
            }
        }
    }

    /// The baseline: every point stays where it was given.
    fn still(&self) -> Result<Row, WorkbenchError> {
        let Question { points, frames, keys, passes, .. } = self.question;
        let still = points.iter().map(|seed| (seed.track, standing(seed, frames.end))).collect();
        let left_out = if *passes { keys::standing(keys, frames) } else { None };
        Ok(Row { left_out, ..self.judge(STATIC, &still)? })
    }

    fn tracker(&self, registry: &Registry, name: &str, params: &Values) -> Result<Row, WorkbenchError> {
        let plugin = registry.find(Kind::Tracker, name)?;
        let memory = Memory::begin();
        let mut racer = Racer::start(self.host, plugin, params)?;
        let (spans, time) = self.follow(&mut racer)?;
        let peak_bytes = memory.and_then(Memory::peak_bytes);
        let mut row = Row { time, peak_bytes, ..self.judge(name, &spans)? };
        if let Some(flow) = self.question.flow.as_ref().filter(|_| plugin.offers("honami.field/1")) {
            let first = self.question.frames.start;
            row.field = racer.beside(|tracker| field::measure(self.media, tracker, flow, first))?;
        }
        if self.question.passes {
            row.back = racer.beside(|tracker| self.there_and_back(tracker, &spans).map(Some))?;
            row.left_out = keys::measure(self, &mut racer)?;
        }
        Ok(Row { n_deaths: racer.spare.n_deaths, ..row })
    }

    /// Runs a tracker over the frames: what it made of the points, and the time it took.
    fn follow(&self, racer: &mut Racer) -> Result<(BTreeMap<TrackId, Span>, Option<Time>), WorkbenchError> {
        let (seeds, frames) = (self.question.points.clone(), self.question.frames.clone());
        let mut spans = BTreeMap::new();
        let step_secs =
            self.drive(racer, seeds, frames, "", &mut |frame, rows| gather(&mut spans, frame, rows))?;
        Ok((spans, Time::of(&step_secs)))
    }

    /// Drives a tracker over all of these frames, in a pass of this name; the seconds that each took.
    fn drive(
        &self,
        Racer { tracker, spare }: &mut Racer,
        seeds: Vec<Seed>,
        frames: Range<u32>,
        pass: &str,
        take: &mut dyn FnMut(u32, &Rows),
    ) -> Result<Vec<f64>, WorkbenchError> {
        // One thread, so that the times of trackers can be compared.
        let plan = Plan { frames: frames.clone(), seeds, detect: None, max_threads: 1 };
        let mut collect = |frame: u32, rows: &Rows| {
            take(frame, rows);
            Ok(())
        };
        let mut numbers = |_| Ok(0..0);
        let watch = self.pass(pass);
        let driven =
            drive::drive(self.media, tracker, plan, &mut numbers, &mut collect, Some(spare), &watch)?;
        if driven.end < frames.end {
            return Err(WorkbenchError::Stopped);
        }
        Ok(driven.step_secs)
    }

    fn judge(&self, tracker: &str, spans: &BTreeMap<TrackId, Span>) -> Result<Row, WorkbenchError> {
        let nothing = Span::default();
        let span = |track| spans.get(&track).unwrap_or(&nothing);
        let points = &self.question.points;
        let kept = |seed: &&Seed| {
            let span = span(seed.track);
            (seed.frame..self.question.frames.end)
                .all(|frame| span.get(frame).is_some_and(|sample| sample.status.is_seen()))
        };
        let kept = points.iter().filter(kept).count() as f64 / points.len() as f64;
        let row = Row { tracker: tracker.to_owned(), kept, ..Row::default() };
        let Some(truth) = &self.question.truth else { return Ok(row) };
        let pair = |seed: &Seed| -> Option<Pair<'_>> {
            let path: &TruePath = truth.get(&seed.track)?;
            Some((path, seed.frame, span(seed.track)))
        };
        let pairs: Vec<Pair<'_>> = points.iter().filter_map(pair).collect();
        Ok(Row {
            accuracy: Some(accuracy(pairs.iter().copied()).ok_or(WorkbenchError::NoTruth)?),
            drift: drift(pairs.iter().copied()),
            errors: histogram(pairs),
            ..row
        })
    }
}

/// A tracker that ends because it was told to has been stopped, and has not failed.
fn of_stop(error: WorkbenchError) -> WorkbenchError {
    match error {
        WorkbenchError::Plugin(HostError::Cancelled { .. }) => WorkbenchError::Stopped,
        error => error,
    }
}

/// Appends a frame's rows to the spans of their tracks; a frame that a tracker left out is lost.
fn gather(spans: &mut BTreeMap<TrackId, Span>, frame: u32, rows: &Rows) {
    for &(track, sample) in rows {
        let span = spans.entry(track).or_insert_with(|| Span { first_frame: frame, samples: Vec::new() });
        if let Some(&last) = span.samples.last() {
            let lost = Sample { status: Status::Lost, quality: Quality::default(), ..last };
            span.samples.resize((frame - span.first_frame) as usize, lost);
        }
        span.samples.push(sample);
    }
}

/// A point that stays where it was given.
fn standing(seed: &Seed, end: u32) -> Span {
    let sample = Sample {
        x: seed.x,
        y: seed.y,
        status: Status::Tracked,
        source: Source::Tracked,
        quality: Quality::default(),
    };
    Span { first_frame: seed.frame, samples: vec![sample; (end - seed.frame) as usize] }
}

#[cfg(test)]
mod tests;
