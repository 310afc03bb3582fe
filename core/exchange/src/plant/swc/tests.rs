//! Files of SWC, right and wrong.

use super::parse;

#[test]
fn a_line_is_a_node() {
    let measured =
        parse("# plant\n1 1 0 0 0 40 -1\n2 3 0 0 100 30 1 # tip\n\n3,3,0,50,100,20,1", 0.01).unwrap();
    let nodes: Vec<_> =
        measured.plant.nodes().iter().map(|node| (node.parent, node.position, node.radius)).collect();
    assert_eq!(
        nodes,
        [(None, [0.0; 3], 0.4), (Some(0), [0.0, 0.0, 1.0], 0.3), (Some(0), [0.0, 0.5, 1.0], 0.2)]
    );
    assert!(measured.notes.is_empty());
}

#[test]
fn what_is_no_node_is_named_with_its_line() {
    let cases = [
        ("", "a file of SWC has a line a node, this has none"),
        ("1 1 0 0 0 1", "line 1: wanted number, type, x, y, z, radius and parent, came 6 cells"),
        ("1 1 0 0 0 1 -1\n2 1 0 x 0 1 1", "line 2: \"x\" is no number"),
        ("1 1 0 0 0 1 -1\n2 1 0 NaN 0 1 1", "line 2: \"NaN\" is no number"),
        (
            "1 1 0 0 0 1 -1\n2 1 0 0 1 -1e300 1",
            "line 2: a radius is 0, where it was not measured, or more, not -1e300",
        ),
        ("1.5 1 0 0 0 1 -1", "line 1: \"1.5\" is no whole number"),
        ("1 1 0 0 0 1 -1", "a plant has two nodes at least, this one has 1"),
        ("1 1 0 0 0 1 2\n2 1 0 0 0 1 1", "line 1: node 1 stands on itself, through its parents"),
    ];
    for (text, wanted) in cases {
        assert_eq!(parse(text, 1.0).map_err(|error| error.to_string()), Err(wanted.to_owned()), "{text:?}");
    }
}
