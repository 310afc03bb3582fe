//! What a correction would do: the affected part of the path, where it would run, and where one walks on it.

use super::{Canvas, DARK, KEY, RING, UNSEEN, WHITE};
use crate::app::correcting::Moving;
use crate::app::tracks::TrackRow;

/// So many frames of it are drawn to both sides of what is looked at.
pub(super) const NEAR: u32 = 12;

/// The path as it would be.
pub(super) const GHOST: [u8; 3] = [255, 120, 255];
/// The part of the path that would change.
pub(super) const AFFECTED: [u8; 3] = [255, 150, 60];

impl Canvas<'_> {
    /// The open correction, as seen in a frame.
    pub(super) fn ghost(&mut self, moving: &Moving, row: Option<&TrackRow>, frame: u32) {
        self.mark(moving.from, &[(0, 0)], UNSEEN, 'o');
        // Around the frame that is seen, and around the sample that was walked to.
        let near =
            |f: u32| [Some(frame), moving.walked].into_iter().flatten().any(|here| f.abs_diff(here) <= NEAR);
        let affected = moving.affected().unwrap_or(0..0);
        for f in affected.clone().filter(|f| near(*f)) {
            if let Some(at) = row.and_then(|row| row.at(f)) {
                self.mark(at, &[(0, 0)], AFFECTED, '.');
            }
        }
        if let Some(ghost) = moving.correction() {
            for f in affected.filter(|f| near(*f)) {
                if let Some(sample) = ghost.span.get(f) {
                    self.mark([sample.x, sample.y], &[(0, 0)], GHOST, ':');
                }
            }
            if frame != moving.frame
                && let Some(sample) = ghost.span.get(frame)
            {
                self.mark([sample.x, sample.y], &RING, GHOST, '@');
            }
        }
        for (_, key) in moving.pins.iter().filter(|(f, _)| near(**f)) {
            self.mark([key.x, key.y], &[(0, 0)], KEY, '*');
        }
        if let Some(at) = moving.walked.and_then(|f| row?.at(f)) {
            self.mark(at, &RING, DARK, ' ');
            self.mark(at, &[(0, 0), (-1, 0), (1, 0), (0, -1), (0, 1)], WHITE, 'O');
        }
        self.cross(moving.to());
    }
}
