//! Trackers side by side on the same clip and the same points.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use honami_exchange::{PointRow, TruthRow};
use honami_host::{CallContext, Kind, Registry, Values};
use honami_media::Media;
use honami_model::track::{Quality, Sample, Source, Span, Status, TrackId};
use honami_motion::accuracy::{TruePath, accuracy};

pub use honami_motion::accuracy::Accuracy;

use crate::drive::{self, Plan, Rows, Seed};
use crate::error::WorkbenchError;
use crate::progress::Progress;

/// The name of the row that tracks nothing: every point stays where it was given.
pub const STATIC: &str = "static";

/// True positions of points, by their number.
pub type Truth = BTreeMap<TrackId, TruePath>;

/// How one tracker did.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Short name of the tracker, or [`STATIC`].
    pub tracker: String,
    /// Against the truth, where there is one.
    pub accuracy: Option<Accuracy>,
    /// Share of the points that are seen in every frame after theirs.
    pub kept: f64,
    /// Time in the tracker, milliseconds a frame; decoding is not in it.
    pub ms_per_frame: Option<f64>,
}

/// Reads a table of true positions of a clip of `n_frames` frames, its rows in any order.
///
/// A frame between a point's first and last that has no row is one in which it is hidden, where it was before.
/// Of two rows for the same point and frame the later one counts.
///
/// # Errors
/// [`WorkbenchError::TruthFrame`] for a row beyond the clip; what the table says of its lines.
pub fn read_truth(path: &Path, n_frames: u32) -> Result<Truth, WorkbenchError> {
    let mut rows = BTreeMap::<TrackId, BTreeMap<u32, (f64, f64, bool)>>::new();
    for row in honami_exchange::read::<TruthRow>(path)? {
        let TruthRow { track, frame, x, y, visible, .. } = row?;
        if frame >= n_frames {
            return Err(WorkbenchError::TruthFrame { track, frame, n_frames });
        }
        rows.entry(TrackId(track)).or_default().insert(frame, (f64::from(x), f64::from(y), visible));
    }
    Ok(rows.into_iter().filter_map(|(track, rows)| Some((track, path_of(&rows)?))).collect())
}

fn path_of(rows: &BTreeMap<u32, (f64, f64, bool)>) -> Option<TruePath> {
    let (&first_frame, &first) = rows.first_key_value()?;
    let (&last_frame, _) = rows.last_key_value()?;
    let mut at = first;
    let positions = (first_frame..=last_frame).map(|frame| {
        at = rows.get(&frame).copied().unwrap_or((at.0, at.1, false));
        at
    });
    Some(TruePath { first_frame, positions: positions.collect() })
}

/// Points to track from a table.
///
/// # Errors
/// What the table says of its lines.
pub fn read_points(path: &Path) -> Result<Vec<Seed>, WorkbenchError> {
    let seed =
        |row: PointRow| Seed { frame: row.frame.unwrap_or(0), track: TrackId(row.id), x: row.x, y: row.y };
    let rows = honami_exchange::read::<PointRow>(path)?;
    Ok(rows.map(|row| row.map(seed)).collect::<Result<_, _>>()?)
}

/// The points of a truth where they can first be seen.
#[must_use]
pub fn points_of(truth: &Truth) -> Vec<Seed> {
    let first_seen = |(&track, path): (&TrackId, &TruePath)| {
        let (frame, &(x, y, _)) =
            (path.first_frame..).zip(&path.positions).find(|(_, position)| position.2)?;
        Some(Seed { frame, track, x: x as f32, y: y as f32 })
    };
    truth.iter().filter_map(first_seen).collect()
}

/// Who is compared.
pub enum Contestant {
    /// A tracker: short name or full id, and its parameters.
    Tracker(String, Values),
    /// What another program made of the same points: its name, and its table of tracks.
    Foreign(String, PathBuf),
}

