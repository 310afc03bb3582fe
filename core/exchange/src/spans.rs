//! Rows of a track table gathered into spans.

use std::collections::BTreeMap;

use honami_model::track::{Quality, Sample, Span, Status, TrackId};

use crate::rows::TrackRow;
use crate::table::TableError;

/// Gathers rows, in whatever order, into one span a track; `n_frames` is the length of their clip.
///
/// A frame between the first and the last of a track that has no row becomes a lost sample at the position
/// before it. Of two rows for the same track and frame the later one counts.
///
/// # Errors
/// The first error among the rows; [`TableError::Frame`] for a row beyond the clip.
pub fn spans(
    rows: impl IntoIterator<Item = Result<TrackRow, TableError>>,
    n_frames: u32,
) -> Result<BTreeMap<TrackId, Span>, TableError> {
    let mut samples = BTreeMap::<TrackId, Vec<(u32, Sample)>>::new();
    for row in rows {
        let TrackRow { track, frame, sample, .. } = row?;
        if frame >= n_frames {
            return Err(TableError::Frame { track, frame, n_frames });
        }
        samples.entry(track).or_default().push((frame, sample));
    }
    Ok(samples.into_iter().map(|(track, samples)| (track, without_gaps(samples))).collect())
}

fn without_gaps(mut samples: Vec<(u32, Sample)>) -> Span {
    samples.sort_by_key(|&(frame, _)| frame); // stable: the later row stays the later one
    let mut span = Span { first_frame: samples.first().map_or(0, |&(frame, _)| frame), samples: Vec::new() };
    for (frame, sample) in samples {
        if let Some(&last) = span.samples.last() {
            let lost = Sample { status: Status::Lost, quality: Quality::default(), ..last };
            span.samples.resize((frame - span.first_frame) as usize, lost);
        }
        span.samples.push(sample);
    }
    span
}
