//! Ends that nobody chose: signals, terminals that go, faults, projects that cannot be opened.

use std::io::Write as _;
use std::time::Instant;

use portable_pty::CommandBuilder;
use rustix::process::Signal;
use serde_json::Value;

use super::work::{open, said};
use super::{PATIENCE, Terminal, folder};

/// Ways to end that nobody chose, with the exit status as shells count it.
const ENDS: [(&str, Option<Signal>); 4] = [
    ("SIGTERM", Some(Signal::TERM)),
    ("SIGHUP", Some(Signal::HUP)),
    ("SIGINT", Some(Signal::INT)),
    ("the end of the terminal", None),
];

/// Ends it so; its status has to say how.
#[track_caller]
fn end(mut terminal: Terminal, (how, signal): (&str, Option<Signal>)) {
    let status = match signal {
        Some(signal) => {
            terminal.signal(signal);
            let status = terminal.wait_for_status();
            terminal.assert_restored();
            status
        }
        None => {
            let Terminal { mut child, pty, mut keyboard, output, .. } = terminal;
            drop(output);
            // Who reads for the terminal notices with the next bytes: the whole screen, painted anew.
            keyboard.write_all(b"\x0c").unwrap();
            drop((pty, keyboard));
            let until = Instant::now() + PATIENCE;
            loop {
                if let Some(status) = child.try_wait().unwrap() {
                    break status.exit_code();
                }
                assert!(Instant::now() < until, "it lives on without a terminal");
                std::thread::yield_now();
            }
        }
    };
    let expect = 128 + signal.unwrap_or(Signal::HUP).as_raw();
    assert_eq!(i32::try_from(status).unwrap(), expect, "{how}");
}

#[test]
fn after_an_end_that_nobody_chose_everything_is_where_it_was() {
    for how in ENDS {
        let folder = folder();
        let mut terminal = Terminal::honami(folder.path(), (80, 24), true);
        terminal.wait_for_text("0/11");
        terminal.press("7.a\r");
        terminal.wait_for_text("placed at frame 7");
        terminal.press("z,");
        terminal
            .wait_for("frame 6, closer", |s| s.contents().contains("6/11") && s.contents().contains("1x"));
        end(terminal, how);
        // The project is whole, and has what was acknowledged.
        let log: Value = serde_json::from_str(&said(folder.path(), "log sway.honami --json")).unwrap();
        let mut labels = log["log"].as_array().unwrap().iter().filter_map(|entry| entry["label"].as_str());
        assert!(
            labels.next_back().is_some_and(|label| label.contains("placed at frame 7")),
            "{}: {log}",
            how.0
        );
        let mut terminal = Terminal::honami(folder.path(), (80, 24), true);
        terminal.wait_for(how.0, |s| {
            let screen = s.contents();
            screen.contains("6/11") && screen.contains("1x") && screen.contains("track 0")
        });
        terminal.press("q");
        assert!(terminal.wait_for_end());
    }
}

#[test]
fn an_end_in_the_middle_of_a_run_leaves_a_project_that_goes_on() {
    for how in ENDS {
        let folder = folder();
        said(folder.path(), "synth leaves.y4m --size 160x120 --frames 40");
        let mut terminal = open("leaves.y4m", folder.path());
        terminal.wait_for_text("no tracks yet");
        terminal.press("tr");
        terminal.wait_for_text("found anew");
        terminal.press("\r");
        // The run is on its way, or done: either must be safe.
        terminal.wait_for("the run", |s| !s.contents().contains("found anew"));
        end(terminal, how);
        let runs = said(folder.path(), "log leaves.honami");
        let mut terminal = open("leaves.honami", folder.path());
        terminal.wait_for(how.0, |s| s.contents().contains("/39") && s.contents().contains('▀'));
        terminal.press("3.a\r");
        terminal.wait_for_text("placed at frame 3");
        terminal.press("u");
        terminal.wait_for_text("undone: ");
        terminal.press("q");
        assert!(terminal.wait_for_end(), "{}: {runs}", how.0);
    }
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
    command.args(["--exact", "ends::panics_with_the_terminal_in_hand", "--nocapture", "--test-threads=1"]);
    command.env("HONAMI_TEST_PANIC", "1");
    command.env("TMPDIR", folder.path());
    command.env("RUST_BACKTRACE", "0");
    let mut terminal = Terminal::start(command, folder.path(), (80, 24), true);
    assert!(!terminal.wait_for_end());
    let screen = terminal.emulator.screen().contents();
    assert!(screen.contains("a fault in the program"), "the report is not readable:\n{screen}");
    terminal.assert_restored();
}
