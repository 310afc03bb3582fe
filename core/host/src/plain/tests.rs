//! Nothing that moves a cursor reaches a screen.

use super::*;

#[test]
fn printed_lines_lose_what_would_move_a_cursor() {
    for (printed, wanted) in [
        ("plain", "plain"),
        ("\u{1b}[2J\u{1b}[1;1Hgone", "gone"),
        ("\u{1b}]0;title\u{7}after", "after"),
        ("\u{1b}]0;title\u{1b}\\after", "after"),
        ("\u{1b}P1$r\u{1b}\\q", "q"),
        ("a\tb\r\u{8}c\u{7}", "a bc"),
        ("half \u{1b}[31", "half "),
        ("a\u{202e}b\u{2066}c\u{2069}\u{200f}d", "abcd"),
        ("\u{feff}in\u{ad}vi\u{200b}si\u{2060}ble\u{e0041}", "invisible"),
        ("می\u{200c}خواهم", "می\u{200c}خواهم"),
        ("\u{1b}cfull reset", "full reset"),
    ] {
        assert_eq!(plain(printed), wanted, "{printed:?}");
    }
}
