//! The log: everything that was ever done to a project, and what made each result.

use honami_model::history::{Entry, EntryId};
use honami_model::provenance::Provenance;

use crate::clustering::ClusteringInfo;
use crate::error::StoreError;
use crate::journal;
use crate::matte::MatteInfo;
use crate::project::Project;
use crate::run::RunInfo;
use crate::space::SpaceInfo;

/// One line of the log.
#[derive(Clone, Debug, PartialEq)]
pub struct LogLine {
    /// When it happened or began, RFC 3339.
    pub date: String,
    /// What happened.
    pub item: LogItem,
}

/// What a line of the log is about.
#[derive(Clone, Debug, PartialEq)]
pub enum LogItem {
    /// An edit; the first one made the project. Undone ones stay in the log.
    Edit(Entry),
    /// A tracker ran.
    Run(RunInfo),
    /// A clusterer ran.
    Clustering(ClusteringInfo),
    /// A matte was found.
    Matte(MatteInfo),
    /// Two views became tracks in space.
    Space(SpaceInfo),
}

impl Project {
    /// All edits, runs, clusterings, mattes and tracks in space, oldest first and causes before effects: edits in the order they were
    /// made, a result after the edit it was made from and before the first that shows it, by date in between.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn log(&self) -> Result<Vec<LogLine>, StoreError> {
        let entries = self.history().entries();
        let shown = journal::first_shown(&self.conn)?;
        // Clocks differ and are set back: edits count as no older than those before them.
        let dates: Vec<&str> = entries
            .iter()
            .scan("", |latest, entry| {
                *latest = entry.time.as_str().max(*latest);
                Some(*latest)
            })
            .collect();
        let date_of = |id: EntryId| dates.get(id.0 as usize).copied();
        let mut lines = Vec::with_capacity(entries.len());
        for entry in entries {
            let line = LogLine { date: entry.time.clone(), item: LogItem::Edit(entry.clone()) };
            lines.push((date_of(entry.id).unwrap_or_default().to_owned(), entry.id, false, line));
        }
        let mut add_result = |made: &Provenance, shown_by: Option<&EntryId>, item| {
            let from = EntryId(made.input_revision);
            let first = made.date.as_str().max(date_of(from).unwrap_or_default());
            let last = shown_by.and_then(|&id| date_of(id)).unwrap_or(first);
            let line = LogLine { date: made.date.clone(), item };
            lines.push((first.min(last).to_owned(), from, true, line));
        };
        for run in self.runs()? {
            add_result(&run.head.provenance.clone(), shown.runs.get(&run.id), LogItem::Run(run));
        }
        for info in self.clusterings()? {
            let shown_by = shown.clusterings.get(&info.id);
            add_result(&info.provenance.clone(), shown_by, LogItem::Clustering(info));
        }
        for info in self.mattes()? {
            let shown_by = shown.mattes.get(&info.id);
            add_result(&info.provenance.clone(), shown_by, LogItem::Matte(info));
        }
        for info in self.spaces()? {
            let shown_by = shown.spaces.get(&info.id);
            add_result(&info.provenance.clone(), shown_by, LogItem::Space(info));
        }
        // In the same second a result comes after the edit it was made from and before all later ones.
        lines.sort_by(|a, b| (&a.0, a.1, a.2).cmp(&(&b.0, b.1, b.2)));
        Ok(lines.into_iter().map(|(.., line)| line).collect())
    }
}
