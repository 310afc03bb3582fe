//! Scale bars: the one that is kept, in its frame, and the one that is being set.

use honami_workbench::scale::ScaleBar;

use super::{CROSSED, CURSOR, Canvas, WHITE};
use crate::app::scaling::Scaling;

/// A kept bar is seen when it is looked for.
const KEPT: [u8; 3] = [150, 150, 150];

impl Canvas<'_> {
    /// The bar that is kept.
    pub(super) fn scale_bar(&mut self, bar: &ScaleBar) {
        let ends = bar.ends.map(|end| end.map(|v| v as f32));
        self.line(ends[0], ends[1], KEPT);
        ends.into_iter().for_each(|end| self.mark(end, &[(0, 0)], WHITE, '+'));
    }

    /// The bar that is being set.
    pub(super) fn scaling(&mut self, scaling: &Scaling) {
        let cursor = scaling.is_placing().then_some(scaling.at);
        let ends: Vec<[f32; 2]> = scaling.ends.iter().map(|end| end.at).chain(cursor).collect();
        if let &[a, b] = &ends[..] {
            self.line(a, b, WHITE);
        }
        for end in &scaling.ends {
            self.mark(end.at, &CROSSED, CURSOR, 'x');
        }
        cursor.into_iter().for_each(|at| self.cross(at));
    }
}
