//! The models that are offered for a sample that is placed: their errors, and what those have found that work behind the
//! screen.
//!
//! Nothing here waits. What is wished for is asked of the world, and what comes is taken only for the wish that stands.

use std::sync::Arc;

use honami_model::clip::FrameTimes;
use honami_model::correct::{Correction, Layers};
use honami_model::document::Key;
use honami_model::track::TrackId;
use honami_workbench::offer::{Errors, Model, Wish};

use super::{Moving, Tool};

/// What would be kept, or why it cannot be.
pub type Ghost = Result<Arc<Correction>, String>;

/// Something to be worked out behind the screen.
#[derive(Clone, Debug, PartialEq)]
pub enum Ask {
    /// How far the models are from the key-frames nearest to a frame.
    Errors(TrackId, u32),
    /// What a model makes of the track; `None`: nothing any more.
    Ghost(Option<Wish>),
}

/// Something that was worked out.
#[derive(Clone, Debug)]
pub enum Answer {
    /// How far the models are from the key-frames of a track, or why that is not known.
    Errors(TrackId, Result<Errors, String>),
    /// What a model makes of the track.
    Ghost(Wish, Ghost),
}

/// What is known of the models.
#[derive(Clone, Debug, Default)]
pub struct Offer {
    /// Their errors; `None` while they are measured.
    pub errors: Option<Errors>,
    /// Whether the person has chosen the model: then no other is put in its place.
    is_chosen: bool,
    has_asked: bool,
    wish: Option<Wish>,
    found: Option<(Wish, Ghost)>,
}

impl Offer {
    /// Nothing is known yet; `is_chosen`: the model is not to be replaced.
    pub(super) fn new(is_chosen: bool) -> Self {
        Self { is_chosen, ..Self::default() }
    }

    /// Forgets what was found: the track is another one now.
    pub(super) fn forget(&mut self) {
        (self.wish, self.found) = (None, None);
    }
}

/// Whether several runs have followed a track.
fn has_rivals(layers: &Layers) -> bool {
    layers.runs.iter().any(|(run, _)| *run != layers.runs[0].0)
}

impl Moving {
    /// The models that can be offered, in their order.
    pub fn models(&self) -> impl Iterator<Item = Model> + use<> {
        let has_rivals = self.layers.as_ref().is_some_and(|layers| has_rivals(layers));
        Model::ALL.into_iter().filter(move |model| *model != Model::Fused || has_rivals)
    }

    /// The model in use, where the sample is placed.
    #[must_use]
    pub fn model(&self) -> Option<Model> {
        match self.tool {
            Tool::Place { model, .. } => Some(model),
            Tool::Slide(_) => None,
        }
    }

    /// Whether what would be kept is still being worked out.
    #[must_use]
    pub fn is_pending(&self) -> bool {
        self.ghost.is_none() && self.wish().is_some()
    }

    /// What the model in use has to be asked for behind the screen; `None`: it works at once.
    #[must_use]
    pub fn wish(&self) -> Option<Wish> {
        let (Tool::Place { to, model }, Some(layers)) = (&self.tool, &self.layers) else { return None };
        if model.at_once().is_some() {
            return None;
        }
        let keys = self.pins.iter().map(|(&frame, &key)| (frame, key));
        let keys = keys.chain([(self.frame, Key::set(to[0], to[1]))]).collect();
        Some(Wish { track: layers.id, frame: self.frame, model: *model, keys })
    }

    /// What is to be asked for now, and was not yet.
    pub fn asks(&mut self) -> Vec<Ask> {
        let mut asks = Vec::new();
        if self.layers.is_none() || self.model().is_none() {
            return asks;
        }
        let wish = self.wish();
        if wish != self.offer.wish {
            self.offer.wish.clone_from(&wish);
            asks.push(Ask::Ghost(wish));
        }
        if !std::mem::replace(&mut self.offer.has_asked, true) {
            asks.push(Ask::Errors(self.track, self.frame));
        }
        asks
    }

    /// What was found for the wish that stands.
    pub(super) fn found(&self) -> Option<Ghost> {
        let (wish, ghost) = self.offer.found.as_ref()?;
        (Some(wish) == self.wish().as_ref()).then(|| ghost.clone())
    }

    /// Takes what was worked out; `may_offer`: the model that does best may take the place of one that nobody chose.
    pub fn answer(&mut self, answer: Answer, may_offer: bool) {
        match answer {
            Answer::Ghost(wish, ghost) => self.offer.found = Some((wish, ghost)),
            Answer::Errors(track, errors) if track == self.track => {
                let errors = errors.unwrap_or_default();
                let first = errors.first();
                self.offer.errors = Some(errors);
                if let (Tool::Place { model, .. }, Some(first)) = (&mut self.tool, first)
                    && may_offer
                    && !self.offer.is_chosen
                {
                    *model = first;
                }
            }
            Answer::Errors(..) => {}
        }
    }

    /// What was found was handed over and came to nothing: it has to be found again.
    pub fn refused(&mut self, times: &FrameTimes) {
        self.offer.forget();
        self.preview(times);
    }

    /// Uses this model, because the person says so.
    pub fn choose(&mut self, chosen: Model) {
        if let Tool::Place { model, .. } = &mut self.tool {
            *model = chosen;
            self.offer.is_chosen = true;
        }
    }
}
