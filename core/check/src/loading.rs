//! Level 2: what loading does beside loading.
//!
//! A library's constructors run when it is loaded, before anybody has asked it for anything. The process that these
//! checks run in gives up what a plugin's own process gives up, and looks at itself before and after.

mod world;

use crate::raw::{Desk, Library, Made};
use crate::{Check, Fault, Subject, Verdict};
use honami_host::{Hosting, Registry, SearchPath};
use std::ffi::CString;
use std::time::{Duration, Instant};
use world::{World, listening};

const SOON: Duration = Duration::from_secs(10);
/// A manifest is read within so long, or a list of plugins is slow.
const SCAN: Duration = Duration::from_millis(100);
/// So many instances are made and destroyed, one after the other,
const INSTANCES: usize = 100;
/// after so many in which a library may set itself up.
const WARM_UP: usize = 5;

pub(crate) const CHECKS: &[Check] = &[
    Check {
        id: crate::crew::LOADS,
        level: 2,
        claim: "it starts in a process that has given up files, network and other programs",
        // An interpreter may have much to import.
        deadline: Duration::from_secs(30),
        run: starts,
    },
    Check {
        id: "loading.scan",
        level: 2,
        claim: "its manifest is read within 100 ms",
        deadline: SOON,
        run: scan,
    },
    Check {
        id: "loading.ids",
        level: 2,
        claim: "its ids are its own: reverse domain names, each once",
        deadline: SOON,
        run: ids,
    },
    Check {
        id: "loading.twice",
        level: 2,
        claim: "its entry gives the same record every time, with the manifest of its file",
        deadline: SOON,
        run: twice,
    },
    Check {
        id: "loading.unknown",
        level: 2,
        claim: "it has no plugin and no interface of a name that it does not know",
        deadline: SOON,
        run: unknown,
    },
    Check {
        id: "loading.instances",
        level: 2,
        claim: "a hundred instances, made and destroyed, leave nothing open",
        deadline: Duration::from_secs(30),
        run: instances,
    },
    Check {
        id: "loading.prints",
        level: 2,
        claim: "it prints nothing when it is loaded",
        deadline: SOON,
        run: prints,
    },
    Check {
        id: "loading.threads",
        level: 2,
        claim: "it starts no threads when it is loaded",
        deadline: SOON,
        run: |subject| unchanged(subject, "threads", |world| world.threads.to_string()),
    },
    Check {
        id: "loading.files",
        level: 2,
        claim: "it opens and closes no files when it is loaded",
        deadline: SOON,
        run: |subject| unchanged(subject, "open files", |world| world.files.join(" ")),
    },
    Check {
        id: "loading.signals",
        level: 2,
        claim: "it leaves the handling of signals alone",
        deadline: SOON,
        run: |subject| unchanged(subject, "signals", |world| world.signals.clone()),
    },
    Check {
        id: "loading.locale",
        level: 2,
        claim: "it leaves the locale alone",
        deadline: SOON,
        run: |subject| unchanged(subject, "the locale", |world| world.locale.clone()),
    },
    Check {
        id: "loading.floats",
        level: 2,
        claim: "it leaves the floating-point mode alone: rounding, denormal numbers, traps",
        deadline: SOON,
        run: |subject| unchanged(subject, "the floating-point mode", |world| world.floats.clone()),
    },
    Check {
        id: "loading.folder",
        level: 2,
        claim: "it leaves the working directory alone",
        deadline: SOON,
        run: |subject| unchanged(subject, "the working directory", |world| world.folder.clone()),
    },
    Check {
        id: "loading.environment",
        level: 2,
        claim: "it leaves the environment alone",
        deadline: SOON,
        run: |subject| unchanged(subject, "the environment", |world| world.environment.join(" ")),
    },
];

fn scan(subject: &Subject) -> Result<Verdict, Fault> {
    let path = SearchPath { named: vec![subject.info.library.clone()], ..SearchPath::default() };
    let once = |_| {
        let began = Instant::now();
        drop(Registry::scan_path(&path));
        began.elapsed()
    };
    let best = (0..3).map(once).min().unwrap_or_default();
    let measured = format!("{:.1} ms", best.as_secs_f64() * 1e3);
    // Time decides nothing: the machine may be busy.
    Ok(if best > SCAN { Verdict::Doubtful(measured) } else { Verdict::Holds(measured) })
}

