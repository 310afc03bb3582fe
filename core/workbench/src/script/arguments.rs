//! The words after the first: numbers, tracks, frames and positions, each refused with what was wanted.

use std::ops::Range;

use honami_model::track::{TrackId, TrackSet};

use super::{ScriptError, Word};
use crate::session::Session;
use crate::shape::parse_groups;

/// The words after the first, as many as the word takes.
pub(super) struct Arguments<'a> {
    word: &'static Word,
    given: &'a [&'a str],
}

impl<'a> Arguments<'a> {
    /// As many as the word takes: `…` at the end of its form is one or more, what stands in brackets may be missing.
    pub(super) fn of(word: &'static Word, given: &'a [&'a str]) -> Result<Self, ScriptError> {
        let forms = word.takes.split_whitespace();
        let least = forms.clone().filter(|form| !form.starts_with('[')).count();
        let most = if word.takes.contains('…') { usize::MAX } else { forms.count() };
        if (least..=most).contains(&given.len()) {
            Ok(Self { word, given })
        } else {
            Err(ScriptError::Form { name: word.name, takes: word.takes })
        }
    }

    /// The word in a place; empty where none was given.
    pub(super) fn text(&self, at: usize) -> &'a str {
        self.given.get(at).copied().unwrap_or_default()
    }

    /// The words from a place on.
    pub(super) fn rest(&self, at: usize) -> &'a [&'a str] {
        self.given.get(at..).unwrap_or_default()
    }

    /// It is not what the word takes there.
    pub(super) fn wrong(&self, at: usize, wanted: &str) -> ScriptError {
        let got = self.given.get(at).map_or_else(|| format!("{} alone", self.word.name), ToString::to_string);
        ScriptError::Wrong { wanted: wanted.to_owned(), got }
    }

    pub(super) fn whole(&self, at: usize, what: &str) -> Result<u32, ScriptError> {
        self.text(at).parse().ok().ok_or_else(|| self.wrong(at, &format!("the {what} as a whole number")))
    }

    /// A finite number.
    pub(super) fn number(&self, at: usize, wanted: &str) -> Result<f64, ScriptError> {
        let number: Option<f64> = self.text(at).parse().ok();
        number.filter(|number| number.is_finite()).ok_or_else(|| self.wrong(at, wanted))
    }

    pub(super) fn track(&self, at: usize) -> Result<TrackId, ScriptError> {
        Ok(TrackId(self.whole(at, "track")?))
    }

    /// A group by its number, which counts from 1; returned from 0.
    pub(super) fn group(&self, at: usize) -> Result<u32, ScriptError> {
        let number = self.whole(at, "group")?.checked_sub(1);
        number.ok_or_else(|| self.wrong(at, "the group as a whole number from 1 on"))
    }

    /// Groups, which count from 1; returned from 0.
    pub(super) fn groups(&self, at: usize) -> Result<Vec<u32>, ScriptError> {
        parse_groups(self.text(at)).ok_or_else(|| self.wrong(at, "groups as 3, 3,4 or 1-4"))
    }

    /// Where a root is, which need not be in the clip.
    pub(super) fn root(&self, at: usize) -> Result<[f64; 2], ScriptError> {
        let wanted = "a position in pixels";
        Ok([self.number(at, wanted)?, self.number(at + 1, wanted)?])
    }

    /// The tracks from a place on.
    pub(super) fn tracks(&self, at: usize) -> Result<TrackSet, ScriptError> {
        (at..self.given.len()).map(|at| self.track(at)).collect()
    }

    /// The frames from the one in this place to the one in the next, both included.
    pub(super) fn frames(&self, at: usize) -> Result<Range<u32>, ScriptError> {
        let (first, last) = (self.whole(at, "first frame")?, self.whole(at + 1, "last frame")?);
        if first > last {
            return Err(self.wrong(at + 1, &format!("a last frame from {first} on")));
        }
        Ok(first..last.saturating_add(1))
    }

    /// A frame and a position in the clip: elsewhere no tracker could go on from it.
    pub(super) fn place(&self, at: usize, session: &Session) -> Result<(u32, [f32; 2]), ScriptError> {
        let clip = session.media.clip();
        let (width, height, n_frames) = (clip.width, clip.height, clip.n_frames());
        let frame = self.whole(at, "frame")?;
        let pixels = |at: usize| {
            self.text(at).parse::<f32>().ok().ok_or_else(|| self.wrong(at, "a position in pixels"))
        };
        let [x, y] = [pixels(at + 1)?, pixels(at + 2)?];
        let inside = |v: f32, size: u32| (-0.5..size as f32 - 0.5).contains(&v);
        if inside(x, width) && inside(y, height) && frame < n_frames {
            Ok((frame, [x, y]))
        } else {
            let [x, y] = [at + 1, at + 2].map(|at| self.text(at).to_owned());
            Err(ScriptError::Outside { x, y, frame, width, height, n_frames })
        }
    }
}
