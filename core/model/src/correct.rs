//! Corrections: what a person does to the motion curve of one track, previewed before it is done.
//!
//! Every tool here is a pure function of what is [`Shown`] that gives a [`Correction`]: one transaction, and
//! the curve as it will be shown. The affected frames and the largest displacement are not claimed by the
//! tools but measured, by composing the track before and after.
//!
//! A correction places one sample, which becomes a key-frame (Diener 2009, 3.5), and says what becomes of
//! the samples beside it. Other key-frames never move. Only what is seen or predicted is carried along: a
//! lost sample has no position to correct, and what is merely interpolated between key-frames follows them
//! anyway (see [`compose`](mod@crate::compose)).

use std::collections::BTreeMap;
use std::ops::Range;

use crate::clip::FrameTimes;
use crate::compose::compose;
use crate::document::{Document, Key, RunId, Track};
use crate::edit::{Edit, EditError, Transaction, apply};
use crate::over::{Laid, Over};
use crate::track::{Quality, Sample, Source, Span, Status, TrackId};

pub use blend::{Blended, Side, blended};
pub use interpolate::{hermite, linear};
pub use mark::{delete_range, mark};
pub use refused::Refused;
pub use sketch::{Drawn, HUMAN_DELAY_S, Played, Stroke, sketch};
pub use space::space;
pub use take::take;
pub use time::{Slid, time};

mod blend;
mod interpolate;
mod mark;
mod refused;
mod sketch;
mod space;
mod take;
mod time;
pub mod tracks;

/// A track and the runs below it: what a correction is made from.
#[derive(Clone, Debug)]
pub struct Layers {
    /// Its number.
    pub id: TrackId,
    /// The hand work on it.
    pub track: Track,
    /// The spans of its shown runs, the topmost last; several of one run in any order.
    pub runs: Vec<(RunId, Span)>,
}

impl Layers {
    /// What is shown of it.
    #[must_use]
    pub fn shown<'a>(&'a self, times: &'a FrameTimes) -> Shown<'a> {
        Shown::new(self.id, &self.track, &self.runs, times)
    }
}

/// What is shown of a track, with all that its correction must know.
#[derive(Clone, Debug)]
pub struct Shown<'a> {
    id: TrackId,
    track: &'a Track,
    runs: &'a [(RunId, Span)],
    times: &'a FrameTimes,
    span: Span,
}

/// One step that a person can keep or leave.
#[derive(Clone, Debug, PartialEq)]
pub struct Correction {
    /// What to commit; its line says what happened.
    pub transaction: Transaction,
    /// The track as it will be.
    pub track: Track,
    /// The samples as they will be shown.
    pub span: Span,
    /// The frames in which something changes; empty when nothing but a key-frame's making does.
    pub affected: Range<u32>,
    /// The farthest that a sample moves, pixels.
    pub largest_px: f32,
}

impl<'a> Shown<'a> {
    /// Composes what is shown of a track; `runs` are the spans of its shown runs, the topmost last.
    #[must_use]
    pub fn new(id: TrackId, track: &'a Track, runs: &'a [(RunId, Span)], times: &'a FrameTimes) -> Self {
        let span = composed(track, runs, times);
        Self { id, track, runs, times, span }
    }

    /// Its number.
    #[must_use]
    pub fn id(&self) -> TrackId {
        self.id
    }

