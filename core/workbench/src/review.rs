//! Review: the evidence of a project's tracks, measured behind the screen, and the queue that comes of it.
//!
//! [`Changes`] are read from the project; a [`Reviewer`] takes them on any thread. What needs no pixels is told at once,
//! correlations follow a batch of tracks at a time, the most doubtful first, and the ranking with them.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use honami_media::Media;
use honami_model::document::{RunId, ShownClustering, Track};
use honami_model::judgement::Judgement;
use honami_model::over::{Laid, Over};
use honami_model::track::{Span, TrackId};
use honami_store::Project;

pub use honami_review::evidence::{Evidence, Kind, Parts, Rival, Subject};
pub use honami_review::queue::{
    Item, Progress as ReviewProgress, Queue, Rank, Reasons, Segments, Tally, effort,
};
pub use honami_review::{Review, Standing};

use honami_review::evidence::Correlator;

use crate::error::WorkbenchError;
use crate::progress::{Flow, Progress};

mod crew;
pub mod tables;

use crew::Crew;

/// Tracks that a thread correlates before their ranking is told.
const BATCH: usize = 128;
/// Changed tracks from which on whole runs are read instead of one track after the other.
const MANY: usize = 16;

/// What reviewers have said of a track, by the first frame of the segment.
type Judgements = BTreeMap<u32, Judgement>;

/// What a reviewer has been told of; empty at first.
#[derive(Clone, Debug, Default)]
pub struct Known {
    tracks: BTreeMap<TrackId, (Arc<Span>, Judgements)>,
    runs: Vec<RunId>,
    grouped: Grouped,
}

/// What decides which group a track is in: the shown clustering, its cut, and what is held by hand.
type Grouped = Option<(ShownClustering, Vec<Vec<u32>>)>;

/// What has changed in a project since a reviewer was told of it last.
#[derive(Clone, Debug, Default)]
pub struct Changes {
    subjects: Vec<Subject>,
    judgements: Vec<(TrackId, Judgements)>,
    gone: Vec<TrackId>,
    /// The group of every grouped track, where that has changed.
    groups: Option<BTreeMap<TrackId, u32>>,
}

impl Changes {
    /// What has changed in the project since `known`, which is brought up to date.
    ///
    /// # Errors
    /// What the project met.
    pub fn since(known: &mut Known, project: &Project) -> Result<Self, WorkbenchError> {
        let document = project.document();
        let runs: Vec<RunId> = document.runs().iter().map(|shown| shown.run).collect();
        let all_anew = runs != known.runs;
        let held = |shown: ShownClustering| (shown, document.held_groups(shown.id).to_vec());
        let mut new = Known { tracks: BTreeMap::new(), runs, grouped: document.clustering().map(held) };
        let (mut moved, mut changes) = (Vec::new(), Self::default());
        for (track, span) in project.shown_all()? {
            let judgements = document.track(track).map(|track| track.judgements.clone()).unwrap_or_default();
            let old = known.tracks.get(&track);
            if all_anew || old.is_none_or(|(old, _)| !Arc::ptr_eq(old, &span)) {
                moved.push((track, Arc::clone(&span)));
            }
            if old.is_none_or(|(_, old)| *old != judgements) {
                changes.judgements.push((track, judgements.clone()));
            }
            new.tracks.insert(track, (span, judgements));
        }
        let is_gone = |track: &TrackId| !new.tracks.contains_key(track);
        changes.gone = known.tracks.keys().copied().filter(is_gone).collect();
        let crew = Crew::of(project)?;
        let mut rivals = crew.rivals(project, &moved.iter().map(|(track, _)| *track).collect())?;
        let subject = |(track, span)| {
            let unseen = document.track(track).map(unseen).unwrap_or_default();
            let rivals = rivals.remove(&track).unwrap_or_default();
            Subject { track, kind: crew.kind(document, track), span, rivals, unseen }
        };
        changes.subjects = moved.into_iter().map(subject).collect();
        if new.grouped != known.grouped {
            changes.groups = Some(project.grouping()?.map(|grouping| grouping.group_of).unwrap_or_default());
        }
        // Last: what could not be read has not been told.
        *known = new;
        Ok(changes)
    }

    /// Whether nothing has changed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let of_tracks = self.subjects.is_empty() && self.judgements.is_empty() && self.gone.is_empty();
        of_tracks && self.groups.is_none()
    }
}

