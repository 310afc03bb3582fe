//! What is written to a pipe in place of a terminal.

use std::os::fd::OwnedFd;

use ratatui::style::Color;
use rustix::pipe::{PipeFlags, pipe_with};

use super::*;
use crate::term::capabilities::Around;

const AREA: Rect = Rect { x: 1, y: 1, width: 6, height: 3 };

/// A terminal that takes everything and acknowledges it at once.
struct Wire {
    reader: OwnedFd,
    device: OwnedFd,
    writer: Writer,
    now: Duration,
}

impl Wire {
    fn new() -> Self {
        let (reader, device) = pipe_with(PipeFlags::NONBLOCK).unwrap();
        let mut capabilities = Capabilities::new(Around::Nothing);
        capabilities.learn(&Reply::Mode { mode: 2026, state: 0 });
        let writer = Writer::new(Depth::True, capabilities);
        Self { reader, device, writer, now: Duration::ZERO }
    }

    /// What was written since the last time; all of it is answered.
    fn taken(&mut self) -> String {
        let mut bytes = vec![0; 1 << 16];
        let n = rustix::io::read(&self.reader, &mut bytes).unwrap_or(0);
        bytes.truncate(n);
        let text = String::from_utf8(bytes).unwrap();
        for _ in text.matches("\x1b[5n") {
            self.now += Duration::from_millis(20);
            self.writer.answered(&Reply::Ready, self.now);
        }
        text
    }

    fn paint(&mut self, frame: &Frame, moving: bool) -> (usize, String) {
        self.now += Duration::from_millis(20);
        let n_wrong = self.writer.paint(&self.device, frame, moving, self.now).unwrap();
        (n_wrong, self.taken())
    }

    fn send(&mut self) -> String {
        self.now += Duration::from_millis(20);
        self.writer.send_still(&self.device, self.now).unwrap();
        self.taken()
    }
}

/// A picture in the area, of one colour but for its first cell.
fn frame(scene: u64, first: u8) -> Frame {
    let mut frame = Frame::new(10, 6);
    for at in AREA.positions() {
        let v = if (at.x, at.y) == (AREA.x, AREA.y) { first } else { 90 };
        frame.cells[at].set_char('▀').set_fg(Color::Rgb(v, v, v)).set_bg(Color::Rgb(v, v, v));
        let i = frame.cells.index_of(at.x, at.y);
        frame.softness[i] = 1;
    }
    Frame { scene, ..frame }
}

fn still(replaces: bool) -> Still {
    let pieces = ["<one>", "<two>", "<three>"].map(|piece| piece.as_bytes().to_vec()).to_vec();
    Still { area: AREA, pieces, stop: b"<stop>".to_vec(), remove: b"<remove>".to_vec(), replaces }
}

#[test]
fn pieces_are_acknowledged_one_by_one_and_the_still_stays_while_the_picture_does() {
    let mut wire = Wire::new();
    let (n_wrong, _) = wire.paint(&frame(1, 90), false);
    assert_eq!(n_wrong, 0);
    wire.writer.show_still(still(false), &frame(1, 90));
    for piece in ["<one>", "<two>", "<three>"] {
        assert!(wire.writer.is_sending());
        assert_eq!(wire.send(), format!("{piece}\x1b[m\x1b[5n"));
    }
    assert!(!wire.writer.is_sending() && wire.writer.has_still());
    // Text elsewhere is no reason to take it away.
    let mut other = frame(1, 90);
    other.cells[(9, 5)].set_char('x');
    let (_, bytes) = wire.paint(&other, false);
    assert!(bytes.contains('x') && !bytes.contains('<'), "{bytes:?}");
    // The same cells, but another picture: it goes, and the cells below need nothing.
    let (_, bytes) = wire.paint(&Frame { scene: 2, ..other }, false);
    assert_eq!(bytes, "<remove>\x1b[5n");
    assert!(!wire.writer.has_still());
}

#[test]
fn a_change_stops_what_is_being_sent() {
    let mut wire = Wire::new();
    wire.paint(&frame(1, 90), false);
    wire.writer.show_still(still(false), &frame(1, 90));
    assert!(wire.send().starts_with("<one>"));
    let (_, bytes) = wire.paint(&frame(2, 200), true);
    assert!(bytes.starts_with("<stop>") && bytes.matches(['▀', ' ']).count() == 1, "{bytes:?}");
    assert!(!wire.writer.is_sending() && !wire.writer.has_still());
    // Nothing of it was sent: nothing is to be stopped.
    wire.writer.show_still(still(false), &frame(2, 200));
    let (_, bytes) = wire.paint(&frame(3, 90), true);
    assert!(!bytes.contains('<'), "{bytes:?}");
}

#[test]
fn cells_that_a_still_has_replaced_are_painted_anew_the_most_wrong_first() {
    let mut wire = Wire::new();
    wire.paint(&frame(1, 90), false);
    wire.writer.show_still(still(true), &frame(1, 90));
    (0..3).for_each(|_| drop(wire.send()));
    let n_cells = |bytes: &str| bytes.matches(['▀', ' ']).count();
    // Playing: only what looks different is worth its bytes.
    let (_, first) = wire.paint(&frame(2, 200), true);
    assert!(
        first.starts_with("<remove>\x1b[2;2H\x1b[48;2;200;200;200m ") && n_cells(&first) == 1,
        "{first:?}"
    );
    // Paused: everything is painted once, and then nothing.
    let (n_wrong, rest) = wire.paint(&frame(2, 200), false);
    assert_eq!((n_wrong, n_cells(&first) + n_cells(&rest)), (0, 18), "{first:?} {rest:?}");
    assert_eq!(wire.paint(&frame(2, 200), false), (0, String::new()));
}

#[test]
fn a_new_screen_has_no_still() {
    let mut wire = Wire::new();
    wire.paint(&frame(1, 90), false);
    wire.writer.show_still(still(true), &frame(1, 90));
    (0..3).for_each(|_| drop(wire.send()));
    wire.writer.forget();
    let (n_wrong, bytes) = wire.paint(&frame(1, 90), false);
    assert!(
        n_wrong == 0 && bytes.contains("<remove>") && bytes.matches(['▀', ' ']).count() == 18,
        "{bytes:?}"
    );
}

#[test]
fn a_still_does_not_outlive_the_session() {
    let mut wire = Wire::new();
    wire.paint(&frame(1, 90), false);
    wire.writer.show_still(still(false), &frame(1, 90));
    wire.send();
    wire.writer.end_still(&wire.device).unwrap();
    assert_eq!(wire.taken(), "<stop>");
}
