//! One fault each: the check that is there for it fails, and nothing of a lower level does.

use crate::tools::{check, compile, failed, has_cc};
use honami_check::{Finding, Outcome, checks};
use std::collections::BTreeSet;

/// A plugin with one fault.
struct Bad {
    /// Chosen by `-DFAULT=`.
    fault: &'static str,
    /// In which file.
    source: &'static str,
    /// For the compiler and the linker.
    flags: &'static [&'static str],
    /// The check that must fail,
    check: &'static str,
    /// and what it says, in part.
    says: &'static str,
}

const LOADED: &str = "tests/bad/loaded.c";
const TRACKER: &str = "tests/bad/tracker.c";
const CLUSTERER: &str = "tests/bad/clusterer.c";
const STRUCTURE: &str = "tests/bad/structure.c";
const SIMULATOR: &str = "tests/bad/simulator.c";

/// Levels 1 to 3.
const LOW: &[Bad] = &[
    Bad {
        fault: "NONE",
        source: LOADED,
        flags: &["-Wl,-z,execstack"],
        check: "file.stack",
        says: "noexecstack",
    },
    Bad {
        fault: "NONE",
        source: LOADED,
        flags: &["-fvisibility=default"],
        check: "file.exports",
        says: "helper",
    },
    Bad { fault: "NONE", source: LOADED, flags: &["-Wl,-rpath,lib"], check: "file.runpath", says: "\"lib\"" },
    Bad {
        fault: "NONE",
        source: LOADED,
        flags: &["-Wl,-rpath,/tmp"],
        check: "file.runpath",
        says: "everybody may write",
    },
    Bad {
        fault: "NONE",
        source: LOADED,
        flags: &["-DTEXTREL", "-Wl,-z,notext"],
        check: "file.relocations",
        says: "-fPIC",
    },
    Bad { fault: "PRINTS", source: LOADED, flags: &[], check: "loading.prints", says: "hello" },
    Bad {
        fault: "THREAD",
        source: LOADED,
        flags: &["-pthread"],
        check: "loading.threads",
        says: "1; after: 2",
    },
    Bad { fault: "OPENS", source: LOADED, flags: &[], check: "loading.files", says: "/dev/null" },
    Bad { fault: "LOCALE", source: LOADED, flags: &[], check: "loading.locale", says: "C.UTF-8" },
    Bad { fault: "FLOATS", source: LOADED, flags: &["-lm"], check: "loading.floats", says: "0x" },
    Bad { fault: "CHDIR", source: LOADED, flags: &[], check: "loading.folder", says: "after: /usr" },
    Bad { fault: "SETENV", source: LOADED, flags: &[], check: "loading.environment", says: "HONAMI_BAD=1" },
    Bad { fault: "SIGNAL", source: LOADED, flags: &[], check: "loading.signals", says: "SigCgt" },
    Bad { fault: "DIES", source: LOADED, flags: &[], check: "loading.starts", says: "SIGABRT" },
    Bad {
        fault: "HANGS",
        source: LOADED,
        flags: &[],
        check: "loading.starts",
        says: "did not end within 5 s",
    },
    Bad { fault: "OTHER_RECORD", source: LOADED, flags: &[], check: "loading.twice", says: "another record" },
    Bad {
        fault: "ANY_ID",
        source: LOADED,
        flags: &[],
        check: "loading.unknown",
        says: "made an instance of",
    },
    Bad {
        fault: "ANY_INTERFACE",
        source: LOADED,
        flags: &[],
        check: "loading.unknown",
        says: "gave an interface",
    },
    Bad {
        fault: "LEAKS_FILES",
        source: LOADED,
        flags: &[],
        check: "loading.instances",
        says: "open files became",
    },
    Bad {
        fault: "NONE",
        source: LOADED,
        flags: &["-DID_TEXT=\"bad\""],
        check: "loading.ids",
        says: "got bad",
    },
    Bad { fault: "READS_PAST", source: LOADED, flags: &[], check: "abi.older-host", says: "SIGSEGV" },
    Bad { fault: "WRITES_TAIL", source: LOADED, flags: &[], check: "abi.newer-host", says: "SIGSEGV" },
    Bad {
        fault: "EXACT_SIZE",
        source: LOADED,
        flags: &[],
        check: "abi.newer-host",
        says: "of another honami",
    },
    Bad { fault: "RESERVED", source: LOADED, flags: &[], check: "abi.reserved", says: "not zero" },
    Bad { fault: "NEEDS_COLOUR", source: LOADED, flags: &[], check: "abi.optional", says: "SIGSEGV" },
    Bad { fault: "NEEDS_SERVICE", source: LOADED, flags: &[], check: "abi.optional", says: "SIGSEGV" },
    Bad { fault: "NEEDS_PARAMS", source: LOADED, flags: &[], check: "abi.optional", says: "SIGSEGV" },
    Bad { fault: "TRUSTS_RESERVE", source: LOADED, flags: &[], check: "abi.no-memory", says: "SIGSEGV" },
    Bad { fault: "HIDES_REFUSAL", source: LOADED, flags: &[], check: "abi.no-memory", says: "returned 0" },
    Bad { fault: "OTHER_TABLE", source: LOADED, flags: &[], check: "abi.tables", says: "another table" },
];

