//! What ends the viewer before it is through: signals, and the end of whoever started it. What it has not finished is removed.

use std::io;
use std::thread::Builder;

use honami_model::unfinished::names;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

/// From now on this process leaves nothing behind where a signal ends it; nor, where it is `attended`, where standard input
/// ends, which whoever started it holds.
///
/// # Errors
/// When the system refuses a handler, or a thread.
pub(crate) fn heed(attended: bool) -> io::Result<()> {
    let mut signals = Signals::new([SIGINT, SIGTERM, SIGHUP])?;
    let wait = move || signals.forever().for_each(end);
    Builder::new().name("signals".to_owned()).spawn(wait)?;
    if attended {
        let wait = || {
            io::copy(&mut io::stdin().lock(), &mut io::sink()).unwrap_or_default();
            end(SIGTERM);
        };
        Builder::new().name("attended".to_owned()).spawn(wait)?;
    }
    Ok(())
}

fn end(signal: i32) {
    // Held until the end: nothing is begun any more, and nothing takes its name.
    let unfinished = names();
    for name in &*unfinished {
        std::fs::remove_file(name).or_else(|_| std::fs::remove_dir_all(name)).unwrap_or_default();
    }
    // It is of those that the system knows, and does not return.
    emulate_default_handler(signal).unwrap_or_default();
}
