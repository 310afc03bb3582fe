//! What is being drawn: the stroke as it goes, what it would make of the path near a frame, and the point.

use super::ghost::{AFFECTED, GHOST, NEAR};
use super::{Canvas, RING};
use crate::app::sketching::Sketching;
use crate::app::tracks::TrackRow;

impl Canvas<'_> {
    /// The open sketch, as seen in a frame.
    pub(super) fn sketch(&mut self, sketching: &Sketching, row: Option<&TrackRow>, frame: u32) {
        if let Some(ghost) = sketching.correction() {
            let near = ghost.affected.clone().filter(|f| frame.abs_diff(*f) <= NEAR);
            for at in near.clone().filter_map(|f| row?.at(f)) {
                self.mark(at, &[(0, 0)], AFFECTED, '.');
            }
            for sample in near.filter_map(|f| ghost.span.get(f)) {
                self.mark([sample.x, sample.y], &[(0, 0)], GHOST, ':');
            }
            if let Some(sample) = ghost.span.get(frame).filter(|_| ghost.affected.contains(&frame)) {
                self.mark([sample.x, sample.y], &RING, GHOST, '@');
            }
        }
        for at in sketching.trail() {
            self.mark(at, &[(0, 0)], GHOST, ':');
        }
        self.cross(sketching.point);
    }
}
