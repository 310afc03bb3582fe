//! The watch-dog: how far a plugin is, whether it lives, and that it stops.

use super::Isolated;
use super::process::Ended;
use crate::context::{CallContext, Flow, Patience, Silence};
use crate::wire::memory::Output;
use rustix::process::Signal;
use std::sync::atomic::Ordering::Relaxed;
use std::time::{Duration, Instant};

/// After an abort, which leaves a trace for the plugin's author, it is killed.
pub(super) const ABORT: Duration = Duration::from_secs(1);

/// When the plugin last gave a sign of life.
pub(super) struct Watch {
    beat: u64,
    /// Whether there was one since the request.
    is_alive: bool,
    since: Instant,
    asked: Option<Instant>,
    /// How long it may be silent.
    at_most: Duration,
}

impl Watch {
    pub(super) fn new(output: &Output, at_most: Duration) -> Self {
        Self {
            beat: output.heartbeat().load(Relaxed),
            is_alive: false,
            since: Instant::now(),
            asked: None,
            at_most,
        }
    }

    fn silence(&mut self, output: &Output) -> Duration {
        let beat = output.heartbeat().load(Relaxed);
        if beat != self.beat {
            (self.beat, self.since, self.is_alive) = (beat, Instant::now(), true);
        }
        self.since.elapsed()
    }
}

impl Isolated {
    /// Passes on how far it is, asks whether to go on, and ends what does not live or does not stop.
    pub(super) fn watch(&mut self, watch: &mut Watch, cx: &CallContext<'_>) -> Option<Ended> {
        let silent = watch.silence(&self.output);
        let fraction = if watch.is_alive { self.output.fraction() } else { -1.0 };
        let fraction = if fraction.is_finite() { fraction } else { -1.0 };
        if (cx.progress)(fraction, &self.at) == Flow::Stop && watch.asked.is_none() {
            self.output.cancel().store(1, Relaxed);
            watch.asked = Some(Instant::now());
            self.is_asked_to_stop = true;
        }
        let is_too_long = silent > watch.at_most;
        let is_spared = || std::env::var_os("HONAMI_NO_WATCHDOG").is_some() || self.process.is_traced();
        let silence = (silent >= self.limits.tell).then(|| Silence {
            since: silent,
            is_too_long,
            at_most: watch.at_most,
            is_spared: is_spared(),
        });
        let is_to_end = match (cx.silent)(silence) {
            Patience::Usual => is_too_long,
            Patience::Wait => false,
            Patience::End => silence.is_some(),
        };
        // What is aborted may take a while to end; it is gone when it must have stopped.
        let to_end = ABORT.min(self.limits.stop / 3);
        let to_stop = self.limits.stop.saturating_sub(to_end);
        let is_late = watch.asked.map_or(is_to_end, |asked| asked.elapsed() > to_stop);
        if !is_late || is_spared() {
            return None;
        }
        self.process.signal(Signal::ABORT);
        self.process.ends_within(if watch.asked.is_some() { to_end } else { ABORT });
        self.process.kill();
        Some(if watch.asked.is_some() { Ended::Stopped } else { Ended::Silent(silent.as_secs()) })
    }
}
