//! The skeleton: a line a bone, in the colour of the group whose centre its joint is; the chosen bone strong. Seen from
//! elsewhere than the camera it stands before nothing, so that nobody takes it for what lies in the picture.

use honami_workbench::palette::{self, DARK, FORK, UNSEEN};

use super::{Canvas, WHITE};
use crate::app::panel::Panel;
use crate::app::skeleton::{Bones, Pose, Skeletal};
use crate::app::state::{Mode, State};

/// What is behind a skeleton that is not seen from the front.
const NOTHING: [u8; 3] = [26, 26, 26];
/// Pixels of the root's mark, and round them.
const ROOT: [(i64, i64); 6] = [(0, -1), (-1, 0), (0, 0), (1, 0), (-1, 1), (1, 1)];
const ROOT_HALO: [(i64, i64); 10] =
    [(0, -2), (-1, -1), (1, -1), (-2, 0), (2, 0), (-2, 1), (0, 1), (2, 1), (-1, 2), (1, 2)];
/// Round a strong line, in pixels of the screen.
const BESIDE: [(f64, f64); 4] = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)];

impl Canvas<'_> {
    /// Takes the picture away from behind a skeleton that is not seen from the front.
    pub(super) fn clear(&mut self) {
        self.pixels.fill(NOTHING);
        self.note([0.0; 2], NOTHING);
    }

    /// The bones of a frame, where there are some: in grey as they were, where one is being shaped, and where the groups
    /// are others since.
    pub(super) fn skeleton(&mut self, state: &State, frame: u32) {
        let skeleton = &state.skeleton;
        let (Some(bones), Some(pose)) = (skeleton.bones.as_deref(), skeleton.pose.as_deref()) else { return };
        if let Mode::Shape(shaping) = &state.mode {
            self.bones(state, (bones, pose), frame, Some(UNSEEN));
            self.bones(state, (bones, &shaping.pose), frame, None);
        } else {
            // The colours are of the groups as they are now.
            self.bones(state, (bones, pose), frame, skeleton.is_past.then_some(UNSEEN));
        }
    }

    fn bones(&mut self, state: &State, (bones, pose): (&Bones, &Pose), frame: u32, grey: Option<[u8; 3]>) {
        let Some(places) = pose.at(frame) else { return };
        let azimuth = Skeletal::azimuth(state);
        let seen = |row: usize| match state.mode {
            // The cursor is to be the root.
            Mode::Root(at) if row == 0 => (at, 0.0),
            _ => pose.seen(places[row], azimuth),
        };
        let is_worked_on = state.panel == Some(Panel::Skeleton) || matches!(state.mode, Mode::Shape(_));
        let chosen = Skeletal::current(state).filter(|_| is_worked_on && grey.is_none());
        let all: Vec<usize> = (1..places.len()).collect();
        // From the front copies are seen where what they are copies of is.
        let rows = if azimuth == 0 { &bones.own } else { &all };
        let joints = bones.growth.skeleton.joints();
        for (&row, strong) in rows.iter().map(|row| (row, false)).chain(chosen.iter().map(|row| (row, true)))
        {
            let Some(parent) = joints[row].parent else { continue };
            let ((from, near), (to, far)) = (seen(parent as usize), seen(row));
            let colour = joints[row].groups.first().map_or(FORK, |group| palette::group(Some(*group)));
            // What is behind is darker.
            let is_behind = azimuth != 0 && near + far > 0.0 && !strong;
            let colour = if is_behind { colour.map(|v| v / 5 * 3) } else { colour };
            let colour = grey.unwrap_or(colour);
            if strong {
                self.strong(from, to, colour);
            } else {
                self.line(from, to, colour);
            }
        }
        self.mark(seen(0).0, &ROOT_HALO, DARK, ' ');
        self.mark(seen(0).0, &ROOT, WHITE, '^');
    }

    /// A line three pixels wide, light in its middle; in letters with one at its middle.
    fn strong(&mut self, from: [f32; 2], to: [f32; 2], colour: [u8; 3]) {
        let (columns, rows) = self.lens.size();
        let px = [self.lens.width / f64::from(columns.max(1)), self.lens.height / f64::from(rows.max(1))];
        for (across, down) in BESIDE {
            let moved = |[x, y]: [f32; 2]| [x + (across * px[0]) as f32, y + (down * px[1]) as f32];
            self.line(moved(from), moved(to), colour);
        }
        self.line(from, to, WHITE);
        self.mark([0, 1].map(|axis| f32::midpoint(from[axis], to[axis])), &[], WHITE, '#');
    }
}