fn ids(subject: &Subject) -> Result<Verdict, Fault> {
    let path = SearchPath { named: vec![subject.info.library.clone()], ..SearchPath::default() };
    let registry = Registry::scan_path(&path);
    let plugins = registry.plugins().iter().map(|info| info.id.as_str());
    let is_name = |id: &str| {
        let parts: Vec<&str> = id.split('.').collect();
        let is_part = |part: &&str| {
            !part.is_empty()
                && part.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b"-_".contains(&b))
        };
        parts.len() >= 3 && parts.iter().all(is_part)
    };
    let wrong: Vec<&str> =
        plugins.chain([subject.info.library_id.as_str()]).filter(|id| !is_name(id)).collect();
    if !wrong.is_empty() {
        let wrong = wrong.join(", ");
        return Err(Fault(format!("wanted ids such as org.lab.name, in small letters, got {wrong}")));
    }
    if let Some(twin) = registry.shadowed().first() {
        return Err(Fault(format!("it has {} twice", twin.id)));
    }
    Ok(Verdict::Holds(subject.info.id.clone()))
}

fn starts(subject: &Subject) -> Result<Verdict, Fault> {
    let origin = subject.origin(Hosting::Isolated)?;
    let level = format!("sandbox {}", origin.sandbox);
    // A program starts another by its nature; of what else is missing the kernel is the reason.
    let wanted = if !subject.info.is_program() { "full" } else { "partial" };
    Ok(if origin.sandbox == wanted { Verdict::Holds(level) } else { Verdict::Doubtful(level) })
}

/// Runs with the library of a subject, loaded in this process, which is shut in first; beside the point for a program.
pub(crate) fn loaded(
    subject: &Subject,
    run: impl FnOnce(&Library) -> Result<Verdict, Fault>,
) -> Result<Verdict, Fault> {
    if subject.info.is_program() {
        return Ok(Verdict::Beside("a program has a process of its own, and nothing is loaded".into()));
    }
    run(&Library::open(subject)?)
}

fn twice(subject: &Subject) -> Result<Verdict, Fault> {
    loaded(subject, |library| {
        let records = [library.enter()?, library.enter()?, library.enter()?];
        if records.iter().any(|record| *record != records[0]) {
            return Err(Fault("its entry gave another record the second time".into()));
        }
        if library.manifest()? != subject.info.manifest() {
            return Err(Fault("its record has another manifest than its file".into()));
        }
        Ok(Verdict::Holds(String::new()))
    })
}

fn unknown(subject: &Subject) -> Result<Verdict, Fault> {
    loaded(subject, |library| {
        let id = &subject.info.id;
        let others =
            [String::new(), format!("{id}x"), format!("{id} "), format!("{id}.x"), id[..id.len() - 1].into()];
        let desk = Desk::new()?;
        for other in others {
            let name = CString::new(other.as_str()).map_err(|error| Fault(error.to_string()))?;
            if library.create(&desk, &name)?.is_some() {
                return Err(Fault(format!(
                    "it made an instance of {other:?}, which is no plugin of its manifest"
                )));
            }
        }
        let made = Made::of(library, &desk, &subject.info)?;
        for other in ["", "honami.tracker", "honami.tracker/1x", "honami.tracker/999", "honami.nothing/1"] {
            let name = CString::new(other).map_err(|error| Fault(error.to_string()))?;
            if !made.interface(&name)?.is_null() {
                return Err(Fault(format!("it gave an interface for {other:?}, which nobody has")));
            }
        }
        Ok(Verdict::Holds(String::new()))
    })
}

fn instances(subject: &Subject) -> Result<Verdict, Fault> {
    loaded(subject, |library| {
        let desk = Desk::new()?;
        let make = |n| (0..n).try_for_each(|_| Made::of(library, &desk, &subject.info).map(drop));
        make(WARM_UP)?;
        let before = World::now()?;
        make(INSTANCES)?;
        let after = World::now()?;
        let growth = [
            ("threads", before.threads, after.threads),
            ("open files", before.files.len(), after.files.len()),
        ];
        for (what, before, after) in growth {
            if after > before {
                return Err(Fault(format!("{before} {what} became {after} over {INSTANCES} instances")));
            }
        }
        Ok(Verdict::Holds(String::new()))
    })
}

/// Something of the world that loading and entering the library must leave as it is.
fn unchanged(subject: &Subject, what: &str, look: fn(&World) -> String) -> Result<Verdict, Fault> {
    let before = World::now()?;
    loaded(subject, |library| {
        library.enter()?;
        let (before, after) = (look(&before), look(&World::now()?));
        if before == after {
            return Ok(Verdict::Holds(String::new()));
        }
        Err(Fault(format!("{what} before it was loaded: {before}; after: {after}")))
    })
}

fn prints(subject: &Subject) -> Result<Verdict, Fault> {
    let (verdict, printed) = listening(|| {
        loaded(subject, |library| {
            library.enter()?;
            Ok(Verdict::Holds(String::new()))
        })
    })?;
    if printed.is_empty() { Ok(verdict) } else { Err(Fault(format!("it printed {printed:?}"))) }
}
