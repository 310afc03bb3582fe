//! A line that is being typed, wherever it is.

use super::action::Action;

/// Longest text typed into a menu, a form or as a wind, characters.
pub const TYPED_MAX: usize = 256;

/// What was pasted, as it could have been typed.
#[must_use]
pub fn pasted(text: &str) -> String {
    text.trim().chars().filter(|c| !c.is_control()).collect()
}

/// Types more, as far as there is room for so many characters.
pub fn append(typed: &mut String, more: impl Iterator<Item = char>, n_max: usize) {
    let n = typed.chars().count();
    typed.extend(more.take(n_max.saturating_sub(n)));
}

/// Takes back the last letter, or the whole line.
pub fn take_back(typed: &mut String, action: Action) {
    match action {
        Action::EraseLine => typed.clear(),
        _ => drop(typed.pop()),
    }
}
