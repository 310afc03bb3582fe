//! What a person comes for, with the real plugins: track, group, correct, and find it all there after a kill.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use portable_pty::CommandBuilder;
use rustix::process::Signal;
use serde_json::Value;

use super::Terminal;

/// What is built where it has not been chosen.
const NEEDED: &str =
    "-p honami-plughost -p honami-tracker-anchored -p honami-clusterer-bod -p honami-structure-diener";

/// Folder of the shipped plugins and of the program that plugins run in, as cargo builds them: the tests of this package
/// do not. They are built once, before any test uses them, for what is built anew is not there for a moment.
pub(super) fn plugins() -> &'static Path {
    static BUILT: OnceLock<PathBuf> = OnceLock::new();
    BUILT.get_or_init(|| {
        let profile = if cfg!(debug_assertions) { "dev" } else { "release" };
        // Where all is tested together, what is built has to be chosen as it was, or much is built once more.
        let what = std::env::var("HONAMI_BUILD");
        let what = what.as_deref().unwrap_or(NEEDED);
        let output = Command::new(env!("CARGO"))
            .args(["build", "--quiet", "--message-format=json", "--profile", profile])
            .args(what.split_whitespace())
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .stderr(Stdio::inherit())
            .output()
            .unwrap();
        assert!(output.status.success(), "the plugins do not build");
        let library = |line: &str| {
            let message: Value = serde_json::from_str(line).ok()?;
            let is_it = message["target"]["name"] == "honami_tracker_anchored";
            message["filenames"][0].as_str().filter(|_| is_it).map(PathBuf::from)
        };
        let messages = String::from_utf8(output.stdout).unwrap();
        let library = messages.lines().find_map(library).expect("the tracker is a library");
        library.parent().unwrap().to_owned()
    })
}

