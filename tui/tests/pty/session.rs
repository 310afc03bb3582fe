//! Sessions from start to end: with a terminal that answers, with one that does not, and with haste.

use std::time::{Duration, Instant};

use portable_pty::CommandBuilder;

use super::{PATIENCE, Terminal, folder, write_clip};

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
