//! Signals that end a command: what works in its process has not brought it down, and is not to be blamed for it; and what
//! it has not finished is removed.

use std::fs;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread::Builder;

use honami_model::unfinished::names;
use honami_workbench::plugins::ended_well;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
use signal_hook::iterator::{Handle, Signals};
use signal_hook::low_level::{emulate_default_handler, exit};

/// What a shell says of a program that Ctrl-C has ended.
const INTERRUPTED: i32 = 130;

/// Who waits for signals, while somebody does.
static WATCH: Mutex<Option<Handle>> = Mutex::new(None);
/// What Ctrl-C asks to stop: gone with its job.
static JOB: Mutex<Weak<AtomicBool>> = Mutex::new(Weak::new());

/// From now on this process ends in an orderly way where a signal ends it, until [`leave`].
///
/// # Errors
/// When the system refuses a handler, or a thread.
pub(super) fn heed() -> io::Result<()> {
    // A file that may not grow further is an error like any other, not the end.
    signal_hook::flag::register(SIGXFSZ, Arc::default())?;
    let caught =
        [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| *signal == SIGINT || !is_ignored(*signal));
    let mut signals = Signals::new(caught)?;
    *lock(&WATCH) = Some(signals.handle());
    Builder::new().name("signals".to_owned()).spawn(move || signals.forever().for_each(take)).map(drop)
}

/// Leaves the signals to the screen, which has more to do with them.
pub(super) fn leave() {
    if let Some(watch) = lock(&WATCH).take() {
        watch.close();
    }
}

/// From now on the first Ctrl-C sets this, as long as it is there.
pub(super) fn stops(stop: &Arc<AtomicBool>) {
    *lock(&JOB) = Arc::downgrade(stop);
}

fn take(signal: i32) {
    let job = lock(&JOB).upgrade().filter(|_| signal == SIGINT);
    if job.as_ref().is_some_and(|stop| !stop.swap(true, Ordering::Relaxed)) {
        return;
    }
    ended_well();
    // Held until the end: nothing is begun any more, and nothing takes its name.
    let unfinished = names();
    for name in &*unfinished {
        fs::remove_file(name).or_else(|_| fs::remove_dir_all(name)).unwrap_or_default();
    }
    // The second Ctrl-C ends the program at once: whoever presses twice means it.
    if job.is_some() {
        exit(INTERRUPTED);
    }
    // It is of those that the system knows, and does not return.
    emulate_default_handler(signal).unwrap_or_default();
}

/// Whether who started this process wants it to live through a signal, as `nohup` does.
fn is_ignored(signal: i32) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    ignored.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
