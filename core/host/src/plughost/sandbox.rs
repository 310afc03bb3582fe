//! What the process gives up before it loads a library, whose constructors run at once.
//!
//! Files: reads the system's libraries, its own library and what it was given, writes nothing (landlock). No sockets but
//! local ones, no other programs, no look into other processes (seccomp, a list of what is refused: a list of what is
//! allowed would break with every new libc).

use landlock::{
    ABI, Access as _, AccessFs, AccessNet, CompatLevel, Compatible as _, Ruleset, RulesetAttr as _,
    RulesetCreatedAttr as _, RulesetStatus, Scope, path_beneath_rules,
};
use rustix::process::{Resource, Rlimit, setrlimit};
use seccompiler::{
    BpfProgram, SeccompAction, SeccompCmpArgLen, SeccompCmpOp, SeccompCondition, SeccompFilter, SeccompRule,
    apply_filter,
};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

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

/// Calls that a plugin has no business with.
const REFUSED: [libc::c_long; 20] = [
    // What it starts is to end with it.
    libc::SYS_setsid,
    libc::SYS_setpgid,
    libc::SYS_pidfd_getfd,
    libc::SYS_execve,
    libc::SYS_execveat,
    libc::SYS_ptrace,
    libc::SYS_process_vm_readv,
    libc::SYS_process_vm_writev,
    libc::SYS_bpf,
    libc::SYS_perf_event_open,
    libc::SYS_io_uring_setup,
    libc::SYS_userfaultfd,
    libc::SYS_mount,
    libc::SYS_umount2,
    libc::SYS_pivot_root,
    libc::SYS_unshare,
    libc::SYS_setns,
    libc::SYS_keyctl,
    libc::SYS_add_key,
    libc::SYS_request_key,
];

/// Whether other programs may be started: the plugin itself may be one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Programs {
    Refused,
    /// They give up what this process has given up.
    Allowed,
}

/// How much of it this system could do, in a word for the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Level {
    Full,
    Partial,
    None,
}

impl Level {
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Full => "full",
            Self::Partial => "partial",
            Self::None => "none",
        }
    }
}

/// Takes no more memory than this from now on, and leaves no image of itself behind when it dies.
pub(super) fn limit(memory_bytes: Option<u64>) {
    let no_more = |bytes| Rlimit { current: Some(bytes), maximum: Some(bytes) };
    // What the system does not let it give up it keeps.
    setrlimit(Resource::Core, no_more(0)).unwrap_or_default();
    // Also the memory that it shares with the host.
    setrlimit(Resource::Fsize, no_more(2 << 30)).unwrap_or_default();
    if let Some(bytes) = memory_bytes {
        setrlimit(Resource::Data, no_more(bytes)).unwrap_or_default();
    }
}

/// Gives it all up, for this thread and those it starts from now on.
pub(super) fn enter(library: &Path, read: &[PathBuf], programs: Programs) -> Level {
    let files = files(library, read).unwrap_or(RulesetStatus::NotEnforced);
    let calls = calls(programs);
    match (files, calls) {
        (RulesetStatus::FullyEnforced, Ok(())) if programs == Programs::Refused => Level::Full,
        (RulesetStatus::NotEnforced, Err(_)) => Level::None,
        _ => Level::Partial,
    }
}

fn files(library: &Path, read: &[PathBuf]) -> Result<RulesetStatus, landlock::RulesetError> {
    let abi = ABI::V6;
    let paths = SYSTEM.iter().map(Path::new).chain([library]).chain(read.iter().map(PathBuf::as_path));
    let paths = paths.filter(|path| path.exists());
    let status = Ruleset::default()
        .set_compatibility(CompatLevel::BestEffort)
        .handle_access(AccessFs::from_all(abi))?
        .handle_access(AccessNet::from_all(abi))?
        .scope(Scope::from_all(abi))?
        .create()?
        .add_rules(path_beneath_rules(paths, AccessFs::from_read(abi)))?
        .restrict_self()?;
    Ok(status.ruleset)
}

fn calls(programs: Programs) -> Result<(), Box<dyn std::error::Error>> {
    let mut rules: BTreeMap<i64, Vec<SeccompRule>> = REFUSED.iter().map(|call| (*call, Vec::new())).collect();
    if programs == Programs::Allowed {
        rules.remove(&libc::SYS_execve);
    }
    let is_local = libc::AF_UNIX.unsigned_abs().into();
    let not_local = SeccompCondition::new(0, SeccompCmpArgLen::Dword, SeccompCmpOp::Ne, is_local)?;
    rules.insert(libc::SYS_socket, vec![SeccompRule::new(vec![not_local])?]);
    let refused = SeccompAction::Errno(libc::EPERM.unsigned_abs());
    let filter =
        SeccompFilter::new(rules, SeccompAction::Allow, refused, std::env::consts::ARCH.try_into()?)?;
    apply_filter(&BpfProgram::try_from(filter)?)?;
    Ok(())
}
