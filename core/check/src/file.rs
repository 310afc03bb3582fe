//! Level 1: what can be told of the file before any of its code runs.

mod elf;
mod known;

use crate::{Check, Fault, Subject, Verdict};
use elf::Elf;
use honami_host::Entry;
use std::fs;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

const SOON: Duration = Duration::from_secs(5);

/// Who reads a file for the first time does this check; what it says of one that cannot be read is told in its name.
pub(crate) const READABLE: Check = Check {
    id: "file.readable",
    level: 1,
    claim: "it is a plugin for this machine and this ABI, with a whole manifest",
    deadline: SOON,
    run: |subject| {
        let (major, minor) = subject.info.abi;
        Ok(Verdict::Holds(format!("ABI {major}.{minor}, a {}", subject.info.kind)))
    },
};

pub(crate) const CHECKS: &[Check] = &[
    READABLE,
    Check {
        id: "file.manifest",
        level: 1,
        claim: "its manifest says nothing that this honami does not know",
        deadline: SOON,
        run: manifest,
    },
    Check {
        id: "file.described",
        level: 1,
        claim: "it says what it is for, under which licence, and every parameter says what it does",
        deadline: SOON,
        run: described,
    },
    Check {
        id: "file.program",
        level: 1,
        claim: "the files that it is started with lie beside its manifest",
        deadline: SOON,
        run: program,
    },
    Check {
        id: "file.exports",
        level: 1,
        claim: "it exports honami_library_v1 and nothing else",
        deadline: SOON,
        run: exports,
    },
    Check {
        id: "file.relocations",
        level: 1,
        claim: "its code is not written to when it is loaded (no TEXTREL)",
        deadline: SOON,
        run: relocations,
    },
    Check {
        id: "file.stack",
        level: 1,
        claim: "it asks for no stack that can be executed",
        deadline: SOON,
        run: stack,
    },
    Check {
        id: "file.runpath",
        level: 1,
        claim: "it looks for libraries only where nobody can slip one in",
        deadline: SOON,
        run: runpath,
    },
    Check {
        id: "file.needed",
        level: 1,
        claim: "the libraries that it needs are there",
        deadline: SOON,
        run: needed,
    },
];

/// The file as ELF; `Err` with what to say of a program, which has none.
fn elf(subject: &Subject) -> Result<Result<Elf, Verdict>, Fault> {
    if subject.info.is_program() {
        return Ok(Err(Verdict::Beside("a program, no library".into())));
    }
    Elf::read(&subject.info.library).map(Ok)
}

fn manifest(subject: &Subject) -> Result<Verdict, Fault> {
    let unknown = known::unknown_to(subject.info.manifest())?;
    if unknown.is_empty() {
        return Ok(Verdict::Holds(String::new()));
    }
    Ok(Verdict::Doubtful(format!("{} mean nothing here: misspelt, or of a later honami", unknown.join(", "))))
}

fn described(subject: &Subject) -> Result<Verdict, Fault> {
    let info = &subject.info;
    let silent = info.params.iter().filter(|param| param.doc.is_empty()).map(|param| param.id.as_str());
    let of_entries = info.params.iter().filter(|param| match &param.kind {
        honami_host::ParamKind::Enum { entries, .. } => {
            entries.iter().all(|Entry { label, doc, .. }| label.is_empty() && doc.is_empty())
        }
        _ => false,
    });
    let silent: Vec<_> = silent.chain(of_entries.map(|param| param.id.as_str())).collect();
    if !silent.is_empty() {
        return Ok(Verdict::Doubtful(format!("nothing is said of {}", silent.join(", "))));
    }
    if info.doc.is_empty() || info.license.is_empty() {
        return Ok(Verdict::Doubtful("its manifest has no doc or no license".into()));
    }
    Ok(Verdict::Holds(String::new()))
}

