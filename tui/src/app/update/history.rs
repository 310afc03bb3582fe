//! Going about in the undo tree.

use super::{Effect, Mode, State, edit};
use crate::app::panel::Panel;

/// Opens the undo tree at the entry where the document stands, or closes it.
pub(super) fn toggle(state: &mut State) {
    if let Mode::History { .. } = state.mode {
        return close(state);
    }
    let below = state.panel.replace(Panel::History);
    state.mode = Mode::History { at: state.history.head_row(), below };
}

/// Leaves the undo tree; the panel that was shown before is shown again.
pub(super) fn close(state: &mut State) {
    if let Mode::History { below, .. } = std::mem::replace(&mut state.mode, Mode::Review) {
        state.panel = below;
    }
}

/// Chooses a row so many further down, within the tree.
pub(super) fn step(state: &mut State, rows: i64) {
    let last = state.history.len().saturating_sub(1);
    if let Mode::History { at, .. } = &mut state.mode {
        *at = at.saturating_add_signed(isize::try_from(rows).unwrap_or(0)).min(last);
    }
}

/// Goes to the chosen entry.
pub(super) fn jump(state: &mut State) -> Vec<Effect> {
    let Mode::History { at, .. } = state.mode else { return Vec::new() };
    let Some(to) = state.history.row(at).map(|(entry, _)| entry.id) else { return Vec::new() };
    if edit::is_writable(state) { vec![Effect::Jump(to)] } else { Vec::new() }
}
