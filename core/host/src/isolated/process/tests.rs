//! Ends have names.

use super::*;

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
