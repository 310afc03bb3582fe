//! Themes: what the roles of [`style`] look like.
//!
//! Everything is drawn in the roles' own colours, which are those of the first theme; the last step of drawing
//! gives them the theme's. The picture and the colours of groups are the same in every theme.

use ratatui::style::{Color, Modifier, Style};

use super::style;
use crate::term::encode::Frame;

/// A role: its name in configuration files, and the colour it is drawn in.
struct Role {
    name: &'static str,
    drawn: Option<Color>,
}

/// The roles that a theme colours.
const ROLES: [Role; 6] = [
    Role { name: "accent", drawn: style::ACCENT.fg },
    Role { name: "dim", drawn: style::DIM.fg },
    Role { name: "error", drawn: style::ERROR.fg },
    Role { name: "key", drawn: style::KEY.fg },
    Role { name: "panel-text", drawn: style::PANEL.fg },
    Role { name: "panel", drawn: style::PANEL.bg },
];

/// What the roles look like.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Theme {
    /// What it is called.
    pub name: String,
    roles: [Style; ROLES.len()],
}

impl Theme {
    /// The themes everybody has; the first is the usual one.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let own = ROLES.map(|role| role.drawn.unwrap_or_default());
        let indexed = |numbers: [u8; ROLES.len()]| numbers.map(Color::Indexed);
        let plain = |name: &str, colours: [Color; ROLES.len()]| Self {
            name: name.to_owned(),
            roles: colours.map(|colour| Style::new().fg(colour)),
        };
        let mut contrast = plain(
            "contrast",
            [
                Color::LightYellow,
                Color::Reset,
                Color::LightRed,
                Color::LightYellow,
                Color::White,
                Color::Black,
            ],
        );
        for at in [0, 2, 3] {
            contrast.roles[at] = contrast.roles[at].add_modifier(Modifier::BOLD);
        }
        vec![plain("dark", own), plain("light", indexed([28, 242, 160, 130, 235, 254])), contrast]
    }

    /// A theme like another one, with some roles as a user wants them; and what is wrong with that.
    #[must_use]
    pub fn like(base: &Self, name: &str, wanted: &toml::Table) -> (Self, Vec<String>) {
        let mut theme = Self { name: name.to_owned(), roles: base.roles };
        let mut wrong = Vec::new();
        for (role, value) in wanted.iter().filter(|(role, _)| *role != "like") {
            let Some(at) = ROLES.iter().position(|known| known.name == role) else {
                let known = ROLES.map(|role| role.name).join(", ");
                wrong.push(format!("themes.{name}: {role} is no role; there are {known}"));
                continue;
            };
            match value.as_str().and_then(read) {
                Some(style) => theme.roles[at] = style,
                None => wrong.push(format!(
                    "themes.{name}.{role}: a colour is wanted, as \"#2f7d32\", \"28\" or \"bold red\", got {value}"
                )),
            }
        }
        (theme, wrong)
    }

    /// Gives a drawn frame its colours.
    pub(super) fn paint(&self, frame: &mut Frame) {
        let look = |colour: Color| {
            let at = ROLES.iter().position(|role| role.drawn == Some(colour))?;
            Some(self.roles[at])
        };
        for cell in &mut frame.cells.content {
            if let Some(role) = look(cell.fg) {
                cell.fg = role.fg.unwrap_or(cell.fg);
                cell.modifier |= role.add_modifier;
            }
            if let Some(role) = look(cell.bg) {
                cell.bg = role.fg.unwrap_or(cell.bg);
            }
        }
    }
}

/// Reads `bold #2f7d32`: a colour, and words for how it is written.
fn read(text: &str) -> Option<Style> {
    let mut style = Style::new();
    for word in text.split_whitespace() {
        style = match word {
            "bold" => style.add_modifier(Modifier::BOLD),
            "underlined" => style.add_modifier(Modifier::UNDERLINED),
            "reversed" => style.add_modifier(Modifier::REVERSED),
            colour => style.fg(colour.parse().ok()?),
        };
    }
    style.fg.map(|_| style)
}
