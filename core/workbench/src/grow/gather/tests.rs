//! Which frames a skeleton grows over, and what is said of those in which nothing is seen.

use super::*;

/// `#` where something is seen: the whole, the longest run from its beginning on, and the note.
#[test]
fn frames_are_those_in_which_something_is_seen() {
    let across = ": groups go straight there from the frame before to the frame after";
    let cases = [
        ("", None, 0..0, None),
        ("....", None, 0..0, None),
        ("####", Some(0..4), 0..4, None),
        ("..#..", Some(2..3), 0..1, None),
        (".###..##.", Some(1..8), 0..3, Some("frames 4-5")),
        ("..##.###..", Some(2..8), 3..6, Some("frame 4")),
        ("##.##...#", Some(0..9), 0..2, Some("frame 2 and in 3 more")),
    ];
    for (seen, wanted, run, gap) in cases {
        let is_seen: Vec<bool> = seen.chars().map(|c| c == '#').collect();
        let frames = whole(&is_seen);
        assert_eq!(frames, wanted, "{seen}");
        let Some(frames) = frames else { continue };
        let within = &is_seen[frames.start as usize..frames.end as usize];
        assert_eq!(unbroken(within), run, "{seen}");
        let note = gap.map(|gap| format!("nothing of any group is seen in {gap}{across}"));
        assert_eq!(blind(within, frames.start), note, "{seen}");
    }
}

#[test]
fn samples_outside_are_left_out() {
    let cases =
        [(0..10, 3..7), (3..5, 3..5), (0..4, 3..4), (6..9, 6..7), (0..2, 3..3), (8..9, 7..7), (0..0, 3..3)];
    for (some, wanted) in cases {
        assert_eq!(cut(&some, &(3..7)), wanted, "{some:?}");
    }
}