/// Levels 4 to 8.
const MIDDLE: &[Bad] = &[
    Bad {
        fault: "NAN_AT_THE_END",
        source: TRACKER,
        flags: &["-lm"],
        check: "params.extremes",
        says: "radius=9",
    },
    Bad {
        fault: "INACTIVE",
        source: TRACKER,
        flags: &["-lm"],
        check: "params.inactive",
        says: "reach does not count",
    },
    Bad { fault: "READS_PAST", source: TRACKER, flags: &["-lm"], check: "frames.bounds", says: "SIGSEGV" },
    Bad { fault: "READS_BEFORE", source: TRACKER, flags: &["-lm"], check: "frames.bounds", says: "SIGSEGV" },
    Bad {
        fault: "READS_GAPS",
        source: TRACKER,
        flags: &["-lm"],
        check: "frames.stride",
        says: "bytes between rows",
    },
    Bad { fault: "DIES_OF_SMALL", source: TRACKER, flags: &["-lm"], check: "frames.small", says: "SIGSEGV" },
    Bad {
        fault: "STAYS",
        source: TRACKER,
        flags: &["-lm"],
        check: "truth.shift",
        says: "left where they were",
    },
    Bad {
        fault: "DRIFTS",
        source: TRACKER,
        flags: &["-lm"],
        check: "truth.still",
        says: "nothing moves, and points do",
    },
    Bad {
        fault: "FORGETS",
        source: TRACKER,
        flags: &["-lm"],
        check: "truth.ids",
        says: "have no row any more",
    },
    Bad {
        fault: "KEEPS_RETIRED",
        source: TRACKER,
        flags: &["-lm"],
        check: "truth.seeds",
        says: "which is not live there",
    },
    Bad {
        fault: "TRACKS_NOTHING",
        source: TRACKER,
        flags: &["-lm"],
        check: "truth.outside",
        says: "that had left are called tracked",
    },
    Bad {
        fault: "MERGES_TWICE",
        source: CLUSTERER,
        flags: &["-lm"],
        check: "clusterer.groups",
        says: "a second time",
    },
    Bad {
        fault: "WITHOUT_THE_LAST",
        source: CLUSTERER,
        flags: &["-lm"],
        check: "clusterer.groups",
        says: "not 15",
    },
    Bad {
        fault: "BY_ORDER",
        source: CLUSTERER,
        flags: &["-lm"],
        check: "clusterer.order",
        says: "in another order",
    },
    Bad {
        fault: "BY_SIZE",
        source: CLUSTERER,
        flags: &["-lm"],
        check: "clusterer.groups",
        says: "pairs of tracks are wrong",
    },
    Bad {
        fault: "DIES_OF_NONE",
        source: CLUSTERER,
        flags: &["-lm"],
        check: "clusterer.few",
        says: "SIGSEGV",
    },
    Bad {
        fault: "DIES_OF_LOST",
        source: CLUSTERER,
        flags: &["-lm"],
        check: "clusterer.hard",
        says: "SIGSEGV",
    },
];

/// Level 9, whose checks take longer.
const HIGH: &[Bad] = &[
    Bad { fault: "CLOCK", source: TRACKER, flags: &["-lm"], check: "running.twice", says: "and point" },
    Bad { fault: "THREADS", source: TRACKER, flags: &["-lm"], check: "running.threads", says: "and point" },
    Bad {
        fault: "ELSEWHERE",
        source: TRACKER,
        flags: &["-lm"],
        check: "running.isolated",
        says: "and point",
    },
    Bad { fault: "STATE", source: TRACKER, flags: &["-lm"], check: "running.again", says: "and point" },
    Bad {
        fault: "SHARED_SMALL",
        source: TRACKER,
        flags: &["-lm"],
        check: "running.turns",
        says: "and point",
    },
    Bad {
        fault: "FIRST_BESIDE",
        source: TRACKER,
        flags: &["-lm"],
        check: "running.parallel",
        says: "and point",
    },
    Bad { fault: "SHARED", source: TRACKER, flags: &["-lm"], check: "running.turns", says: "and point" },
    Bad { fault: "FALLS", source: TRACKER, flags: &["-lm"], check: "running.progress", says: "and then at" },
    Bad { fault: "DEAF", source: TRACKER, flags: &["-lm"], check: "running.stop", says: "gave a result" },
    Bad {
        fault: "LEAKS_FILES",
        source: TRACKER,
        flags: &["-lm"],
        check: "running.growth",
        says: "2000 files",
    },
    Bad { fault: "LEAKS_MEMORY", source: TRACKER, flags: &["-lm"], check: "running.growth", says: "kB" },
];

