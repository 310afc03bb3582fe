//! Quarter turns against a picture drawn by hand, and four of them against the start.

use super::turn;

#[test]
fn quarters_turn_clockwise() {
    // 1 2 3
    // 4 5 6
    let picture = [1, 2, 3, 4, 5, 6];
    for (quarters, want) in [
        (0, [1, 2, 3, 4, 5, 6]),
        (1, [4, 1, 5, 2, 6, 3]), // 2 wide
        (2, [6, 5, 4, 3, 2, 1]),
        (3, [3, 6, 2, 5, 1, 4]), // 2 wide
    ] {
        let mut got = [0; 6];
        turn(&picture, 3, quarters, &mut got);
        assert_eq!(got, want, "{quarters} quarters");
    }
}