/// What the program says on a command line.
pub(super) fn said(folder: &Path, line: &str) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_honami"));
    command.args(line.split_whitespace()).current_dir(folder);
    for name in ["XDG_STATE_HOME", "XDG_CACHE_HOME", "XDG_DATA_HOME", "HOME"] {
        command.env(name, folder);
    }
    let output = command.output().unwrap();
    assert!(output.status.success(), "{line}: {output:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// A clip or a project in the terminal, with the shipped plugins.
pub(super) fn open(what: &str, folder: &Path) -> Terminal {
    let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_honami"));
    command.arg(what);
    command.env("HONAMI_PLUGIN_PATH", plugins());
    Terminal::start(command, folder, (80, 24), true)
}

#[test]
fn a_clip_is_tracked_grouped_and_corrected_and_survives_a_kill() {
    let folder = super::folder();
    let open = |what| open(what, folder.path());
    said(folder.path(), "synth leaves.y4m --size 160x120 --frames 30");
    let mut terminal = open("leaves.y4m");
    terminal.wait_for_text("no tracks yet");
    terminal.press("tr");
    terminal.wait_for_text("found anew");
    terminal.press("\r");
    terminal.wait_for("the tracks", |s| {
        let screen = s.contents();
        screen.contains("tracks, frames 0-29") && screen.contains("(u undoes)")
    });
    terminal.press("c");
    terminal.wait_for_text("group with");
    terminal.press("\r");
    terminal.wait_for_text("outlier frames");
    terminal.press("3.m");
    terminal.wait_for_text("0.00 px in space");
    terminal.press("l");
    terminal.wait_for_text("1.00 px in space");
    terminal.press("\r");
    terminal.wait_for_text("corrected, up to 1.0 px");
    terminal.wait_for_text("t t tracks again round it");
    // The run that follows is for the corrected track alone.
    terminal.press("tr");
    terminal.wait_for_text("the selected track");
    terminal.press("\r");
    terminal.wait_for_text("anchored: track ");
    terminal.signal(Signal::KILL);
    assert!(!terminal.wait_for_end());

    let log: Value = serde_json::from_str(&said(folder.path(), "log leaves.honami --json")).unwrap();
    let entries = log["log"].as_array().unwrap().iter();
    let labels: Vec<&str> = entries.filter_map(|entry| entry["label"].as_str()).collect();
    assert!(labels.iter().any(|label| label.contains("corrected, up to 1.0 px")), "{labels:?}");
    let mut terminal = open("leaves.honami");
    terminal.wait_for_text("groups");
    terminal.press("]");
    terminal.wait_for("the key-frame", |s| {
        let screen = s.contents();
        screen.contains("3/29") && screen.contains("key-frame")
    });
    terminal.press("q");
    assert!(terminal.wait_for_end());
    terminal.assert_restored();
}

#[test]
fn a_logged_session_is_done_again_on_a_copy() {
    let folder = super::folder();
    let path = |name: &str| folder.path().join(name);
    said(folder.path(), "synth leaves.y4m --size 160x120 --frames 20");
    said(folder.path(), "new p.honami leaves.y4m");
    std::fs::copy(path("p.honami"), path("copy.honami")).unwrap();
    let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_honami"));
    command.args(["p.honami", "--log", "s.log.jsonl"]);
    command.env("HONAMI_PLUGIN_PATH", plugins());
    let mut terminal = Terminal::start(command, folder.path(), (80, 24), true);
    terminal.wait_for_text("no tracks yet");
    terminal.press("tr");
    terminal.wait_for_text("found anew");
    terminal.press("\r");
    terminal.wait_for_text("(u undoes)");
    terminal.press("3.m2l\r");
    terminal.wait_for_text("corrected, up to 2.0 px");
    terminal.press("u");
    terminal.wait_for_text("undone: track");
    terminal.press("/7\rm3k");
    terminal.wait_for_text("3.00 px");
    terminal.press("\r");
    terminal.wait_for_text("corrected, up to 3.0 px");
    terminal.press("PL");
    terminal.wait_for_text("is saved as");
    // The line that said so was on the disk before it was on the screen.
    terminal.signal(Signal::KILL);
    assert!(!terminal.wait_for_end());

    let log = std::fs::read_to_string(path("s.log.jsonl")).unwrap();
    assert!(log.lines().last().unwrap().contains("is saved as"), "{log}");
    let saved = std::fs::read_to_string(path("p.log.jsonl")).unwrap();
    assert!(log.starts_with(&saved) && saved.lines().last().unwrap().contains("save-log"), "{saved}");
    let told =
        said(folder.path(), &format!("replay copy.honami s.log.jsonl --plugin {}", plugins().display()));
    assert!(told.contains("undone: track") && told.contains("lines done as in the log"), "{told}");
    let tables = ["p", "copy"].map(|name| {
        said(folder.path(), &format!("export {name}.honami tracks {name}.csv"));
        std::fs::read_to_string(path(&format!("{name}.csv"))).unwrap()
    });
    assert!(tables[0].contains(",key") && tables[0] == tables[1]);
}

#[test]
fn a_run_that_finds_nothing_has_nothing_to_undo() {
    let folder = super::folder();
    let mut clip = b"YUV4MPEG2 W64 H48 F25:1 Cmono\n".to_vec();
    for _ in 0..3 {
        clip.extend(b"FRAME\n");
        clip.extend([90; 64 * 48]);
    }
    std::fs::write(folder.path().join("fog.y4m"), clip).unwrap();
    let mut terminal = open("fog.y4m", folder.path());
    terminal.wait_for_text("no tracks yet");
    terminal.press("tr");
    terminal.wait_for_text("found anew");
    terminal.press("\r");
    terminal.wait_for_text("0 tracks, frames 0-2");
    assert!(!terminal.emulator.screen().contents().contains("undoes"));
    terminal.press("u");
    terminal.wait_for_text("nothing to be undone");
    terminal.press("q");
    assert!(terminal.wait_for_end());
}

#[test]
fn the_tutorial_begins_anew_each_time_and_is_never_a_project_opened_lately() {
    let folder = super::folder();
    for _ in 0..2 {
        let mut terminal = open("tutorial", folder.path());
        terminal.wait_for_text("1/16");
        terminal.press(" ");
        terminal.wait_for_text("2/16");
        terminal.press(" .j");
        terminal.wait_for_text("5/16");
        terminal.wait_for_text("to review, 0 done");
        terminal.press("n");
        terminal.wait_for_text("6/16");
        terminal.press("g?");
        terminal.wait_for_text("1/16");
        terminal.press("Q");
        assert!(terminal.wait_for_end());
        terminal.assert_restored();
    }
    assert!(!folder.path().join("honami/recent").exists());
}
