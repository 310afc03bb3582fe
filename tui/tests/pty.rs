//! The real program on a pseudo-terminal, before a small terminal of our own that answers, or does not.

#![expect(clippy::unwrap_used, reason = "helpers of tests")]

use std::io::{Read as _, Write as _};
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

use portable_pty::{Child, CommandBuilder, MasterPty, PtySize, native_pty_system};
use rustix::process::{Pid, Signal, kill_process};

#[path = "pty/correct.rs"]
mod correct;
#[path = "pty/display.rs"]
mod display;
#[path = "pty/ends.rs"]
mod ends;
#[path = "pty/plugins.rs"]
mod plugins;
#[path = "pty/session.rs"]
mod session;
#[path = "pty/sizes.rs"]
mod sizes;
#[path = "pty/start.rs"]
mod start;
#[path = "pty/window.rs"]
mod window;
#[path = "pty/work.rs"]
mod work;
#[path = "pty/x11.rs"]
mod x11;

/// A condition that has not come true by then never will.
const PATIENCE: Duration = Duration::from_secs(60);
const N_FRAMES: usize = 12;

/// The status query, and its answer.
const STATUS: (&[u8], &[u8]) = (b"\x1b[5n", b"\x1b[0n");

/// A terminal: shows what it gets, and answers what it knows.
struct Terminal {
    emulator: vt100::Parser,
    output: Receiver<Vec<u8>>,
    keyboard: Box<dyn std::io::Write + Send>,
    pty: Box<dyn MasterPty + Send>,
    child: Box<dyn Child + Send + Sync>,
    modes_before: String,
    /// Queries, and what it answers to each.
    answers: Vec<(&'static [u8], &'static [u8])>,
    /// Answers that are not sent for now, where they are held back.
    held: Option<Vec<u8>>,
    /// All of the output.
    seen: Vec<u8>,
    /// How much of it was searched for queries.
    n_searched: usize,
}

fn size(columns: u16, rows: u16) -> PtySize {
    PtySize { rows, cols: columns, pixel_width: 0, pixel_height: 0 }
}

impl Terminal {
    /// Starts a command in a folder, on a terminal of this size.
    fn start(mut command: CommandBuilder, folder: &Path, (columns, rows): (u16, u16), answers: bool) -> Self {
        let pair = native_pty_system().openpty(size(columns, rows)).unwrap();
        let modes_before = format!("{:?}", pair.master.get_termios());
        command.cwd(folder);
        for (name, value) in [("TERM", "xterm-256color"), ("COLORTERM", "truecolor")] {
            command.env(name, value);
        }
        for name in ["XDG_STATE_HOME", "XDG_CACHE_HOME", "XDG_DATA_HOME", "HOME"] {
            command.env(name, folder);
        }
        for name in ["TMUX", "SSH_CONNECTION", "NO_COLOR", "HONAMI_COLOR", "HONAMI_GLYPHS"] {
            command.env_remove(name);
        }
        let child = pair.slave.spawn_command(command).unwrap();
        drop(pair.slave);
        let mut reader = pair.master.try_clone_reader().unwrap();
        let (sender, output) = sync_channel(1024);
        std::thread::Builder::new()
            .name("output".to_owned())
            .spawn(move || {
                let mut bytes = vec![0; 1 << 16];
                while let Ok(n @ 1..) = reader.read(&mut bytes) {
                    if sender.send(bytes[..n].to_vec()).is_err() {
                        break;
                    }
                }
            })
            .unwrap();
        Self {
            emulator: vt100::Parser::new(rows.try_into().unwrap(), columns.try_into().unwrap(), 0),
            output,
            keyboard: pair.master.take_writer().unwrap(),
            pty: pair.master,
            child,
            modes_before,
            answers: if answers { vec![STATUS] } else { Vec::new() },
            held: None,
            seen: Vec::new(),
            n_searched: 0,
        }
    }

    /// honami on a small clip.
    fn honami(folder: &Path, size: (u16, u16), answers: bool) -> Self {
        write_clip(&folder.join("sway.y4m"));
        let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_honami"));
        command.arg("sway.y4m");
        Self::start(command, folder, size, answers)
    }

    /// Shows what comes within a moment; whether anything came, and whether more may come.
    fn listen(&mut self, within: Duration) -> (bool, bool) {
        match self.output.recv_timeout(within) {
            Ok(bytes) => {
                self.emulator.process(&bytes);
                self.seen.extend_from_slice(&bytes);
                self.answer();
                (true, true)
            }
            Err(RecvTimeoutError::Timeout) => (false, true),
            Err(RecvTimeoutError::Disconnected) => (false, false),
        }
    }

