//! What plugins print and log while they work, the newest last.

use std::collections::VecDeque;

use honami_workbench::plugins::Level;

/// So many lines are kept; older ones go.
pub(super) const N_KEPT: usize = 1000;

/// A line of a plugin's.
#[derive(Clone, Debug, PartialEq)]
pub struct Print {
    /// When, seconds since its job began.
    pub t_s: f64,
    /// Its short name; empty for what was printed in this process, where nobody knows by whom.
    pub plugin: String,
    /// How severe it is; what is printed is information.
    pub level: Level,
    /// The line, fit for a screen.
    pub text: String,
}

/// The lines that are kept.
#[derive(Clone, Debug, Default)]
pub struct Prints {
    lines: VecDeque<Print>,
    n: u64,
}

impl Prints {
    /// Adds lines, in the order in which they came.
    pub fn add(&mut self, lines: impl IntoIterator<Item = Print>) {
        for line in lines {
            self.n += 1;
            self.lines.push_back(line);
            if self.lines.len() > N_KEPT {
                self.lines.pop_front();
            }
        }
    }

    /// Those that are kept.
    #[must_use]
    pub fn lines(&self) -> &VecDeque<Print> {
        &self.lines
    }

    /// How many have come.
    #[must_use]
    pub fn n(&self) -> u64 {
        self.n
    }
}
