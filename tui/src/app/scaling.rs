//! A scale bar that is being set: both ends, then how long it is, then what it says before it is kept.

use honami_workbench::scale::{BarError, ScaleBar};

use crate::scale::Length;

/// Standard error of an end that is seen as large as can be, pixels: nobody points closer.
const LEAST_PX: f64 = 0.5;

/// What is set so far.
#[derive(Clone, Debug, PartialEq)]
pub struct Scaling {
    /// The frame that it is seen in.
    pub frame: u32,
    /// Where keys lead the cursor that sets an end, image pixels.
    pub at: [f32; 2],
    /// The ends that are set, at most two.
    pub ends: Vec<End>,
    /// Its length as far as it is typed, once both ends are set.
    pub typed: String,
    /// What all this makes, to be kept or not.
    pub bar: Option<ScaleBar>,
}

/// One end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// Where it is, image pixels.
    pub at: [f32; 2],
    /// Width and height of what was pointed at, a cell or a pixel of the screen, in image pixels.
    pub sides_px: [f64; 2],
}

impl End {
    /// Variance of its place along a direction of length 1, image pixels squared.
    ///
    /// What was meant lies anywhere in what was pointed at: the variance of an even distribution over a width w is w² / 12.
    fn variance_along(&self, way: [f64; 2]) -> f64 {
        let spread = self.sides_px[0] * way[0] * self.sides_px[0] * way[0]
            + self.sides_px[1] * way[1] * self.sides_px[1] * way[1];
        (spread / 12.0).max(LEAST_PX * LEAST_PX)
    }
}

impl Scaling {
    /// Nothing set in a frame yet, the cursor at a place.
    #[must_use]
    pub fn new(frame: u32, at: [f32; 2]) -> Self {
        Self { frame, at, ends: Vec::new(), typed: String::new(), bar: None }
    }

    /// Whether an end is being placed.
    #[must_use]
    pub fn is_placing(&self) -> bool {
        self.ends.len() < 2
    }

    /// Whether its length is being typed.
    #[must_use]
    pub fn is_typing(&self) -> bool {
        !self.is_placing() && self.bar.is_none()
    }

    /// Sets the next end.
    ///
    /// # Errors
    /// When the two are too near to each other to measure anything.
    pub fn set(&mut self, end: End) -> Result<(), BarError> {
        self.at = end.at;
        self.ends.push(end);
        // In parts of it, the error of what the ends say is the same whatever is between them.
        let checked = self.bar_of(1.0).map_or(Ok(()), |bar| bar.check());
        if checked.is_err() {
            self.ends.pop();
        }
        checked
    }

    /// Makes a bar of what was typed.
    ///
    /// # Errors
    /// A line that says why it is no length.
    pub fn measure(&mut self) -> Result<(), String> {
        let length: Length = self.typed.trim().parse()?;
        let bar = self.bar_of(length.metres()?);
        bar.iter().try_for_each(ScaleBar::check).map_err(|why| why.to_string())?;
        self.bar = bar;
        Ok(())
    }

    /// Takes back what was set last; whether there was something.
    pub fn take_back(&mut self) -> bool {
        self.bar.take().is_some() || self.ends.pop().is_some()
    }

    /// Both ends and a length, metres.
    fn bar_of(&self, length_m: f64) -> Option<ScaleBar> {
        let &[a, b] = &self.ends[..] else { return None };
        let ends = [a, b].map(|end| end.at.map(f64::from));
        let way = [0, 1].map(|axis| ends[1][axis] - ends[0][axis]);
        let far = way[0].hypot(way[1]);
        let way = way.map(|part| if far > 0.0 { part / far } else { 0.0 });
        // One error stands for both ends: what counts is the sum of their squares.
        let end_error_px = ((a.variance_along(way) + b.variance_along(way)) / 2.0).sqrt();
        Some(ScaleBar { frame: self.frame, ends, length_m, length_error_m: 0.0, end_error_px })
    }
}
