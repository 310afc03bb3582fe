//! What may become of the samples beside one that a person places: the models that are offered, and how well each does
//! on this track, which is measured by leaving out one key-frame after the other.

use std::collections::BTreeMap;
use std::sync::Arc;

use honami_model::correct::{Correction, Shown, hermite, key_only, space};
use honami_model::document::{Key, Track};
use honami_model::track::{Sample, Source, Status, TrackId};
use honami_review::loko::{Placed, loko};

pub use honami_review::loko::LeftOut;

use crate::error::WorkbenchError;
use crate::progress::{Flow, Progress};
use crate::retrack::{Retracked, Study, Way};

/// So many key-frames are left out, the nearest to the sample that is placed: what holds there matters, and the time
/// that it takes is bounded.
const N_LEFT_OUT: usize = 8;

/// What becomes of the samples beside the one that is placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Model {
    /// They are carried along.
    Space,
    /// They are tracked again from the key-frames on both sides, and blended.
    Both,
    /// They become the best path through what several runs have found.
    Fused,
    /// A curve through the key-frames replaces them.
    Hermite,
    /// Those after it are tracked again.
    Forward,
    /// Those before it are tracked again.
    Backward,
    /// They stay.
    KeyOnly,
}

impl Model {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 7] =
        [Self::Space, Self::Both, Self::Fused, Self::Hermite, Self::Forward, Self::Backward, Self::KeyOnly];

    /// The word for it on screen.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Space => "in space",
            Self::Both => "both ways",
            Self::Fused => "fused",
            Self::Hermite => "curve",
            Self::Forward => "forward",
            Self::Backward => "backward",
            Self::KeyOnly => "this frame only",
        }
    }

    /// How far it is mostly off, as a multiple of the best model's error; `None`: it is never offered first.
    ///
    /// From `cargo xtask bench review` on other clips than those of docs/review.md.
    fn usual_error(self) -> Option<f64> {
        match self {
            Self::Fused => Some(1.0),
            Self::Both => Some(1.2),
            Self::Space => Some(2.0),
            Self::Forward => Some(2.5),
            Self::Backward => Some(3.0),
            Self::Hermite => Some(4.0),
            Self::KeyOnly => None,
        }
    }

    /// How a tracker goes for it; `None`: it needs none.
    #[must_use]
    pub fn way(self) -> Option<Way> {
        match self {
            Self::Both => Some(Way::Both),
            Self::Forward => Some(Way::Forward),
            Self::Backward => Some(Way::Backward),
            Self::Space | Self::Fused | Self::Hermite | Self::KeyOnly => None,
        }
    }

    /// The correction, for the models that need nothing but what is shown of the track.
    #[must_use]
    pub fn at_once(self) -> Option<AtOnce> {
        match self {
            Self::Space => Some(space),
            Self::Hermite => Some(hermite),
            Self::KeyOnly => Some(key_only),
            Self::Both | Self::Fused | Self::Forward | Self::Backward => None,
        }
    }
}

/// A correction as a function of what is shown, a frame, and where its sample goes, pixels.
pub type AtOnce = fn(&Shown<'_>, u32, [f32; 2]) -> Result<Correction, honami_model::correct::Refused>;

/// A sample that is placed, and a model that works behind the screen.
#[derive(Clone, Debug, PartialEq)]
pub struct Wish {
    /// Its track.
    pub track: TrackId,
    /// Its frame.
    pub frame: u32,
    /// What becomes of the others: a model that is not made [`at_once`](Model::at_once).
    pub model: Model,
    /// The key-frames that are set with it, its own among them.
    pub keys: Vec<(u32, Key)>,
}

/// What was found for a wish; nothing is kept of it unless it is committed.
pub enum Granted {
    /// Passes of a tracker: give them to [`finish`](crate::retrack::finish).
    Retracked(Box<Retracked>),
    /// A correction that needs no new run: commit its transaction.
    Ready(Box<Correction>),
}

impl Granted {
    /// What it would do.
    #[must_use]
    pub fn correction(&self) -> &Correction {
        match self {
            Self::Retracked(retracked) => retracked.correction(),
            Self::Ready(correction) => correction,
        }
    }
}

/// Does the work for a wish.
///
/// # Errors
/// [`WorkbenchError::Stopped`], [`WorkbenchError::LostAtOnce`], and what the clip or the tracker met.
pub fn grant(study: &Arc<Study>, wish: &Wish, progress: &dyn Progress) -> Result<Granted, WorkbenchError> {
    let Some(way) = wish.model.way() else {
        return Ok(Granted::Ready(Box::new(study.fused(wish.frame, &wish.keys)?)));
    };
    let job = study.job(study.around(way, wish.frame, wish.keys.clone(), None))?;
    Ok(Granted::Retracked(Box::new(job.run(progress)?)))
}

/// The models that can be offered for a track, and how far each is from key-frames that it was not told of; one that is
/// missing could find none of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Errors {
    models: Vec<Model>,
    known: BTreeMap<Model, LeftOut>,
}

impl Errors {
    /// Errors that are known, of models that can be offered.
    #[must_use]
    pub fn new(models: Vec<Model>, known: impl IntoIterator<Item = (Model, LeftOut)>) -> Self {
        Self { models, known: known.into_iter().collect() }
    }

    /// Mean distance of a model from the key-frames left out, pixels.
    #[must_use]
    pub fn px(&self, model: Model) -> Option<f64> {
        self.known.get(&model).map(|out| out.mean_px)
    }

