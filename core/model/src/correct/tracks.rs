//! Whole tracks: split, swapped, joined, duplicated, averaged; and one tool on many of them.
//!
//! New tracks get a number that the caller has reserved. They hold what was shown, laid down frame by frame
//! with the run that found it, so that nothing but hand work ever has to be shown for them.

use std::ops::Range;

use super::mark::within;
use super::{Correction, Refused, Shown, keys_in, said};
use crate::edit::{Edit, Transaction};
use crate::over::{Laid, Over};
use crate::track::{Quality, Sample, Source, Status, TrackId, TrackSet};

/// Cuts a track in two: from `frame` on it is the new one.
///
/// # Errors
/// [`Refused::NoSamples`] when there is nothing on one of the two sides.
pub fn split(shown: &Shown<'_>, frame: u32, new: TrackId) -> Result<Transaction, Refused> {
    let all = shown.span.frames();
    let rest = frame..all.end;
    if frame <= all.start || rest.is_empty() {
        return Err(Refused::NoSamples {
            track: shown.id,
            frames: if rest.is_empty() { rest } else { 0..frame },
        });
    }
    let mut edits = given_up(shown, &rest);
    edits.extend(shown.held(&edits, rest.clone())?);
    edits.extend(copied(shown, rest, new));
    Ok(Transaction::new(format!("track {} split at {frame}: track {new} goes on", shown.id), edits))
}

/// Exchanges two tracks in a range of frames: each goes on where the other was.
///
/// # Errors
/// [`Refused::NoSamples`] when one of them is not shown in the range.
pub fn swap(a: &Shown<'_>, b: &Shown<'_>, frames: Range<u32>) -> Result<Transaction, Refused> {
    let (in_a, in_b) = (within(a, &frames)?, within(b, &frames)?);
    let frames = in_a.start.min(in_b.start)..in_a.end.max(in_b.end);
    let label = format!("tracks {} and {} swapped: {}", a.id, b.id, said(&frames));
    let mut edits = Vec::new();
    for (from, to) in [(a, b), (b, a)] {
        let mut half = given_up(to, &frames);
        half.extend(keys_in(&from.track.keys, &frames).into_iter().map(|(frame, key)| Edit::SetKey {
            track: to.id,
            frame,
            key,
        }));
        half.extend(laid_down(from, frames.clone(), to.id));
        half.extend(to.held(&half, frames.clone())?);
        edits.append(&mut half);
    }
    Ok(Transaction::new(label, edits))
}

/// Fills a track, where it is not seen, with what another one has there; the other one is deleted.
///
/// Where the first is merely interpolated, what the second has seen counts more; what it was interpolated
/// itself does not.
///
/// # Errors
/// [`Refused::NothingSeen`] when the second has nothing that the first lacks.
pub fn join(a: &Shown<'_>, b: &Shown<'_>) -> Result<Transaction, Refused> {
    let fills = |frame: u32| {
        let is_known = a.carried(frame).is_some() || a.track.keys.contains_key(&frame);
        let is_better = |sample: &&Sample| {
            let is_found = sample.status.is_seen() && sample.source != Source::Interpolated;
            is_found || a.placed(frame).is_none()
        };
        b.placed(frame).filter(|_| !is_known).filter(is_better)
    };
    let filled: Vec<u32> = b.span.frames().filter(|&frame| fills(frame).is_some()).collect();
    let (Some(&first), Some(&last)) = (filled.first(), filled.last()) else {
        return Err(Refused::NothingSeen);
    };
    let mut edits: Vec<Edit> = a
        .relay(first..last + 1, |frame| fills(frame).map(|sample| b.laid(frame, *sample)))
        .into_iter()
        .collect();
    edits.extend(filled.iter().filter_map(|frame| {
        let key = *b.track.keys.get(frame)?;
        Some(Edit::SetKey { track: a.id, frame: *frame, key })
    }));
    edits.extend(a.held(&edits, first..last + 1)?);
    edits.push(Edit::DeleteTracks { tracks: b.id.into() });
    let label = format!("track {} joined with track {}: {} filled", a.id, b.id, said(&(first..last + 1)));
    Ok(Transaction::new(label, edits))
}

/// A new track that is like this one.
///
/// # Errors
/// [`Refused::NoSamples`] when it has none.
pub fn duplicate(shown: &Shown<'_>, new: TrackId) -> Result<Transaction, Refused> {
    let frames = within(shown, &(0..shown.times.len()))?;
    Ok(Transaction::new(format!("track {} duplicated: track {new}", shown.id), copied(shown, frames, new)))
}

