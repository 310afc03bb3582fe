//! The log of the session: what was done and what was said to it, the last line in sight.

use honami_workbench::scene::control;
use ratatui::text::{Line, Span};

use super::{List, Pick, style};
use crate::app::command_log::{Here, What};
use crate::app::state::State;

pub(super) struct Log<'a>(pub(super) &'a State);

impl List for Log<'_> {
    fn heading(&self) -> String {
        format!("{:>7} {} lines", "s", self.0.log.n())
    }

    fn nothing(&self) -> &'static str {
        "nothing was done yet"
    }

    fn len(&self) -> usize {
        self.0.log.lines().len()
    }

    fn current(&self) -> Option<usize> {
        self.len().checked_sub(1)
    }

    fn row(&self, i: usize) -> Line<'static> {
        let Some(line) = self.0.log.lines().get(i) else { return Line::default() };
        let done = |text: String| Span::raw(format!(" {text}"));
        let what = match &line.what {
            What::Action(name) => done(counted(name, line.here.as_ref())),
            What::Text(text) => done(format!("“{text}”")),
            What::Mouse(touch) => done(match touch.at {
                Some([x, y]) => format!("mouse at {x:.1}, {y:.1}"),
                None => "mouse beside the picture".to_owned(),
            }),
            What::Screen(columns, rows) => done(format!("screen {columns}x{rows}")),
            What::Ended(plugin) => done(format!("{plugin} ended")),
            What::Window(event) => done(format!("window {}", control::line(event).trim_end())),
            What::Notice(text) => Span::styled(format!("  {text}"), style::DIM),
            What::Error(text) => Span::styled(format!("  {text}"), style::ERROR),
        };
        Line::from(vec![Span::styled(format!("{:>6.1}", line.t_s), style::DIM), what])
    }

    fn pick(&self, _: usize) -> Option<Pick> {
        None
    }
}

/// An action with its count, and what was chosen by it.
fn counted(name: &str, here: Option<&Here>) -> String {
    let count = here.and_then(|here| here.count).map_or_else(String::new, |count| format!("{count} "));
    let chosen = here.and_then(|here| here.chosen.as_ref()).map_or_else(String::new, |row| format!(" {row}"));
    format!("{count}{name}{chosen}")
}
