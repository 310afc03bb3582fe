//! What is printed, and how much of it is kept.

use std::io::{Read as _, Write as _};

use super::log::{LOG_MAX, aside};
use super::*;
use crate::term::signals;

/// Prints something, and gives the lines that were heard, the log and what of it was put aside.
fn printed(bytes: &[u8]) -> (Vec<String>, Vec<u8>, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("new/session.log");
    let log = Log::open(&path).unwrap();
    let (pipe, end) = rustix::pipe::pipe().unwrap();
    let (waker, mut woken) = signals::pair().unwrap();
    let prints = Prints::begin(pipe, log, waker).unwrap();
    File::from(end).write_all(bytes).unwrap();
    // The thread ends with the pipe.
    prints.alive.recv().unwrap_err();
    assert_eq!(bytes.is_empty(), woken.read(&mut [0; 64]).is_ok_and(|n| n == 0));
    (prints.take(), std::fs::read(&path).unwrap(), std::fs::read(aside(&path)).unwrap_or_default())
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
        let (lines, log, old) = printed(bytes);
        assert_eq!(lines, wanted);
        assert_eq!((log.as_slice(), old.as_slice()), (bytes, b"".as_slice()));
    }
}

#[test]
fn what_has_no_end_is_bounded() {
    let (lines, ..) = printed(&[b'x'; 3 * LINE_MAX]);
    assert!(lines.len() == 3 && lines.iter().all(|line| line.len() == LINE_MAX));
    let max = usize::try_from(LOG_MAX).unwrap();
    let (lines, log, old) = printed(&b"again\n".repeat(max));
    assert_eq!(lines.len(), N_WAITING);
    // The last is whole across both.
    let all = [old, log].concat();
    assert!(all.len() > max && all.len() <= 2 * (max + PIECE), "{}", all.len());
    assert!(all.ends_with(b"again\nagain\n"));
}

#[test]
fn an_overlong_log_is_put_aside_when_it_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.log");
    let long = vec![b'x'; usize::try_from(LOG_MAX).unwrap() + 1];
    std::fs::write(&path, &long).unwrap();
    Log::open(&path).unwrap().write(b"new\n");
    assert_eq!(std::fs::read(&path).unwrap(), b"new\n");
    assert_eq!(std::fs::read(aside(&path)).unwrap(), long);
}
