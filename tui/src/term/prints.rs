//! What others print while the terminal is ours: it comes through a pipe, and goes to a log file and to whoever asks.

use std::fs::File;
use std::io::{ErrorKind, Read as _};
use std::os::fd::OwnedFd;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::Duration;

use super::signals::Waker;

mod log;

pub(super) use log::Log;

/// Bytes that are read at once.
const PIECE: usize = 1 << 14;
/// A line longer than this is cut, bytes.
const LINE_MAX: usize = 1 << 12;
/// So many lines wait at most until somebody asks for them; more of them are only in the log.
const N_WAITING: usize = 1024;
/// What was printed last has so long to come into the log.
const LAST_WORDS: Duration = Duration::from_millis(200);

/// What is printed into a pipe.
#[derive(Debug)]
pub(super) struct Prints {
    lines: Receiver<String>,
    /// Says nothing: it is closed with the thread that reads.
    alive: Receiver<()>,
}

impl Prints {
    /// Reads what comes until nobody can print any more; lines wake the screen.
    pub(super) fn begin(pipe: OwnedFd, log: Log, waker: Waker) -> std::io::Result<Self> {
        let (said, lines) = sync_channel(N_WAITING);
        let (end, alive) = sync_channel(1);
        std::thread::Builder::new().name("prints".to_owned()).spawn(move || {
            let _end: SyncSender<()> = end;
            read(File::from(pipe), log, &said, &waker);
        })?;
        Ok(Self { lines, alive })
    }

    /// Whole lines that have come since it was asked last, as they were printed.
    pub(super) fn take(&self) -> Vec<String> {
        self.lines.try_iter().collect()
    }

    /// Waits a moment for the last words.
    pub(super) fn end(&self) {
        // However it ends, the moment is over.
        self.alive.recv_timeout(LAST_WORDS).unwrap_or_default();
    }
}

fn read(mut pipe: File, mut log: Log, said: &SyncSender<String>, waker: &Waker) {
    let (mut piece, mut line) = ([0; PIECE], Vec::new());
    let tell = |line: &mut Vec<u8>| {
        // Nobody may ask, and what is too much is in the log.
        said.try_send(String::from_utf8_lossy(line).into_owned()).unwrap_or_default();
        line.clear();
    };
    loop {
        let n = match pipe.read(&mut piece) {
            Ok(0) => break,
            Ok(n) => n,
            // A signal has come; whoever prints into a pipe without a reader would be ended by it.
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(_) => break,
        };
        log.write(&piece[..n]);
        for &byte in &piece[..n] {
            if byte == b'\n' || line.len() >= LINE_MAX {
                tell(&mut line);
            }
            if byte != b'\n' {
                line.push(byte);
            }
        }
        waker.wake();
    }
    if !line.is_empty() {
        tell(&mut line);
    }
}

#[cfg(test)]
mod tests;
