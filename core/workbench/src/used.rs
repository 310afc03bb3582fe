//! With which values plugins were used last in a project: what their forms begin with.
//!
//! They are read from the provenance of what is shown, which is never written again: what a plugin is told that is not
//! here, or a parameter that only a newer build has, stays in the project as it was written, and counts again once the
//! plugin is back. They follow the document, so that undoing a run undoes them, and a log that is done again finds them.

use std::collections::BTreeMap;

use honami_host::Values;
use honami_model::document::{ClusteringId, RunId};
use honami_model::provenance::Provenance;
use honami_store::{Project, StoreError};

/// The values of all that is shown in a project, read once each.
#[derive(Debug, Default)]
pub struct Used {
    runs: BTreeMap<RunId, Use>,
    clusterings: BTreeMap<ClusteringId, Use>,
    /// What is shown, the topmost run last.
    shown: (Vec<RunId>, Option<ClusteringId>),
}

/// One use: the plugin's id, and what it was told.
type Use = (String, Values);

impl Used {
    /// Looks at a project; whether something else is shown than at the last look.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn look(&mut self, project: &Project) -> Result<bool, StoreError> {
        let document = project.document();
        let runs = document.runs().iter().map(|shown| shown.run).collect();
        let shown = (runs, document.clustering().map(|shown| shown.id));
        if shown == self.shown {
            return Ok(false);
        }
        for run in &shown.0 {
            if !self.runs.contains_key(run) {
                self.runs.insert(*run, use_of(project.run(*run)?.head.provenance));
            }
        }
        if let Some(id) = shown.1.filter(|id| !self.clusterings.contains_key(id)) {
            self.clusterings.insert(id, use_of(project.clustering(id)?.provenance));
        }
        self.shown = shown;
        Ok(true)
    }

    /// The last value of every parameter that a plugin was told, under the ids that it has now; ids that nobody knows
    /// are among them.
    #[must_use]
    pub fn values(&self, plugin_id: &str, renamed: &BTreeMap<String, String>) -> Values {
        let (runs, clustering) = &self.shown;
        let runs = runs.iter().filter_map(|run| self.runs.get(run));
        let clusterings = clustering.iter().filter_map(|id| self.clusterings.get(id));
        let mut values = Values::default();
        for (_, told) in runs.chain(clusterings).filter(|(id, _)| id == plugin_id) {
            values.restore(told, renamed);
        }
        values
    }
}

fn use_of(provenance: Provenance) -> Use {
    (provenance.plugin_id, provenance.params.into_iter().collect())
}

#[cfg(test)]
mod tests;