/// Runs each tracker over the whole clip; the last row is the baseline that tracks nothing.
///
/// # Errors
/// [`WorkbenchError::NoFeatures`], [`WorkbenchError::NoTruth`], [`WorkbenchError::Stopped`], and what the clip
/// or a tracker met.
pub fn compare(
    media: &Media,
    registry: &Registry,
    contestants: &[Contestant],
    points: &[Seed],
    truth: Option<&Truth>,
    progress: &dyn Progress,
) -> Result<Vec<Row>, WorkbenchError> {
    drive::check_seeds(points, media.clip())?;
    let n_frames = media.clip().n_frames();
    let mut rows = Vec::new();
    for contestant in contestants {
        let (name, spans, ms_per_frame) = match contestant {
            Contestant::Tracker(name, params) => {
                let (spans, secs) = follow(media, registry, (name, params), points, progress)?;
                (name, spans, Some(1e3 * secs / f64::from(n_frames)))
            }
            Contestant::Foreign(name, path) => {
                (name, honami_exchange::spans(honami_exchange::read(path)?, n_frames)?, None)
            }
        };
        rows.push(judge(name.clone(), points, n_frames, (&spans, truth), ms_per_frame)?);
    }
    let still = points.iter().map(|seed| (seed.track, standing(seed, n_frames))).collect();
    rows.push(judge(STATIC.to_owned(), points, n_frames, (&still, truth), None)?);
    Ok(rows)
}

/// Runs a tracker over the whole clip; its spans, and the seconds spent in it.
fn follow(
    media: &Media,
    registry: &Registry,
    (name, params): (&str, &Values),
    points: &[Seed],
    progress: &dyn Progress,
) -> Result<(BTreeMap<TrackId, Span>, f64), WorkbenchError> {
    let n_frames = media.clip().n_frames();
    let plugin = registry.find(Kind::Tracker, name)?;
    let (mut tracker, _) = honami_host::Host::new().tracker(plugin, params, &CallContext::silent())?;
    // One thread, so that the times of trackers can be compared.
    let plan = Plan { frames: 0..n_frames, seeds: points.to_vec(), detect: None, max_threads: 1 };
    let mut spans = BTreeMap::new();
    let mut collect = |frame: u32, rows: &Rows| {
        gather(&mut spans, frame, rows);
        Ok(())
    };
    let mut numbers = |_| Ok(0..0);
    let driven = drive::drive(media, &mut tracker, plan, &mut numbers, &mut collect, progress)?;
    if driven.end < n_frames {
        return Err(WorkbenchError::Stopped);
    }
    Ok((spans, driven.tracker_secs))
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
fn standing(seed: &Seed, n_frames: u32) -> Span {
    let sample = Sample {
        x: seed.x,
        y: seed.y,
        status: Status::Tracked,
        source: Source::Tracked,
        quality: Quality::default(),
    };
    Span { first_frame: seed.frame, samples: vec![sample; (n_frames - seed.frame) as usize] }
}

fn judge(
    tracker: String,
    points: &[Seed],
    n_frames: u32,
    (spans, truth): (&BTreeMap<TrackId, Span>, Option<&Truth>),
    ms_per_frame: Option<f64>,
) -> Result<Row, WorkbenchError> {
    let nothing = Span::default();
    let span = |track| spans.get(&track).unwrap_or(&nothing);
    let kept = |seed: &&Seed| {
        let span = span(seed.track);
        (seed.frame..n_frames).all(|frame| span.get(frame).is_some_and(|sample| sample.status.is_seen()))
    };
    let accuracy = match truth {
        None => None,
        Some(truth) => {
            let pairs = points.iter().filter_map(|s| Some((truth.get(&s.track)?, s.frame, span(s.track))));
            Some(accuracy(pairs).ok_or(WorkbenchError::NoTruth)?)
        }
    };
    let kept = points.iter().filter(kept).count() as f64 / points.len().max(1) as f64;
    Ok(Row { tracker, accuracy, kept, ms_per_frame })
}
