//! Plugins that misbehave while somebody watches: what they print is in its panel, and nothing of it on the screen.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use portable_pty::CommandBuilder;

use super::work::{plugins, said};
use super::{Terminal, folder, write_clip};

/// A tracker that leaves its points where they are, with one fault, and the program that plugins run in; `None`
/// without a C compiler.
fn bad(folder: &Path, fault: &str) -> Option<PathBuf> {
    if !Command::new("cc").arg("--version").output().is_ok_and(|output| output.status.success()) {
        let never = std::env::var_os("HONAMI_SKIP").is_some_and(|value| value == "never");
        assert!(!never, "there is no C compiler (cc), and HONAMI_SKIP=never forbids to do without");
        std::io::stderr().write_all(b"skipped: there is no C compiler (cc)\n").unwrap();
        return None;
    }
    let (library, core) = (folder.join("bad.so"), Path::new(env!("CARGO_MANIFEST_DIR")).join("../core"));
    let mut cc = Command::new("cc");
    cc.args(["-O1", "-shared", "-fPIC", "-fvisibility=hidden", "-I"]).arg(core.join("abi/include"));
    cc.args([format!("-DFAULT={fault}").as_str(), "-o"]).arg(&library).arg(core.join("host/tests/bad/bad.c"));
    assert!(cc.status().unwrap().success());
    plugins();
    Some(library)
}

/// A clip with a feature, in the terminal, and the form of the bad tracker.
fn open(folder: &Path, library: &Path, hosting: &str) -> Terminal {
    write_clip(&folder.join("sway.y4m"));
    let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_honami"));
    command.arg("sway.y4m");
    command.env("HONAMI_PLUGIN_PATH", library);
    command.env("HONAMI_HOSTING", hosting);
    let mut terminal = Terminal::start(command, folder, (100, 24), true);
    terminal.wait_for_text("0/11");
    terminal.press("a\r");
    terminal.wait_for_text("placed at frame 0");
    terminal.press("tr");
    terminal.wait_for_text("bad 0");
    terminal
}

#[test]
fn what_a_plugin_prints_is_in_its_panel_wherever_it_works() {
    for (hosting, by) in [("isolated", "bad "), ("in-process", "here ")] {
        let folder = folder();
        let Some(library) = bad(folder.path(), "ESCAPES") else { return };
        let mut terminal = open(folder.path(), &library, hosting);
        terminal.press("\r");
        terminal.wait_for_text("frames 0-11");
        terminal.press("Po");
        terminal.wait_for(hosting, |s| {
            let screen = s.contents();
            let line = screen.lines().find(|line| line.contains(by) && line.trim_end().ends_with(" red"));
            // The rest of the screen is as it was.
            line.is_some() && screen.starts_with("sway") && screen.contains("track 0")
        });
        terminal.press("q");
        assert!(terminal.wait_for_end());
        terminal.assert_restored();
    }
}

#[test]
fn a_run_whose_plugin_dies_again_and_again_goes_on_with_the_rebuilt_one_at_a_key() {
    let folder = folder();
    let Some(library) = bad(folder.path(), "WITHERS") else { return };
    let mut terminal = open(folder.path(), &library, "isolated");
    terminal.press("\r");
    // Which plugin, where, on which signal; and what can be done.
    terminal.wait_for("what has become of it", |s| {
        let screen = s.contents().split_whitespace().collect::<Vec<_>>().join(" ");
        screen.contains("bad failed at frame 4, track 0 up to there kept")
            && screen.contains("died of SIGSEGV")
    });
    terminal.wait_for_text("! lets bad start again and goes on from frame 2");
    bad(folder.path(), "NONE");
    terminal.press("!");
    terminal.wait_for_text("bad: track 0, frames 1-11");
    // One track through all frames.
    terminal.wait_for("the whole track", |s| {
        let time = s.contents().lines().find(|line| line.starts_with("0◆")).map(str::to_owned);
        time.is_some_and(|time| !time.contains('░') && !time.contains('╌'))
    });
    terminal.press("!");
    terminal.wait_for_text("no run has ended early");
    terminal.press("q");
    assert!(terminal.wait_for_end());
    let log = said(folder.path(), "log sway.honami");
    assert!(log.contains("started again at frame 2: it ended in run 1"), "{log}");
}

#[test]
fn a_plugin_that_hangs_is_named_and_a_stopped_run_goes_on() {
    let folder = folder();
    let Some(library) = bad(folder.path(), "SLEEPS") else { return };
    let mut terminal = open(folder.path(), &library, "isolated");
    terminal.press("\r");
    terminal.wait_for_text("bad, frame 2: no sign of life for");
    terminal.press("\x1b");
    terminal.wait_for_text("! goes on from frame 2");
    bad(folder.path(), "NONE");
    terminal.press("!");
    terminal.wait_for_text("bad: track 0, frames 1-11");
    terminal.press("q");
    assert!(terminal.wait_for_end());
}

#[test]
fn a_session_after_one_that_died_with_a_plugin_inside_says_so_and_keeps_it_out() {
    let folder = folder();
    let Some(library) = bad(folder.path(), "SEGFAULT") else { return };
    let mut terminal = open(folder.path(), &library, "in-process");
    terminal.press("\r");
    assert!(!terminal.wait_for_end(), "it dies of a signal");
    let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_honami"));
    command.arg("sway.honami");
    command.env("HONAMI_PLUGIN_PATH", &library);
    command.env("HONAMI_HOSTING", "in-process");
    let mut terminal = Terminal::start(command, folder.path(), (100, 24), true);
    terminal.wait_for_text("bad works in a process of its own: honami ended while it was inside");
    terminal.press("tr");
    terminal.wait_for_text("sandbox");
    terminal.press("\r");
    terminal.wait_for_text("frames 0-11");
    terminal.press("q");
    assert!(terminal.wait_for_end());
    terminal.assert_restored();
}
