//! Processes that do not speak as a plugin's should: each is told in bounded time and memory, and takes nothing with it.

use crate::tools::{host, isolating, named, pixels, point, scratch, stream, view};
use honami_host::{CallContext, Host, HostError, Limits, Points, Registry, Values};
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

/// No misdeed takes longer to be told: the longest waits for the watch-dog, which is told to wait this long.
const END: Duration = Duration::from_secs(3);

fn has_python() -> bool {
    let there = Command::new("python3").arg("--version").output().is_ok_and(|output| output.status.success());
    if !there {
        eprintln!("skipped: needs python3");
    }
    there
}

/// A tracker in `tests/bad/hostile.py` that does this.
fn hostile(misdeed: &str) -> Registry {
    let folder = scratch().join(format!("hostile{misdeed}"));
    fs::create_dir_all(&folder).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad/hostile.py");
    fs::copy(script, folder.join("hostile.py")).unwrap();
    let manifest = serde_json::json!({
        "honami": 1, "abi": [1, 0], "library": { "id": "org.honami.hostile", "version": "0" },
        "exec": ["python3", "hostile.py", misdeed],
        "plugins": [{ "id": "org.honami.hostile", "kind": "tracker", "name": "Hostile", "interfaces": ["honami.tracker/1"] }],
    });
    let file = folder.join("hostile.honami.json");
    fs::write(&file, manifest.to_string()).unwrap();
    named(&[&file])
}

fn watchful() -> Host {
    let _built = isolating();
    let limits = Limits { tell: END / 10, end: END, ..Limits::default() };
    host().limits(limits).without_quarantine()
}

/// Frames 0 to 4; those before the misdeed, 0 and 1, are always whole.
fn in_frame_2(misdeed: &str) -> Result<Vec<Points>, HostError> {
    from_frame_2(misdeed, 5)
}

/// Frames 0 to `end`.
fn from_frame_2(misdeed: &str, end: i64) -> Result<Vec<Points>, HostError> {
    let registry = hostile(misdeed);
    assert!(registry.problems().is_empty(), "{:?}", registry.problems());
    let cx = CallContext::silent();
    let (mut tracker, _) = watchful().tracker(&registry.plugins()[0], &Values::default(), &cx).unwrap();
    tracker.begin(stream(), &cx).unwrap();
    tracker.seed(&[point(3, 1.0, 1.0), point(1, 2.0, 1.5)], &cx).unwrap();
    for n in 0..2 {
        assert_eq!(tracker.push(&view(&pixels(n), n), &cx).unwrap()[0].rows.len(), 2, "{misdeed}");
    }
    let begun = Instant::now();
    let rest = (2..end).map(|n| Ok(tracker.push(&view(&pixels(n), n), &cx)?.remove(0))).collect();
    assert!(begun.elapsed() < 10 * END, "{misdeed}: {:?}", begun.elapsed());
    rest
}

#[test]
fn what_a_hostile_process_says_is_told() {
    if !has_python() {
        return;
    }
    let column = "answered with column \"x\" of honami.points/1 outside its memory";
    for (misdeed, wanted) in [
        ("--far-column", column),
        ("--last-byte", column),
        ("--header-column", column),
        ("--beyond", "of honami.points/1 outside its memory"),
        ("--huge-rows", "answered with 18446744073709551615 rows of honami.points/1, more than 1 GiB"),
        ("--more-than-memory", "answered with 1152921504606846976 rows of honami.points/1, more than 1 GiB"),
        ("--negative-rows", "its process said what nobody understands: invalid value"),
        ("--no-column", "answered with honami.points/1 without column \"x\""),
        ("--other-table", "answered with \"honami.dendrogram/1\", which is no result of this function"),
        ("--no-table", "returned without committing honami.points/1 for frame 2"),
        ("--other-word", "its process said what nobody understands: unknown variant"),
        ("--refuses", "its process refuses what it has begun"),
        ("--deep", "its process said what nobody understands"),
        ("--garbage", "its process said what nobody understands"),
        ("--number", "its process said what nobody understands"),
        ("--empty", "its process said what nobody understands"),
        ("--fault", "misbehaves in push: it is all wrong"),
        ("--twice", "its process answers what nobody has asked"),
        ("--later", "its process answers what nobody has asked"),
        ("--endless", "its process said a line without end"),
        ("--half", "was ended after 3 s without a sign of life in push of frame 2"),
        ("--half-and-gone", "ended its process with status 0 in push of frame 2"),
        ("--chatter", "was ended after 3 s without a sign of life in push of frame 2"),
        ("--hangs-up", "its process hung up"),
        ("--shrinks", "Operation not permitted, Operation not permitted, Operation not permitted"),
        ("--grows", "committed point 0 in frame 2, which is not live there"),
    ] {
        let got = in_frame_2(misdeed).expect_err(misdeed).to_string();
        assert!(got.contains(wanted), "{misdeed}: wanted {wanted:?}, got {got:?}");
    }
}

/// Long before so many frames a socket is full that nobody reads.
const FRAMES: i64 = 5_000;

#[test]
fn a_process_that_answers_and_does_not_listen_is_ended() {
    if !has_python() {
        return;
    }
    let got = from_frame_2("--deaf", FRAMES).expect_err("nobody reads").to_string();
    assert!(got.contains("was ended after 3 s without a sign of life in push"), "{got}");
}

#[test]
fn memory_that_changes_while_it_is_read_never_brings_what_was_not_checked() {
    if !has_python() {
        return;
    }
    match in_frame_2("--flicker") {
        Ok(all) => {
            let mut rows = all.iter().flat_map(|points| &points.rows);
            assert!(rows.all(|row| row.x.is_finite() && row.y.is_finite()), "{all:?}");
        }
        Err(error) => assert!(error.to_string().contains("put point"), "{error}"),
    }
    // Columns may lie over each other: they are read, not written.
    let overlapping = in_frame_2("--overlap").unwrap();
    assert!(overlapping.iter().flat_map(|points| &points.rows).any(|row| row.x.to_bits() == row.y.to_bits()));
}
