//! From the suspicion of samples to the segments worth a look.

use std::fmt;
use std::ops::Range;

use honami_model::judgement::{Judgement, Verdict};
use honami_model::track::{Sample, Source, Span, TrackId};

use super::{Item, Tally};
use crate::evidence::Parts;
use crate::suspicion::{N_PARTS, is_lost, of_sample, transformed, weights};

/// A sample is worth a look from this suspicion on: one in five such samples is bad.
pub const DOUBTFUL: f32 = 0.2;
/// Segments that are no farther apart are one, frames. Less than this beside a judged segment is not worth an item.
const NEAR: u32 = 8;
/// What speaks against a segment, as short codes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Reasons(u8);

impl Reasons {
    /// The codes: forward-backward error, correlation, jump, neighbours, disagreement of trackers, group; and lost.
    pub const CODES: [&str; 7] = ["FB", "NCC", "JMP", "NBR", "DIS", "GRP", "LOST"];
    /// The code of each of the evidence's parts.
    const OF_PART: [usize; N_PARTS] = [0, 1, 2, 3, 4, 1, 4, 5];
    /// The track is lost.
    pub const LOST: Self = Self(1 << 6);

    /// The parts that speak against a sample: those that are worse than in four of five good samples, the strongest at
    /// least.
    #[must_use]
    pub fn of(parts: &Parts) -> Self {
        let weights = weights(parts.kind).parts;
        let x = transformed(parts);
        let worse =
            |k: usize| x[k].map_or(f64::NEG_INFINITY, |x| weights[k].slope * (x - weights[k].ordinary));
        let bit = |k: usize| 1 << Self::OF_PART[k];
        let notable = (0..N_PARTS).filter(|&k| worse(k) > 0.0).fold(0, |bits, k| bits | bit(k));
        let strongest =
            (0..N_PARTS).filter(|&k| x[k].is_some()).max_by(|&a, &b| worse(a).total_cmp(&worse(b)));
        Self(if notable == 0 { strongest.map_or(0, bit) } else { notable })
    }

    /// Both together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Its codes.
    pub fn codes(self) -> impl Iterator<Item = &'static str> {
        Self::CODES.into_iter().enumerate().filter(move |(k, _)| self.0 >> k & 1 == 1).map(|(_, code)| code)
    }
}

impl fmt::Display for Reasons {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.codes().collect::<Vec<_>>().join(" "))
    }
}

/// What there is to review in a track.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Segments {
    /// Its doubtful segments.
    pub items: Vec<Item>,
    /// Frame of the first of `suspicions`.
    pub first_frame: u32,
    /// Suspicion of every sample.
    pub suspicions: Vec<f32>,
    /// What was found of the judged segments whose samples are still those that were judged.
    pub judged: Tally,
}

/// The doubtful segments of a track and the suspicion of every sample; judged segments are left out as long as their
/// samples are those that were judged.
///
/// A segment is a longest range of doubtful or lost samples without key-frames, ranges near each other joined. The
/// frames `unseen`, ascending, are those of which a person has said that the feature is not seen there: like a key-frame
/// they are no part of it.
pub fn segments<'a>(
    track: TrackId,
    span: &Span,
    (parts, unseen): (&[Parts], &[u32]),
    judgements: impl IntoIterator<Item = (u32, &'a Judgement)>,
) -> Segments {
    let is_word = |frame: u32, sample: &Sample| {
        is_wall(sample) || !sample.status.is_seen() && unseen.binary_search(&frame).is_ok()
    };
    let suspicion = |((frame, sample), parts): ((u32, &Sample), &Parts)| {
        if is_word(frame, sample) { 0.0 } else { of_sample(sample, parts) }
    };
    let suspicions: Vec<f32> = span.frames().zip(&span.samples).zip(parts).map(suspicion).collect();
    let standing = standing(span, judgements);
    let with = |later: bool| {
        let wanted = standing.iter().filter(move |(_, verdict)| (*verdict == Verdict::Later) == later);
        wanted.map(|(frames, _)| frames.clone()).collect::<Vec<_>>()
    };
    let (done, later) = (with(false), with(true));
    let is_done = |frame: u32| done.iter().any(|frames| frames.contains(&frame));
    let mut found: Vec<Range<u32>> = Vec::new();
    let mut is_open = false;
    for (frame, (sample, suspicion)) in span.frames().zip(span.samples.iter().zip(&suspicions)) {
        if is_word(frame, sample) || is_done(frame) {
            is_open = false;
        } else if *suspicion >= DOUBTFUL {
            match found.last_mut().filter(|last| is_open && frame - last.end <= NEAR) {
                Some(last) => last.end = frame + 1,
                None => found.push(frame..frame + 1),
            }
            is_open = true;
        }
    }
    // What sticks out of a judged segment by a few frames was looked at with it.
    let is_rest = |frames: &Range<u32>| {
        let near = |done: &Range<u32>| frames.start <= done.end + 1 && done.start <= frames.end + 1;
        frames.end - frames.start <= NEAR && done.iter().any(near)
    };
    found.retain(|frames| !is_rest(frames));
    let item = |frames: Range<u32>| item(track, frames, (span, parts, &suspicions), &later);
    let items = found.into_iter().map(item).collect();
    Segments {
        items,
        first_frame: span.first_frame,
        judged: standing.iter().map(|(_, verdict)| *verdict).collect(),
        suspicions,
    }
}

/// A person's word between two segments.
fn is_wall(sample: &Sample) -> bool {
    sample.source == Source::Key
}

/// The judged segments whose samples are still those that were judged.
fn standing<'a>(
    span: &Span,
    judgements: impl IntoIterator<Item = (u32, &'a Judgement)>,
) -> Vec<(Range<u32>, Verdict)> {
    let segment = |(first_frame, judgement): (u32, &Judgement)| {
        let frames = first_frame..judgement.end_frame;
        let stands = judgement.seal.is_none_or(|seal| seal == span.seal(frames.clone()));
        stands.then_some((frames, judgement.verdict))
    };
    judgements.into_iter().filter_map(segment).collect()
}

fn item(
    track: TrackId,
    frames: Range<u32>,
    (span, parts, suspicions): (&Span, &[Parts], &[f32]),
    later: &[Range<u32>],
) -> Item {
    let at = |frame: u32| (frame - span.first_frame) as usize;
    let samples = at(frames.start)..at(frames.end);
    // The first of equally doubtful ones: where it went wrong.
    let worst = samples.clone().rev().max_by(|&a, &b| suspicions[a].total_cmp(&suspicions[b]));
    let worst = worst.unwrap_or(samples.start);
    let lost = samples.clone().any(|at| is_lost(&span.samples[at]));
    let seen = samples.filter(|&at| !is_lost(&span.samples[at]) && suspicions[at] >= DOUBTFUL);
    let measured = seen.max_by(|&a, &b| suspicions[a].total_cmp(&suspicions[b]));
    let frame_of = |at: usize| span.first_frame + u32::try_from(at).unwrap_or(0);
    let of_parts = measured.map_or(Reasons::default(), |at| Reasons::of(&parts[at]));
    let later = later.iter().any(|put_off| put_off.start < frames.end && frames.start < put_off.end);
    Item {
        track,
        frames,
        worst: frame_of(worst),
        reasons: if lost { of_parts.and(Reasons::LOST) } else { of_parts },
        measured: frame_of(measured.unwrap_or(worst)),
        parts: measured.map(|at| parts[at]).unwrap_or_default(),
        opponent: None,
        suspicion: suspicions[worst],
        later,
    }
}
