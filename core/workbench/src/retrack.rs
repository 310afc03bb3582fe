//! Re-tracking: a tracker goes on from a person's key-frames, forward, backward, or both ways between two.
//!
//! The tracker sees only what lies round the path that the feature is known to take (`retrack/crop.rs`), which makes
//! a pass a matter of milliseconds. Every pass is kept as an immutable run; what it found is laid over the track by
//! one edit. Key-frames, strokes and marks of a person are never changed by it.

mod crop;
mod direction;
mod lay;
mod pass;
mod plan;
mod study;
#[cfg(test)]
mod tests;

use std::ops::RangeInclusive;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

use honami_host::Values;
use honami_model::correct::Correction;
use honami_model::document::{Key, RunId};
use honami_model::history::EntryId;
use honami_model::track::{Span, TrackId};
use honami_store::RunHead;

use crate::error::WorkbenchError;
use crate::ground::Ground;
use crate::progress::Progress;
use crate::session::Session;
pub(crate) use direction::usual;
pub use study::{Study, study};

pub(crate) use plan::Anchors;

use direction::{Direction, Made};
use lay::{Runs, Tracked};
use pass::{Found, Meter, Scene};
use plan::{Pass, Stretch};

/// In which direction the tracker goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// From a key-frame on, until the feature is lost or up to the next key-frame.
    Forward,
    /// From a key-frame back, until the feature is lost or down to the one before.
    Backward,
    /// From both of two neighbouring key-frames; where both have found the feature the two paths are blended.
    Both,
}

/// What to re-track.
#[derive(Clone, Debug, PartialEq)]
pub struct RetrackRequest {
    /// The track.
    pub track: TrackId,
    /// The direction.
    pub way: Way,
    /// First and last frame; key-frames among them are where passes begin and end.
    pub frames: RangeInclusive<u32>,
    /// Key-frames that are not in the project yet: they are set by the same edit.
    pub keys: Vec<(u32, Key)>,
    /// The tracker, short name or full id, with its parameters; `None`: those of the track's run.
    pub with: Option<(String, Values)>,
}

/// Passes that are ready to go.
pub struct RetrackJob {
    study: Arc<Study>,
    request: RetrackRequest,
    stretches: Vec<Stretch>,
    forward: Option<Direction>,
    backward: Option<Direction>,
    margin_px: u32,
}

/// Passes that have ended; give them to [`finish`], or drop them and nothing has happened.
pub struct Retracked {
    request: RetrackRequest,
    tracked: Vec<Tracked>,
    heads: [Option<RunHead>; 2],
    correction: Correction,
    warnings: Vec<String>,
}

/// What a re-tracking came to.
#[derive(Clone, Debug, PartialEq)]
pub struct RetrackOutcome {
    /// The runs that were made.
    pub runs: Vec<RunId>,
    /// The edit that laid them over the track.
    pub entry: EntryId,
    /// What happened, in one line.
    pub line: String,
    /// What the tracker warned of.
    pub warnings: Vec<String>,
}

/// Loads the tracker, once for each direction.
///
/// # Errors
/// When there is no such track; as [`Study::job`].
pub fn prepare(session: &Session, request: &RetrackRequest) -> Result<RetrackJob, WorkbenchError> {
    Arc::new(study(session, request.track)?).job(request.clone())
}

/// Where a person, or the track's birth, says where the feature is.
pub(crate) fn anchors(session: &Session, track: TrackId) -> Result<Anchors, WorkbenchError> {
    let ground = Ground::of(&session.project, track)?;
    Ok(lay::anchors(&ground, &[], &session.media.clip().times))
}

