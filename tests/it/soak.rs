//! kill -9, full disks, folders that refuse, long days: nothing that was acknowledged is lost, and nothing grows without end.
//!
//! In seconds as tests; `cargo xtask soak` runs them for as long as it is told, by these variables.

mod day;
mod editing;
mod faults;
mod recipe;

use std::time::{Duration, Instant};

use honami_tests::Bench;
use rusqlite::{Connection, OpenFlags};

/// How many kills, or for how long; and the seed of their instants.
struct Plan {
    kills: u32,
    until: Option<Duration>,
    seed: u64,
    begun: Instant,
}

impl Plan {
    /// What `HONAMI_SOAK_KILLS`, `HONAMI_SOAK_MINUTES` and `HONAMI_SOAK_SEED` ask for, else these.
    fn asked(kills: u32, seed: u64) -> Self {
        let number = |name: &str| {
            let word = std::env::var(format!("HONAMI_SOAK_{name}")).ok()?;
            Some(
                word.parse::<u32>()
                    .unwrap_or_else(|_| panic!("HONAMI_SOAK_{name} wants a number, not {word}")),
            )
        };
        Self {
            kills: number("KILLS").unwrap_or(kills),
            until: number("MINUTES").map(|minutes| Duration::from_secs(60 * u64::from(minutes))),
            seed: number("SEED").map_or(seed, u64::from),
            begun: Instant::now(),
        }
    }

    fn goes_on(&self, kills: u32) -> bool {
        self.until.map_or(kills < self.kills, |until| self.begun.elapsed() < until)
    }

    /// One line of what was done.
    fn tell(&self, what: &str, kills: u32, acknowledged: usize) {
        let seconds = self.begun.elapsed().as_secs_f64();
        told(&format!(
            "{what}: {kills} kills in {seconds:.0} s ({:.1} per second), {acknowledged} acknowledged, 0 lost, \
             0 files damaged (seed {})",
            f64::from(kills) / seconds,
            self.seed
        ));
    }
}

/// Whether the long version runs.
fn is_long() -> bool {
    ["HONAMI_SOAK_KILLS", "HONAMI_SOAK_MINUTES"].iter().any(|name| std::env::var_os(name).is_some())
}

#[expect(clippy::print_stderr, reason = "what was measured is for a person to read")]
fn told(line: &str) {
    eprintln!("{line}");
}

/// Spins for so long: a kill is to fall anywhere, not where a scheduler wakes.
fn spin(moment: Duration) {
    let begun = Instant::now();
    while begun.elapsed() < moment {
        std::hint::spin_loop();
    }
}

/// SQLite finds nothing wrong in the whole of a project.
#[track_caller]
fn assert_whole(bench: &Bench, project: &str) {
    let database =
        Connection::open_with_flags(bench.path(project), OpenFlags::SQLITE_OPEN_READ_WRITE).unwrap();
    database.busy_timeout(Duration::from_secs(20)).unwrap();
    let check: String = database.query_row("PRAGMA integrity_check", [], |row| row.get(0)).unwrap();
    assert_eq!(check, "ok", "{project}");
    let mut keys = database.prepare("PRAGMA foreign_key_check").unwrap();
    assert!(!keys.exists([]).unwrap(), "{project}: a row names one that is not there");
}
