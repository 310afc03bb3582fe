//! Dendrograms in dots: small ones as pictures, and those that have nothing to draw.

use honami_model::document::ClusteringId;
use honami_model::hierarchy::{Dendrogram, Merge};
use honami_model::track::TrackId;

use super::*;

/// Merges of (first, second, height).
fn groups(rows: &[(u32, u32, f64)], k: u32) -> Groups {
    let n = rows.len() as u32 + 1;
    let mut sizes = vec![1; n as usize];
    let merge = |&(a, b, height): &(u32, u32, f64)| {
        let size = sizes[a as usize] + sizes[b as usize];
        sizes.push(size);
        Merge { a, b, height, size }
    };
    let dendrogram = Dendrogram::new(n, rows.iter().map(merge).collect()).unwrap();
    Groups::new(
        String::new(),
        (ClusteringId(1), (0..n).map(TrackId).collect(), dendrogram),
        (k, &[]),
        Vec::new(),
    )
}

fn text(groups: &Groups, size: (u16, u16)) -> Vec<String> {
    let lines = draw(groups, Some(0), size);
    lines.iter().map(|line| line.to_string().trim_end().to_owned()).collect()
}

#[test]
fn small_dendrograms() {
    // ((0 1) ((2 3) 4)): each merge is twice as high as the one below.
    let five = [(0, 1, 1.0), (2, 3, 2.0), (6, 4, 4.0), (5, 7, 8.0)];
    for (k, wanted) in [
        (2, ["╌╌⡏⠉⠉⠉⠉⠉⠉⡇╌╌ 2", "  ⡇    ⡤⠤⠧⢤", "  ⡇   ⣀⣇⡀ ⢸", "  ⡇   ⡇ ⡇ ⢸", " ⡖⠓⢲  ⡇ ⡇ ⢸", "  1      2"]),
        (3, ["  ⡏⠉⠉⠉⠉⠉⠉⡇", "  ⡇    ⡤⠤⠧⢤", "╌╌⡇╌╌╌⣀⣇⡀╌⢸╌ 3", "  ⡇   ⡇ ⡇ ⢸", " ⡖⠓⢲  ⡇ ⡇ ⢸", "  1    2  3"]),
        (5, ["  ⡏⠉⠉⠉⠉⠉⠉⡇", "  ⡇    ⡤⠤⠧⢤", "  ⡇   ⣀⣇⡀ ⢸", "  ⡇   ⡇ ⡇ ⢸", "╌⡖⠓⢲╌╌⡇╌⡇╌⢸╌ 5", " 1 2  3 4 5"]),
    ] {
        assert_eq!(text(&groups(&five, k), (14, 6)), wanted, "at {k}");
    }
    // Where there is no room for all numbers the largest groups have theirs, and the selected one.
    assert_eq!(text(&groups(&five, 5), (7, 4))[3], "1 3 5 …");
    assert_eq!(text(&groups(&five, 5), (4, 4))[3], "1  …");
}

#[test]
fn the_line_of_the_cut_lies_between_the_merges_that_it_parts() {
    let five = [(0, 1, 1.0), (2, 3, 2.0), (6, 4, 4.0), (5, 7, 8.0)];
    for k in 1..=5 {
        let groups = groups(&five, k);
        let scale = Scale::of(&groups.chart.heights, 40, 64);
        let row = cut_row(&groups, &scale);
        let above = groups.chart.heights.iter().filter(|height| scale.row(**height) < row).count();
        assert_eq!(above, k as usize - 1, "at {k}");
    }
}

#[test]
fn whatever_is_no_tree_is_drawn_all_the_same() {
    let flat = [(0, 1, 0.0), (2, 3, 0.0)];
    let inverted = [(0, 1, 9.0), (3, 2, 1.0)];
    let alike = [(0, 1, 2.0), (3, 2, 2.0)];
    for rows in [&[][..], &flat, &inverted, &alike] {
        for k in 1..=3 {
            for size in [(0, 0), (1, 1), (3, 9), (40, 1), (40, 12)] {
                let groups = groups(rows, k);
                let lines = draw(&groups, None, size);
                assert!(lines.len() <= usize::from(size.1));
                assert!(
                    lines.iter().all(|line| line.width() <= usize::from(size.0)),
                    "{lines:?} in {size:?}"
                );
            }
        }
    }
}
