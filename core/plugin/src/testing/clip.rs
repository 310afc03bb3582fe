//! Clips that are functions of place and frame, so that all motion in them is known.

use super::{stream, track};
use crate::Result;
use crate::tracker::{Frame, Gray, Point, Seed, Tracker};

/// Pictures in memory, 25 a second.
#[derive(Clone, Debug)]
pub struct Clip {
    width: u32,
    height: u32,
    pictures: Vec<Vec<u8>>,
}

impl Clip {
    /// So many pictures of this size, of the brightness `(x, y, frame)` at the centres of pixels, rounded to 0..=255.
    #[must_use]
    pub fn new(
        width: u32,
        height: u32,
        n_frames: usize,
        brightness: impl Fn(f64, f64, usize) -> f64,
    ) -> Self {
        let pixels = || (0..height).flat_map(|y| (0..width).map(move |x| (f64::from(x), f64::from(y))));
        let byte = |(x, y), t| brightness(x, y, t).round().clamp(0.0, 255.0) as u8;
        let pictures = (0..n_frames).map(|t| pixels().map(|at| byte(at, t)).collect()).collect();
        Self { width, height, pictures }
    }

    /// The same picture in every frame, moved by `step` pixels from each to the next: `brightness(x, y)` in the first.
    #[must_use]
    pub fn drifting(
        width: u32,
        height: u32,
        n_frames: usize,
        step: [f64; 2],
        brightness: impl Fn(f64, f64) -> f64,
    ) -> Self {
        Self::new(width, height, n_frames, |x, y, t| {
            brightness(x - step[0] * t as f64, y - step[1] * t as f64)
        })
    }

    /// One frame.
    ///
    /// # Panics
    /// When there are not as many.
    #[must_use]
    #[track_caller]
    pub fn frame(&self, t: usize) -> Frame<'_> {
        Frame::new(Gray::packed(&self.pictures[t], self.width, self.height), t as i64, t as f64 / 25.0)
    }

    /// All frames, in order.
    pub fn frames(&self) -> impl Iterator<Item = Frame<'_>> {
        (0..self.pictures.len()).map(|t| self.frame(t))
    }

    /// Tracks points through all frames, on one thread. Returns the rows of every frame.
    ///
    /// # Errors
    /// The tracker's.
    pub fn track<T: Tracker>(&self, params: &T::Params, seeds: &[Seed]) -> Result<Vec<Vec<Point>>> {
        let mut rows = track::<T>(params, &stream(self.width, self.height), seeds, self.frames())?;
        rows.truncate(self.pictures.len());
        Ok(rows)
    }
}

/// How far a row of frame `t` is from where its point is, which was seeded in frame 0 and drifts by `step` a frame, pixels.
#[must_use]
pub fn off_px(row: &Point, seed: &Seed, step: [f64; 2], t: usize) -> f64 {
    let along = |at: f32, from: f32, step: f64| f64::from(at) - f64::from(from) - step * t as f64;
    along(row.x, seed.x, step[0]).hypot(along(row.y, seed.y, step[1]))
}