    /// The model to offer first: the one with the smallest error, as far as errors are known, and as long as
    /// they are few, also the one that mostly does best.
    ///
    /// Errors are compared as logarithms, because those of a track in calm air and of one in a storm differ by factors;
    /// what is mostly so counts as much as five key-frames. A model that missed a key-frame which another one
    /// found is not offered first. While nothing is known it is what several runs have found, where there are several:
    /// that is there at once.
    #[must_use]
    pub fn first(&self) -> Option<Model> {
        let Some(most) = self.known.values().map(|out| out.n).max() else {
            return self.models.contains(&Model::Fused).then_some(Model::Fused);
        };
        let score = |model: Model| -> Option<(f64, Model)> {
            let prior = PRIOR_KEYS * model.usual_error()?.ln();
            let out = self.known.get(&model).filter(|out| out.n == most)?;
            Some((prior + out.n as f64 * (out.mean_px + SURE_PX).ln(), model))
        };
        self.models
            .iter()
            .copied()
            .filter_map(score)
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, model)| model)
    }
}

/// What is mostly so counts as much as so many key-frames left out.
const PRIOR_KEYS: f64 = 5.0;
/// Errors below this are the hand's, pixels: they say nothing of the model.
const SURE_PX: f64 = 0.5;

/// Leaves out the key-frames nearest to a frame, one after the other, and asks every model where they are.
///
/// Those at the ends stay: only between two others does every model say something. The track's birth counts as a
/// key-frame that is never left out. The models work on what the runs have found, and not on what was corrected.
///
/// # Errors
/// [`WorkbenchError::Stopped`], and what the clip or the tracker met.
pub fn errors(study: &Study, frame: u32, progress: &dyn Progress) -> Result<Errors, WorkbenchError> {
    let anchors = study.anchors(&[]);
    let placed: Vec<Placed> = anchors.iter().filter_map(|(&frame, at)| Some((frame, (*at)?))).collect();
    let keys = nearest(&placed, frame);
    let mut told: BTreeMap<Model, BTreeMap<u32, [f32; 2]>> = BTreeMap::new();
    for around in keys.windows(3) {
        let &[before, (left, _), after] = around else { continue };
        if progress.report(0, 0, "key-frame") == Flow::Stop {
            return Err(WorkbenchError::Stopped);
        }
        // Where the feature is said to be lost in between, a model has nothing to go on.
        if anchors.range(before.0..after.0).any(|(_, at)| at.is_none()) {
            continue;
        }
        for (model, at) in predicted(study, &placed, before, left, after, progress)? {
            told.entry(model).or_default().insert(left, at);
        }
    }
    let of = |(model, told): (Model, BTreeMap<u32, [f32; 2]>)| {
        Some((model, loko(keys, |_, frame| told.get(&frame).copied())?))
    };
    Ok(Errors::new(study.models().collect(), told.into_iter().filter_map(of)))
}

/// The key-frames to leave out, with their neighbours.
fn nearest(placed: &[Placed], frame: u32) -> &[Placed] {
    let n = placed.len().min(N_LEFT_OUT + 2);
    let here = placed.partition_point(|(at, _)| *at < frame);
    let start = here.saturating_sub(n / 2).min(placed.len() - n);
    &placed[start..start + n]
}

/// Where the models put the feature in a frame between two key-frames.
fn predicted(
    study: &Study,
    placed: &[Placed],
    before: Placed,
    left: u32,
    after: Placed,
    progress: &dyn Progress,
) -> Result<Vec<(Model, [f32; 2])>, WorkbenchError> {
    let ground = &study.ground;
    let bare = Track { keys: BTreeMap::new(), over: BTreeMap::new(), ..ground.track.clone() };
    let keys = placed.iter().filter(|(at, _)| *at != left && ground.track.keys.contains_key(at));
    let keys = keys.map(|&(at, [x, y])| (at, Key::set(x, y))).collect();
    let drawn = Track { keys, ..bare.clone() };
    let curve = Shown::new(ground.id, &drawn, &[], study.times());
    let curve = curve.span().get(left).filter(|sample| sample.source == Source::Interpolated).and_then(at);
    let found = Shown::new(ground.id, &bare, &ground.runs, study.times());
    let carried = space(&found, before.0, before.1)
        .and_then(|first| found.then(&first, |shown| space(shown, after.0, after.1), ""));
    let carried = carried.ok().and_then(|carried| carried.span.get(left).and_then(at));
    let fused = study.has_rivals().then(|| study.fused_between([before, after], left)).flatten();
    let tracked = study.between([before, after], left, progress)?;
    let [both, ahead, back] = tracked.map(|sample| sample.as_ref().and_then(at));
    let said = [
        (Model::Space, carried),
        (Model::Both, both),
        (Model::Fused, fused.as_ref().and_then(at)),
        (Model::Hermite, curve),
        (Model::Forward, ahead),
        (Model::Backward, back),
    ];
    Ok(said.into_iter().filter_map(|(model, at)| Some((model, at?))).collect())
}

/// Where a sample says that the feature is.
fn at(sample: &Sample) -> Option<[f32; 2]> {
    let is_placed = sample.status.is_seen() || sample.status == Status::Occluded;
    is_placed.then_some([sample.x, sample.y])
}

#[cfg(test)]
mod tests;
