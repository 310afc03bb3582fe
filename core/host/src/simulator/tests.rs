//! What is seen of a motion that is lost.

use super::{LOOKS_LEAST, lost};

/// Of any number of copies and nodes, one copy's motion is lost but for its root: it is found.
#[test]
fn a_copy_whose_motion_is_lost_is_found() {
    for (n_copies, n_nodes) in [(1, 2), (1, 5000), (3, 900), (1500, 2), (2000, 31), (4000, 300)] {
        for copy in [0, n_copies / 2, n_copies - 1] {
            let mut rows = vec![[0.0; 3]; n_copies * n_nodes];
            for row in &mut rows[copy * n_nodes + 1..(copy + 1) * n_nodes] {
                row[1] = f32::NAN;
            }
            let found = lost(&rows, LOOKS_LEAST.max(n_copies));
            assert!(
                found.is_some_and(|row| row / n_nodes == copy),
                "{n_copies} x {n_nodes}, {copy}: {found:?}"
            );
            assert_eq!(lost(&rows, usize::MAX), Some(copy * n_nodes + 1));
        }
    }
}
