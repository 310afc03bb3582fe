//! Dendrograms: what is refused, what a cut gives.

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
        (Dendrogram::new(1, vec![]).unwrap(), 12, 1),
    ];
    for (tree, k_max, want) in cases {
        assert_eq!(tree.clearest_cut(k_max), want, "{tree:?}");
    }
}
