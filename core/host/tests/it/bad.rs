//! Plugins with one fault each: the host names plugin, function and fault, and takes nothing from them.

use crate::tools::{compile, has_cc, host, isolating, named, point, push, start, start_in, stream};
use honami_host::{CallContext, Host, HostError, Points, Registry};
use std::path::Path;

const INCLUDE: &str = "../abi/include";

pub(crate) fn bad(fault: &str, more: &[&str]) -> Registry {
    let name = format!("bad-{fault}-{}", more.join("").replace(|c: char| !c.is_alphanumeric(), ""));
    let define = format!("-DFAULT={fault}");
    named(&[&compile("tests/bad/bad.c", &name, INCLUDE, &[&[define.as_str()], more].concat())])
}

/// Three points through one frame, in this process.
fn use_it(registry: &Registry) -> Result<Points, HostError> {
    use_in(&host(), registry)
}

fn use_in(host: &Host, registry: &Registry) -> Result<Points, HostError> {
    let mut tracker = start_in(host, &registry.plugins()[0], &[])?;
    let cx = CallContext::silent();
    tracker.begin(stream(), &cx)?;
    tracker.seed(&[point(3, 1.0, 1.0), point(1, 2.0, 1.5), point(2, 3.0, 2.0)], &cx)?;
    Ok(push(&mut tracker, 0)?.remove(0))
}

#[test]
fn a_library_that_cannot_be_loaded_says_what_is_missing() {
    if !has_cc() {
        return;
    }
    let got = use_it(&bad("NULL_CREATE", &["-DMISSING"])).expect_err("not loaded").to_string();
    assert!(got.contains("cannot be loaded: ") && got.contains("undefined symbol: not_anywhere"), "{got}");
}

#[test]
fn a_fault_in_use_is_named() {
    if !has_cc() {
        return;
    }
    let faults = [
        ("NULL_RECORD", "refuses this honami"),
        ("SMALL_RECORD", "library record is too small, 8 bytes"),
        ("NULL_CREATE", "library record has no create"),
        ("OTHER_MANIFEST", "another manifest than its note"),
        ("NO_INSTANCE", "org.honami.bad: create: gives no instance and no reason"),
        ("NULL_FUNCTION", "misbehaves in get_interface: the table of honami.tracker/1 lacks functions"),
        ("SMALL_INSTANCE", "misbehaves in create: the instance lacks functions"),
        ("SMALL_TABLE", "misbehaves in get_interface: the table of honami.tracker/1 lacks functions"),
        (
            "NULL_TABLE",
            "misbehaves in get_interface: its manifest has honami.tracker/1, the instance has none",
        ),
        ("OTHER_LATENCY", "misbehaves in get_interface: its manifest has latency 0, its table 3"),
        ("REFUSES_PARAMS", "org.honami.bad: set_params: not these (wrong argument)"),
        ("SEED_RESULT", "misbehaves in seed: called reserve for \"honami.points/1\", which is no result"),
        ("NAN_POSITION", "misbehaves in push: put point 3 at (1, NaN)"),
        ("UNKNOWN_ID", "misbehaves in push: committed point 999 in frame 0, which is not live there"),
        ("TWICE", "misbehaves in push: committed point 3 twice in frame 0"),
        ("NO_ROWS", "misbehaves in push: returned without committing honami.points/1 for frame 0"),
        ("NEGATIVE", "org.honami.bad: push: the frame is too dark (unusable data)"),
        ("SILENT", "org.honami.bad: push: gives no reason (failed, code -77)"),
        ("UNASKED_CANCEL", "org.honami.bad: push: gives no reason (cancelled)"),
        ("AGAIN", "misbehaves in push: returned again with a result, or without a latency"),
        ("OVERCOMMIT", "misbehaves in push: committed 4 rows of honami.points/1 after reserving 3"),
        ("COMMIT_ONLY", "misbehaves in push: committed honami.points/1 without reserving it"),
        ("COMMIT_TWICE", "misbehaves in push: committed honami.points/1 twice"),
        ("COMMIT_RESERVE_COMMIT", "misbehaves in push: reserved honami.points/1 after committing it"),
        ("PAST_THE_END", "misbehaves in push: wrote past the end of column x of honami.points/1"),
        ("BAD_STATUS", "misbehaves in push: gave point 3 status 6"),
        ("BAD_QUALITY", "misbehaves in push: gave point 3 fb -3"),
        ("WRONG_TYPE", "misbehaves in push: reserved column \"status\" of \"honami.points/1\" as type 7 x 1"),
        ("MISSING_COLUMN", "misbehaves in push: reserved \"honami.points/1\" without column \"status\""),
        (
            "OTHER_SCHEMA",
            "misbehaves in push: called reserve for \"honami.dendrogram/1\", which is no result",
        ),
        ("TOO_MUCH", "org.honami.bad: push: the host gives nothing (no memory)"),
    ];
    for (fault, wanted) in faults {
        let registry = bad(fault, &[]);
        assert!(registry.problems().is_empty(), "{fault}: {:?}", registry.problems());
        // It is told in the same words wherever it happens.
        for host in [host(), isolating()] {
            let got = use_in(&host, &registry).map_err(|error| error.to_string()).expect_err(fault);
            assert!(got.contains(wanted), "{fault}: wanted {wanted:?}, got {got:?}");
        }
    }
}

