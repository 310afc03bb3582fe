//! The measured process as the system sees it; only where it runs on this machine.

use std::fs;
use std::path::{Path, PathBuf};

/// Ticks of the processor clock per second in `/proc`; fixed by the interface of the kernel.
const TICKS_PER_S: f64 = 100.0;

/// A process whose number is in a file.
pub(crate) struct Process {
    folder: PathBuf,
}

/// What it has used so far.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Usage {
    /// Switches away from its threads, wished or not: each is a wake-up before.
    pub(crate) n_switches: u64,
    pub(crate) cpu_s: f64,
}

impl Process {
    /// The process whose number the far end has written.
    pub(crate) fn of_file(path: &Path) -> Option<Self> {
        let number = fs::read_to_string(path).ok()?;
        let folder = PathBuf::from(format!("/proc/{}", number.trim()));
        folder.is_dir().then_some(Self { folder })
    }

    pub(crate) fn usage(&self) -> Usage {
        let tasks = fs::read_dir(self.folder.join("task")).into_iter().flatten().flatten();
        let n_switches =
            tasks.map(|task| sum_of(&task.path().join("status"), "ctxt_switches:").unwrap_or(0)).sum();
        let stat = fs::read_to_string(self.folder.join("stat")).unwrap_or_default();
        // After the name in brackets: utime and stime are fields 14 and 15 of all.
        let fields = stat.rsplit_once(')').map_or("", |(_, rest)| rest).split_whitespace();
        let ticks: u64 = fields.skip(11).take(2).filter_map(|field| field.parse::<u64>().ok()).sum();
        Usage { n_switches, cpu_s: ticks as f64 / TICKS_PER_S }
    }

    /// Bytes handed to `write` so far.
    pub(crate) fn n_written(&self) -> u64 {
        sum_of(&self.folder.join("io"), "wchar:").unwrap_or(0)
    }
}

/// Sum of the numbers in the lines whose names end so.
fn sum_of(path: &Path, ending: &str) -> Option<u64> {
    let text = fs::read_to_string(path).ok()?;
    let lines = text.lines().filter_map(|line| line.split_once(char::is_whitespace));
    Some(
        lines
            .filter(|(name, _)| name.ends_with(ending))
            .filter_map(|(_, number)| number.trim().parse::<u64>().ok())
            .sum(),
    )
}
