//! Hand work on skeletons: what it says, what it refuses, and that undo takes it back.

use super::*;
use crate::edit::{EditError, apply};

const ID: ClusteringId = ClusteringId(4);

fn grouped() -> Document {
    let mut document = Document::new(1);
    apply(&mut document, &Transaction::show_clustering(ID, 3)).unwrap();
    document
}

fn bud() -> Bone {
    Bone { clustering: ID, node: 7, name: "group 3 bud-left".to_owned(), groups: vec![2] }
}

fn degrees_of(plane: f64, lean: f64, gain: f64) -> Shape {
    Shape { plane_rad: plane.to_radians(), lean_rad: lean.to_radians(), gain }
}

/// All that hands have done to the skeleton, in words.
fn seen(document: &Document) -> String {
    let root = document.root().map(|[x, y]| format!("root {x} {y}"));
    let shapes = document.shapes(ID).map(|(node, shape)| format!("{node}: {shape}"));
    root.into_iter().chain(shapes).collect::<Vec<_>>().join("; ")
}

#[test]
fn steps_say_what_they_did_and_are_taken_back() {
    let fork = || Bone { clustering: ID, node: 2, name: "fork 1,2".to_owned(), groups: vec![0, 1] };
    let mut document = grouped();
    let mut undo = Vec::new();
    for (step, label, wanted) in [
        (Step::Root(Some([130.0, 352.25])), "root placed at 130.0, 352.2", "root 130 352.25"),
        (
            Step::Bone(bud(), degrees_of(30.0, 0.0, 1.0)),
            "group 3 bud-left: plane 30°",
            "root 130 352.25; 7: plane 30°",
        ),
        (
            Step::Bone(bud(), degrees_of(30.0, -10.0, 1.5)),
            "group 3 bud-left: lean -10°, gain 1.5",
            "root 130 352.25; 7: plane 30°, lean -10°, gain 1.5",
        ),
        (
            Step::Bone(fork(), degrees_of(0.0, 0.0, 0.0)),
            "fork 1,2: gain 0",
            "root 130 352.25; 2: gain 0; 7: plane 30°, lean -10°, gain 1.5",
        ),
        (
            Step::Bone(bud(), degrees_of(0.0, -10.0, 1.5)),
            "group 3 bud-left: plane 0°",
            "root 130 352.25; 2: gain 0; 7: lean -10°, gain 1.5",
        ),
        (Step::Bone(bud(), Shape::default()), "group 3 bud-left: as it grows", "root 130 352.25; 2: gain 0"),
        (Step::Root(None), "root: as it grows", "2: gain 0"),
        (Step::Root(Some([1.0, 2.0])), "root placed at 1.0, 2.0", "root 1 2; 2: gain 0"),
        (Step::Release, "root and 1 bone: as the skeleton grows", ""),
    ] {
        let before = document.clone();
        let done = transaction(&document, &step).unwrap();
        assert_eq!(done.label, label);
        undo.push((before, apply(&mut document, &done).unwrap()));
        assert_eq!(seen(&document), wanted, "{label}");
    }
    while let Some((before, back)) = undo.pop() {
        apply(&mut document, &back).unwrap();
        assert_eq!(document, before);
    }
}

#[test]
fn what_would_change_nothing_is_refused() {
    let bare = Document::new(1);
    let mut shaped = grouped();
    let shape = degrees_of(30.0, 0.0, 1.0);
    for step in [Step::Root(Some([1.0, 2.0])), Step::Bone(bud(), shape)] {
        let done = transaction(&shaped, &step).unwrap();
        apply(&mut shaped, &done).unwrap();
    }
    // Another clustering has a node 7 as well, which is another bone.
    let mut regrouped = shaped.clone();
    apply(&mut regrouped, &Transaction::show_clustering(ClusteringId(5), 3)).unwrap();
    for (document, step, wanted) in [
        (&bare, Step::Bone(bud(), shape), "no clustering is shown: bones are those of its groups"),
        (
            &regrouped,
            Step::Bone(bud(), shape),
            "group 3 bud-left is a bone of other groups than those shown: choose a bone of these",
        ),
        (&bare, Step::Root(None), "root: as it grows already"),
        (&bare, Step::Release, "nothing of the skeleton was placed or shaped by hand: it is as it grows"),
        (&shaped, Step::Root(Some([1.0, 2.0])), "root placed at 1.0, 2.0 already"),
        (&shaped, Step::Bone(bud(), shape), "group 3 bud-left: plane 30° already"),
        (
            &shaped,
            Step::Bone(Bone { node: 1, ..bud() }, Shape::default()),
            "group 3 bud-left: as it grows already",
        ),
    ] {
        let refused = transaction(document, &step).unwrap_err();
        assert_eq!(refused.to_string(), wanted, "{step:?}");
    }
}

#[test]
fn numbers_out_of_range_are_refused_and_change_nothing() {
    for (shape, wanted) in [
        (degrees_of(181.0, 0.0, 1.0), "the plane of a bone is turned by -180 to 180 degrees, not 181"),
        (degrees_of(0.0, -200.0, 1.0), "a bone leans by -180 to 180 degrees, not -200"),
        (degrees_of(0.0, f64::NAN, 1.0), "a bone leans by -180 to 180 degrees, not NaN"),
        (degrees_of(0.0, 0.0, -0.1), "the gain of a bone is 0 (stiff) to 10, not -0.1"),
        (degrees_of(0.0, 0.0, f64::INFINITY), "the gain of a bone is 0 (stiff) to 10, not inf"),
    ] {
        let mut document = grouped();
        let done = transaction(&document, &Step::Bone(bud(), shape)).unwrap();
        assert_eq!(apply(&mut document, &done).unwrap_err().to_string(), wanted);
        assert_eq!(seen(&document), "");
    }
    let half_turns = degrees_of(180.0, -180.0, 10.0);
    assert_eq!(half_turns.check(), Ok(()), "the ends of the ranges are in them");
    let mut document = grouped();
    let done = transaction(&document, &Step::Root(Some([f64::NAN, 2.0]))).unwrap();
    assert_eq!(apply(&mut document, &done), Err(EditError::Root("NaN, 2".to_owned())));
}

#[test]
fn projects_say_it_so() {
    let shape = Some(Shape { plane_rad: 0.5, lean_rad: -0.25, gain: 2.0 });
    for (edit, wanted) in [
        (Edit::PlaceRoot { root: Some([130.0, 352.5]) }, r#"{"place-root":{"root":[130.0,352.5]}}"#),
        (Edit::PlaceRoot { root: None }, r#"{"place-root":{"root":null}}"#),
        (
            Edit::ShapeBone { clustering: ID, node: 7, shape },
            r#"{"shape-bone":{"clustering":4,"node":7,"shape":{"plane_rad":0.5,"lean_rad":-0.25,"gain":2.0}}}"#,
        ),
    ] {
        assert_eq!(serde_json::to_string(&edit).unwrap(), wanted);
        assert_eq!(serde_json::from_str::<Edit>(wanted).unwrap(), edit);
    }
}
