//! The scripted user's terminal: shows what comes, answers queries as it is told to, notes every paint.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::wanted::Wanted;

/// Window title with which the far end says that it starts the program now.
pub(crate) const EXEC_TITLE: &[u8] = b"honami-wan-exec";
/// A slow terminal answers this much later.
const SLOW: Duration = Duration::from_millis(300);

/// How queries are answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Answers {
    /// At once, as a terminal emulator does.
    Normal,
    /// Never.
    Silent,
    /// After 300 ms.
    Slow,
    /// Every query twice, and before the frame it ends.
    Lying,
}

impl Answers {
    pub(crate) fn named(name: &str) -> Option<Self> {
        let all = [Self::Normal, Self::Silent, Self::Slow, Self::Lying];
        all.into_iter().zip(["normal", "silent", "slow", "lying"]).find(|(_, n)| *n == name).map(|(a, _)| a)
    }
}

/// The screen at the end of a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Paint {
    pub(crate) at: Instant,
    /// The frame number on screen.
    pub(crate) number: u32,
    /// The picture on screen against that frame's, dB; infinite when it is exact.
    pub(crate) psnr: f64,
    /// Bytes since the paint before.
    pub(crate) n_bytes: usize,
}

/// What the emulator calls back.
pub(crate) struct Desk {
    wanted: Arc<Wanted>,
    answers: Answers,
    /// Frames end with a status query; where they do not, the screen is looked at whenever output pauses.
    pub(crate) has_queries: bool,
    pub(crate) paints: Vec<Paint>,
    /// Answers, and when they are due.
    due: Vec<(Instant, Vec<u8>)>,
    /// When the bytes being shown have come.
    now: Instant,
    n_bytes: usize,
    /// When the far end has started the program.
    pub(crate) exec: Option<Instant>,
    /// When the first line of the program was there.
    pub(crate) chrome: Option<Instant>,
}

impl Desk {
    fn answer(&mut self, bytes: &[u8]) {
        match self.answers {
            Answers::Silent => {}
            Answers::Normal => self.due.push((self.now, bytes.to_vec())),
            Answers::Slow => self.due.push((self.now + SLOW, bytes.to_vec())),
            Answers::Lying => self.due.push((self.now, bytes.repeat(2))),
        }
    }

    fn look(&mut self, screen: &vt100::Screen) {
        let n_bytes = std::mem::take(&mut self.n_bytes);
        let Some(number) = self.wanted.number_on(screen) else { return };
        self.chrome.get_or_insert(self.now);
        let psnr = self.wanted.psnr(screen, number);
        self.paints.push(Paint { at: self.now, number, psnr, n_bytes });
    }
}

impl vt100::Callbacks for Desk {
    fn set_window_title(&mut self, _: &mut vt100::Screen, title: &[u8]) {
        if title.ends_with(EXEC_TITLE) {
            self.exec.get_or_insert(self.now);
        }
    }

    fn unhandled_csi(
        &mut self,
        screen: &mut vt100::Screen,
        intermediate: Option<u8>,
        second: Option<u8>,
        parameters: &[&[u16]],
        last: char,
    ) {
        let first = parameters.first().and_then(|p| p.first()).copied().unwrap_or(0);
        match (intermediate, second, last, first) {
            (None, _, 'n', 5) => {
                self.has_queries = true;
                self.look(screen);
                self.answer(b"\x1b[0n");
            }
            (None, _, 'c', 0) => self.answer(b"\x1b[?62;22c"),
            (Some(b'>'), _, 'q', _) => self.answer(b"\x1bP>|wan_user 1\x1b\\"),
            (Some(b'?'), Some(b'$'), 'p', mode) => {
                let state = if mode == 2026 { 2 } else { 0 };
                self.answer(format!("\x1b[?{mode};{state}$y").as_bytes());
            }
            _ => {}
        }
    }
}

/// A terminal emulator with somebody before it.
pub(crate) struct Terminal {
    emulator: vt100::Parser<Desk>,
    /// When the first byte after the start of the program came.
    pub(crate) first_byte: Option<Instant>,
    pub(crate) n_received: usize,
}

impl Terminal {
    pub(crate) fn new((columns, rows): (u16, u16), answers: Answers, wanted: Arc<Wanted>) -> Option<Self> {
        let desk = Desk {
            wanted,
            answers,
            has_queries: false,
            paints: Vec::new(),
            due: Vec::new(),
            now: Instant::now(),
            n_bytes: 0,
            exec: None,
            chrome: None,
        };
        let (rows, columns) = (rows.try_into().ok()?, columns.try_into().ok()?);
        let emulator = vt100::Parser::new_with_callbacks(rows, columns, 0, desk);
        Some(Self { emulator, first_byte: None, n_received: 0 })
    }

    pub(crate) fn desk(&self) -> &Desk {
        self.emulator.callbacks()
    }

    pub(crate) fn screen(&self) -> &vt100::Screen {
        self.emulator.screen()
    }

    pub(crate) fn forget_paints(&mut self) {
        self.emulator.callbacks_mut().paints.clear();
    }

    /// Shows bytes that came at a time; `is_all` says that no more are waiting.
    pub(crate) fn show(&mut self, bytes: &[u8], at: Instant, is_all: bool) {
        self.n_received += bytes.len();
        let had_exec = self.desk().exec.is_some();
        let desk = self.emulator.callbacks_mut();
        desk.now = at;
        desk.n_bytes += bytes.len();
        self.emulator.process(bytes);
        if self.first_byte.is_none() && self.desk().exec.is_some() {
            let title = bytes.windows(EXEC_TITLE.len()).position(|w| w == EXEC_TITLE);
            let is_more = title.is_none_or(|at| at + EXEC_TITLE.len() + 1 < bytes.len());
            self.first_byte = (had_exec || is_more).then_some(at);
        }
        let (screen, desk) = self.emulator.screen_and_callbacks_mut();
        if is_all && !desk.has_queries {
            desk.look(screen);
        }
    }

    /// Answers that are due, and when the next one is.
    pub(crate) fn take_answers(&mut self, now: Instant) -> (Vec<u8>, Option<Instant>) {
        let desk = self.emulator.callbacks_mut();
        let n_due = desk.due.iter().take_while(|(at, _)| *at <= now).count();
        let bytes = desk.due.drain(..n_due).flat_map(|(_, bytes)| bytes).collect();
        (bytes, desk.due.first().map(|(at, _)| *at))
    }
}
