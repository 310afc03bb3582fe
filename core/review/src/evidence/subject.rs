//! What is measured: a track as it is shown, and what other runs say of it.

use std::sync::Arc;

use honami_model::track::{Sample, Span, TrackId};

use super::Parts;

/// How a tracker knows its feature, which decides how it errs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// From the frame before: its errors add up, and it does not notice.
    #[default]
    Stepwise,
    /// As its key-frame shows it: what does not look like that it calls hidden.
    Anchored,
}

/// What a run says of a track.
#[derive(Clone, Debug)]
pub struct Rival {
    /// What the tracker is called.
    pub name: Arc<str>,
    /// How it knows the feature.
    pub kind: Kind,
    /// Its samples.
    pub span: Arc<Span>,
}

/// A track to measure.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Its number.
    pub track: TrackId,
    /// How the tracker knows the feature whose run is shown.
    pub kind: Kind,
    /// Its samples as they are shown.
    pub span: Arc<Span>,
    /// What the runs say of it, where there are several; else empty.
    pub rivals: Vec<Rival>,
    /// Frames, ascending, of which a person has said that the feature is not seen there: nothing is doubtful in them.
    pub unseen: Vec<u32>,
}

impl Subject {
    /// The runs that see the feature elsewhere than the run that is shown, and how far from there, pixels.
    ///
    /// Where a correction has laid something else than any of them, they say nothing of it.
    pub(super) fn others(&self, frame: u32) -> Vec<(&Rival, f32)> {
        let Some(shown) = self.span.get(frame) else { return Vec::new() };
        let seen = |rival: &Rival| rival.span.get(frame).filter(|sample| sample.status.is_seen()).copied();
        let far = |sample: Sample| (sample.x - shown.x).hypot(sample.y - shown.y);
        let mut said: Vec<(&Rival, f32)> =
            self.rivals.iter().filter_map(|rival| Some((rival, far(seen(rival)?)))).collect();
        let own = said.iter().position(|(_, px)| *px == 0.0);
        own.map_or_else(Vec::new, |own| {
            said.remove(own);
            said
        })
    }

    /// What the run is called that is farthest from what is shown, of those that suspicion asks.
    pub(crate) fn opponent(&self, frame: u32, parts: &Parts) -> Option<Arc<str>> {
        let far = parts.farthest_px()?;
        let off = |said: &(&Rival, f32)| (said.1 - far).abs();
        let nearest = self.others(frame).into_iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        nearest.map(|(rival, _)| Arc::clone(&rival.name))
    }
}
