//! The real program on a pseudo-terminal, before a small terminal of our own that answers, or does not.

#![expect(clippy::unwrap_used, reason = "helpers of tests")]

use std::io::{Read as _, Write as _};
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

use portable_pty::{Child, CommandBuilder, MasterPty, PtySize, native_pty_system};
use rustix::process::{Pid, Signal, kill_process};

#[path = "pty/display.rs"]
mod display;
#[path = "pty/start.rs"]
mod start;
#[path = "pty/work.rs"]
mod work;

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

#[test]
fn a_session_from_start_to_end() {
    let folder = folder();
    let mut terminal = Terminal::honami(folder.path(), (80, 24), true);
    terminal.wait_for("the first frame", |s| s.contents().contains("0/11") && s.contents().contains('▀'));
    assert!(terminal.emulator.screen().alternate_screen());
    terminal.press("3.");
    terminal.wait_for_text("3/11");
    terminal.press("a\r");
    terminal.wait_for_text("placed at frame 3");
    terminal.press("u");
    terminal.wait_for_text("undone: ");
    terminal.press("?");
    terminal.wait_for_text("what works here");
    terminal.press("\x1b");
    terminal.wait_for("the help to close", |s| !s.contents().contains("what works here"));
    terminal.press("q");
    assert!(terminal.wait_for_end());
    terminal.assert_restored();
}

#[test]
fn the_picture_becomes_exact_and_then_nothing_is_sent() {
    let folder = folder();
    let mut terminal = Terminal::honami(folder.path(), (80, 24), true);
    // The square's middle, 16,24 of 64x48: 53 cells wide from column 13, 20 high from row 1.
    let colour = |s: &vt100::Screen, x, y| s.cell(y, x).map(vt100::Cell::bgcolor);
    let bright = Some(vt100::Color::Rgb(255, 255, 255));
    let dark = Some(vt100::Color::Rgb(0, 0, 0));
    terminal.wait_for("the square", |s| colour(s, 26, 10) == bright && colour(s, 60, 3) == dark);
    terminal.wait_for_text(" ms");
    // Quiet, once decoding is done and the last answer has come; longer than the figures of the link and the
    // patience with an answer take to come round again.
    let until = Instant::now() + PATIENCE;
    while terminal.listen(Duration::from_millis(2500)).0 {
        assert!(Instant::now() < until, "it never falls silent");
    }
    terminal.press("q");
    assert!(terminal.wait_for_end());
}

#[test]
fn a_terminal_that_never_answers_is_served_all_the_same() {
    let folder = folder();
    let mut terminal = Terminal::honami(folder.path(), (80, 24), false);
    terminal.wait_for("the first frame", |s| s.contents().contains("0/11") && s.contents().contains('▀'));
    terminal.press("5.");
    terminal.wait_for_text("5/11");
    terminal.press(",");
    terminal.wait_for_text("no answers");
    terminal.press("q");
    assert!(terminal.wait_for_end());
    terminal.assert_restored();
}

#[test]
fn signals_end_it_and_the_terminal_is_restored() {
    for signal in [Signal::TERM, Signal::HUP, Signal::INT] {
        let folder = folder();
        let mut terminal = Terminal::honami(folder.path(), (80, 24), true);
        terminal.wait_for_text("0/11");
        terminal.signal(signal);
        let status = i32::try_from(terminal.wait_for_status()).unwrap();
        assert_eq!(status, 128 + signal.as_raw(), "as shells count it");
        terminal.assert_restored();
    }
}

#[test]
fn after_a_dropped_connection_everything_is_where_it_was() {
    for signal in [Signal::HUP, Signal::TERM] {
        let folder = folder();
        let mut terminal = Terminal::honami(folder.path(), (80, 24), true);
        terminal.wait_for_text("0/11");
        terminal.press("7.a\r");
        terminal.wait_for_text("placed at frame 7");
        terminal.press("z,");
        terminal
            .wait_for("frame 6, closer", |s| s.contents().contains("6/11") && s.contents().contains("1x"));
        terminal.signal(signal);
        terminal.wait_for_status();
        let mut terminal = Terminal::honami(folder.path(), (80, 24), true);
        terminal.wait_for("the same place", |s| {
            let screen = s.contents();
            screen.contains("6/11") && screen.contains("1x") && screen.contains("track 0")
        });
        terminal.press("q");
        assert!(terminal.wait_for_end());
    }
}

#[test]
fn what_cannot_be_opened_is_said_after_the_screen_is_given_back() {
    let folder = folder();
    std::fs::write(folder.path().join("no.honami"), "no project").unwrap();
    let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_honami"));
    command.arg("no.honami");
    let mut terminal = Terminal::start(command, folder.path(), (80, 24), true);
    assert_eq!(terminal.wait_for_status(), 1);
    terminal.assert_restored();
    let screen = terminal.emulator.screen().contents();
    assert!(screen.contains("no.honami"), "{screen}");
}

#[test]
fn what_is_typed_before_the_project_is_there_is_done_when_it_is() {
    let folder = folder();
    let mut terminal = Terminal::honami(folder.path(), (80, 24), true);
    terminal.wait_for("the screen taken over", vt100::Screen::alternate_screen);
    terminal.press("4.a\r");
    terminal.wait_for_text("placed at frame 4");
    terminal.press("q");
    assert!(terminal.wait_for_end());
    terminal.assert_restored();
}

