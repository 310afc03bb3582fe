//! What is printed reaches no screen as it was; ends have names.

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
        ("\u{1b}cfull reset", "full reset"),
    ] {
        assert_eq!(plain(printed.as_bytes()), wanted, "{printed:?}");
    }
    assert_eq!(plain(b"\xff\xfe"), "\u{fffd}\u{fffd}");
}

#[test]
fn ends_are_told_in_words() {
    for (ended, wanted) in [
        (Ended::Signal(11), "died of SIGSEGV (it used memory that is not its own)"),
        (Ended::Signal(6), "died of SIGABRT (it gave up)"),
        (Ended::Signal(63), "died of signal 63"),
        (Ended::Exit(0), "ended its process with status 0"),
        (Ended::Silent(10), "was ended after 10 s without a sign of life"),
    ] {
        assert_eq!(ended.to_string(), wanted);
    }
}
