//! Finding things: by the letters on them, or in a list.

use super::{Mode, State, complain, say, time};
use crate::app::labels::labels;
use crate::app::menu::Menu;

/// Puts letters on the tracks that are seen.
pub(super) fn label(state: &mut State) {
    if labels(state).is_empty() {
        return complain(state, "no track is seen here: Z looks from farther away, / finds tracks by name");
    }
    time::stop(state);
    state.mode = Mode::Label(String::new());
}

/// Takes a letter of a label; the last one selects.
pub(super) fn type_label(state: &mut State, c: char) {
    let Mode::Label(typed) = &mut state.mode else { return };
    typed.extend(c.to_lowercase());
    let typed = typed.clone();
    let labels = labels(state);
    if let Some((_, track, _)) = labels.iter().find(|(label, ..)| *label == typed) {
        state.mode = Mode::Review;
        time::select(state, *track);
        say(state, format!("track {track} is selected"));
    } else if !labels.iter().any(|(label, ..)| label.starts_with(&typed)) {
        state.mode = Mode::Review;
        complain(state, format!("no track here has the letters {typed}"));
    }
}

/// Lists the key-frames of the selected track.
pub(super) fn key_frame(state: &mut State) {
    let Some(row) = state.selected_row() else {
        return complain(state, "select a track first: j takes the next");
    };
    if row.keys.is_empty() {
        let line = format!("track {} has no key-frames; m moves a sample, Enter confirms one", row.id);
        return complain(state, line);
    }
    let menu = Menu::of_key_frames(row, &state.clip.times);
    state.mode = Mode::Menu(Box::new(menu));
}

/// Lists the plugins.
pub(super) fn plugin(state: &mut State) {
    if state.plugins.is_empty() {
        return complain(state, "no plugins were found; `honami doctor` says where they are looked for");
    }
    state.mode = Mode::Menu(Box::new(Menu::of_plugins(&state.plugins)));
}