#[test]
fn it_takes_the_terminal_back_when_it_is_continued() {
    let folder = folder();
    let mut terminal = Terminal::honami(folder.path(), (80, 24), true);
    terminal.wait_for_text("0/11");
    let slave = std::fs::File::open(terminal.pty.tty_name().unwrap()).unwrap();
    let raw = format!("{:?}", terminal.pty.get_termios());
    // What a shell does when its job stops: lines again, and its own screen.
    terminal.signal(Signal::STOP);
    let mut modes = rustix::termios::tcgetattr(&slave).unwrap();
    modes.local_modes |= rustix::termios::LocalModes::ICANON | rustix::termios::LocalModes::ECHO;
    rustix::termios::tcsetattr(&slave, rustix::termios::OptionalActions::Now, &modes).unwrap();
    assert_ne!(format!("{:?}", terminal.pty.get_termios()), raw);
    terminal.emulator = vt100::Parser::new(24.try_into().unwrap(), 80.try_into().unwrap(), 0);
    terminal.signal(Signal::CONT);
    terminal.wait_for("the whole screen", |s| {
        s.alternate_screen() && s.contents().contains("0/11") && s.contents().contains('▀')
    });
    assert_eq!(format!("{:?}", terminal.pty.get_termios()), raw);
    terminal.press("q");
    assert!(terminal.wait_for_end());
    terminal.assert_restored();
}

#[test]
fn a_long_paste_stops_nothing_and_one_without_end_ends() {
    let folder = folder();
    let mut terminal = Terminal::honami(folder.path(), (80, 24), true);
    terminal.wait_for_text("0/11");
    terminal.press("?");
    terminal.wait_for_text("what works here");
    let words = "undo the last edit ".repeat(1000);
    terminal.press(&format!("\x1b[200~{words}\x1b[201~"));
    terminal.wait_for_text("undo the last");
    terminal.press("\x1b");
    terminal.wait_for("the help to close", |s| !s.contents().contains("choose"));
    terminal.press("?\x1b[200~whose end is lost");
    terminal.wait_for_text("whose end is lost");
    // The keyboard is the user's again.
    terminal.press("\x1b");
    terminal.wait_for("the help to close", |s| !s.contents().contains("choose"));
    terminal.press("q");
    assert!(terminal.wait_for_end());
    terminal.assert_restored();
}

#[test]
fn where_its_log_cannot_be_written_it_starts_all_the_same() {
    for temp in ["temp", "honami"] {
        let folder = folder();
        std::fs::create_dir(folder.path().join("temp")).unwrap();
        // A file is where the folder of the log would be.
        std::fs::write(folder.path().join("honami"), []).unwrap();
        write_clip(&folder.path().join("sway.y4m"));
        let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_honami"));
        command.arg("sway.y4m");
        command.env("TMPDIR", folder.path().join(temp));
        let mut terminal = Terminal::start(command, folder.path(), (80, 24), true);
        terminal.wait_for_text("0/11");
        terminal.press("q");
        assert!(terminal.wait_for_end(), "{temp}");
        terminal.assert_restored();
        assert_eq!(
            std::fs::read_dir(folder.path().join("temp")).unwrap().count(),
            usize::from(temp == "temp")
        );
    }
}

#[test]
fn it_ends_with_its_terminal() {
    let folder = folder();
    let mut terminal = Terminal::honami(folder.path(), (80, 24), true);
    terminal.wait_for_text("0/11");
    let Terminal { mut child, pty, keyboard, output, .. } = terminal;
    drop((pty, keyboard, output));
    let until = Instant::now() + PATIENCE;
    while child.try_wait().unwrap().is_none() {
        assert!(Instant::now() < until, "it lives on without a terminal");
        std::thread::yield_now();
    }
}

#[test]
fn a_storm_of_sizes_leaves_the_last() {
    let folder = folder();
    let mut terminal = Terminal::honami(folder.path(), (80, 24), true);
    terminal.wait_for_text("0/11");
    for n in 0..40_u16 {
        terminal.pty.resize(size(40 + 2 * n, 10 + n % 20)).unwrap();
        terminal.listen(Duration::from_millis(1));
    }
    terminal.pty.resize(size(120, 40)).unwrap();
    terminal.emulator.screen_mut().set_size(40.try_into().unwrap(), 120.try_into().unwrap());
    terminal.wait_for("the last row", |s| s.contents_between(39, 0, 39, 120).contains("0/11"));
    terminal.press("q");
    assert!(terminal.wait_for_end());
    terminal.assert_restored();
}

/// Not a test of its own: the process that [`a_panic_gives_the_terminal_back`] starts.
#[test]
fn panics_with_the_terminal_in_hand() {
    if std::env::var_os("HONAMI_TEST_PANIC").is_some() {
        let log = std::env::temp_dir().join("honami-test-panic.log");
        let _screen = honami_tui::term::screen::Screen::open(&log).unwrap();
        panic!("a fault in the program");
    }
}

#[test]
fn a_panic_gives_the_terminal_back() {
    let folder = folder();
    let mut command = CommandBuilder::new(std::env::current_exe().unwrap());
    command.args(["--exact", "panics_with_the_terminal_in_hand", "--nocapture", "--test-threads=1"]);
    command.env("HONAMI_TEST_PANIC", "1");
    command.env("TMPDIR", folder.path());
    command.env("RUST_BACKTRACE", "0");
    let mut terminal = Terminal::start(command, folder.path(), (80, 24), true);
    assert!(!terminal.wait_for_end());
    let screen = terminal.emulator.screen().contents();
    assert!(screen.contains("a fault in the program"), "the report is not readable:\n{screen}");
    terminal.assert_restored();
}
