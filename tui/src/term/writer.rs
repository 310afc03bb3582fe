//! Frames out: each is one write, bracketed as one update, and ends with the query that acknowledges it.

use std::io;
use std::os::fd::AsFd;
use std::time::Duration;

use ratatui::buffer::Cell;
use ratatui::layout::Rect;
use rustix::io::Errno;

use super::capabilities::Capabilities;
use super::colour::Depth;
use super::encode::{Encoder, Frame};
use super::input::Reply;
use super::link::Link;
use super::still::Still;

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
    capabilities: Capabilities,
    still: Option<Showing>,
    /// What takes the last still away; goes before everything else.
    farewell: Vec<u8>,
}

/// A still that is being sent, or is there.
#[derive(Debug)]
struct Showing {
    still: Still,
    n_sent: usize,
    /// The picture that it shows, and the cells that show it coarsely.
    scene: u64,
    cells: Vec<Cell>,
}

/// As much of a still goes at once as a link carries in this time: then a key can still stop it.
const STILL_SLICE: Duration = Duration::from_millis(16);

impl Writer {
    /// A writer to a terminal of which no more is known than this.
    #[must_use]
    pub fn new(depth: Depth, capabilities: Capabilities) -> Self {
        Self {
            encoder: Encoder::new(depth),
            link: Link::default(),
            bytes: Vec::new(),
            n_written: 0,
            capabilities,
            still: None,
            farewell: Vec::new(),
        }
    }

    /// What is known of the terminal.
    #[must_use]
    pub fn capabilities(&self) -> &Capabilities {
        &self.capabilities
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
        self.forget();
        self.bytes.extend_from_slice(bytes);
        self.bytes.extend_from_slice(&self.capabilities.questions());
        self.bytes.extend_from_slice(QUERY);
        self.link.sent(now, self.bytes.len());
        self.flush(terminal)
    }

    /// Sends `bytes` that change nothing on the screen, after whatever is on its way.
    ///
    /// # Errors
    /// When the terminal is gone.
    pub fn send(&mut self, terminal: impl AsFd, bytes: &[u8]) -> io::Result<()> {
        self.bytes.extend_from_slice(bytes);
        self.flush(terminal)
    }

    /// Nothing is known of the screen any more; the next frame paints all of it.
    pub fn forget(&mut self) {
        self.drop_still();
        self.encoder.forget();
    }

    /// Begins to show a still over a frame that is on screen; [`send_still`](Self::send_still) goes on.
    pub fn show_still(&mut self, still: Still, frame: &Frame) {
        self.drop_still();
        let cells = cells_in(frame, still.area);
        self.still = Some(Showing { still, n_sent: 0, scene: frame.scene, cells });
    }

    /// Whether a still is there, or is being sent.
    #[must_use]
    pub fn has_still(&self) -> bool {
        self.still.is_some()
    }

    /// Whether pieces of a still wait to be sent.
    #[must_use]
    pub fn is_sending(&self) -> bool {
        self.still.as_ref().is_some_and(|showing| showing.n_sent < showing.still.pieces.len())
    }

    /// Sends the next pieces of the still. Call it only when a slot is free.
    ///
    /// # Errors
    /// When the terminal is gone.
    pub fn send_still(&mut self, terminal: impl AsFd, now: Duration) -> io::Result<()> {
        let slice = self.link.goodput().map_or(0, |rate| (rate * STILL_SLICE.as_secs_f64()) as usize);
        let slice = slice.min(self.link.budget());
        let Some(showing) = &mut self.still else { return Ok(()) };
        self.bytes.append(&mut self.farewell);
        let begin = self.bytes.len();
        while let Some(piece) = showing.still.pieces.get(showing.n_sent) {
            let n = self.bytes.len() - begin;
            if n > 0 && n + piece.len() > slice {
                break;
            }
            self.bytes.extend_from_slice(piece);
            showing.n_sent += 1;
        }
        // Pieces may set colours, and leave none set.
        self.bytes.extend_from_slice(b"\x1b[m");
        self.encoder.lose_pen();
        self.bytes.extend_from_slice(QUERY);
        self.link.sent(now, self.bytes.len());
        self.flush(terminal)
    }

    /// Gives the still up; the next frame takes away what is there of it.
    pub fn drop_still(&mut self) {
        let Some(Showing { still, n_sent, .. }) = self.still.take().filter(|showing| showing.n_sent > 0)
        else {
            return;
        };
        let is_whole = n_sent == still.pieces.len();
        self.farewell.extend_from_slice(if is_whole { &still.remove } else { &still.stop });
        if still.replaces {
            self.encoder.cover(still.area);
        }
    }

    /// Takes the still away, before the terminal is given back.
    ///
    /// # Errors
    /// When the terminal is gone.
    pub fn end_still(&mut self, terminal: impl AsFd) -> io::Result<()> {
        self.drop_still();
        self.bytes.append(&mut self.farewell);
        self.flush(terminal)
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
        let synchronizes = self.capabilities.synchronizes();
        let frills = QUERY.len() + if synchronizes { BEGIN.len() + END.len() } else { 0 };
        if synchronizes {
            self.bytes.extend_from_slice(BEGIN);
        }
        let stays = |showing: &Showing| {
            showing.scene == frame.scene && showing.cells == cells_in(frame, showing.still.area)
        };
        if !self.still.as_ref().is_none_or(stays) {
            self.drop_still();
        }
        let begin = self.bytes.len();
        self.bytes.append(&mut self.farewell);
        let budget = self.link.budget_at(now).saturating_sub(frills);
        let n_wrong = self.encoder.encode(frame, budget, moving, &mut self.bytes);
        if self.bytes.len() == begin {
            self.bytes.clear();
            return Ok(n_wrong);
        }
        if synchronizes {
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
        self.capabilities.learn(reply);
        self.encoder.set_light(self.capabilities.is_light());
        if self.capabilities.is_relayed() {
            self.link.relay();
        }
        if *reply == Reply::Ready {
            self.link.answered(now);
        }
    }
}

/// The cells of a frame in an area; none where it reaches out of the frame.
fn cells_in(frame: &Frame, area: Rect) -> Vec<Cell> {
    if area.intersection(frame.cells.area) != area {
        return Vec::new();
    }
    area.positions().map(|at| frame.cells[at].clone()).collect()
}

#[cfg(test)]
mod tests;
