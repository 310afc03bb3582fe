//! Dense motion: the picture as a set of overlapping squares, each looked for by itself, there and back.

use honami_follow::{check_size, field_there_and_back, picture, windows};
use honami_plugin::{Cx, Field, Frame, Result};
use honami_vision::boxes::{self, Boxes};
use honami_vision::klt::Flow;

use crate::cost_ns;
use crate::settings::Settings;

/// Displacements between two frames; none where nothing could be measured: no texture, hidden, or out of the picture.
pub(crate) fn field(
    settings: &Settings,
    from: &Frame<'_>,
    to: &Frame<'_>,
    max_threads: u32,
    cx: &Cx<'_>,
) -> Result<Field> {
    check_size(to, (from.gray.width, from.gray.height))?;
    let params = settings.matching();
    let [from, to] = [from, to].map(|frame| Boxes::new(&picture(frame), params.levels(), params.radius_px));
    let grid = windows(&from.picture(), params.radius_px);
    field_there_and_back(grid, [&from, &to], cost_ns(&params), cx, |prev, next, from| {
        let found = boxes::track(prev, next, from, None, &params, max_threads as usize);
        found.into_iter().map(|found| Flow { to: found.to, state: found.state }).collect()
    })
}
