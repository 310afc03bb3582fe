//! Corrections in the real world: the keys, the program, the plugins, and what the project file has afterwards.

use std::path::Path;

use serde_json::Value;

use super::work::{open, said};
use super::{Terminal, folder};

/// A clip of moving leaves with tracks, in the terminal.
fn tracked(folder: &Path) -> Terminal {
    said(folder, "synth leaves.y4m --size 160x120 --frames 30");
    let mut terminal = open("leaves.y4m", folder);
    terminal.wait_for_text("no tracks yet");
    terminal.press("tr");
    terminal.wait_for_text("found anew");
    terminal.press("\r");
    terminal.wait_for_text("(u undoes)");
    terminal
}

/// What was done to the project, oldest first.
fn labels(folder: &Path) -> Vec<String> {
    let log: Value = serde_json::from_str(&said(folder, "log leaves.honami --json")).unwrap();
    let entries = log["log"].as_array().unwrap().iter();
    entries.filter_map(|entry| entry["label"].as_str()).map(str::to_owned).collect()
}

/// Sample of a track in a frame, from the project file: status and source among it.
fn sample(folder: &Path, track: u32, frame: u32) -> String {
    said(folder, "export leaves.honami tracks leaves.csv");
    let table = std::fs::read_to_string(folder.join("leaves.csv")).unwrap();
    std::fs::remove_file(folder.join("leaves.csv")).unwrap();
    let row = table.lines().find(|line| line.starts_with(&format!("{track},{frame},")));
    row.unwrap_or_default().to_owned()
}

#[test]
fn a_track_is_tracked_again_both_ways_between_two_key_frames() {
    let folder = folder();
    let mut terminal = tracked(folder.path());
    // Two key-frames, a pixel off where the tracker was.
    for (go, frame) in [("5gf", "5/29"), ("15gf", "15/29")] {
        terminal.press(go);
        terminal.wait_for_text(frame);
        terminal.press("m");
        terminal.wait_for_text("0.00 px in space");
        terminal.press("l");
        terminal.wait_for_text("1.00 px in space");
        terminal.press("\r");
        terminal.wait_for_text("corrected, up to 1.0 px");
        terminal.press("M");
        terminal.wait_for("the notice gone", |s| !s.contents().contains("corrected, up to"));
    }
    let keys = [5, 15].map(|frame| sample(folder.path(), 0, frame));
    assert!(keys.iter().all(|key| key.contains("key")), "{keys:?}");
    terminal.press("10gf");
    terminal.wait_for_text("10/29");
    terminal.press("tt");
    terminal.wait_for_text("re-tracked 6-14 both ways");
    terminal.wait_for_text("(u undoes)");
    assert!(labels(folder.path()).last().unwrap().contains("re-tracked 6-14 both ways"));
    let again = [5, 15].map(|frame| sample(folder.path(), 0, frame));
    assert_eq!(again, keys, "what was set by hand is never changed");
    terminal.press("u");
    terminal.wait_for_text("undone: track 0: re-tracked");
    terminal.press("q");
    assert!(terminal.wait_for_end());
    terminal.assert_restored();
}

#[test]
fn ranges_and_whole_tracks_are_corrected_in_the_project_file() {
    let folder = folder();
    let mut terminal = tracked(folder.path());
    let steps = [
        ("8gfr12gfo", "8-12 occluded"),
        ("20gfx", "20-29 lost"),
        ("ed", "duplicated"),
        ("10gfes", "split at 10"),
        ("ykyea", "average of 2 tracks"),
        ("5gfr7gfdr", "5-7 taken away"),
    ];
    for (keys, said) in steps {
        terminal.press(keys);
        terminal.wait_for_text(said);
    }
    let labels = labels(folder.path());
    let n = labels.len() - steps.len();
    for (label, (keys, said)) in labels[n..].iter().zip(steps) {
        assert!(label.contains(said), "{keys}: {labels:?}");
    }
    terminal.press("6u");
    terminal.wait_for_text("undone: 6 edits");
    terminal.press("q");
    assert!(terminal.wait_for_end());
    terminal.assert_restored();
}