fn program(subject: &Subject) -> Result<Verdict, Fault> {
    let Some((interpreter, args)) = subject.info.exec().split_first() else {
        return Ok(Verdict::Beside("a library, no program".into()));
    };
    let folder = subject.info.library.parent().unwrap_or(Path::new("/"));
    let own: Vec<&String> = args.iter().filter(|word| !word.starts_with('-')).collect();
    if let Some(missing) = own.iter().find(|file| !folder.join(file).is_file()) {
        return Err(Fault(format!("it is started with {missing}, which is not in {}", folder.display())));
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    let mut places = std::env::split_paths(&path).map(|place| place.join(interpreter));
    if !Path::new(interpreter).is_absolute() && !places.any(|place| place.is_file()) {
        return Err(Fault(format!("it is started by {interpreter}, which is not on the search path (PATH)")));
    }
    Ok(Verdict::Holds(format!(
        "started by {interpreter}; the hash is of its manifest and {} beside it",
        own.len()
    )))
}

fn exports(subject: &Subject) -> Result<Verdict, Fault> {
    let elf = match elf(subject)? {
        Ok(elf) => elf,
        Err(beside) => return Ok(beside),
    };
    // It may have one for another major version, too.
    let others: Vec<&str> =
        elf.exports.iter().map(String::as_str).filter(|name| !name.starts_with("honami_library_v")).collect();
    if others.is_empty() {
        return Ok(Verdict::Holds(String::new()));
    }
    let (shown, n) = (others.iter().take(5).copied().collect::<Vec<_>>().join(", "), others.len());
    Err(Fault(format!(
        "it exports {n} more, {shown}: names that other libraries may mean; build it with -fvisibility=hidden"
    )))
}

fn relocations(subject: &Subject) -> Result<Verdict, Fault> {
    Ok(match elf(subject)? {
        Err(beside) => beside,
        Ok(elf) if elf.has_text_relocations => {
            return Err(Fault("it has TEXTREL; build all of it with -fPIC".into()));
        }
        Ok(_) => Verdict::Holds(String::new()),
    })
}

fn stack(subject: &Subject) -> Result<Verdict, Fault> {
    Ok(match elf(subject)? {
        Err(beside) => beside,
        Ok(elf) if elf.wants_executable_stack => {
            return Err(Fault(
                "its stack is marked executable (PT_GNU_STACK), and the whole process would have one; link it with \
                 -z noexecstack"
                    .into(),
            ));
        }
        Ok(_) => Verdict::Holds(String::new()),
    })
}

fn runpath(subject: &Subject) -> Result<Verdict, Fault> {
    let elf = match elf(subject)? {
        Ok(elf) => elf,
        Err(beside) => return Ok(beside),
    };
    for place in &elf.runpath {
        if is_origin(place) {
            return Err(Fault(format!("it looks for libraries in {place}: {NO_ORIGIN}")));
        }
        if !place.starts_with('/') {
            return Err(Fault(format!("it looks for libraries in {place:?}, wanted absolute folders")));
        }
        // Whoever may write the last folder that is there may make those that are not.
        let mut folders = Path::new(place).ancestors();
        let there = folders.find_map(|folder| Some((folder, fs::metadata(folder).ok()?)));
        if let Some((folder, _)) = there.filter(|(_, meta)| meta.mode() & 0o002 != 0) {
            let folder = folder.display();
            return Err(Fault(format!("it looks for libraries in {place}; everybody may write {folder}")));
        }
    }
    Ok(Verdict::Holds(elf.runpath.join(", ")))
}

fn needed(subject: &Subject) -> Result<Verdict, Fault> {
    let elf = match elf(subject)? {
        Ok(elf) => elf,
        Err(beside) => return Ok(beside),
    };
    let cache = fs::read("/etc/ld.so.cache").unwrap_or_default();
    let own: Vec<PathBuf> = elf.runpath.iter().map(PathBuf::from).collect();
    let is_there = |name: &String| {
        let entry = format!("/{name}\0");
        let is_cached = cache.windows(entry.len()).any(|bytes| bytes == entry.as_bytes());
        let system = ["/lib64", "/usr/lib64", "/lib", "/usr/lib"].map(PathBuf::from);
        is_cached || own.iter().chain(&system).any(|folder| folder.join(name).is_file())
    };
    let missing: Vec<&str> = elf.needed.iter().filter(|name| !is_there(name)).map(String::as_str).collect();
    if missing.is_empty() {
        return Ok(Verdict::Holds(elf.needed.join(", ")));
    }
    let beside = subject.info.library.parent().unwrap_or(Path::new("/"));
    let why = if elf.runpath.iter().any(|place| is_origin(place))
        || missing.iter().any(|name| beside.join(name).is_file())
    {
        format!("; {NO_ORIGIN}")
    } else {
        String::new()
    };
    Err(Fault(format!("it needs {}, which this system does not have{why}", missing.join(", "))))
}

/// Why a library that lies beside the plugin is not found.
const NO_ORIGIN: &str = "$ORIGIN does not work, because honami loads a copy of the plugin, from where nothing lies beside \
                         it; link what it needs into it, or install that in a folder of the system's";

fn is_origin(place: &str) -> bool {
    ["$ORIGIN", "${ORIGIN}"].iter().any(|origin| place.starts_with(origin))
}
