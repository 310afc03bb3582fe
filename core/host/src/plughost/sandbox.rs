//! What the process gives up before it loads a library, whose constructors run at once.
//!
//! Files: reads the system's libraries, its own library and what it was given, writes in a folder of its own that goes
//! with it (landlock). No sockets, no other programs, no look into other processes (`calls.rs`).

mod calls;
mod probe;

use landlock::{
    ABI, Access as _, AccessFs, AccessNet, BitFlags, CompatLevel, Compatible as _, Ruleset, RulesetAttr as _,
    RulesetCreatedAttr as _, RulesetStatus, Scope, path_beneath_rules,
};
pub(crate) use probe::foresee;
use rustix::process::{Resource, Rlimit, setrlimit};
use std::path::{Path, PathBuf};

/// Environment variable with the folder of its own.
pub(crate) const ROOM: &str = "TMPDIR";
/// The rights that files, ports and other processes are kept from by.
const RIGHTS: ABI = ABI::V6;
/// So many files it may hold open: a library that forgets to close is told early.
const OPEN_FILES: u64 = 1024;

/// What every library needs to be loaded and to work.
const SYSTEM: [&str; 14] = [
    "/usr",
    "/lib",
    "/lib64",
    "/opt",
    "/nix/store",
    "/etc/ld.so.cache",
    "/etc/localtime",
    "/proc/self",
    "/proc/cpuinfo",
    "/proc/meminfo",
    "/proc/stat",
    "/sys/devices/system",
    "/dev/null",
    "/dev/urandom",
];

/// Whether other programs may be started: the plugin itself may be one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Programs {
    Refused,
    /// What the plugin itself is, and what that needs to be started.
    These(Vec<PathBuf>),
    /// They give up what this process has given up.
    All,
}

/// How much of it this system could do, in a word for the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Level {
    Full,
    Partial,
    None,
}

impl Level {
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Full => "full",
            Self::Partial => "partial",
            Self::None => "none",
        }
    }
}

/// Closes what whoever started the host has left open beside the three standard ones: a plugin would find it.
pub(super) fn close_inherited() {
    // SAFETY: nothing of this process has opened a file yet. A kernel that does not know the call knows no landlock
    // either, and the level says so.
    #[allow(unsafe_code, reason = "rustix has no such call")]
    let _closed = unsafe { libc::syscall(libc::SYS_close_range, 3_u32, u32::MAX, 0_u32) };
}

/// Takes no more memory than this from now on, and leaves no image of itself behind when it dies.
pub(super) fn limit(memory_bytes: Option<u64>) {
    let no_more = |bytes| Rlimit { current: Some(bytes), maximum: Some(bytes) };
    // What the system does not let it give up it keeps.
    setrlimit(Resource::Core, no_more(0)).unwrap_or_default();
    setrlimit(Resource::Nofile, no_more(OPEN_FILES)).unwrap_or_default();
    // Also the memory that it shares with the host.
    setrlimit(Resource::Fsize, no_more(2 << 30)).unwrap_or_default();
    if let Some(bytes) = memory_bytes {
        setrlimit(Resource::Data, no_more(bytes)).unwrap_or_default();
    }
}

/// Gives it all up but these files and the folder of its own, for this thread and those it starts from now on.
pub(super) fn enter(library: &Path, read: &[PathBuf], programs: &Programs) -> Level {
    let files = files(library, read, programs).unwrap_or(RulesetStatus::NotEnforced);
    let calls = calls::refuse(programs);
    level(&files, calls.is_ok(), *programs == Programs::Refused)
}

/// The level that comes of what is kept of files, and of whether calls and programs are refused.
fn level(files: &RulesetStatus, calls_refused: bool, programs_refused: bool) -> Level {
    match (files, calls_refused) {
        (RulesetStatus::FullyEnforced, true) if programs_refused => Level::Full,
        (RulesetStatus::NotEnforced, false) => Level::None,
        _ => Level::Partial,
    }
}

fn files(
    library: &Path,
    read: &[PathBuf],
    programs: &Programs,
) -> Result<RulesetStatus, landlock::RulesetError> {
    let paths = SYSTEM.iter().map(Path::new).chain([library]).chain(read.iter().map(PathBuf::as_path));
    let paths = paths.filter(|path| path.exists());
    // The host has made one, and removes it.
    let own = std::env::var_os(ROOM).map(PathBuf::from);
    let (these, others) = match programs {
        Programs::These(these) => (these.as_slice(), AccessFs::Execute.into()),
        Programs::Refused | Programs::All => (&[][..], BitFlags::EMPTY),
    };
    let these = these.iter().filter(|path| path.exists());
    let status = Ruleset::default()
        .set_compatibility(CompatLevel::BestEffort)
        .handle_access(AccessFs::from_all(RIGHTS))?
        .handle_access(AccessNet::from_all(RIGHTS))?
        .scope(Scope::from_all(RIGHTS))?
        .create()?
        .add_rules(path_beneath_rules(paths, AccessFs::from_read(RIGHTS) & !others))?
        .add_rules(path_beneath_rules(own, AccessFs::from_all(RIGHTS) & !others))?
        .add_rules(path_beneath_rules(these, AccessFs::from_read(RIGHTS)))?
        .restrict_self()?;
    Ok(status.ruleset)
}
