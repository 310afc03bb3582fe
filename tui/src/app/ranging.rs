//! A range of frames that is marked for work.

use std::ops::Range;

/// A range from where it was begun to where it was ended, or still to the current frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ranging {
    /// Where it was begun.
    pub from: u32,
    /// Where it was ended, before or after; `None` while it goes on.
    pub to: Option<u32>,
}

impl Ranging {
    /// Its frames, both ends included, when one is at a frame.
    #[must_use]
    pub fn frames(self, here: u32) -> Range<u32> {
        let to = self.to.unwrap_or(here);
        self.from.min(to)..self.from.max(to).saturating_add(1)
    }

    /// Its frames in words: `range 187-203`.
    #[must_use]
    pub fn words(self, here: u32) -> String {
        let frames = self.frames(here);
        format!("range {}-{}", frames.start, frames.end - 1)
    }
}
