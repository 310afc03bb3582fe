//! What is printed, and how much of it is kept.

use std::io::Read as _;

use super::*;
use crate::term::signals;

/// Prints something, and gives the lines that were heard and the log.
fn printed(bytes: &[u8]) -> (Vec<String>, Vec<u8>) {
    let file = tempfile::NamedTempFile::new().unwrap();
    let log = File::options().append(true).open(file.path()).unwrap();
    let (pipe, end) = rustix::pipe::pipe().unwrap();
    let (waker, mut woken) = signals::pair().unwrap();
    let prints = Prints::begin(pipe, log, waker).unwrap();
    File::from(end).write_all(bytes).unwrap();
    // The thread ends with the pipe.
    prints.alive.recv().unwrap_err();
    assert_eq!(bytes.is_empty(), woken.read(&mut [0; 64]).is_ok_and(|n| n == 0));
    (prints.take(), std::fs::read(file.path()).unwrap())
}

#[test]
fn lines_are_told_as_they_come_and_all_is_in_the_log() {
    let cases: [(&[u8], &[&str]); 4] = [
        (b"", &[]),
        (b"one\ntwo\n", &["one", "two"]),
        (b"one\n\nno end", &["one", "", "no end"]),
        (b"\x1b[2Jwipes\xff\n", &["\u{1b}[2Jwipes\u{fffd}"]),
    ];
    for (bytes, wanted) in cases {
        let (lines, log) = printed(bytes);
        assert_eq!(lines, wanted);
        assert_eq!(log, bytes);
    }
}

#[test]
fn what_has_no_end_is_bounded() {
    let (lines, _) = printed(&[b'x'; 3 * LINE_MAX]);
    assert!(lines.len() == 3 && lines.iter().all(|line| line.len() == LINE_MAX));
    let (lines, log) = printed(&b"again\n".repeat(LOG_MAX));
    assert_eq!(lines.len(), N_WAITING);
    assert!(log.len() <= LOG_MAX + PIECE, "{}", log.len());
}
