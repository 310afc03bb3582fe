//! The log: everything that was ever done to a project, and what made each result.

use honami_model::history::Entry;

use crate::clustering::ClusteringInfo;
use crate::error::StoreError;
use crate::project::Project;
use crate::run::RunInfo;

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
}

impl Project {
    /// All edits, runs and clusterings by date; in the same second results come before the edits that show
    /// them.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn log(&self) -> Result<Vec<LogLine>, StoreError> {
        let line = |date: &str, item| LogLine { date: date.to_owned(), item };
        let runs = self.runs()?.into_iter();
        let clusterings = self.clusterings()?.into_iter();
        let mut lines: Vec<LogLine> = runs
            .map(|run| line(&run.head.provenance.date.clone(), LogItem::Run(run)))
            .chain(clusterings.map(|made| line(&made.provenance.date.clone(), LogItem::Clustering(made))))
            .chain(
                self.history().entries().iter().map(|entry| line(&entry.time, LogItem::Edit(entry.clone()))),
            )
            .collect();
        lines.sort_by(|a, b| a.date.cmp(&b.date));
        Ok(lines)
    }
}