#[test]
fn a_fault_in_the_file_is_found_without_running_it() {
    if !has_cc() {
        return;
    }
    let faults: [(&str, &[&str], &str); 5] = [
        ("NONE", &["-DNO_NOTE"], "carries no manifest"),
        ("NONE", &["-DSYMBOL=something_else"], "does not export honami_library_v1"),
        ("NONE", &["-DSYMBOL=honami_library_v2"], "is built for ABI 2, this honami knows ABI 1"),
        (
            "NONE",
            &["-DKNOWN=\"\\\"honami\\\":1,\\\"abi\\\":[2,0],\""],
            "built for ABI 2, this honami knows ABI 1",
        ),
        ("NONE", &["-DKNOWN=\"\\\"honami\\\":1,\""], "its manifest is broken: missing field `abi`"),
    ];
    for (fault, flags, wanted) in faults {
        let registry = bad(fault, flags);
        assert!(registry.plugins().is_empty(), "{flags:?}");
        let got = registry.problems()[0].to_string();
        assert!(got.contains(wanted), "{flags:?}: wanted {wanted:?}, got {got:?}");
    }
    let text = named(&[Path::new("Cargo.toml"), Path::new("nowhere.so")]);
    let lines: Vec<String> = text.problems().iter().map(ToString::to_string).collect();
    assert!(
        lines[0].contains("is no 64-bit ELF library") && lines[1].contains("cannot be read"),
        "{lines:?}"
    );
}

#[test]
fn what_is_no_fault_is_let_pass() {
    if !has_cc() {
        return;
    }
    // An unknown column is ignored; a point without a row has ended; what a plugin prints is not in its answer.
    for (fault, rows, ended) in [("NONE", 3, vec![]), ("PRINTS", 3, vec![]), ("FEWER", 1, vec![1, 2])] {
        for host in [host(), isolating()] {
            let points = use_in(&host, &bad(fault, &[])).unwrap();
            assert_eq!((points.rows.len(), &points.ended), (rows, &ended), "{fault}");
        }
    }
}

#[test]
fn a_failed_instance_answers_no_more() {
    if !has_cc() {
        return;
    }
    let registry = bad("NEGATIVE", &[]);
    let mut tracker = start(&registry.plugins()[0], &[]).unwrap();
    let cx = CallContext::silent();
    tracker.begin(stream(), &cx).unwrap();
    push(&mut tracker, 0).expect_err("a fault");
    let got = tracker.begin(stream(), &cx).expect_err("a failed instance").to_string();
    assert!(got.contains("has failed before; make it anew"), "{got}");
}

#[test]
fn a_library_rebuilt_with_another_manifest_is_refused() {
    if !has_cc() {
        return;
    }
    let build = |known: &str| {
        let known = format!("-DKNOWN={known:?}");
        compile("tests/bad/bad.c", "rebuilt", INCLUDE, &["-DFAULT=NONE", &known])
    };
    let (old, new) = (r#""honami":1,"abi":[1,0],"#, r#""honami":1,"abi":[1,0],"more":2,"#);
    let registry = named(&[&build(old)]);
    use_it(&registry).unwrap();
    let rebuilt = named(&[&build(new)]);
    // Both before and after the new one has been loaded.
    for _ in 0..2 {
        let got = use_it(&registry).expect_err("another manifest").to_string();
        let wanted =
            "rebuilt.so: was rebuilt with another manifest since honami looked at it: start honami again";
        assert!(got.contains(wanted), "{got}");
        use_it(&rebuilt).unwrap();
    }
}