    /// Answers the queries that have come, in their order.
    fn answer(&mut self) {
        let mut answers = Vec::new();
        let mut at = self.n_searched;
        while at < self.seen.len() {
            let rest = &self.seen[at..];
            match self.answers.iter().find(|(query, _)| rest.starts_with(query)) {
                Some((query, answer)) => {
                    answers.extend_from_slice(answer);
                    at += query.len();
                }
                // A query may be split: its beginning waits for the rest.
                None if self.answers.iter().any(|(query, _)| query.starts_with(rest)) => break,
                None => at += 1,
            }
        }
        self.n_searched = at;
        match &mut self.held {
            Some(held) => held.append(&mut answers),
            // A program that has gone needs no answer.
            None => drop(self.keyboard.write_all(&answers)),
        }
    }

    #[track_caller]
    fn wait_for(&mut self, what: &str, condition: impl Fn(&vt100::Screen) -> bool) {
        let until = Instant::now() + PATIENCE;
        while !condition(self.emulator.screen()) {
            let (_, goes_on) = self.listen(Duration::from_millis(50));
            let screen = self.emulator.screen().contents();
            assert!(goes_on || condition(self.emulator.screen()), "{what}: it ended with\n{screen}");
            assert!(Instant::now() < until, "{what}: still not there, but\n{screen}");
        }
    }

    /// Waits until the output from `start` on has something; returns where it ends.
    #[track_caller]
    fn wait_for_bytes(&mut self, start: usize, wanted: &str) -> usize {
        let until = Instant::now() + PATIENCE;
        loop {
            let found = self.seen[start..].windows(wanted.len()).position(|w| w == wanted.as_bytes());
            if let Some(at) = found {
                return start + at + wanted.len();
            }
            assert!(self.listen(Duration::from_millis(50)).1, "it ended without {wanted:?}");
            assert!(Instant::now() < until, "no {wanted:?} came");
        }
    }

    #[track_caller]
    fn wait_for_text(&mut self, text: &str) {
        self.wait_for(text, |screen| screen.contents().contains(text));
    }

    fn press(&mut self, keys: &str) {
        self.keyboard.write_all(keys.as_bytes()).unwrap();
    }

    fn signal(&self, signal: Signal) {
        let pid = i32::try_from(self.child.process_id().unwrap()).unwrap();
        kill_process(Pid::from_raw(pid).unwrap(), signal).unwrap();
    }

    /// Waits for the end; returns the exit status's success.
    #[track_caller]
    fn wait_for_end(&mut self) -> bool {
        self.wait_for_status() == 0
    }

    /// Waits for the end; returns the exit status.
    #[track_caller]
    fn wait_for_status(&mut self) -> u32 {
        let until = Instant::now() + PATIENCE;
        loop {
            self.listen(Duration::from_millis(20));
            if let Some(status) = self.child.try_wait().unwrap() {
                while self.listen(Duration::from_millis(20)).0 {}
                return status.exit_code();
            }
            assert!(Instant::now() < until, "it does not end:\n{}", self.emulator.screen().contents());
        }
    }

    /// Asserts that the terminal is as it was before.
    #[track_caller]
    fn assert_restored(&self) {
        let screen = self.emulator.screen();
        assert!(!screen.alternate_screen(), "the alternate screen is still there");
        assert!(!screen.hide_cursor(), "the cursor is hidden");
        assert!(!screen.bracketed_paste(), "paste is bracketed");
        assert_eq!(screen.mouse_protocol_mode(), vt100::MouseProtocolMode::None);
        assert_eq!(format!("{:?}", self.pty.get_termios()), self.modes_before);
    }
}

/// A bright square that sways on a dark ground, 64x48, as Y4M.
fn write_clip(path: &Path) {
    let mut bytes = b"YUV4MPEG2 W64 H48 F25:1 Ip C420jpeg\n".to_vec();
    for n in 0..N_FRAMES {
        bytes.extend_from_slice(b"FRAME\n");
        let inside = |x: usize, y: usize| (8 + n..24 + n).contains(&x) && (16..32).contains(&y);
        bytes.extend((0..48).flat_map(|y| (0..64).map(move |x| if inside(x, y) { 235 } else { 16 })));
        bytes.extend([128; 2 * 32 * 24]);
    }
    std::fs::write(path, bytes).unwrap();
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}