/// Frames of which a person has said that the feature is lost, hidden or outside. What a tracker lost keeps its run,
/// also where it was laid over the track.
fn unseen(track: &Track) -> Vec<u32> {
    let is_said =
        |over: &Over| matches!(over, Over::Sample(Laid { sample, run: None }) if !sample.status.is_seen());
    track.over.iter().filter(|(_, over)| is_said(over)).map(|(&frame, _)| frame).collect()
}

/// What there is to review in a track now; `None`: it is no longer shown.
pub type Told = (TrackId, Option<Segments>);

/// Measures the evidence of a project's tracks.
#[derive(Debug)]
pub struct Reviewer {
    media: Arc<Media>,
    max_threads: usize,
    evidence: Evidence,
    judgements: BTreeMap<TrackId, Judgements>,
    /// Tracks with samples that were not looked at in the pictures: the edited ones, then the most doubtful.
    pending: Vec<TrackId>,
}

impl Reviewer {
    /// Of a project without tracks; its clip is looked at by up to `max_threads` threads at a time.
    #[must_use]
    pub fn new(media: Arc<Media>, max_threads: usize) -> Self {
        let (evidence, judgements, pending) = Default::default();
        Self { media, max_threads: max_threads.max(1), evidence, judgements, pending }
    }

    /// Takes changes and measures what needs no pixels. Returns what has changed of the review.
    pub fn tell(&mut self, changes: Changes) -> Vec<Told> {
        let Changes { subjects, judgements, gone, groups } = changes;
        let mut touched: BTreeSet<TrackId> = judgements.iter().map(|(track, _)| *track).collect();
        self.judgements.extend(judgements);
        let moved: Vec<TrackId> = subjects.iter().map(|subject| subject.track).collect();
        let nothing = |track| {
            let (span, kind) = (Arc::default(), Kind::default());
            Subject { track, kind, span, rivals: Vec::new(), unseen: Vec::new() }
        };
        let all = moved.len() + gone.len();
        if all > MANY && all > self.evidence.tracks().count() / MANY {
            self.measure_all(subjects, &gone);
            touched = self.evidence.tracks().chain(gone.iter().copied()).collect();
        } else {
            for subject in subjects.into_iter().chain(gone.iter().copied().map(nothing)) {
                touched.extend(self.evidence.replace(subject));
            }
        }
        touched.extend(groups.into_iter().flat_map(|groups| self.evidence.group(groups)));
        gone.iter().for_each(|track| drop(self.judgements.remove(track)));
        let told: Vec<Told> = touched.into_iter().map(|track| (track, self.segments(track))).collect();
        self.plan(&moved, &gone, &told);
        told
    }

    /// Many tracks have changed: everything is measured anew, but for correlations that still hold.
    fn measure_all(&mut self, subjects: Vec<Subject>, gone: &[TrackId]) {
        let mut all: BTreeMap<TrackId, Subject> =
            self.evidence.subjects().map(|subject| (subject.track, subject.clone())).collect();
        gone.iter().for_each(|track| drop(all.remove(track)));
        all.extend(subjects.into_iter().map(|subject| (subject.track, subject)));
        let mut evidence = Evidence::new(all.into_values().collect(), self.max_threads);
        evidence.inherit(&self.evidence);
        self.evidence = evidence;
    }

    /// Puts changed tracks at the front of those to be correlated: few as they come, many the most doubtful first.
    fn plan(&mut self, moved: &[TrackId], gone: &[TrackId], told: &[Told]) {
        let suspicion: BTreeMap<TrackId, f32> = told
            .iter()
            .map(|(track, segments)| {
                (*track, segments.iter().flat_map(|s| &s.items).map(|i| i.suspicion).fold(0.0, f32::max))
            })
            .collect();
        let changed: BTreeSet<TrackId> = moved.iter().chain(gone).copied().collect();
        let mut first: Vec<TrackId> = moved.to_vec();
        let of = |track: &TrackId| suspicion.get(track).copied().unwrap_or(0.0);
        first.sort_by(|a, b| of(b).total_cmp(&of(a)).then(a.cmp(b)));
        first.extend(self.pending.iter().filter(|track| !changed.contains(track)));
        self.pending = first;
    }