fn finds(table: &[Bad]) {
    if !has_cc() {
        return;
    }
    let all = checks();
    let mut complaints = Vec::new();
    for Bad { fault, source, flags, check: wanted, says } in table {
        let level = all.iter().find(|known| known.id == *wanted).map_or(0, |known| known.level);
        let name = format!("{fault}{}", flags.join("").replace(|c: char| !c.is_alphanumeric(), ""));
        let define = format!("-DFAULT={fault}");
        let library = compile(source, &name, &[&[define.as_str()], *flags].concat());
        let outcomes = check(&library, |known| known.level < level || known.id == *wanted);
        let is_found = |outcome: &Outcome| {
            outcome.check.id == *wanted
                && matches!(&outcome.finding, Finding::Fails(why) if why.contains(says))
        };
        if !outcomes.iter().any(is_found) {
            let got = failed(&outcomes);
            complaints.push(format!("{name}: wanted {wanted} to fail with {says:?}, got {got:?}"));
        }
        let below: Vec<_> = outcomes.into_iter().filter(|outcome| outcome.check.level < level).collect();
        complaints
            .extend(failed(&below).iter().map(|failed| format!("{name}: a lower level fails: {failed}")));
    }
    assert!(complaints.is_empty(), "\n{}\n", complaints.join("\n"));
}

#[test]
fn a_fault_of_the_file_of_loading_or_of_the_abi_is_found_at_its_level() {
    finds(LOW);
}

#[test]
fn a_library_that_is_not_there_is_named() {
    if !has_cc() {
        return;
    }
    let name = "-Wl,-soname,libnobody-has-this.so.1";
    let other = compile(LOADED, "other", &["-DFAULT=NONE", name]);
    let flags = ["-DFAULT=NONE", "-Wl,--no-as-needed", other.to_str().unwrap()];
    let library = compile(LOADED, "needs", &flags);
    let got = failed(&check(&library, |known| known.level == 1));
    assert!(got.len() == 1 && got[0].starts_with("file.needed: it needs libnobody-has-this.so.1"), "{got:?}");
}

#[test]
fn a_fault_in_parameters_frames_or_what_is_said_of_them_is_found_at_its_level() {
    finds(MIDDLE);
}

#[test]
fn a_fault_in_the_way_of_working_is_found_at_its_level() {
    finds(HIGH);
}

/// Of structure builders.
const GROWING: &[Bad] = &[
    growing("DIES_OF_ONE", "structure.few", "SIGSEGV"),
    growing("DIES_OF_LOST", "structure.hard", "SIGSEGV"),
    growing("STILL", "structure.follows", "is not that of its joint"),
    growing("FIFTH", "structure.follows", "0.80 of the motion"),
    growing("LEAVES_ONE_OUT", "structure.follows", "has no joint"),
    growing("BARE_LEAVES", "structure.leaves", "px from it"),
    growing("BY_ORDER", "structure.order", "in another order"),
    growing("OWN_ROOT", "structure.root", "it stands at"),
];

const fn growing(fault: &'static str, check: &'static str, says: &'static str) -> Bad {
    Bad { fault, source: STRUCTURE, flags: &["-lm"], check, says }
}

#[test]
fn a_fault_of_a_structure_builder_is_found_at_its_level() {
    finds(GROWING);
}

/// Of simulators.
const SWAYING: &[Bad] = &[
    swaying("DRIFTS", "simulator.rest", "in no wind a node is"),
    swaying("NEVER_CALMS", "simulator.calms", "still sways by"),
    swaying("ONCE_A_CALL", "simulator.chunks", "60 steps in 60 calls"),
    swaying("KEEPS_SPEED", "simulator.chunks", "lead"),
    swaying("COARSE", "simulator.finer", "of the motion"),
    swaying("FIRST_WIND", "simulator.copies", "copy 1 of 3"),
    swaying("UNTURNED", "simulator.turned", "is off by"),
    swaying("IN_THE_WORLD", "simulator.turned", "is off by"),
    swaying("SKIPS_UNWANTED", "simulator.detail", "go on otherwise"),
    swaying("FORGETS", "simulator.state", "one that loads what another saved goes on otherwise"),
    swaying("DIES_OF_ONE", "simulator.odd", "SIGSEGV"),
];

