//! What is asked for in the viewer is one edit each, which undo takes back, or a line that says why not.

use honami_store::Access;

use super::*;
use crate::tried;

/// Turns the bone of a node; that of the second track is 1, and 9 there is not.
fn shape(node: u32, plane_deg: f64) -> Event {
    Event::Shape { node, plane_deg, lean_deg: 0.0, gain: 1.0 }
}

/// What becomes of an event, in a line.
fn done(project: &mut Project, event: &Event) -> String {
    match edit(project, event) {
        Ok(Some(line)) => line,
        Ok(None) => "nothing".to_owned(),
        Err(error) => format!("error: {error}"),
    }
}

#[test]
fn what_is_asked_for_is_one_edit_each() {
    let (_folder, mut session) = tried::grouped();
    let project = &mut session.project;
    let begun = project.history().entries().len();
    for (event, begins, n_edits) in [
        (Event::Root(Some([12.5, 40.0])), "root placed at 12.5, 40.0", 1),
        (Event::Root(Some([12.5, 40.0])), "nothing", 1),
        (Event::Root(Some([1e9, 40.0])), "error: ", 1),
        (Event::Root(Some([f64::NAN, 40.0])), "error: ", 1),
        (shape(1, 30.0), "group 2", 2),
        (shape(1, 30.0), "nothing", 2),
        (shape(9, 30.0), "error: ", 2),
        (shape(1, f64::NAN), "error: ", 2),
        (Event::Cut(1), "cut into 1 group", 3),
        (Event::Cut(0), "error: ", 3),
        (Event::Cut(3), "error: ", 3),
        (Event::Undo, "undone: cut into 1 group", 3),
        (Event::Undo, "undone: group 2", 3),
        (Event::Redo, "done again: group 2", 3),
        (Event::Root(None), "", 4),
        // What tells and asks for nothing.
        (Event::Frame(2), "nothing", 4),
        (Event::Passing(2), "nothing", 4),
        (Event::Selected(None), "nothing", 4),
        (Event::Closed, "nothing", 4),
    ] {
        let line = done(project, &event);
        assert!(line.starts_with(begins), "{event:?}: {line}");
        assert_eq!(project.history().entries().len(), begun + n_edits, "{event:?}: {line}");
        let is_asked =
            !matches!(event, Event::Frame(_) | Event::Passing(_) | Event::Selected(_) | Event::Closed);
        assert_eq!(is_edit(&event), is_asked, "{event:?}");
    }
    let document = project.document();
    let shown = document.clustering().unwrap();
    let plane_deg = document.shape(shown.id, 1).unwrap().plane_rad.to_degrees();
    assert!((plane_deg - 30.0).abs() < 1e-9 && document.root().is_none() && shown.k == 2, "{plane_deg}");
}

/// An edit is asked for without being made; undo and redo are no edits of their own.
#[test]
fn a_transaction_changes_nothing_by_itself() {
    let (_folder, session) = tried::grouped();
    let project = &session.project;
    let before = project.revision();
    for (event, label) in [
        (shape(1, -30.5), Some("group 2")),
        (Event::Root(Some([1.0, 2.0])), Some("root placed at 1.0, 2.0")),
        (Event::Cut(1), Some("cut into 1 group")),
        (Event::Root(None), None),
        (shape(1, 0.0), None),
        (Event::Undo, None),
        (Event::Redo, None),
    ] {
        let made = transaction(project, &event).unwrap().map(|transaction| transaction.label);
        assert_eq!(made.is_some(), label.is_some(), "{event:?}: {made:?}");
        assert!(made.zip(label).is_none_or(|(made, label)| made.starts_with(label)), "{event:?}");
    }
    assert_eq!(project.revision(), before);
}

#[test]
fn nobody_writes_to_a_project_that_is_looked_at() {
    let (folder, session) = tried::grouped();
    drop(session);
    let mut project = Project::open(&folder.path().join("clip.honami"), Access::Read).unwrap();
    for event in [Event::Cut(1), Event::Undo, Event::Root(Some([1.0, 2.0])), shape(1, 30.0)] {
        assert!(edit(&mut project, &event).is_err(), "{event:?}");
    }
    // Without groups there is nothing to cut or to shape.
    let (_folder, mut session) = tried::project(2);
    for event in [Event::Cut(1), shape(1, 30.0)] {
        assert!(matches!(edit(&mut session.project, &event), Err(WorkbenchError::NoGroups)), "{event:?}");
    }
}