    /// Whether there are samples that were not looked at in the pictures.
    #[must_use]
    pub fn is_pending(&self) -> bool {
        !self.pending.is_empty()
    }

    /// Looks at the pictures for the next tracks, and waits for the frames that are still to be decoded. Returns what
    /// has changed of the review; nothing when it was stopped, and then these tracks stay to be looked at.
    ///
    /// # Errors
    /// [`WorkbenchError::Fault`], and what the clip met.
    pub fn look(&mut self, progress: &dyn Progress) -> Result<Vec<Told>, WorkbenchError> {
        let n = self.pending.len().min(BATCH * self.max_threads);
        let tracks = self.pending[..n].to_vec();
        let share = n.div_ceil(self.max_threads).max(1);
        let correlators: Vec<Correlator> =
            tracks.chunks(share).map(|some| self.evidence.correlator(some)).collect();
        let media = &*self.media;
        let looked = std::thread::scope(|scope| {
            let work = |correlator| scope.spawn(move || correlate(media, correlator, progress));
            let workers: Vec<_> = correlators.into_iter().map(work).collect();
            // All are waited for, also when the first has failed: the scope panics for those that are not.
            let join = |worker: std::thread::ScopedJoinHandle<'_, _>| worker.join();
            let ends: Vec<_> = workers.into_iter().map(join).collect();
            let ends = ends.into_iter().map(|end| end.unwrap_or(Err(WorkbenchError::Fault)));
            ends.collect::<Result<Option<Vec<Correlator>>, WorkbenchError>>()
        })?;
        let Some(looked) = looked else { return Ok(Vec::new()) };
        looked.into_iter().for_each(|correlator| self.evidence.correlated(correlator));
        self.pending.drain(..n);
        Ok(tracks.into_iter().map(|track| (track, self.segments(track))).collect())
    }

    fn segments(&self, track: TrackId) -> Option<Segments> {
        let none = Judgements::new();
        self.evidence.segments(track, self.judgements.get(&track).unwrap_or(&none))
    }
}

/// Shows a correlator its pictures; `None` when it was stopped.
fn correlate(
    media: &Media,
    mut correlator: Correlator,
    progress: &dyn Progress,
) -> Result<Option<Correlator>, WorkbenchError> {
    for frame in correlator.template_frames() {
        correlator.cut(frame, &media.frame(frame)?.planes().y);
    }
    let n_frames = u64::from(media.clip().n_frames());
    for frame in correlator.sample_frames() {
        if progress.report(u64::from(frame), n_frames, "frame") == Flow::Stop {
            return Ok(None);
        }
        correlator.look(frame, &media.frame(frame)?.planes().y);
    }
    Ok(Some(correlator))
}

/// Tracks with segments that are still to be reviewed, as far as that is known without looking at the pictures.
///
/// # Errors
/// What the project met.
pub fn n_doubtful(project: &Project) -> Result<usize, WorkbenchError> {
    let Changes { subjects, judgements, groups, .. } = Changes::since(&mut Known::default(), project)?;
    let judgements: BTreeMap<TrackId, Judgements> = judgements.into_iter().collect();
    let mut evidence = Evidence::new(subjects, crate::track::threads() as usize);
    evidence.group(groups.unwrap_or_default());
    let none = Judgements::new();
    let is_doubtful = |track: &TrackId| {
        let segments = evidence.segments(*track, judgements.get(track).unwrap_or(&none));
        segments.is_some_and(|segments| !segments.items.is_empty())
    };
    Ok(evidence.tracks().filter(is_doubtful).count())
}

/// The review of a project, measured to the end.
///
/// # Errors
/// [`WorkbenchError::Stopped`], and what the project or the clip met.
pub fn review(
    project: &Project,
    media: Arc<Media>,
    progress: &dyn Progress,
) -> Result<Review, WorkbenchError> {
    let mut reviewer = Reviewer::new(media, crate::track::threads() as usize);
    let mut review = Review::default();
    let mut told = reviewer.tell(Changes::since(&mut Known::default(), project)?);
    loop {
        told.into_iter().for_each(|(track, segments)| review.set(track, segments));
        if !reviewer.is_pending() {
            return Ok(review);
        }
        told = reviewer.look(progress)?;
        if told.is_empty() {
            return Err(WorkbenchError::Stopped);
        }
    }
}

#[cfg(test)]
mod tests;
