//! `honami` alone: the start screen, and from it into projects and back.

use portable_pty::CommandBuilder;

use super::{Terminal, folder, write_clip};

#[test]
fn from_the_start_screen_into_a_clip_and_the_next_time_straight_to_it() {
    let folder = folder();
    write_clip(&folder.path().join("sway.y4m"));
    std::fs::write(folder.path().join("no.honami"), "no project").unwrap();
    let honami =
        || Terminal::start(CommandBuilder::new(env!("CARGO_BIN_EXE_honami")), folder.path(), (80, 24), true);
    let mut terminal = honami();
    terminal.wait_for_text("measures how plants move");
    // Both answers of the machine, or none: the line comes with the second.
    terminal.wait_for_text("ffmpeg");
    // What cannot be opened is said here.
    terminal.press("\rno.h\r");
    terminal.wait_for("one line", |s| s.contents().contains("no.honami") && s.contents().contains("demo"));
    terminal.press("\r./sway.y4m\r");
    terminal.wait_for("the first frame", |s| s.contents().contains("0/11") && s.contents().contains('▀'));
    terminal.press("5.");
    terminal.wait_for_text("5/11");
    // To another project from here; what is no file is said, and nothing is left.
    terminal.press("gcnone\r");
    terminal.wait_for_text("there is no file");
    terminal.press("gcno.h\r");
    terminal.wait_for_text("measures how plants move");
    terminal.press("q");
    assert!(terminal.wait_for_end());
    terminal.assert_restored();
    let mut terminal = honami();
    terminal.wait_for("it among those opened lately", |s| {
        let screen = s.contents();
        screen.contains("0 tracks") && screen.contains("· just now")
    });
    terminal.press("\r");
    terminal.wait_for_text("5/11");
    terminal.press("q");
    assert!(terminal.wait_for_end());
    terminal.assert_restored();
}

#[test]
fn esc_goes_back_from_what_is_still_being_opened() {
    let folder = folder();
    // Nobody gets further with a pipe than its writer.
    let pipe = folder.path().join("slow.y4m");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let honami = CommandBuilder::new(env!("CARGO_BIN_EXE_honami"));
    let mut terminal = Terminal::start(honami, folder.path(), (80, 24), true);
    terminal.wait_for_text("ffmpeg");
    for _ in 0..2 {
        terminal.press("gc./slow.y4m\r");
        terminal.wait_for_text("Esc back  q leave");
        terminal.press("\x1b");
        terminal.wait_for_text("measures how plants move");
    }
    terminal.press("q");
    assert!(terminal.wait_for_end());
    terminal.assert_restored();
}