    /// The hand work on it.
    #[must_use]
    pub fn track(&self) -> &'a Track {
        self.track
    }

    /// Its samples.
    #[must_use]
    pub fn span(&self) -> &Span {
        &self.span
    }

    /// The frame times of the clip.
    #[must_use]
    pub fn times(&self) -> &'a FrameTimes {
        self.times
    }

    /// The key-frames before and after a frame, whether or not there is one in it.
    #[must_use]
    pub fn keys_around(&self, frame: u32) -> (Option<u32>, Option<u32>) {
        let keys = &self.track.keys;
        let before = keys.range(..frame).next_back();
        let after = keys.range(frame.saturating_add(1)..).next();
        (before.map(|(&frame, _)| frame), after.map(|(&frame, _)| frame))
    }

    /// The correction that these edits of the track are.
    ///
    /// # Errors
    /// What the document refuses.
    pub fn correct(&self, edits: Vec<Edit>, words: &str) -> Result<Correction, Refused> {
        let id = self.id;
        self.labelled(edits, |affected, largest_px| {
            let up_to =
                if largest_px >= 0.05 { format!(", up to {largest_px:.1} px") } else { String::new() };
            format!("track {id}: {} {words}{up_to}", said(affected))
        })
    }

    /// One correction out of two: `second` corrects what `first` has left.
    ///
    /// # Errors
    /// What `second` is refused for.
    pub fn then(
        &self,
        first: &Correction,
        second: impl FnOnce(&Shown<'_>) -> Result<Correction, Refused>,
        words: &str,
    ) -> Result<Correction, Refused> {
        let second = second(&Shown::new(self.id, &first.track, self.runs, self.times))?;
        self.correct([&first.transaction.edits[..], &second.transaction.edits].concat(), words)
    }

    fn labelled(
        &self,
        edits: Vec<Edit>,
        label: impl FnOnce(&Range<u32>, f32) -> String,
    ) -> Result<Correction, Refused> {
        let mut document = Document::new(self.times.len());
        document.tracks.insert(self.id, self.track.clone());
        let mut transaction = Transaction::new(String::new(), edits);
        apply(&mut document, &transaction)?;
        let track = document.tracks.remove(&self.id).ok_or(EditError::NoSuchTrack(self.id))?;
        let span = composed(&track, self.runs, self.times);
        let (mut affected, largest_px) = difference(&self.span, &span);
        if affected.is_empty() {
            let mut keys = transaction.edits.iter().filter_map(|edit| match edit {
                Edit::SetKey { frame, .. } | Edit::ClearKey { frame, .. } => Some(*frame),
                _ => None,
            });
            affected = keys.next().map_or(0..0, |frame| frame..frame + 1);
        }
        transaction.label = label(&affected, largest_px);
        Ok(Correction { transaction, track, span, affected, largest_px })
    }

    /// The sample where the feature is seen, or predicted while it is hidden.
    fn placed(&self, frame: u32) -> Option<&Sample> {
        self.span.get(frame).filter(|sample| is_placed(sample.status))
    }

    /// Seconds; 0 beyond the clip, where no sample is.
    fn time(&self, frame: u32) -> f64 {
        self.times.get(frame).unwrap_or_default()
    }

    fn key(&self, frame: u32, to: [f32; 2]) -> Edit {
        Edit::SetKey { track: self.id, frame, key: Key::set(to[0], to[1]) }
    }

    /// The sample that a correction may carry along: of a run, or laid over it by hand, not lost; no key-frame.
    fn carried(&self, frame: u32) -> Option<&Sample> {
        let sample = self.placed(frame)?;
        let is_live = sample.source == Source::Interpolated && !self.track.over.contains_key(&frame);
        (sample.source != Source::Key && !is_live).then_some(sample)
    }

    /// The run that a sample was found by.
    fn run_of(&self, frame: u32, sample: &Sample) -> Option<RunId> {
        if let Some(Over::Sample(laid)) = self.track.over.get(&frame) {
            return laid.run;
        }
        let is_found = matches!(sample.source, Source::Tracked | Source::Imported);
        let of = self.runs.iter().rev().find(|(_, span)| span.get(frame).is_some());
        of.filter(|_| is_found).map(|(run, _)| *run)
    }

    /// A shown sample, laid over the runs as it is.
    fn laid(&self, frame: u32, sample: Sample) -> Option<Over> {
        Some(Over::Sample(Laid { sample, run: self.run_of(frame, &sample) }))
    }

    /// Lays over a range what `over` says of each frame but the key-frames; there, and where it says
    /// nothing, what lies there stays. `None` when the range is empty.
    fn relay(&self, frames: Range<u32>, over: impl Fn(u32) -> Option<Option<Over>>) -> Option<Edit> {
        let new = |frame| over(frame).filter(|_| !self.track.keys.contains_key(&frame));
        let over: Vec<Option<Over>> = frames
            .clone()
            .map(|frame| new(frame).unwrap_or_else(|| self.track.over.get(&frame).copied()))
            .collect();
        (!over.is_empty()).then_some(Edit::Lay { track: self.id, first_frame: frames.start, over })
    }

    /// Lays what is shown outside a range wherever these edits would change it: key-frames that come and go
    /// bend the curve through their neighbours. Where a lost feature was last seen is nothing to hold.
    fn held(&self, edits: &[Edit], inside: Range<u32>) -> Result<Vec<Edit>, Refused> {
        let after = self.correct(edits.to_vec(), "")?;
        let known = |span: &Span, at: u32| span.get(at).filter(|s| s.status != Status::Lost).copied();
        let changes = |at: u32| !inside.contains(&at) && known(&after.span, at) != known(&self.span, at);
        let keep = |frames: Range<u32>| {
            self.relay(frames, |at| changes(at).then(|| self.laid(at, *self.span.get(at)?)))
        };
        let affected = &after.affected;
        Ok(keep(affected.start..inside.start).into_iter().chain(keep(inside.end..affected.end)).collect())
    }
}

