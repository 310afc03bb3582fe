//! How the tracks of a run ended.

use honami_model::track::{Span, Status, TrackId};

/// How many tracks of a run are not seen in the last frame that was tracked, and why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ends {
    /// Lost by the tracker, or rejected by it.
    pub n_lost: usize,
    /// Occluded.
    pub n_hidden: usize,
    /// Outside the picture.
    pub n_outside: usize,
    /// Born on the way by the tracker itself, seen or not: it ends them when it likes, which is no loss.
    pub n_born: usize,
    /// Samples of the others that are seen.
    pub n_seen: usize,
    /// Frames of the others, each from its first to the last that was tracked.
    pub n_frames: usize,
}

impl Ends {
    /// Of the spans of a run, those of a track next to each other, by their frames; `last` is the last frame tracked.
    pub(super) fn of(spans: &[(TrackId, Span)], last: u32) -> Self {
        let mut ends = Self::default();
        for of_track in spans.chunk_by(|(a, _), (b, _)| a == b) {
            let samples = || of_track.iter().flat_map(|(_, span)| span.frames().zip(&span.samples));
            if samples().next().is_some_and(|(_, sample)| sample.status == Status::Newborn) {
                ends.n_born += 1;
                continue;
            }
            let first = samples().next().map_or(last, |(frame, _)| frame);
            ends.n_frames += last.abs_diff(first) as usize + 1;
            ends.n_seen += samples().filter(|(_, sample)| sample.status.is_seen()).count();
            match samples().last().map(|(frame, sample)| (sample.status, frame)) {
                Some((status, frame)) if status.is_seen() && frame == last => {}
                Some((Status::Outside, _)) => ends.n_outside += 1,
                Some((Status::Occluded, _)) => ends.n_hidden += 1,
                _ => ends.n_lost += 1,
            }
        }
        ends
    }
}

/// As the line of a run says it: `98 % of samples seen; at the end 3 lost, 1 outside`.
impl std::fmt::Display for Ends {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Downwards: all of them are seen where none is not.
        if let Some(permille) = (1000 * self.n_seen).checked_div(self.n_frames) {
            write!(f, "{} % of samples seen; at the end ", permille as f64 / 10.0)?;
        }
        write!(f, "{} lost", self.n_lost)?;
        let others =
            [(self.n_hidden, "occluded"), (self.n_outside, "outside"), (self.n_born, "born on the way")];
        others.iter().filter(|(n, _)| *n > 0).try_for_each(|(n, what)| write!(f, ", {n} {what}"))
    }
}

#[cfg(test)]
mod tests;
