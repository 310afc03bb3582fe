//! What hands have done in the viewer, as edits of the project: each is one transaction, which undo takes back.

use honami_model::edit::Transaction;
use honami_model::shape::{Refused, Shape, Step};
use honami_scene::control::Event;
use honami_store::Project;

use crate::error::WorkbenchError;
use crate::shape::{bones, prepare};

/// Does what the viewer asks for; returns what was done, `None` where that changes nothing.
///
/// # Errors
/// As [`transaction`], and what the project met: nobody writes to one that is read only.
pub fn edit(project: &mut Project, event: &Event) -> Result<Option<String>, WorkbenchError> {
    match event {
        Event::Undo => Ok(project.undo()?.map(|entry| format!("undone: {}", entry.label))),
        Event::Redo => Ok(project.redo()?.map(|entry| format!("done again: {}", entry.label))),
        event => {
            let Some(transaction) = transaction(project, event)? else { return Ok(None) };
            let label = transaction.label.clone();
            project.commit(transaction)?;
            Ok(Some(label))
        }
    }
}

/// The edit that the viewer asks for; `None` where that changes nothing, or goes through the edits that there are.
///
/// # Errors
/// As [`prepare`], [`WorkbenchError::NoGroups`] and [`WorkbenchError::Groups`] of cuts, [`WorkbenchError::NoBone`] of a bone
/// that these groups do not have.
pub fn transaction(project: &Project, event: &Event) -> Result<Option<Transaction>, WorkbenchError> {
    let transaction = match event {
        Event::Root(root) => prepare(project, &Step::Root(*root)),
        Event::Shape { node, plane_deg, lean_deg, gain } => {
            let listed = bones(project)?;
            let names = || listed.iter().map(|listed| &*listed.bone.name).collect::<Vec<_>>().join("; ");
            let bone = listed.iter().find(|listed| listed.bone.node == *node);
            let bone = bone
                .ok_or_else(|| WorkbenchError::NoBone { wanted: format!("node {node}"), names: names() })?;
            let [plane_rad, lean_rad] = [plane_deg, lean_deg].map(|degrees| degrees.to_radians());
            prepare(project, &Step::Bone(bone.bone.clone(), Shape { plane_rad, lean_rad, gain: *gain }))
        }
        Event::Cut(k) => cut(project, *k),
        Event::Undo
        | Event::Redo
        | Event::Ready { .. }
        | Event::Frame(_)
        | Event::Passing(_)
        | Event::Playing(_)
        | Event::Selected(_)
        | Event::Captured(_)
        | Event::Closed
        | Event::Failed(_) => return Ok(None),
    };
    match transaction {
        Err(WorkbenchError::Shape(Refused::Same(_))) => Ok(None),
        other => other.map(Some),
    }
}

/// Whether an event asks for an edit.
#[must_use]
pub fn is_edit(event: &Event) -> bool {
    matches!(event, Event::Undo | Event::Redo | Event::Root(_) | Event::Shape { .. } | Event::Cut(_))
}

fn cut(project: &Project, k: u32) -> Result<Transaction, WorkbenchError> {
    let shown = project.document().clustering().ok_or(WorkbenchError::NoGroups)?;
    let n_tracks = project.clustering(shown.id)?.tracks.len();
    match k > 0 && k as usize <= n_tracks {
        true => Ok(Transaction::set_cut(k)),
        false => Err(WorkbenchError::Groups { groups: k, n_tracks }),
    }
}

#[cfg(test)]
mod tests;
