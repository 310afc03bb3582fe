//! The few colours of the chrome: one accent, one for errors; all else is the terminal's own.

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

/// Colours of groups: far from foliage and from each other; they repeat after the last.
const GROUPS: [[u8; 3]; 12] = [
    [255, 209, 0],
    [0, 200, 255],
    [255, 80, 80],
    [255, 120, 240],
    [120, 140, 255],
    [255, 150, 40],
    [170, 255, 90],
    [0, 240, 180],
    [200, 100, 255],
    [255, 220, 180],
    [170, 110, 60],
    [200, 200, 200],
];

/// Colour of a group's tracks; of those without a group where `None`.
#[must_use]
pub fn group(group: Option<u32>) -> [u8; 3] {
    group.map_or([90, 220, 255], |g| GROUPS[g as usize % GROUPS.len()])
}

/// The same as a text colour.
#[must_use]
pub fn group_text(number: Option<u32>) -> Style {
    let [r, g, b] = group(number);
    Style::new().fg(Color::Rgb(r, g, b))
}
