//! What plugins print and log while they work, the newest last.

use std::collections::VecDeque;

use honami_workbench::plugins::Level;

/// So many lines are kept; older ones go.
pub(super) const N_KEPT: usize = 1000;

/// A line of a plugin's.
#[derive(Clone, Debug, PartialEq)]
pub struct Print {
    /// The frame of the clip that it was at; `None` where it was at none.
    pub frame: Option<u32>,
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
    /// The line that is looked at, counted from the first that has come; `None`: the newest, whichever that is.
    at: Option<u64>,
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

    /// The line that is looked at, among those that are kept.
    #[must_use]
    pub fn current(&self) -> Option<usize> {
        let last = self.lines.len().checked_sub(1)?;
        let Some(at) = self.at else { return Some(last) };
        Some(usize::try_from(at.saturating_sub(self.n_gone())).map_or(last, |at| at.min(last)))
    }

    /// Looks at one of those that are kept: it stays in sight while others come, unless it is the newest.
    pub fn look_at(&mut self, i: usize) {
        self.at = (i + 1 < self.lines.len()).then(|| self.n_gone() + i as u64);
    }

    /// Those that came before the first that is kept.
    fn n_gone(&self) -> u64 {
        self.n - self.lines.len() as u64
    }

    /// How many have come.
    #[must_use]
    pub fn n(&self) -> u64 {
        self.n
    }
}

#[cfg(test)]
mod tests;
