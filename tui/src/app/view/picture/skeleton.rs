//! The skeleton: a line a bone, in the colour of the group whose centre its joint is.

use super::{Canvas, DARK, WHITE};
use crate::app::state::{Mode, State};
use crate::app::view::style;

/// Bones that end in forks.
const FORK: [u8; 3] = [235, 235, 235];
/// Pixels of the root's mark, and round them.
const ROOT: [(i64, i64); 6] = [(0, -1), (-1, 0), (0, 0), (1, 0), (-1, 1), (1, 1)];
const ROOT_HALO: [(i64, i64); 10] =
    [(0, -2), (-1, -1), (1, -1), (-2, 0), (2, 0), (-2, 1), (0, 1), (2, 1), (-1, 2), (1, 2)];

impl Canvas<'_> {
    /// The bones of a frame, where there are some; from the cursor on, where that is to be their root.
    pub(super) fn skeleton(&mut self, state: &State, frame: u32) {
        let Some(bones) = state.skeleton.bones.as_deref() else { return };
        let Some(places) = bones.at(frame) else { return };
        let seen = |row: usize| match state.mode {
            Mode::Root(at) if row == 0 => at,
            _ => [places[row][0], -places[row][2]],
        };
        let joints = bones.growth.skeleton.joints();
        for (row, joint) in joints.iter().enumerate().take(1 + bones.n_seen) {
            let Some(parent) = joint.parent else { continue };
            let colour = joint.groups.first().map_or(FORK, |group| style::group(Some(*group)));
            self.line(seen(parent as usize), seen(row), colour);
        }
        self.mark(seen(0), &ROOT_HALO, DARK, ' ');
        self.mark(seen(0), &ROOT, WHITE, '^');
    }
}
