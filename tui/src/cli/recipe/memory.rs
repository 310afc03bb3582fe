//! How much memory processes have, as the system tells.

use std::fs;

use rustix::process::Pid;

/// Resident memory of a process and all that it has started, bytes; 0 where it has ended, or the system does not tell.
///
/// What they share is counted for each of them.
pub(super) fn of_tree(pid: Pid) -> u64 {
    let (mut left, mut bytes) = (vec![pid.as_raw_nonzero().to_string()], 0);
    while let Some(pid) = left.pop() {
        bytes += line(&pid, "VmRSS:").unwrap_or(0);
        // Of every thread the processes that it has started.
        let threads = fs::read_dir(format!("/proc/{pid}/task")).into_iter().flatten().flatten();
        for thread in threads {
            let children = fs::read_to_string(thread.path().join("children")).unwrap_or_default();
            left.extend(children.split_whitespace().map(str::to_owned));
        }
    }
    bytes
}

/// The most that this process had, bytes.
pub(super) fn peak_of_self() -> u64 {
    line("self", "VmHWM:").unwrap_or(0)
}

fn line(pid: &str, name: &str) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{pid}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}
