//! Frames out: each is one write, bracketed as one update, and ends with the query that acknowledges it.

use std::io;
use std::os::fd::AsFd;
use std::time::Duration;

use rustix::io::Errno;

use super::colour::Depth;
use super::encode::{Encoder, Frame};
use super::input::Reply;
use super::link::Link;

/// Asks who the terminal is and whether it knows synchronized output; ends with the status query.
const PROBE: &[u8] = b"\x1b[>q\x1b[?2026$p\x1b[5n";
/// The query at the end of a frame. Its answer, `CSI 0 n`, is no key.
const QUERY: &[u8] = b"\x1b[5n";
const BEGIN: &[u8] = b"\x1b[?2026h";
const END: &[u8] = b"\x1b[?2026l";

/// Owns what goes to the terminal.
#[derive(Debug)]
pub struct Writer {
    encoder: Encoder,
    link: Link,
    /// The frame being written, and how much of it is.
    bytes: Vec<u8>,
    n_written: usize,
    synchronized: bool,
    /// Synchronized output makes this terminal redraw everything: never use it.
    never_synchronized: bool,
}

impl Writer {
    /// A writer that assumes synchronized output (terminals without it ignore it) unless told otherwise.
    #[must_use]
    pub fn new(depth: Depth, synchronized: bool) -> Self {
        Self {
            encoder: Encoder::new(depth),
            link: Link::default(),
            bytes: Vec::new(),
            n_written: 0,
            synchronized,
            never_synchronized: false,
        }
    }

    /// The colours that frames are painted in.
    #[must_use]
    pub fn depth(&self) -> Depth {
        self.encoder.depth()
    }

    /// What is known of the link.
    #[must_use]
    pub fn link(&self) -> &Link {
        &self.link
    }

    /// Sends `bytes` before anything else, with the questions to the terminal.
    ///
    /// # Errors
    /// When the terminal is gone.
    pub fn begin(&mut self, terminal: impl AsFd, bytes: &[u8], now: Duration) -> io::Result<()> {
        self.encoder.forget();
        self.bytes.extend_from_slice(bytes);
        self.bytes.extend_from_slice(PROBE);
        self.link.sent(now, self.bytes.len());
        self.flush(terminal)
    }

    /// Nothing is known of the screen any more; the next frame paints all of it.
    pub fn forget(&mut self) {
        self.encoder.forget();
    }

    /// Whether a frame is only half written: wait until the terminal takes more, then [`flush`](Self::flush).
    #[must_use]
    pub fn is_blocked(&self) -> bool {
        self.n_written < self.bytes.len()
    }

    /// When the next frame may go; `None` until the terminal does something.
    #[must_use]
    pub fn next_slot(&self, now: Duration) -> Option<Duration> {
        if self.is_blocked() { None } else { self.link.next_slot(now) }
    }

    /// Looks at the clock; returns until when the terminal has time to answer.
    pub fn check(&mut self, now: Duration) -> Option<Duration> {
        self.link.check(now);
        self.link.deadline()
    }

    /// Brings the screen nearer to the frame, in one write; returns how many cells stay wrong.
    ///
    /// Sends nothing when the screen is right already. Call it only when a slot is free.
    ///
    /// # Errors
    /// When the terminal is gone.
    pub fn paint(
        &mut self,
        terminal: impl AsFd,
        frame: &Frame,
        moving: bool,
        now: Duration,
    ) -> io::Result<usize> {
        let frills = QUERY.len() + if self.synchronized { BEGIN.len() + END.len() } else { 0 };
        if self.synchronized {
            self.bytes.extend_from_slice(BEGIN);
        }
        let begin = self.bytes.len();
        let budget = self.link.budget().saturating_sub(frills);
        let n_wrong = self.encoder.encode(frame, budget, moving, &mut self.bytes);
        if self.bytes.len() == begin {
            self.bytes.clear();
            return Ok(n_wrong);
        }
        if self.synchronized {
            self.bytes.extend_from_slice(END);
        }
        self.bytes.extend_from_slice(QUERY);
        self.link.sent(now, self.bytes.len());
        self.flush(terminal)?;
        Ok(n_wrong)
    }

    /// Writes what the terminal takes of the current frame without waiting.
    ///
    /// # Errors
    /// When the terminal is gone.
    pub fn flush(&mut self, terminal: impl AsFd) -> io::Result<()> {
        while self.is_blocked() {
            match rustix::io::write(&terminal, &self.bytes[self.n_written..]) {
                Ok(n) => self.n_written += n,
                Err(Errno::AGAIN) => return Ok(()),
                Err(Errno::INTR) => {}
                Err(error) => return Err(error.into()),
            }
        }
        self.bytes.clear();
        self.n_written = 0;
        Ok(())
    }

    /// Takes notice of an answer.
    pub fn answered(&mut self, reply: &Reply, now: Duration) {
        match reply {
            Reply::Ready => self.link.answered(now),
            Reply::Mode { mode: 2026, state } => {
                self.synchronized = matches!(state, 1..=3) && !self.never_synchronized;
            }
            Reply::Version(version) if redraws_on_sync(version) => {
                self.never_synchronized = true;
                self.synchronized = false;
            }
            _ => {}
        }
    }
}

/// tmux 3.7 to 3.7c redraw the whole pane at the end of every synchronized update (tmux PR 5612).
fn redraws_on_sync(version: &str) -> bool {
    matches!(version.strip_prefix("tmux 3.7"), Some("" | "a" | "b" | "c"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_gets_synchronized_output() {
        let mode = |state| Reply::Mode { mode: 2026, state };
        let version = |v: &str| Reply::Version(v.to_owned());
        for (replies, expect) in [
            (vec![], true),
            (vec![mode(0)], false),
            (vec![mode(2)], true),
            (vec![version("tmux 3.7b"), mode(2)], false),
            (vec![mode(2), version("tmux 3.7")], false),
            (vec![version("tmux 3.8"), mode(1)], true),
        ] {
            let mut writer = Writer::new(Depth::True, true);
            for reply in &replies {
                writer.answered(reply, Duration::ZERO);
            }
            assert_eq!(writer.synchronized, expect, "{replies:?}");
        }
    }
}
