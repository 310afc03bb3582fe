//! What speaks against the samples of shown tracks, measured; what cannot be measured stays missing.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

use honami_model::track::{Sample, Source, Span, TrackId};

mod anchors;
mod groups;
mod neighbours;
mod steps;
mod subject;
mod templates;

use anchors::Anchors;
use neighbours::{Crowd, Neighbourhood};
pub use subject::{Kind, Rival, Subject};
pub use templates::{Correlations, Correlator, TEMPLATE_RADIUS_PX};

/// What speaks against a sample; larger is worse but for `ncc`. A part that could not be measured is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Parts {
    /// How the tracker knows the feature.
    pub kind: Kind,
    /// Largest forward-backward error of a step since the last key-frame (or the first sample), pixels.
    pub fb_px: Option<f32>,
    /// Correlation with the template at the last key-frame, or the mean of that and of the next one's; -1..=1.
    pub ncc: Option<f32>,
    /// Largest change of the step since the last key-frame, as multiples of the track's usual one.
    pub jump: Option<f32>,
    /// How far the displacement since the last key-frame is from the neighbours' median, pixels; the geometric
    /// mean with that from the next key-frame, where there is one.
    pub nbr_px: Option<f32>,
    /// Distance to what another run says, the nearest where there are several, pixels. Of a run that is
    /// [stepwise](Kind::Stepwise) the anchored ones are asked by themselves.
    pub dis_px: Option<f32>,
    /// Correlation with the key-frame's template as the tracker found it, turned and stretched; of anchored ones.
    pub own_ncc: Option<f32>,
    /// Distance from a stepwise run to what the nearest anchored one says, pixels.
    pub anchored_px: Option<f32>,
    /// How far the displacement since the last key-frame is from where its group's leads, pixels; the geometric mean with
    /// that from the next key-frame, where there is one.
    pub group_px: Option<f32>,
}

impl Parts {
    /// Nothing was measured yet.
    #[must_use]
    pub fn of(kind: Kind) -> Self {
        Self { kind, ..Self::default() }
    }

    /// Both correlations, the smaller; `None` where there is neither.
    #[must_use]
    pub fn likeness(&self) -> Option<f32> {
        self.ncc.into_iter().chain(self.own_ncc).min_by(f32::total_cmp)
    }

    /// Distance to what other runs say, the farthest that was measured, pixels.
    #[must_use]
    pub fn farthest_px(&self) -> Option<f32> {
        self.dis_px.into_iter().chain(self.anchored_px).max_by(f32::total_cmp)
    }
}

/// Whether a tracker or a curve made the sample and says that the feature is seen there: what is judged.
#[must_use]
pub fn is_judged(sample: &Sample) -> bool {
    sample.status.is_seen() && !matches!(sample.source, Source::Key | Source::Sketch)
}

/// The evidence of all shown tracks.
#[derive(Clone, Debug, Default)]
pub struct Evidence {
    rows: BTreeMap<TrackId, Row>,
    groups: BTreeMap<TrackId, u32>,
}

#[derive(Clone, Debug)]
struct Row {
    subject: Subject,
    anchors: Anchors,
    neighbours: Neighbourhood,
    /// How far each sample strays from its group, pixels; empty without one.
    strays_px: Vec<f32>,
    correlations: Correlations,
}

