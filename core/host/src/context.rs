//! What the workbench hears of a call, and how it stops one.

use std::time::Duration;

/// Whether the work goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// It does.
    Continue,
    /// It is to stop; the call then fails with [`HostError::Cancelled`](crate::HostError::Cancelled).
    Stop,
}

/// Severity of a plugin's log line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// For the plugin's author.
    Debug,
    /// The user may want to know.
    Info,
    /// The user should know.
    Warning,
    /// Something failed.
    Error,
}

impl Level {
    pub(crate) fn of(number: i32) -> Self {
        match number {
            ..=0 => Self::Debug,
            1 => Self::Info,
            2 => Self::Warning,
            3.. => Self::Error,
        }
    }
}

/// How long a plugin in a process of its own has given no sign of life.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Silence {
    /// Since its last one.
    pub since: Duration,
    /// Whether it is ended now, unless somebody is patient.
    pub is_too_long: bool,
    /// After so long a silence it is.
    pub at_most: Duration,
    /// Whether it is never ended: a debugger holds it, or `HONAMI_NO_WATCHDOG` is set.
    pub is_spared: bool,
}

/// What becomes of a plugin that gives no sign of life.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Patience {
    /// It is ended when the silence is too long.
    Usual,
    /// It is waited for.
    Wait,
    /// It is ended now.
    End,
}

/// Listens to one call. All functions may be called from any thread, while the call lasts.
#[derive(Clone, Copy)]
pub struct CallContext<'a> {
    /// Told how far the work is (0..=1; negative: unknown), and a few words.
    pub progress: &'a (dyn Fn(f64, &str) -> Flow + Sync),
    /// Told the lines of the plugin's log.
    pub log: &'a (dyn Fn(Level, &str) + Sync),
    /// Asked every few hundredths of a second while a process works that may be silent; `None` while it lives.
    pub silent: &'a (dyn Fn(Option<Silence>) -> Patience + Sync),
}

impl CallContext<'static> {
    /// Listens to nothing and never stops.
    #[must_use]
    pub fn silent() -> Self {
        Self { progress: &|_, _| Flow::Continue, log: &|_, _| {}, silent: &|_| Patience::Usual }
    }
}

impl std::fmt::Debug for CallContext<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("CallContext")
    }
}
