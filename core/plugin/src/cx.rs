//! The context of one call: progress, cancel and log.

use crate::{Error, Result};
use honami_abi::log;

/// Receives what a plugin says while it works; the host, or a test.
pub trait Listener: Sync {
    /// Told how far the work is; `true` means stop.
    fn progress(&self, fraction: f64, text: &str) -> bool;
    /// Told a line for the log, with a severity of [`honami_abi::log`].
    fn log(&self, level: i32, text: &str);
}

/// What a plugin may ask of the host during one call. Share it with your threads; it dies with the call.
#[derive(Clone, Copy)]
pub struct Cx<'a> {
    listener: &'a dyn Listener,
}

impl<'a> Cx<'a> {
    /// A context that speaks to `listener`.
    #[must_use]
    pub fn new(listener: &'a dyn Listener) -> Self {
        Self { listener }
    }

    /// Says how far the work is, 0..=1 (negative: unknown), with a few words. Call it at least every 250 ms of work.
    ///
    /// # Errors
    /// [`Error::cancelled`] when the user wants to stop: pass it on with `?`.
    pub fn progress(&self, fraction: f64, text: &str) -> Result<()> {
        if self.listener.progress(fraction, text) { Err(Error::cancelled()) } else { Ok(()) }
    }

    /// Writes to the plugin's log what its author wants to know.
    pub fn debug(&self, text: &str) {
        self.listener.log(log::DEBUG, text);
    }

    /// Writes to the plugin's log what the user may want to know.
    pub fn info(&self, text: &str) {
        self.listener.log(log::INFO, text);
    }

    /// Writes to the plugin's log what the user should know.
    pub fn warn(&self, text: &str) {
        self.listener.log(log::WARNING, text);
    }
}

impl std::fmt::Debug for Cx<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Cx")
    }
}