const fn swaying(fault: &'static str, check: &'static str, says: &'static str) -> Bad {
    Bad { fault, source: SIMULATOR, flags: &["-lm"], check, says }
}

#[test]
fn a_fault_of_a_simulator_is_found_at_its_level() {
    finds(SWAYING);
}

/// One fault, and every check that is to find it, whatever others say of it.
const SEVERAL: &[(&str, &[&str], &[&str])] = &[
    ("NONE", &["-DWHEN_NOTHING"], &["params.when"]),
    ("NONE", &["-DNOW_NOTHING"], &["params.renamed"]),
    ("CHOICE", &[], &["params.choices"]),
    ("IN_BETWEEN", &[], &["params.random"]),
    ("SECOND", &[], &["params.default"]),
    ("DIES_OF_BLACK", &[], &["frames.odd"]),
    ("DIES_OF_LONG", &[], &["frames.long", "frames.large"]),
    ("DIES_OF_LATE", &[], &["frames.gaps"]),
    ("DIES_OF_MANY", &[], &["frames.many"]),
    ("STAYS", &[], &["truth.turn", "truth.zoom", "truth.sway", "truth.light", "truth.blur"]),
    ("SHARED", &[], &["running.left"]),
    ("FIRST_BESIDE", &[], &["running.callers"]),
];

#[test]
fn a_fault_that_several_checks_are_there_for_is_found_by_each() {
    if !has_cc() {
        return;
    }
    let mut complaints = Vec::new();
    for (fault, flags, wanted) in SEVERAL {
        let define = format!("-DFAULT={fault}");
        let name = format!("several-{fault}{}", flags.concat());
        let library = compile(TRACKER, &name, &[&[define.as_str(), "-lm"], *flags].concat());
        let outcomes = check(&library, |known| wanted.contains(&known.id));
        let missed = outcomes.iter().filter(|outcome| !matches!(outcome.finding, Finding::Fails(_)));
        complaints
            .extend(missed.map(|outcome| format!("{name}: {}: {:?}", outcome.check.id, outcome.finding)));
    }
    assert!(complaints.is_empty(), "\n{}\n", complaints.join("\n"));
}

/// Checks for which no bad plugin is here, and why.
const WITHOUT: &[(&str, &str)] = &[
    ("file.readable", "what cannot be read is no subject: tests of the command line have it"),
    ("file.manifest", "it has doubts alone; tests of the members that are known have it"),
    ("file.described", "it has doubts alone"),
    ("file.program", "it is of programs, and those here are libraries"),
    ("loading.scan", "it has doubts alone, because time decides nothing"),
    ("clusterer.heights", "the bad clusterer has no fault of its heights"),
    ("clusterer.scale", "the bad clusterer has no fault of scale"),
    ("state.goes-on", "the bad tracker saves nothing"),
    ("state.aside", "the bad tracker saves nothing"),
    ("state.damaged", "the bad tracker saves nothing"),
    ("truth.hidden", "the bad tracker has no fault that only hiding shows"),
    ("truth.detect", "the bad tracker detects nothing"),
    ("truth.aside", "the bad tracker detects nothing"),
    ("truth.field", "the bad tracker has no field"),
    ("running.long-growth", "it is running.growth over more frames, and takes minutes"),
    ("stress.order", "it takes minutes"),
    ("stress.killed", "it takes minutes"),
];

#[test]
fn every_check_has_a_bad_plugin_or_a_reason_why_it_has_none() {
    let single = [LOW, MIDDLE, HIGH, GROWING, SWAYING].into_iter().flatten().map(|bad| bad.check);
    let several = SEVERAL.iter().flat_map(|(_, _, wanted)| wanted.iter().copied());
    let found: BTreeSet<&str> = single.chain(several).chain(["file.needed"]).collect();
    let without: BTreeSet<&str> = WITHOUT.iter().map(|(id, _)| *id).collect();
    assert_eq!(found.intersection(&without).count(), 0, "found, and said to be without a bad plugin");
    let all: BTreeSet<&str> = checks().iter().map(|check| check.id).collect();
    assert_eq!(found.union(&without).copied().collect::<BTreeSet<_>>(), all);
}
