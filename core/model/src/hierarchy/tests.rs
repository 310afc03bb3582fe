//! Dendrograms: what is refused, what a cut gives.

use std::collections::BTreeSet;

use proptest::prelude::*;

use super::{Dendrogram, Merge};

fn merge(a: u32, b: u32, height: f64, size: u32) -> Merge {
    Merge { a, b, height, size }
}

#[test]
fn cut_undoes_the_highest_merges() {
    let tree =
        Dendrogram::new(4, vec![merge(0, 2, 1.0, 2), merge(1, 3, 2.0, 2), merge(4, 5, 5.0, 4)]).unwrap();
    let cases = [
        (0, vec![0, 0, 0, 0]),
        (1, vec![0, 0, 0, 0]),
        (2, vec![0, 1, 0, 1]),
        (3, vec![0, 1, 0, 2]),
        (4, vec![0, 1, 2, 3]),
        (9, vec![0, 1, 2, 3]),
    ];
    for (k, want) in cases {
        assert_eq!(tree.cut(k), want, "cut at {k}");
    }
    let nodes = [(1, vec![6]), (2, vec![4, 5]), (3, vec![4, 1, 3]), (9, vec![0, 1, 2, 3])];
    for (k, want) in nodes {
        assert_eq!(tree.nodes(k), want, "clusters of the groups at {k}");
    }
}

#[test]
fn an_inversion_is_undone_after_the_merge_that_holds_it() {
    // The first merge is the highest, but lies inside others; 0 and 1 part only when it is at the top.
    let three = Dendrogram::new(3, vec![merge(0, 1, 2.0, 2), merge(2, 3, 1.0, 3)]).unwrap();
    assert_eq!([1, 2, 3].map(|k| three.cut(k)), [[0, 0, 0], [0, 0, 1], [0, 1, 2]]);
    assert_eq!([1, 2, 3].map(|k| three.nodes(k)), [vec![4], vec![3, 2], vec![0, 1, 2]]);
    let rows = vec![merge(0, 1, 9.0, 2), merge(2, 3, 4.0, 2), merge(5, 4, 3.0, 3), merge(6, 7, 8.0, 5)];
    let five = Dendrogram::new(5, rows).unwrap();
    assert_eq!([2, 3, 4].map(|k| five.nodes(k)), [vec![7, 6], vec![7, 2, 3], vec![5, 2, 3, 4]]);
}

proptest! {
    /// Any tree, any heights: every cut has its k groups, and each splits one group of the cut before.
    #[test]
    fn cuts_are_exact_and_nested(picks in prop::collection::vec((0_usize..99, 0_usize..99, 0_u8..6), 0..30)) {
        let n = picks.len() as u32 + 1;
        let mut open: Vec<(u32, u32)> = (0..n).map(|leaf| (leaf, 1)).collect();
        let mut rows = Vec::new();
        for (made, (a, b, height)) in (n..).zip(picks) {
            let (a, size_a) = open.swap_remove(a % open.len());
            let (b, size_b) = open.swap_remove(b % open.len());
            rows.push(merge(a, b, f64::from(height), size_a + size_b));
            open.push((made, size_a + size_b));
        }
        let tree = Dendrogram::new(n, rows).unwrap();
        for k in 1..=n {
            let (groups, nodes) = (tree.cut(k), tree.nodes(k));
            prop_assert_eq!(nodes.len(), k as usize);
            prop_assert_eq!(groups.iter().max(), Some(&(k - 1)));
            let pairs: BTreeSet<_> = groups.iter().copied().zip(tree.cut(k - 1)).collect();
            prop_assert_eq!(pairs.len(), k as usize, "each group lies in one of the cut before");
            // What is undone next is the highest merge at the top.
            let top = |k| tree.nodes(k).into_iter().filter_map(|node| node.checked_sub(n)).collect::<BTreeSet<_>>();
            let height = |row: &u32| tree.merges()[*row as usize].height;
            if let Some(undone) = top(k).difference(&top(k + 1)).next() {
                prop_assert!(top(k).iter().all(|row| height(row) <= height(undone)));
            }
        }
    }
}

#[test]
fn refuses_rows_that_are_no_tree() {
    let cases = [
        (3, vec![merge(0, 1, 1.0, 2)], "1 merges of 3 tracks, not 2"),
        (2, vec![merge(0, 2, 1.0, 2)], "exist"),
        (3, vec![merge(0, 1, 1.0, 2), merge(0, 2, 2.0, 2)], "second time"),
        (2, vec![merge(0, 1, f64::NAN, 2)], "height NaN"),
        (2, vec![merge(0, 1, 1.0, 3)], "size"),
    ];
    for (n, rows, want) in cases {
        let error = Dendrogram::new(n, rows).unwrap_err();
        assert!(error.to_string().contains(want), "{error}");
    }
    assert!(Dendrogram::new(0, vec![]).is_ok() && Dendrogram::new(1, vec![]).is_ok());
}

#[test]
fn the_clearest_cut_lies_at_the_largest_factor() {
    let chain = |heights: &[f64]| {
        let rows = (0_u32..).zip(heights).map(|(r, &height)| {
            merge(if r == 0 { 0 } else { heights.len() as u32 + r }, r + 1, height, r + 2)
        });
        Dendrogram::new(heights.len() as u32 + 1, rows.collect()).unwrap()
    };
    let cases = [
        (chain(&[1.0, 1.1, 9.0]), 12, 2),
        (chain(&[1.0, 8.0, 9.0]), 12, 3),
        (chain(&[1.0, 8.0, 9.0]), 2, 2),
        (chain(&[0.0, 0.0, 5.0]), 12, 2),
        (chain(&[3.0]), 12, 2),
        // With inversions: in the order in which cuts undo, from the last row to the first.
        (chain(&[2.0, 9.0, 1.0, 6.0]), 12, 2),
        (chain(&[1.0, 9.0, 2.0, 3.0]), 12, 4),
        (Dendrogram::new(1, vec![]).unwrap(), 12, 1),
    ];
    for (tree, k_max, want) in cases {
        assert_eq!(tree.clearest_cut(k_max), want, "{tree:?}");
    }
}