impl RetrackJob {
    /// Makes the passes, the two directions side by side, and looks what they would change.
    ///
    /// # Errors
    /// [`WorkbenchError::Stopped`], [`WorkbenchError::LostAtOnce`], and what the clip or the tracker met; nothing is
    /// kept then.
    pub fn run(self, progress: &dyn Progress) -> Result<Retracked, WorkbenchError> {
        let Self { study, request, stretches, forward, backward, margin_px } = self;
        let (media, ground) = (&study.media, &study.ground);
        let (ahead, back): (Vec<_>, Vec<_>) =
            stretches.iter().map(|stretch| (stretch.forward(), stretch.backward())).unzip();
        let total = ahead.iter().chain(&back).flatten().map(|pass| pass.order().count() as u64).sum();
        let meter = Meter { progress, done: AtomicU64::new(0), total };
        let times = &media.clip().times;
        let path = ground.shown(times).span().clone();
        let scene = Scene { media, track: request.track, path: &path, margin_px, meter: &meter };
        let make = |direction: Option<Direction>, passes: &[Option<Pass>]| {
            direction.map_or_else(|| Ok(Made::default()), |direction| direction.make(&scene, passes))
        };
        let (ahead, back) = rayon::join(|| make(forward, &ahead), || make(backward, &back));
        let (ahead, back) = (ahead?, back?);
        let (mut found_ahead, mut found_back) = (ahead.found.into_iter(), back.found.into_iter());
        let tracked: Vec<Tracked> = stretches
            .into_iter()
            .map(|stretch| Tracked {
                stretch,
                forward: found_ahead.next().flatten(),
                backward: found_back.next().flatten(),
            })
            .collect();
        let mut warnings = ahead.warnings;
        warnings.extend(back.warnings);
        warnings.dedup();
        let correction = lay::correction(ground, &request, &tracked, Runs::default(), times)?;
        Ok(Retracked { request, tracked, heads: [ahead.head, back.head], correction, warnings })
    }
}

impl Retracked {
    /// What it would do; the runs it would be said to come from have no numbers yet.
    #[must_use]
    pub fn correction(&self) -> &Correction {
        &self.correction
    }
}

/// Keeps the passes as runs and lays them over the track: one edit, which undo takes back.
///
/// What a person has marked or drawn in the meantime is not changed.
///
/// # Errors
/// [`WorkbenchError::Changed`] when the key-frames are others than those the passes began at, whose path would not meet
/// them; what the document refuses; what the project met. Nothing is kept then.
pub fn finish(session: &mut Session, done: Retracked) -> Result<RetrackOutcome, WorkbenchError> {
    let Retracked { request, tracked, heads, warnings, .. } = done;
    let project = &mut session.project;
    let times = project.clip().clip.times.clone();
    let ground = Ground::of(project, request.track)?;
    let stretches =
        plan::stretches(&lay::anchors(&ground, &request.keys, &times), &request.frames, request.way);
    if !stretches.iter().eq(tracked.iter().map(|one| &one.stretch)) {
        return Err(WorkbenchError::Changed { track: request.track });
    }
    // What cannot be laid must not leave runs behind.
    lay::correction(&ground, &request, &tracked, Runs::default(), &times)?;
    let [ahead, back] = heads;
    let spans = |pass: fn(&Tracked) -> &Option<Found>| -> Vec<(TrackId, Span)> {
        let found = tracked.iter().filter_map(|one| pass(one).as_ref());
        let kept = found.filter(|found| !found.span.samples.is_empty());
        kept.map(|found| (request.track, found.span.clone())).collect()
    };
    let ahead = ahead.map(|head| (head, spans(|one| &one.forward)));
    let back = back.map(|head| (head, spans(|one| &one.backward)));
    let has_ahead = ahead.is_some();
    let runs = project.keep_runs(&ahead.into_iter().chain(back).collect::<Vec<_>>())?;
    let mut numbers = runs.iter().copied();
    let numbers = Runs { forward: if has_ahead { numbers.next() } else { None }, backward: numbers.next() };
    let correction = lay::correction(&ground, &request, &tracked, numbers, &times)?;
    let line = correction.transaction.label.clone();
    let entry = project.commit(correction.transaction)?;
    Ok(RetrackOutcome { runs, entry, line, warnings })
}
