//! What plugins print and log, the newest line in sight.

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
        format!("{:>7} {} {} lines", "s", padded("plugin", NAME), self.0.prints.n())
    }

    fn nothing(&self) -> &'static str {
        "no plugin has printed anything yet"
    }

    fn len(&self) -> usize {
        self.0.prints.lines().len()
    }

    fn current(&self) -> Option<usize> {
        self.len().checked_sub(1)
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
        let time = Span::styled(format!("{:>6.1} {} ", line.t_s, fitted(name, NAME)), style::DIM);
        Line::from(vec![time, Span::styled(format!("{word}{}", line.text), of_level)])
    }

    fn pick(&self, _: usize) -> Option<Pick> {
        None
    }
}