/// A new track in the middle of others: in every frame the mean of those that are seen there.
///
/// # Errors
/// [`Refused::NothingSeen`] when none of them is seen in any frame.
pub fn average(tracks: &[Shown<'_>], new: TrackId) -> Result<Transaction, Refused> {
    let mean = |frame: u32| {
        let seen =
            tracks.iter().filter_map(|shown| shown.span.get(frame)).filter(|sample| sample.status.is_seen());
        let (n, x, y) = seen.fold((0.0_f64, 0.0, 0.0), |(n, x, y), sample| {
            (n + 1.0, x + f64::from(sample.x), y + f64::from(sample.y))
        });
        let (status, source, quality) = (Status::Tracked, Source::Interpolated, Quality::default());
        let sample = Sample { x: (x / n) as f32, y: (y / n) as f32, status, source, quality };
        (n > 0.0).then_some(Over::Sample(Laid { sample, run: None }))
    };
    let all = tracks.iter().map(|shown| shown.span.frames());
    let start = all.clone().map(|frames| frames.start).min().unwrap_or(0);
    let over: Vec<Option<Over>> =
        (start..all.map(|frames| frames.end).max().unwrap_or(0)).map(mean).collect();
    if over.iter().all(Option::is_none) {
        return Err(Refused::NothingSeen);
    }
    let label = format!("average of {} tracks: track {new}", tracks.len());
    Ok(Transaction::new(
        label,
        vec![Edit::AddTrack { track: new }, Edit::Lay { track: new, first_frame: start, over }],
    ))
}

/// One step out of the same correction on each of many tracks; tracks that refuse it are left out.
///
/// # Errors
/// Why the first refused, when all did.
pub fn many<'a, 'b: 'a>(
    tracks: impl IntoIterator<Item = &'a Shown<'b>>,
    correct: impl Fn(&Shown<'b>) -> Result<Correction, Refused>,
) -> Result<Transaction, Refused> {
    let (mut done, mut refused): (Vec<(TrackId, Correction)>, _) = (Vec::new(), None);
    for shown in tracks {
        match correct(shown) {
            Ok(correction) => done.push((shown.id, correction)),
            Err(why) => refused = refused.or(Some(why)),
        }
    }
    let [(_, first), rest @ ..] = &done[..] else { return Err(refused.unwrap_or(Refused::NothingSeen)) };
    let label = if rest.is_empty() {
        first.transaction.label.clone()
    } else {
        let tracks: TrackSet = done.iter().map(|(id, _)| *id).collect();
        let of_first = first.transaction.label.split_once(": ").map_or("", |(_, what)| what);
        format!("{tracks}: {of_first}")
    };
    Ok(Transaction::new(
        label,
        done.into_iter().flat_map(|(_, correction)| correction.transaction.edits).collect(),
    ))
}

/// The edits that leave nothing of a track in a range.
fn given_up(shown: &Shown<'_>, frames: &Range<u32>) -> Vec<Edit> {
    let keys = keys_in(&shown.track.keys, frames);
    let cleared = keys.iter().map(|&(frame, _)| Edit::ClearKey { track: shown.id, frame });
    let over = frames.clone().map(|_| Some(Over::Nothing)).collect();
    cleared.chain([Edit::Lay { track: shown.id, first_frame: frames.start, over }]).collect()
}

/// What a track shows in a range, laid down for another one; nothing where it shows nothing.
fn laid_down(shown: &Shown<'_>, frames: Range<u32>, track: TrackId) -> Option<Edit> {
    let over: Vec<Option<Over>> = frames
        .clone()
        .map(|frame| match shown.span.get(frame) {
            Some(sample) if sample.source == Source::Key => None,
            Some(sample) => shown.laid(frame, *sample),
            None => Some(Over::Nothing),
        })
        .collect();
    (!over.is_empty()).then_some(Edit::Lay { track, first_frame: frames.start, over })
}

/// A new track with what another one shows in a range.
fn copied(shown: &Shown<'_>, frames: Range<u32>, new: TrackId) -> Vec<Edit> {
    let keys = keys_in(&shown.track.keys, &frames);
    let keys = keys.into_iter().map(|(frame, key)| Edit::SetKey { track: new, frame, key });
    [Edit::AddTrack { track: new }].into_iter().chain(keys).chain(laid_down(shown, frames, new)).collect()
}
