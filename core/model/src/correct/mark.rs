//! Ranges of frames: lost, hidden, outside the picture, seen again; or taken away.

use std::ops::Range;

use super::{Correction, Refused, Shown, keys_in};
use crate::document::Key;
use crate::edit::Edit;
use crate::over::{Laid, Over};
use crate::track::{Sample, Status};

/// Says what is known of the feature in a range of frames; positions stay where they are.
///
/// Key-frames in it stay key-frames and get the status too: the later word of the same person. What is shown
/// beside the range stays. A range that reaches beyond the track is cut to it.
///
/// # Errors
/// [`Refused::NoSamples`] beside the track; [`Refused::Unchanged`] where all of it has this status.
pub fn mark(shown: &Shown<'_>, frames: Range<u32>, status: Status) -> Result<Correction, Refused> {
    let within = within(shown, &frames)?;
    if within.clone().all(|frame| shown.span.get(frame).is_some_and(|sample| sample.status == status)) {
        return Err(Refused::Unchanged { track: shown.id, frames: within, status });
    }
    let keys = keys_in(&shown.track.keys, &within);
    let lay = shown.relay(within.clone(), |frame| {
        let sample = Sample { status, ..*shown.span.get(frame)? };
        Some(Some(Over::Sample(Laid { sample, run: None })))
    });
    let marked =
        |&(frame, key): &(u32, Key)| Edit::SetKey { track: shown.id, frame, key: Key { status, ..key } };
    let mut edits: Vec<Edit> = lay.into_iter().chain(keys.iter().map(marked)).collect();
    edits.extend(shown.held(&edits, within)?);
    shown.correct(edits, &format!("{}{}", word(status), with_keys(keys.len())))
}

/// Takes a range of frames away: at an end the track becomes shorter, in the middle it is lost.
///
/// Key-frames in it are cleared in the same step. What is shown beside the range stays.
///
/// # Errors
/// [`Refused::NoSamples`] beside the track; [`Refused::WholeTrack`] when nothing of it would be left.
pub fn delete_range(shown: &Shown<'_>, frames: Range<u32>) -> Result<Correction, Refused> {
    let within = within(shown, &frames)?;
    if within == shown.span.frames() {
        return Err(Refused::WholeTrack(shown.id));
    }
    let keys = keys_in(&shown.track.keys, &within);
    let over = within.clone().map(|_| Some(Over::Nothing)).collect();
    let cleared = keys.iter().map(|&(frame, _)| Edit::ClearKey { track: shown.id, frame });
    let lay = Edit::Lay { track: shown.id, first_frame: within.start, over };
    let mut edits: Vec<Edit> = cleared.chain([lay]).collect();
    edits.extend(shown.held(&edits, within)?);
    shown.correct(edits, &format!("taken away{}", with_keys(keys.len())))
}

/// What a range of this status is said to be.
pub(super) fn word(status: Status) -> &'static str {
    match status {
        Status::Tracked | Status::Newborn => "seen",
        Status::Lost => "lost",
        Status::Occluded => "occluded",
        Status::Outside => "outside",
        Status::Rejected => "rejected",
    }
}

/// The part of a range in which the track has samples.
pub(super) fn within(shown: &Shown<'_>, frames: &Range<u32>) -> Result<Range<u32>, Refused> {
    let all = shown.span.frames();
    let within = frames.start.max(all.start)..frames.end.min(all.end);
    if within.is_empty() {
        return Err(Refused::NoSamples { track: shown.id, frames: frames.clone() });
    }
    Ok(within)
}

fn with_keys(n: usize) -> String {
    match n {
        0 => String::new(),
        1 => " with 1 key-frame".to_owned(),
        n => format!(" with {n} key-frames"),
    }
}
