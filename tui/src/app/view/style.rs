//! The few colours of the chrome: one accent, one for errors; all else is the terminal's own.

use honami_workbench::palette;
use ratatui::style::{Color, Modifier, Style};

/// What the eye should find first.
pub const ACCENT: Style = Style::new().fg(Color::Indexed(114));
/// What may be overlooked.
pub const DIM: Style = Style::new().fg(Color::Indexed(245));
/// What is wrong.
pub const ERROR: Style = Style::new().fg(Color::Indexed(203));
/// Key-frames and the path.
pub const KEY: Style = Style::new().fg(Color::Indexed(221));
/// Names.
pub const BOLD: Style = Style::new().add_modifier(Modifier::BOLD);
/// Panels over the picture.
pub const PANEL: Style = Style::new().fg(Color::Indexed(252)).bg(Color::Indexed(235));
/// The chosen row of a list, also without colours.
pub const CHOSEN: Style = Style::new().add_modifier(Modifier::REVERSED);

/// Colour of a group's tracks as that of text; of those without a group where `None`.
#[must_use]
pub fn group_text(number: Option<u32>) -> Style {
    let [r, g, b] = palette::group(number);
    Style::new().fg(Color::Rgb(r, g, b))
}
