//! What a command says while it works: a progress bar on a terminal, a line a named part elsewhere.

use std::io::{IsTerminal as _, Write as _};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use honami_model::brief;
use honami_workbench::plugins::plain;
use honami_workbench::progress::{Flow, Level, Patience, Progress, Silence};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::args::Common;
use super::ends;

/// Who is told how far a step is, instead of a bar: its number, how much is done of how much, of what. Nobody there: stop.
type Relay = Box<dyn Fn(usize, u64, u64, &str) -> bool + Send + Sync>;

static RELAY: OnceLock<Relay> = OnceLock::new();
static STEP: AtomicUsize = AtomicUsize::new(0);
/// So often, so that nobody is told more than can be shown.
const TELL_EVERY: Duration = Duration::from_millis(200);

/// From now on what works tells this one how far it is.
pub(super) fn relay(to: Relay) {
    // Once in the life of a process that follows a recipe.
    drop(RELAY.set(to));
}

/// The number of the step that is at work.
pub(super) fn step(number: usize) {
    STEP.store(number, Ordering::Relaxed);
}

/// A progress bar on standard error; Ctrl-C asks the job to stop and keep what it has.
pub(super) struct Bar {
    bar: ProgressBar,
    /// Whether what plugins print is said.
    verbose: bool,
    stop: Arc<AtomicBool>,
    /// A plugin that is silent is told of after so long a silence.
    told: Mutex<Duration>,
    /// When the one who is told of steps was told last.
    relayed: Mutex<Option<Instant>>,
}

impl Bar {
    pub(super) fn new() -> Self {
        Self::with(&Common::default())
    }

    /// A bar over which plugins are heard, if that was asked for.
    pub(super) fn with(common: &Common) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr_with_hz(10));
        let style = "{msg} {pos}/{len} ▕{bar:20}▏ {eta} left";
        if let Ok(style) = ProgressStyle::with_template(style) {
            bar.set_style(style.progress_chars("█▌ "));
        }
        let stop = Arc::new(AtomicBool::new(false));
        ends::stops(&stop);
        Self { bar, verbose: common.verbose, stop, told: Mutex::default(), relayed: Mutex::default() }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Bar {
    fn report(&self, done: u64, total: u64, what: &str) -> Flow {
        if self.bar.message() != what {
            // What is left is told of the steps of this name: others take another time each.
            self.bar.reset();
            self.bar.set_message(what.to_owned());
        }
        self.bar.set_length(total);
        self.bar.set_position(done);
        if let Some(relay) = RELAY.get() {
            let mut last = self.relayed.lock().unwrap_or_else(PoisonError::into_inner);
            if last.is_none_or(|last| last.elapsed() >= TELL_EVERY) {
                *last = Some(Instant::now());
                if !relay(STEP.load(Ordering::Relaxed), done, total, what) {
                    return Flow::Stop;
                }
            }
        }
        if self.stop.load(Ordering::Relaxed) { Flow::Stop } else { Flow::Continue }
    }

    fn hear(&self, plugin: &str, _frame: Option<u32>, level: Level, line: &str) {
        if self.verbose {
            let word = match level {
                Level::Debug | Level::Info => "",
                Level::Warning => "warning: ",
                Level::Error => "error: ",
            };
            self.bar.suspend(|| say(&format!("{plugin}: {word}{line}")));
        }
    }

    fn died(&self, plugin: &str, frame: u32, how: &str, then: Option<&str>) {
        self.hear(plugin, Some(frame), Level::Error, &format!("{how}, in frame {frame}"));
        if let Some(then) = then {
            self.hear(plugin, Some(frame), Level::Warning, then);
        }
    }

    fn silent(&self, plugin: &str, frame: Option<u32>, _at: &str, silence: Option<Silence>) -> Patience {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        match silence {
            None => *told = Duration::ZERO,
            Some(silence) if silence.since >= *told => {
                // Again when it has lasted twice as long.
                *told = 2 * silence.since;
                let place = frame.map_or_else(|| self.bar.message(), |frame| format!("frame {frame}"));
                self.say(&format!("{plugin}, {place}: {}", silence_words(silence)));
            }
            Some(_) => {}
        }
        Patience::Usual
    }

    fn part(&self, name: &str) {
        if self.bar.is_hidden() {
            say(name);
        }
    }

    fn say(&self, line: &str) {
        self.bar.suspend(|| say(line));
    }
}

/// `no sign of life for 2 s; after 10 s it is ended`.
fn silence_words(Silence { since, at_most, is_spared, .. }: Silence) -> String {
    let [since, at_most] = [since, at_most].map(|time| time.as_secs_f64());
    let end =
        if is_spared { "it is not ended".to_owned() } else { format!("after {at_most:.0} s it is ended") };
    format!("no sign of life for {since:.0} s; {end}")
}

/// One line on standard error; where that is gone with the terminal, nobody is left to hear it.
pub(super) fn say(line: &str) {
    writeln!(std::io::stderr(), "{line}").ok();
}

/// What went wrong, the whole chain in one line.
pub(super) fn complain(error: &anyhow::Error) {
    let red = std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    let (on, off) = if red { ("\x1b[31m", "\x1b[0m") } else { ("", "") };
    say(&format!("{on}honami:{off} {}", chain(error)));
}

/// The error and its causes; a cause that the line tells already is not told twice.
pub(super) fn chain(error: &anyhow::Error) -> String {
    plain(&brief::told(error.as_ref()))
}

/// Columns aligned to their widest cell, two spaces apart; the first row is the head.
pub(super) fn table(rows: &[Vec<String>]) -> String {
    // Names and messages come from elsewhere.
    let rows: Vec<Vec<String>> =
        rows.iter().map(|row| row.iter().map(|cell| plain(cell)).collect()).collect();
    let n_columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|r| r.get(column)).map(|c| c.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..n_columns).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:width$}"));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// A line, and below it what a plugin warned of.
pub(super) fn with_warnings(line: &str, warnings: &[String]) -> String {
    let warnings = warnings.iter().map(|warning| format!("\nwarning: {warning}"));
    std::iter::once(line.to_owned()).chain(warnings).collect()
}

#[cfg(test)]
mod tests;
