//! Nodes in any order.

use super::{Raw, plant};

fn raw(id: i64, parent: Option<i64>, z: f64, radius: f64) -> Raw {
    Raw { id, parent, position: [0.0, 0.0, z], radius: Some(radius), line: id as usize }
}

#[test]
fn nodes_may_come_in_any_order_and_under_any_number() {
    let mut notes = Vec::new();
    let nodes = [raw(9, Some(70), 2.0, 0.1), raw(70, Some(3), 1.0, 0.2), raw(3, None, 0.0, 0.3)];
    let made = plant(&nodes, &mut notes).unwrap();
    let found: Vec<_> =
        made.nodes().iter().map(|node| (node.parent, node.position[2], node.radius)).collect();
    assert_eq!(found, [(None, 0.0, 0.3), (Some(0), 1.0, 0.2), (Some(1), 2.0, 0.1)]);
    assert!(notes.is_empty());
}

#[test]
fn orphans_and_further_roots_are_left_out_and_told() {
    let mut notes = Vec::new();
    let nodes = [
        raw(1, None, 0.0, 0.1),
        raw(2, Some(1), 1.0, 0.1),
        raw(5, Some(99), 7.0, 0.1),
        raw(6, None, 8.0, 0.1),
    ];
    assert_eq!(plant(&nodes, &mut notes).unwrap().nodes().len(), 2);
    assert_eq!(
        notes,
        [
            "nodes whose parent is not there: 1, each is a root of its own; the first, in line 5: node 5 stands on node 99, which is not there",
            "further roots: 2; nodes of their trees that were left out: 2; the largest tree is kept"
        ]
    );
}

#[test]
fn radii_that_were_not_measured_are_guessed_and_told() {
    let mut notes = Vec::new();
    let some = [raw(1, None, 0.0, 0.0), raw(2, Some(1), 1.0, 0.3), raw(3, Some(2), 2.0, -1.0)];
    let radii: Vec<f64> = plant(&some, &mut notes).unwrap().nodes().iter().map(|node| node.radius).collect();
    assert_eq!((radii, notes.len()), (vec![0.3; 3], 1));
    let none = [
        raw(1, None, 0.0, 0.0),
        raw(2, Some(1), 1.0, 0.0),
        raw(3, Some(2), 2.0, 0.0),
        raw(4, Some(2), 2.5, 0.0),
    ];
    let mut notes = Vec::new();
    let areas: Vec<f64> = plant(&none, &mut notes)
        .unwrap()
        .nodes()
        .iter()
        .map(|node| (node.radius / 0.0025).powi(2).round())
        .collect();
    assert_eq!(areas, [2.0, 2.0, 1.0, 1.0]);
    assert!(notes[0].contains("pipe model"));
}

#[test]
fn circles_and_second_numbers_are_errors_with_their_line() {
    let cases: [(&[Raw], &str); 4] = [
        (
            &[raw(1, None, 0.0, 0.1), raw(2, Some(4), 1.0, 0.1), raw(4, Some(2), 2.0, 0.1)],
            "line 2: node 2 stands on itself, through its parents",
        ),
        (
            &[raw(1, None, 0.0, 0.1), raw(2, Some(7), 1.0, 0.1)],
            "line 2: node 2 stands on node 7, which is not there",
        ),
        (&[raw(1, Some(1), 0.0, 0.1)], "line 1: node 1 stands on itself, through its parents"),
        (&[raw(1, None, 0.0, 0.1), raw(1, Some(1), 1.0, 0.1)], "line 1: a second node 1"),
    ];
    for (nodes, wanted) in cases {
        assert_eq!(plant(nodes, &mut Vec::new()).map_err(|error| error.to_string()), Err(wanted.to_owned()));
    }
}