impl Evidence {
    /// Measures all that needs no pixels, on up to `max_threads` threads; correlations are
    /// [set](Self::correlated) as they come.
    #[must_use]
    pub fn new(subjects: Vec<Subject>, max_threads: usize) -> Self {
        let crowd = Crowd::of(subjects.iter().map(|subject| (subject.track, subject.span.as_ref())));
        let n_threads = max_threads.min(subjects.len()).max(1);
        let share = subjects.len().div_ceil(n_threads).max(1);
        let measure = |subjects: &[Subject]| -> Vec<Row> {
            subjects.iter().map(|subject| Row::new(subject.clone(), &crowd)).collect()
        };
        let rows = std::thread::scope(|scope| {
            let workers: Vec<_> =
                subjects.chunks(share).map(|subjects| scope.spawn(move || measure(subjects))).collect();
            // A worker that panics has met a fault of this crate: tracks must not be missing without a word.
            let join = |worker: std::thread::ScopedJoinHandle<'_, Vec<Row>>| {
                worker.join().unwrap_or_else(|fault| std::panic::resume_unwind(fault))
            };
            workers.into_iter().flat_map(join).collect::<Vec<_>>()
        });
        let rows = rows.into_iter().map(|row| (row.subject.track, row)).collect();
        Self { rows, groups: BTreeMap::new() }
    }

    /// The measured tracks, in order of their numbers.
    pub fn tracks(&self) -> impl Iterator<Item = TrackId> + '_ {
        self.rows.keys().copied()
    }

    /// What was measured, in order of numbers.
    pub fn subjects(&self) -> impl Iterator<Item = &Subject> {
        self.rows.values().map(|row| &row.subject)
    }

    /// Takes over from an earlier measurement the groups, and the correlations where samples and key-frames are still the
    /// same.
    pub fn inherit(&mut self, old: &Self) {
        self.group(old.groups.clone());
        for (track, row) in &mut self.rows {
            if let Some(old) = old.rows.get(track) {
                row.correlations = row.correlations_from(old);
            }
        }
    }

    /// What was measured of a track.
    #[must_use]
    pub fn subject(&self, track: TrackId) -> Option<&Subject> {
        self.rows.get(&track).map(|row| &row.subject)
    }

    /// The samples that were measured.
    #[must_use]
    pub fn span(&self, track: TrackId) -> Option<&Arc<Span>> {
        self.rows.get(&track).map(|row| &row.subject.span)
    }

    /// Frames, ascending, of which a person has said that the feature is not seen there.
    #[must_use]
    pub fn unseen(&self, track: TrackId) -> &[u32] {
        self.rows.get(&track).map_or(&[], |row| &row.subject.unseen)
    }

    /// What speaks against each sample of a track; empty parts where a sample is not [judged](is_judged).
    #[must_use]
    pub fn parts(&self, track: TrackId) -> Option<Vec<Parts>> {
        self.rows.get(&track).map(Row::parts)
    }

    /// Measures a track anew, or forgets it where it has no samples any more. Returns the tracks whose evidence
    /// may have changed: it, those it is a neighbour of and those of its group. The same as measuring everything anew.
    pub fn replace(&mut self, subject: Subject) -> BTreeSet<TrackId> {
        let track = subject.track;
        let old = self.rows.remove(&track);
        let nothing = Arc::new(Span::default());
        let before = old.as_ref().map_or(&nothing, |row| &row.subject.span);
        let after = Arc::clone(&subject.span);
        let changed = difference(before, &after);
        let mut touched: BTreeSet<TrackId> = [track].into();
        let spans = self.rows.values().map(|row| (row.subject.track, row.subject.span.as_ref()));
        let crowd = Crowd::of(spans.chain([(track, after.as_ref())]));
        let mut affected = Vec::new();
        for (&id, row) in &self.rows {
            if row.neighbours.is_touched((track, &changed), &row.anchors, &crowd) {
                let mut neighbours = row.neighbours.clone();
                neighbours.moved((track, &changed), (id, &row.subject.span, &row.anchors), &crowd);
                affected.push((id, neighbours));
            }
        }
        if !after.samples.is_empty() {
            let mut row = Row::new(subject, &crowd);
            if let Some(old) = &old {
                row.correlations = row.correlations_from(old);
            }
            self.rows.insert(track, row);
        }
        for (id, neighbours) in affected {
            touched.insert(id);
            if let Some(row) = self.rows.get_mut(&id) {
                row.neighbours = neighbours;
            }
        }
        let group = self.groups.get(&track).copied();
        touched.extend(group.into_iter().flat_map(|group| self.follow(group)));
        touched
    }

    /// What must be looked at in the pictures to know the correlations of some tracks.
    #[must_use]
    pub fn correlator(&self, tracks: &[TrackId]) -> Correlator {
        let rows = tracks.iter().filter_map(|track| self.rows.get(track));
        Correlator::new(
            rows.map(|row| (row.subject.track, &*row.subject.span, &row.anchors, &row.correlations)),
        )
    }

    /// Keeps what a [`Correlator`] has found, where the samples are still those it was made for.
    pub fn correlated(&mut self, found: Correlator) {
        for (track, span, correlations) in found.finish() {
            if let Some(row) = self.rows.get_mut(&track).filter(|row| *row.subject.span == span) {
                row.correlations = correlations;
            }
        }
    }
}

