//! Trees above cuts of a small dendrogram.

use honami_model::hierarchy::Merge;

use super::*;

/// ((0 1) ((2 3) 4)).
fn five() -> Dendrogram {
    let merge = |a, b, height, size| Merge { a, b, height, size };
    Dendrogram::new(
        5,
        vec![merge(0, 1, 1.0, 2), merge(2, 3, 2.0, 2), merge(6, 4, 3.0, 3), merge(5, 7, 4.0, 5)],
    )
    .unwrap()
}

/// Written as it is nested: leaves of a group, or its parts in brackets.
fn shape(groups: &[Group], row: usize) -> String {
    let group = &groups[row];
    if group.children.is_empty() {
        return format!("{}:{:?}", group.number, group.leaves);
    }
    let parts: Vec<String> = group.children.iter().map(|&child| shape(groups, child)).collect();
    format!("({})", parts.join(" "))
}

#[test]
fn the_tree_above_a_cut() {
    let seen = [true; 5];
    for (k, wanted) in [
        (1, "0:[0, 1, 2, 3, 4]"),
        (2, "(0:[0, 1] 1:[2, 3, 4])"),
        (3, "(0:[0, 1] (1:[2, 3] 2:[4]))"),
        (5, "((0:[0] 1:[1]) ((2:[2] 3:[3]) 4:[4]))"),
    ] {
        let groups = tree(&five(), k, &seen);
        assert_eq!(shape(&groups, 0), wanted);
        for (row, group) in groups.iter().enumerate() {
            assert!(
                group
                    .parent
                    .map_or(row == 0, |parent| parent < row && groups[parent].children.contains(&row))
            );
        }
    }
}

#[test]
fn what_is_not_seen_is_left_out() {
    let of = |seen: [bool; 5]| {
        let groups = tree(&five(), 5, &seen);
        (!groups.is_empty()).then(|| shape(&groups, 0))
    };
    assert_eq!(of([true, true, true, true, false]).unwrap(), "((0:[0] 1:[1]) (2:[2] 3:[3]))");
    assert_eq!(of([false, false, true, false, true]).unwrap(), "(2:[2] 4:[4])");
    assert_eq!(of([false, false, false, true, false]).unwrap(), "3:[3]");
    assert_eq!(of([false; 5]), None);
    assert_eq!(shape(&tree(&five(), 2, &[true, false, true, true, false]), 0), "(0:[0] 1:[2, 3])");
}

#[test]
fn a_group_of_several_clusters_stands_where_most_of_it_is() {
    let held = |k, held: &[Vec<u32>], is_seen: [bool; 5]| {
        let groups = tree_of(&five(), &five().groups(k, held), &is_seen);
        shape(&groups, 0)
    };
    let all = [true; 5];
    assert_eq!(held(2, &[vec![5, 4]], all), "(0:[0, 1, 4] 1:[2, 3])");
    assert_eq!(held(3, &[vec![4, 0]], all), "((0:[0, 4] 1:[1]) 2:[2, 3])");
    assert_eq!(held(2, &[vec![5, 4]], [false, false, true, true, true]), "(1:[2, 3] 0:[4])");
    assert_eq!(held(1, &[vec![5, 7]], all), "0:[0, 1, 2, 3, 4]");
}

#[test]
fn groups_know_their_nodes() {
    let nodes = |k, held: &[Vec<u32>], is_seen: [bool; 5]| -> Vec<u32> {
        tree_of(&five(), &five().groups(k, held), &is_seen).iter().map(|group| group.node).collect()
    };
    let all = [true; 5];
    assert_eq!(nodes(2, &[], all), [8, 5, 7]);
    assert_eq!(nodes(3, &[], all), [8, 5, 7, 6, 4], "a fork is the same whatever it is cut into");
    assert_eq!(
        nodes(5, &[], [false, false, true, false, true]),
        [7, 2, 4],
        "what is not seen leaves no fork"
    );
    let held = [vec![5, 4]];
    assert_eq!(nodes(2, &held, all), [8, 5, 6]);
    assert_eq!(
        nodes(2, &held, [false, false, true, true, true]),
        [7, 6, 5],
        "its largest, wherever it stands"
    );
}

#[test]
fn one_leaf_is_one_group_and_none_is_none() {
    let one = Dendrogram::new(1, vec![]).unwrap();
    assert_eq!(shape(&tree(&one, 1, &[true]), 0), "0:[0]");
    assert_eq!(tree(&Dendrogram::new(0, vec![]).unwrap(), 1, &[]), []);
}
