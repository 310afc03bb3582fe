//! A correction that is open: what is moved, by which model, and what would become of the track.
//!
//! The preview is the correction itself, made anew with every key: what is seen is what will be kept.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use honami_model::clip::FrameTimes;
use honami_model::correct::{self, Correction, Layers, Refused, Shown};
use honami_model::document::Key;
use honami_model::edit::Edit;
use honami_model::track::{Source, Span, TrackId};
use honami_workbench::offer::{AtOnce, Model};

pub use offer::{Answer, Ask, Ghost, Offer};

mod offer;

/// Image pixels of a nudge by one at this magnification.
#[must_use]
pub fn nudge_px(zoom: u8) -> f32 {
    1.0 / f32::from(1_u16 << zoom)
}

/// How the sample is moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tool {
    /// To another place.
    Place {
        /// Where it will be, image pixels.
        to: [f32; 2],
        /// What becomes of the others.
        model: Model,
    },
    /// Along the curve, by so many frames of mean length.
    Slide(f64),
}

/// A sample that is being moved.
#[derive(Clone, Debug)]
pub struct Moving {
    /// Its track.
    pub track: TrackId,
    /// Its frame; another one may be looked at meanwhile.
    pub frame: u32,
    /// Where it is shown, image pixels.
    pub from: [f32; 2],
    /// How it is moved.
    pub tool: Tool,
    /// Frames that are made key-frames with it, as they are: the correction ends there.
    pub pins: BTreeMap<u32, Key>,
    /// The frame walked to along the path, while the picture stays.
    pub walked: Option<u32>,
    /// The track and what lies below, once known.
    pub layers: Option<Arc<Layers>>,
    /// What would be kept, or why it cannot be.
    pub ghost: Option<Ghost>,
    /// What is known of the models.
    pub offer: Offer,
}

impl Moving {
    /// A sample of a track that is about to be moved; `span` is what is shown of it.
    #[must_use]
    pub fn new(track: TrackId, frame: u32, from: [f32; 2], span: &Span) -> Self {
        let model = match span.get(frame) {
            None => Model::KeyOnly,
            // Between key-frames, they are the curve: it follows of itself.
            Some(sample) if sample.source == Source::Interpolated && sample.status.is_seen() => {
                Model::Hermite
            }
            Some(_) => Model::Space,
        };
        // Where the track is not shown there is nothing to carry along.
        let offer = Offer::new(model == Model::KeyOnly);
        let (pins, walked, layers, ghost) = Default::default();
        Self { track, frame, from, tool: Tool::Place { to: from, model }, pins, walked, layers, ghost, offer }
    }

    /// Where the sample will be.
    #[must_use]
    pub fn to(&self) -> [f32; 2] {
        match (&self.tool, self.correction()) {
            (Tool::Place { to, .. }, _) => *to,
            (Tool::Slide(_), Some(ghost)) => ghost.span.get(self.frame).map_or(self.from, |s| [s.x, s.y]),
            (Tool::Slide(_), None) => self.from,
        }
    }

    /// What would be kept, where it can be.
    #[must_use]
    pub fn correction(&self) -> Option<&Correction> {
        self.ghost.as_ref()?.as_ref().ok().map(AsRef::as_ref)
    }

    /// The frames that would change, once something has been moved.
    #[must_use]
    pub fn affected(&self) -> Option<Range<u32>> {
        let affected = self.correction()?.affected.clone();
        (!affected.is_empty() && self.has_moved()).then_some(affected)
    }

    /// Whether anything has been moved or pinned.
    #[must_use]
    pub fn has_moved(&self) -> bool {
        let to = self.to();
        (to[0] - self.from[0]).hypot(to[1] - self.from[1]) > 0.0 || !self.pins.is_empty()
    }

    /// Makes the preview anew, where it is made at once, or shows what was found. A slide is cut to what keeps the samples in their order.
    pub fn preview(&mut self, times: &FrameTimes) {
        let Some(layers) = self.layers.clone() else { return };
        let shown = layers.shown(times);
        let ghost = match self.tool {
            Tool::Place { to, model } => match model.at_once() {
                Some(correct) => self.placed(&shown, to, correct),
                None => {
                    self.ghost = self.found();
                    return;
                }
            },
            Tool::Slide(frames) => {
                let step_s = times.nominal_fps().map_or(1.0, |fps| 1.0 / fps);
                correct::time(&shown, self.frame, frames * step_s).map(|slid| {
                    self.tool = Tool::Slide(slid.shift_s / step_s);
                    slid.correction
                })
            }
        };
        self.ghost = Some(ghost.map(Arc::new).map_err(|why| why.to_string()));
    }

    fn placed(&self, shown: &Shown<'_>, to: [f32; 2], correct: AtOnce) -> Result<Correction, Refused> {
        if self.pins.is_empty() {
            return correct(shown, self.frame, to);
        }
        let key = |(&frame, &key): (&u32, &Key)| Edit::SetKey { track: self.track, frame, key };
        let pins = shown.correct(self.pins.iter().map(key).collect(), "")?;
        shown.then(&pins, |shown| correct(shown, self.frame, to), "corrected")
    }

    /// The track and what lies below it are these now.
    pub fn study(&mut self, layers: Arc<Layers>, times: &FrameTimes) {
        self.layers = Some(layers);
        self.offer.forget();
        self.preview(times);
    }
}
