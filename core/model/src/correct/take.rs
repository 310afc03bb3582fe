//! One run's word: what it found is laid over what is shown, as a person has chosen it.

use std::ops::Range;

use super::{Correction, Refused, Shown};
use crate::document::RunId;
use crate::over::{Laid, Over};
use crate::track::Span;

/// Lays what a run found of the track over a range, also where it has lost the feature.
///
/// Key-frames stay, and so does what is shown beside the range. A range that reaches beyond what the run found is cut
/// to it. `found` are the run's samples of this track, whether or not the run is shown.
///
/// # Errors
/// [`Refused::NoSamples`] where the run found nothing; [`Refused::ShownAlready`] where nothing would change.
pub fn take(shown: &Shown<'_>, run: RunId, found: &Span, frames: Range<u32>) -> Result<Correction, Refused> {
    let track = shown.id;
    let all = found.frames();
    let within = frames.start.max(all.start)..frames.end.min(all.end);
    let lay = shown.relay(within.clone(), |frame| {
        let sample = *found.get(frame)?;
        Some(Some(Over::Sample(Laid { sample, run: Some(run) })))
    });
    let Some(lay) = lay else { return Err(Refused::NoSamples { track, frames }) };
    let mut edits = vec![lay];
    edits.extend(shown.held(&edits, within.clone())?);
    let taken = shown.correct(edits, &format!("taken from run {run}"))?;
    if taken.affected.is_empty() {
        return Err(Refused::ShownAlready { track, frames: within, run });
    }
    Ok(taken)
}
