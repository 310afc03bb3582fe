//! What a rebuilt tracker makes of the frames before it took over, beside what the build before had made of them.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use honami_host::{CallContext, Host};
use honami_media::Media;
use honami_model::track::{Span, TrackId};

use super::Made;
use crate::drive::{self, Plan, Rows, Seed};
use crate::error::WorkbenchError;
use crate::progress::{Flow, Progress};
use crate::versus::{Paired, disagreement, whole};

/// From here on two builds are told apart in a feature, pixels.
const APART_PX: f64 = 1.0;
/// How often whoever waits is asked whether to wait on.
const ASK_EVERY: Duration = Duration::from_millis(100);

/// How two builds, or two runs, differ on the same frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The frames; in the first of them both begin at the same places.
    pub frames: Range<u32>,
    /// Features that both have.
    pub n_tracks: usize,
    /// Of these, features in which they are 1 px apart or more somewhere.
    pub n_apart: usize,
    /// Median distance of the samples that both see, pixels; `None` where there are none.
    pub median_px: Option<f64>,
    /// Samples that the former does not see, and the new one.
    pub n_unseen: [u64; 2],
}

impl Difference {
    /// Of what both have of the same tracks, in these frames.
    #[must_use]
    pub fn of(frames: Range<u32>, tracks: &[Paired]) -> Self {
        let found = disagreement(tracks);
        let apart = |px: Option<(f64, u32)>| px.is_some_and(|(px, _)| px >= APART_PX);
        Self {
            frames,
            n_tracks: found.summary.n_tracks,
            n_apart: found.rows.iter().filter(|row| apart(row.farthest)).count(),
            median_px: found.summary.median_px,
            n_unseen: found.summary.n_unseen,
        }
    }
}

/// `on frames 162-211 it differs from the build before by 0.42 px in the median, 3 of 40 features by 1 px or more`.
impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { frames, n_tracks, n_apart, median_px, n_unseen: [before, now] } = self;
        write!(f, "on frames {}-{} ", frames.start, frames.end.saturating_sub(1))?;
        match median_px {
            Some(px) => write!(
                f,
                "it differs from the build before by {px:.2} px in the median, {n_apart} of {n_tracks} features by 1 px or more"
            )?,
            None => f.write_str("it sees nothing that the build before sees")?,
        }
        match now.cmp(before) {
            std::cmp::Ordering::Equal => Ok(()),
            std::cmp::Ordering::Less => write!(f, ", and sees {} samples more", before - now),
            std::cmp::Ordering::Greater => write!(f, ", and sees {} samples fewer", now - before),
        }
    }
}

/// Frames of a run, and what features its tracker was given on the way.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stretch {
    /// Rows a frame, in order.
    pub(crate) rows: Vec<(u32, Rows)>,
    /// Features that a person has placed in the run.
    pub(crate) seeds: Vec<Seed>,
    pub(crate) max_threads: u32,
}

impl Stretch {
    /// The same features from the same start.
    fn plan(&self) -> Option<Plan> {
        let (first, last) = (self.rows.first()?.0, self.rows.last()?.0);
        let mut begun = BTreeMap::<TrackId, Seed>::new();
        for (frame, rows) in &self.rows {
            for (track, sample) in rows.iter().filter(|(_, sample)| sample.status.is_seen()) {
                begun.entry(*track).or_insert(Seed {
                    frame: *frame,
                    track: *track,
                    x: sample.x,
                    y: sample.y,
                });
            }
        }
        let placed = self.seeds.iter().filter(|seed| (first + 1..=last).contains(&seed.frame)).copied();
        let is_first = |seed: &Seed| begun.get(&seed.track).is_some_and(|begun| begun.frame == seed.frame);
        let placed: Vec<Seed> = placed.filter(|seed| !is_first(seed)).collect();
        let seeds: Vec<Seed> = begun.into_values().chain(placed).collect();
        (!seeds.is_empty()).then_some(Plan {
            frames: first..last + 1,
            seeds,
            detect: None,
            max_threads: self.max_threads,
        })
    }
}

/// What the rebuilt tracker found.
pub(crate) struct Found {
    /// Its build.
    pub(crate) made: Made,
    /// The first frame that the run has of it.
    pub(crate) seam: u32,
    /// All that it found, the first frame with it.
    pub(crate) frames: Range<u32>,
    pub(crate) spans: Vec<(TrackId, Span)>,
    pub(crate) difference: Difference,
}

