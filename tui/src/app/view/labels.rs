//! Letters on the tracks, over the picture.

use super::style;
use crate::app::labels::labels;
use crate::app::layout::{Layout, Lens};
use crate::app::state::State;
use crate::term::encode::Frame;

pub(super) fn draw(state: &State, typed: &str, layout: &Layout, frame: &mut Frame) {
    let lens = Lens::of(state, layout.picture);
    // From the outside inwards: where labels meet, the one nearer to the middle is on top.
    for (label, _, at) in labels(state).into_iter().rev() {
        let (Some(rest), Some((x, y))) = (label.strip_prefix(typed), lens.pixel_of(at)) else { continue };
        let (x, y) = (lens.area.x + x as u16, lens.area.y + y as u16 / 2);
        let room = usize::from(layout.picture.right().saturating_sub(x));
        for (i, letter) in rest.chars().take(room).enumerate() {
            let at = frame.cells.index_of(x + i as u16, y);
            frame.cells.content[at].reset();
            frame.cells.content[at]
                .set_char(letter)
                .set_style(style::PANEL.patch(style::ACCENT).patch(style::BOLD));
            frame.softness[at] = 0;
        }
    }
}
