//! The way of the selected track through the frames near this one.

use honami_model::track::Span;

use super::{Canvas, KEY};
use crate::app::tracks::TrackRow;

/// The path is drawn this many frames to both sides.
const FRAMES: u32 = 12;

/// Where it came from, and where it goes.
const PAST: [u8; 3] = [255, 235, 160];
const AHEAD: [u8; 3] = [120, 200, 255];

/// Pixels of a key-frame's diamond.
const DIAMOND: [(i64, i64); 5] = [(0, 0), (-1, 0), (1, 0), (0, -1), (0, 1)];

impl Canvas<'_> {
    /// The way of a track, with key-frames as diamonds on it.
    pub(super) fn path(&mut self, row: &TrackRow, frame: u32) {
        self.trace(&row.span, frame, [PAST, AHEAD]);
        let frames = frame.saturating_sub(FRAMES)..=frame.saturating_add(FRAMES);
        for &key in row.keys.iter().filter(|key| frames.contains(key)) {
            if let Some(at) = row.at(key) {
                self.mark(at, &DIAMOND, KEY, '*');
            }
        }
    }

    /// A line from sample to sample, broken where the feature is not seen, in the colours of the past and of what is
    /// ahead.
    pub(super) fn trace(&mut self, span: &Span, frame: u32, [past, ahead]: [[u8; 3]; 2]) {
        let frames = frame.saturating_sub(FRAMES)..=frame.saturating_add(FRAMES);
        let seen = |f: u32| span.get(f).filter(|s| s.status.is_seen()).map(|s| [s.x, s.y]);
        for f in frames.clone() {
            let Some(at) = seen(f) else { continue };
            let colour = if f < frame { past } else { ahead };
            match seen(f + 1).filter(|_| frames.contains(&(f + 1))) {
                Some(next) => self.line(at, next, colour),
                None => self.line(at, at, if f <= frame { past } else { ahead }),
            }
        }
    }

    pub(super) fn line(&mut self, from: [f32; 2], to: [f32; 2], colour: [u8; 3]) {
        // As fine as a cell's dots: no place between is missed, whatever the pixels are.
        let per_px = 4.0 * f64::from(self.lens.area.width) / self.lens.width;
        let n =
            (f64::from((to[0] - from[0]).hypot(to[1] - from[1])) * per_px).ceil().clamp(1.0, 4000.0) as u32;
        for i in 0..=n {
            let part = i as f32 / n as f32;
            let at = [0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis]));
            if self.letters.is_some() {
                self.dot(at, colour);
            } else {
                self.mark(at, &[(0, 0)], colour, '.');
            }
        }
    }
}
