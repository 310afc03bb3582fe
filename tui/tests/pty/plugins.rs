//! Plugins that misbehave while somebody watches: what they print is in its panel, and nothing of it on the screen.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use portable_pty::CommandBuilder;

use super::{Terminal, folder, write_clip};

/// A tracker that leaves its points where they are, with one fault, and the program that plugins run in; `None` without
/// a C compiler.
fn bad(folder: &Path, fault: &str) -> Option<PathBuf> {
    if !Command::new("cc").arg("--version").output().is_ok_and(|output| output.status.success()) {
        std::io::stderr().write_all(b"skipped: there is no C compiler (cc)\n").unwrap();
        return None;
    }
    let (library, core) = (folder.join("bad.so"), Path::new(env!("CARGO_MANIFEST_DIR")).join("../core"));
    let mut cc = Command::new("cc");
    cc.args(["-O1", "-shared", "-fPIC", "-fvisibility=hidden", "-I"]).arg(core.join("abi/include"));
    cc.args([format!("-DFAULT={fault}").as_str(), "-o"]).arg(&library).arg(core.join("host/tests/bad/bad.c"));
    assert!(cc.status().unwrap().success());
    let built =
        Command::new(env!("CARGO")).args(["build", "--quiet", "-p", "honami-plughost"]).status().unwrap();
    assert!(built.success(), "the program that plugins run in does not build");
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
