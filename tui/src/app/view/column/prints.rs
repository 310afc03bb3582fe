//! What plugins print and log, with the frame they were at; the newest line is in sight, or the one that is looked at.

use honami_workbench::plugins::Level;
use ratatui::style::Style;
use ratatui::text::{Line, Span};

use super::{List, Pick, style};
use crate::app::state::State;
use crate::app::view::{fitted, padded};

/// Cells of a plugin's name.
const NAME: usize = 8;

pub(super) struct PrintList<'a>(pub(super) &'a State);

impl List for PrintList<'_> {
    fn heading(&self) -> String {
        format!("{:>6} {} {} lines", "frame", padded("plugin", NAME), self.0.prints.n())
    }

    fn nothing(&self) -> &'static str {
        "no plugin has printed anything yet"
    }

    fn len(&self) -> usize {
        self.0.prints.lines().len()
    }

    fn current(&self) -> Option<usize> {
        self.0.prints.current()
    }

    fn text(&self) -> Option<String> {
        Some(self.0.prints.lines().get(self.current()?)?.text.clone())
    }

    fn row(&self, i: usize) -> Line<'static> {
        let Some(line) = self.0.prints.lines().get(i) else { return Line::default() };
        let (word, of_level) = match line.level {
            Level::Debug => ("", style::DIM),
            Level::Info => ("", Style::new()),
            Level::Warning => ("warning: ", style::ACCENT),
            Level::Error => ("error: ", style::ERROR),
        };
        let name = if line.plugin.is_empty() { "here" } else { &line.plugin };
        let frame = line.frame.map_or_else(String::new, |frame| frame.to_string());
        let whose = Span::styled(format!("{frame:>5} {} ", fitted(name, NAME)), style::DIM);
        Line::from(vec![whose, Span::styled(format!("{word}{}", line.text), of_level)])
    }

    fn pick(&self, i: usize) -> Option<Pick> {
        Some(Pick::Print(i))
    }
}
