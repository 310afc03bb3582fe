//! Correlation with the template at the key-frames around, measured on the pixels.

use std::collections::{BTreeMap, BTreeSet};

use honami_model::track::{Span, TrackId};
use honami_vision::Gray;
use honami_vision::ncc::{Ncc, Template};

use super::anchors::{Anchor, Anchors};
use super::is_judged;

/// Radius of the window that is compared, pixels. Measured on calm and wind, per-sample AUC of this part alone:
/// .926 and .843 with 5, .943 and .878 with 7, .951 and .903 with 10, .950 and .913 with 15; over 40 frames between
/// two key-frames .944, .952, .946 and .936.
pub const TEMPLATE_RADIUS_PX: u32 = 10;

/// The correlation of every sample of a track, as far as the pictures have been looked at.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Correlations(Vec<Measured>);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Measured {
    Pending,
    /// A window is flat, or there is no anchor.
    Never,
    Ncc(f32),
}

impl Correlations {
    pub(super) fn pending(n_samples: usize) -> Self {
        Self(vec![Measured::Pending; n_samples])
    }

    /// Those of another column where one is named, pending elsewhere.
    pub(super) fn kept<'a>(from: impl Iterator<Item = Option<(&'a Self, usize)>>) -> Self {
        let of = |from: Option<(&Self, usize)>| from.and_then(|(old, at)| old.0.get(at).copied());
        Self(from.map(|from| of(from).unwrap_or(Measured::Pending)).collect())
    }

    pub(super) fn get(&self, at: usize) -> Option<f32> {
        match self.0.get(at) {
            Some(Measured::Ncc(ncc)) => Some(*ncc),
            _ => None,
        }
    }
}

/// Compares samples with the templates at the key-frames before and after, picture by picture.
///
/// Show it the pictures of [`template_frames`](Self::template_frames) with [`cut`](Self::cut), then those of
/// [`sample_frames`](Self::sample_frames) with [`look`](Self::look), each in any order, and give it back to
/// [`Evidence::correlated`](super::Evidence::correlated).
#[derive(Debug)]
pub struct Correlator {
    ncc: Ncc,
    tasks: Vec<Task>,
    /// By frame, the tasks and anchors that need its picture as a template.
    cuts: BTreeMap<u32, Vec<(usize, Anchor)>>,
    /// By frame, the tasks with a sample to compare.
    looks: BTreeMap<u32, Vec<usize>>,
}

#[derive(Debug)]
struct Task {
    track: TrackId,
    span: Span,
    anchors: Anchors,
    found: Correlations,
    templates: BTreeMap<u32, Template>,
}

impl Correlator {
    pub(super) fn new<'a>(
        rows: impl Iterator<Item = (TrackId, &'a Span, &'a Anchors, &'a Correlations)>,
    ) -> Self {
        let mut new = Self {
            ncc: Ncc::new(TEMPLATE_RADIUS_PX),
            tasks: Vec::new(),
            cuts: BTreeMap::new(),
            looks: BTreeMap::new(),
        };
        for (track, span, anchors, known) in rows {
            new.add(track, span, anchors, known);
        }
        new
    }

    fn add(&mut self, track: TrackId, span: &Span, anchors: &Anchors, known: &Correlations) {
        let (index, mut found) = (self.tasks.len(), known.clone());
        let mut cuts = BTreeSet::new();
        for (at, (frame, sample)) in span.frames().zip(&span.samples).enumerate() {
            if found.0[at] != Measured::Pending {
                continue;
            }
            let (before, after) = anchors.around(frame);
            if !is_judged(sample) || before.or(after).is_none() {
                found.0[at] = Measured::Never;
                continue;
            }
            self.looks.entry(frame).or_default().push(index);
            for anchor in [before, after].into_iter().flatten().filter(|anchor| cuts.insert(anchor.0)) {
                self.cuts.entry(anchor.0).or_default().push((index, anchor));
            }
        }
        let (span, anchors, templates) = (span.clone(), anchors.clone(), BTreeMap::new());
        self.tasks.push(Task { track, span, anchors, found, templates });
    }

    /// The frames whose pictures hold templates, rising.
    pub fn template_frames(&self) -> impl Iterator<Item = u32> + use<> {
        self.cuts.keys().copied().collect::<Vec<_>>().into_iter()
    }

    /// The frames whose pictures hold samples to compare, rising.
    pub fn sample_frames(&self) -> impl Iterator<Item = u32> + use<> {
        self.looks.keys().copied().collect::<Vec<_>>().into_iter()
    }

    /// Takes the templates out of a picture.
    pub fn cut(&mut self, frame: u32, picture: &Gray<'_>) {
        for &(index, (_, at)) in self.cuts.get(&frame).into_iter().flatten() {
            if let Some(template) = self.ncc.template(picture, at) {
                self.tasks[index].templates.insert(frame, template);
            }
        }
    }

    /// Compares the samples in a picture with their templates.
    pub fn look(&mut self, frame: u32, picture: &Gray<'_>) {
        for &index in self.looks.get(&frame).into_iter().flatten() {
            let task = &mut self.tasks[index];
            let Some(sample) = task.span.get(frame) else { continue };
            let (before, after) = task.anchors.around(frame);
            let anchors = [before, after].into_iter().flatten();
            let templates = anchors.filter_map(|(frame, _)| task.templates.get(&frame));
            let found: Vec<f32> =
                templates.filter_map(|t| self.ncc.against(t, picture, [sample.x, sample.y])).collect();
            let mean = found.iter().sum::<f32>() / found.len() as f32;
            let found = if found.is_empty() { Measured::Never } else { Measured::Ncc(mean) };
            task.found.0[(frame - task.span.first_frame) as usize] = found;
        }
    }

    /// Every track with the samples that were compared, and what was found.
    pub(super) fn finish(self) -> impl Iterator<Item = (TrackId, Span, Correlations)> {
        self.tasks.into_iter().map(|task| (task.track, task.span, task.found))
    }
}
