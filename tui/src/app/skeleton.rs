//! The skeleton over the picture: what has grown behind the screen, and where its joints are seen.

use std::sync::Arc;

use honami_model::document::Document;
use honami_workbench::grow::Growth;

use super::state::State;

/// What is known of the skeleton of the shown groups.
#[derive(Clone, Debug, Default)]
pub struct Skeletal {
    /// Whether it is shown.
    pub is_on: bool,
    /// How often what it grows from has changed.
    pub revision: u64,
    /// What was done to it by hand.
    pub hand: Hand,
    /// What has grown; what was before, until another has.
    pub bones: Option<Arc<Bones>>,
    /// What is awaited of the growth that goes on; `None` while none does.
    pub awaited: Option<Awaited>,
    /// The revision that was asked for last.
    asked: Option<u64>,
}

/// What a person has done to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hand {
    /// Where its root was placed, pixels (right, down).
    pub root: Option<[f64; 2]>,
}

impl Hand {
    /// What a document has of it.
    #[must_use]
    pub fn of(document: &Document) -> Self {
        Self { root: document.root() }
    }
}

/// What is awaited of a growth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Awaited {
    /// A line, too: somebody has asked for it.
    Line,
    /// The bones alone: what they grow from has changed meanwhile.
    Bones,
}

/// A skeleton as the screen draws it.
#[derive(Clone, Debug, PartialEq)]
pub struct Bones {
    /// What has grown.
    pub growth: Growth,
    /// The bones that are seen from the front, copies of these apart.
    pub n_seen: usize,
    /// Joint after joint in frame after frame: right, away, up, pixels.
    places: Vec<[f32; 3]>,
}

impl Bones {
    /// Works out where all joints are.
    #[must_use]
    pub fn of(growth: Growth) -> Self {
        let skeleton = &growth.skeleton;
        let place = |frame: u32| skeleton.places(skeleton.directions(frame));
        let places = (0..skeleton.times().len()).flat_map(place).map(|at| at.map(|v| v as f32)).collect();
        // Copies come after what they are copies of, and from the front they are seen in its place.
        let n_seen = (skeleton.joints().len() - 1) / growth.n_copies.max(1);
        Self { growth, n_seen, places }
    }

    /// Where all joints are in a frame of the clip; `None` where it has none.
    #[must_use]
    pub fn at(&self, frame: u32) -> Option<&[[f32; 3]]> {
        let nth = frame.checked_sub(self.growth.frames.start)? as usize;
        self.places.chunks(self.growth.skeleton.joints().len()).nth(nth)
    }

    /// What it is and what it took: `skeleton: 9 bones of 4 groups, diener, 0.2 s`.
    #[must_use]
    pub fn words(&self) -> String {
        let counted = |n: usize, one: &str| if n == 1 { format!("1 {one}") } else { format!("{n} {one}s") };
        let id = &self.growth.provenance.plugin_id;
        let mut words = format!(
            "skeleton: {} of {}, {}, {:.1} s",
            counted(self.n_seen, "bone"),
            counted(self.growth.groups.len(), "group"),
            id.rsplit('.').next().unwrap_or(id),
            self.growth.seconds
        );
        for note in &self.growth.notes {
            words.push_str(&format!(" · {note}"));
        }
        words
    }
}

impl Skeletal {
    /// What it grows from is another now.
    pub fn outdate(&mut self) {
        self.revision += 1;
    }

    /// There is nothing to grow from.
    pub fn wither(&mut self) {
        (self.bones, self.awaited, self.asked) = (None, None, None);
    }

    /// What was done to it by hand is this now.
    pub fn take(&mut self, hand: Hand) {
        if self.hand != hand {
            self.hand = hand;
            self.outdate();
        }
    }

    /// Shows it, from its growth on.
    pub fn show(&mut self) {
        (self.is_on, self.awaited) = (true, Some(Awaited::Line));
    }

    /// Shows it no longer; what grows is stopped.
    pub fn hide(&mut self) {
        self.wither();
        self.is_on = false;
        // What was asked for before is not what is asked for from now on.
        self.outdate();
    }

    /// The revision that is to grow now, once.
    pub fn request(state: &mut State) -> Option<u64> {
        let skeleton = &mut state.skeleton;
        let wanted = Some(skeleton.revision).filter(|_| skeleton.is_on && state.groups.is_some())?;
        if skeleton.asked.replace(wanted) == Some(wanted) {
            return None;
        }
        skeleton.awaited.get_or_insert(Awaited::Bones);
        Some(wanted)
    }
}