impl Row {
    fn new(subject: Subject, crowd: &Crowd<'_>) -> Self {
        let anchors = Anchors::of(&subject.span);
        let neighbours = Neighbourhood::new(subject.track, &subject.span, &anchors, crowd);
        let correlations = Correlations::pending(subject.span.samples.len());
        Self { subject, anchors, neighbours, strays_px: Vec::new(), correlations }
    }

    /// Correlations that an edit has not changed.
    fn correlations_from(&self, old: &Self) -> Correlations {
        let (new, old_span) = (&self.subject.span, &old.subject.span);
        let kept = new.frames().map(|frame| {
            let same = same_place(new.get(frame), old_span.get(frame))
                && self.anchors.around(frame) == old.anchors.around(frame);
            frame
                .checked_sub(old_span.first_frame)
                .filter(|_| same)
                .map(|at| (&old.correlations, at as usize))
        });
        Correlations::kept(kept)
    }

    fn parts(&self) -> Vec<Parts> {
        let Subject { span, kind, .. } = &self.subject;
        let steps = steps::measure(span, &self.anchors);
        let each = span.frames().zip(&span.samples).zip(steps).enumerate();
        each.map(|(at, ((frame, sample), (fb_px, jump)))| {
            if !is_judged(sample) {
                return Parts::default();
            }
            let others = self.subject.others(frame);
            let nearest = |of: Option<Kind>| {
                let asked = others.iter().filter(|(rival, _)| of.is_none_or(|kind| rival.kind == kind));
                asked.map(|(_, px)| *px).min_by(f32::total_cmp)
            };
            let is_stepwise = *kind == Kind::Stepwise;
            let dis_px = nearest(is_stepwise.then_some(Kind::Stepwise));
            let anchored_px = is_stepwise.then(|| nearest(Some(Kind::Anchored))).flatten();
            let told = Parts { dis_px, anchored_px, ..Parts::of(*kind) };
            // Where it was given or found it is compared with itself.
            if self.anchors.around(frame).0.is_some_and(|(at, _)| at == frame) {
                let (none, alike) = (Some(0.0), Some(1.0));
                let own_ncc = alike.filter(|_| !is_stepwise);
                let group_px = none.filter(|_| !self.strays_px.is_empty());
                return Parts {
                    fb_px: none,
                    ncc: alike,
                    jump: none,
                    nbr_px: none,
                    own_ncc,
                    group_px,
                    ..told
                };
            }
            let own_ncc = sample.quality.ncc.filter(|_| !is_stepwise);
            let (ncc, nbr_px) = (self.correlations.get(at), self.neighbours.deviation_px(at));
            let group_px = self.strays_px.get(at).copied().filter(|px| px.is_finite());
            Parts { fb_px, ncc, jump, nbr_px, own_ncc, group_px, ..told }
        })
        .collect()
    }
}

/// Where a sample is seen, or nowhere, in both alike.
fn same_place(a: Option<&Sample>, b: Option<&Sample>) -> bool {
    let place = |sample: Option<&Sample>| {
        sample.filter(|s| s.status.is_seen()).map(|s| (s.x.to_bits(), s.y.to_bits()))
    };
    place(a) == place(b)
}

/// The frames from the first to the last in which two spans are not in the same place.
fn difference(a: &Span, b: &Span) -> Range<u32> {
    let frames = a.frames().start.min(b.frames().start)..a.frames().end.max(b.frames().end);
    let differs = |frame: &u32| !same_place(a.get(*frame), b.get(*frame));
    match (frames.clone().find(differs), frames.clone().rev().find(differs)) {
        (Some(first), Some(last)) => first..last + 1,
        _ => frames.start..frames.start,
    }
}

#[cfg(test)]
mod tests;
