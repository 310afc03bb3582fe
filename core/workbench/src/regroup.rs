//! Hand work on the shown groups: merged, split, tracks taken into another, named.

use honami_model::edit::Transaction;
use honami_model::regroup::{Refused, transaction};
use honami_store::Project;

pub use honami_model::regroup::Step;

use crate::error::WorkbenchError;

/// The transaction of a step on the shown groups; the project stays as it is.
///
/// # Errors
/// [`WorkbenchError::Regroup`] where nothing would change, and what the project met.
pub fn prepare(project: &Project, step: &Step) -> Result<Transaction, WorkbenchError> {
    let document = project.document();
    let shown = document.clustering().ok_or(Refused::NoGroups)?;
    let clustering = project.clustering(shown.id)?;
    Ok(transaction(document, (&clustering.tracks, &clustering.dendrogram), step)?)
}