/// Moves one sample, which becomes a key-frame; what lies beside it stays, but for the curve through
/// key-frames where no run has seen the feature.
///
/// # Errors
/// What the document refuses: a frame beyond the clip, a position that is not finite.
pub fn key_only(shown: &Shown<'_>, frame: u32, to: [f32; 2]) -> Result<Correction, Refused> {
    let from = shown.span.get(frame).map(|sample| [sample.x, sample.y]);
    let transaction = Transaction::set_key(shown.id, frame, to, from);
    shown.labelled(transaction.edits, |_, _| transaction.label)
}

fn composed(track: &Track, runs: &[(RunId, Span)], times: &FrameTimes) -> Span {
    let spans: Vec<&Span> = runs.iter().map(|(_, span)| span).collect();
    compose(track, &spans, times)
}

/// The frames in which two spans differ, and the farthest that a sample is from where it was, pixels.
fn difference(before: &Span, after: &Span) -> (Range<u32>, f32) {
    let (mut first, mut end, mut largest_px) = (u32::MAX, 0, 0.0_f32);
    let (a, b) = (before.frames(), after.frames());
    for frame in a.start.min(b.start)..a.end.max(b.end) {
        let (was, is) = (before.get(frame), after.get(frame));
        if was != is {
            (first, end) = (first.min(frame), frame + 1);
        }
        if let (Some(was), Some(is)) = (was, is.filter(|is| is_placed(is.status))) {
            largest_px = largest_px.max((is.x - was.x).hypot(is.y - was.y));
        }
    }
    (first.min(end)..end, largest_px)
}

/// Whether a position says where the feature is: seen, or predicted while it is hidden.
fn is_placed(status: Status) -> bool {
    status.is_seen() || status == Status::Occluded
}

fn position(sample: &Sample) -> [f64; 2] {
    [f64::from(sample.x), f64::from(sample.y)]
}

/// The sample at another position; how it was found no longer tells how far to trust it.
fn moved(sample: &Sample, [x, y]: [f64; 2]) -> Sample {
    let there = Sample { x: x as f32, y: y as f32, ..*sample };
    if there == *sample { there } else { Sample { quality: Quality::default(), ..there } }
}

/// Frames as a person would say them: `frame 158`, `frames 158-203`.
fn said(frames: &Range<u32>) -> String {
    let last = frames.end.saturating_sub(1);
    if frames.start >= last {
        format!("frame {}", frames.start)
    } else {
        format!("frames {}-{last}", frames.start)
    }
}

/// Key-frames within a range.
fn keys_in(keys: &BTreeMap<u32, Key>, frames: &Range<u32>) -> Vec<(u32, Key)> {
    keys.range(frames.clone()).map(|(&frame, &key)| (frame, key)).collect()
}

#[cfg(test)]
mod tests;