/// A rebuilt tracker that does the frames again, behind the run.
pub(crate) struct Beside {
    thread: JoinHandle<Result<Option<Found>, WorkbenchError>>,
    stop: Arc<AtomicBool>,
    /// Says nothing: it is closed when the thread ends.
    at_work: Receiver<()>,
}

/// Nobody watches, and somebody may stop it.
struct Quiet(Arc<AtomicBool>);

impl Progress for Quiet {
    fn report(&self, _done: u64, _total: u64, _what: &str) -> Flow {
        if self.0.load(Ordering::Relaxed) { Flow::Stop } else { Flow::Continue }
    }
}

impl Beside {
    /// Begins; the stretch ends before `seam`. `None` where no thread can be had.
    pub(crate) fn begin(
        media: Arc<Media>,
        host: Host,
        made: Made,
        stretch: Stretch,
        seam: u32,
    ) -> Option<Self> {
        let stop = Arc::new(AtomicBool::new(false));
        let (sender, at_work) = sync_channel(0);
        let quiet = Quiet(Arc::clone(&stop));
        let work = move || {
            let _alive: std::sync::mpsc::SyncSender<()> = sender;
            follow(&media, &host, made, &stretch, seam, &quiet)
        };
        let thread = thread::Builder::new().name("beside".to_owned()).spawn(work).ok()?;
        Some(Self { thread, stop, at_work })
    }

    /// What it found, once it is done; nothing where whoever watches wants to stop, or where it has failed.
    pub(crate) fn end(self, n_frames: u64, progress: &dyn Progress) -> Option<Found> {
        while self.at_work.recv_timeout(ASK_EVERY) == Err(RecvTimeoutError::Timeout) {
            if progress.report(n_frames, n_frames, "the build before") == Flow::Stop {
                self.stop.store(true, Ordering::Relaxed);
            }
        }
        // That it fails there, or is stopped, takes nothing from the run.
        self.thread.join().ok()?.ok()?
    }

    /// Ends it without a result.
    pub(crate) fn give_up(self) {
        self.stop.store(true, Ordering::Relaxed);
        drop(self.thread.join());
    }
}

fn follow(
    media: &Media,
    host: &Host,
    made: Made,
    stretch: &Stretch,
    seam: u32,
    quiet: &Quiet,
) -> Result<Option<Found>, WorkbenchError> {
    let Some(plan) = stretch.plan() else { return Ok(None) };
    let frames = plan.frames.clone();
    let (mut tracker, made) = made.start_again(host, &CallContext::silent())?;
    let mut rows = Vec::new();
    let mut keep = |frame: u32, found: &Rows| {
        rows.push((frame, found.clone()));
        Ok(())
    };
    let driven = drive::drive(media, &mut tracker, plan, &mut |n| Ok(0..n), &mut keep, None, quiet)?;
    if driven.end < frames.end {
        return Ok(None);
    }
    let [mut before, now] = [&stretch.rows, &rows].map(|rows| spans(rows, frames.end));
    let pair = |(track, now): (&TrackId, &Span)| {
        let spans = [before.remove(track)?, now.clone()].map(after_the_first);
        Some(Paired { track: *track, spans })
    };
    let tracks: Vec<Paired> = now.iter().filter_map(pair).collect();
    let difference = Difference::of(frames.clone(), &tracks);
    Ok(Some(Found { made, seam, frames, spans: now.into_iter().collect(), difference }))
}

/// Where both begin they are the same.
fn after_the_first(span: Span) -> Span {
    let samples = span.samples.into_iter().skip(1).collect();
    Span { first_frame: span.first_frame + 1, samples }
}

/// Rows a frame as one span a track.
fn spans(frames: &[(u32, Rows)], end: u32) -> BTreeMap<TrackId, Span> {
    let mut pieces = BTreeMap::<TrackId, Vec<Span>>::new();
    for (frame, rows) in frames {
        for (track, sample) in rows {
            let pieces = pieces.entry(*track).or_default();
            match pieces.last_mut().filter(|last| last.frames().end == *frame) {
                Some(last) => last.samples.push(*sample),
                None => pieces.push(Span { first_frame: *frame, samples: vec![*sample] }),
            }
        }
    }
    pieces.into_iter().map(|(track, pieces)| (track, whole(pieces, end))).collect()
}

#[cfg(test)]
mod tests;
