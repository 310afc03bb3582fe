//! Plugins in a process of their own: what they do there cannot hurt this one.
//!
//! `process.rs` is the process, `start.rs` how a plugin gets into it, `say.rs` how it is asked, `watch.rs` who looks whether it
//! lives, `results.rs` what is taken from it.

mod process;
mod results;
mod say;
mod start;
mod watch;

pub use process::Ended;
pub use start::program;

use crate::context::{CallContext, Level};
use crate::instance::{Instance, Request};
use crate::plain::plain;
use crate::reply::{Reply, Schema};
use crate::wire::memory::{Outbox, Output};
use crate::wire::{self, Answer, Ask, Refusal, Tell};
use honami_abi::code;
pub(crate) use process::MEMORY;
use process::Process;
pub(crate) use start::create;
use std::io;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Duration;
use watch::{ABORT, Watch};

/// How often the host looks whether the user wants to stop,
const TICK: Duration = Duration::from_millis(20);
/// and after how many lines at the latest, however quickly they come.
const LINES_A_LOOK: usize = 256;
/// So many pieces of what it has printed are read after its end.
const LAST_PRINTS: usize = 64;

/// Letters of its last line that are told with its death.
const LAST_WORDS_MAX: usize = 160;

/// What a plugin may take in a process of its own.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// After so long without a sign of life its user is told.
    pub tell: Duration,
    /// After so long it is ended.
    pub end: Duration,
    /// So long it may take to start: an interpreter may have much to import.
    pub start: Duration,
    /// After so long it is ended when it was asked to stop.
    pub stop: Duration,
    /// It is given no more memory than this.
    pub memory_bytes: Option<u64>,
}

impl Limits {
    /// With less memory than this, in bytes, a process does not come as far as its plugin.
    pub const MEMORY_BYTES_MIN: u64 = 64 << 20;

    /// What `$HONAMI_PLUGIN_MEMORY` says: the bytes that a plugin may take, or words that are no such number.
    #[must_use]
    pub fn memory_of_environment() -> Option<Result<u64, String>> {
        let said = std::env::var_os(MEMORY)?;
        let bytes = said.to_str().and_then(|text| text.parse().ok());
        let bytes = bytes.filter(|bytes| *bytes >= Self::MEMORY_BYTES_MIN);
        Some(bytes.ok_or_else(|| said.to_string_lossy().into_owned()))
    }
}

impl Default for Limits {
    fn default() -> Self {
        let [end, start, stop] = [10, 60, 3].map(Duration::from_secs);
        // Within two seconds it is on the screen.
        Self { tell: Duration::from_millis(1_800), end, start, stop, memory_bytes: None }
    }
}

/// An instance of a plugin in a process of its own.
pub(crate) struct Isolated {
    process: Process,
    input: Outbox,
    output: Output,
    limits: Limits,
    /// What the plugin last said that it is at.
    at: String,
    /// The last line that it printed.
    last_words: String,
    /// How far it has shut itself in, once it has said so.
    sandbox: Option<String>,
    /// Whether the user wants the call to stop that is going on.
    is_asked_to_stop: bool,
}

impl Instance for Isolated {
    fn invoke(&mut self, request: &Request<'_>, cx: &CallContext<'_>, reply: &mut Reply) {
        match wire::ask(request, &mut self.input) {
            Some(ask) => self.ask(&ask, request.schemas(), cx, reply),
            None => {
                reply.clear();
                reply.code = code::MEMORY;
                reply.text = "what it is to be given is more than 4 GiB".into();
            }
        }
    }

    fn can_end(&self) -> bool {
        true
    }
}

impl Isolated {
    fn ask(
        &mut self,
        ask: &Ask,
        schemas: &'static [&'static Schema],
        cx: &CallContext<'_>,
        reply: &mut Reply,
    ) {
        reply.clear();
        self.output.cancel().store(0, Relaxed);
        match self.exchange(ask, cx) {
            Ok(Heard::Answer(answer)) => {
                reply.stopped = self.is_asked_to_stop;
                self.take(answer, schemas, reply);
            }
            Ok(Heard::End(how)) => {
                (reply.ended, reply.last_words) = (Some(how), self.take_last_words());
            }
            Ok(Heard::Refusal(_)) => reply.faults.push("its process refuses what it has begun".into()),
            Err(error) => {
                self.process.kill();
                reply.faults.push(format!("its process {error}"));
            }
        }
    }

    /// Says a request and hears what it leads to. It may end already while nobody hears it, or does not listen.
    fn exchange(&mut self, ask: &Ask, cx: &CallContext<'_>) -> io::Result<Heard> {
        self.is_asked_to_stop = false;
        let mut watch = Watch::new(&self.output, self.limits.end);
        if let Some(how) = self.catch_up(&mut watch, cx)? {
            return Ok(Heard::End(how));
        }
        match self.say(ask, &mut watch, cx)? {
            Some(how) => Ok(Heard::End(how)),
            None => self.listen(cx, self.limits.end),
        }
    }

    /// Takes a line apart; an answer is for who has asked.
    fn hear(&mut self, line: &[u8], cx: &CallContext<'_>) -> io::Result<Option<Heard>> {
        let said = serde_json::from_slice(line);
        match said.map_err(|error| io::Error::other(format!("said what nobody understands: {error}")))? {
            Tell::Done(answer) => return Ok(Some(Heard::Answer(answer))),
            Tell::Refused(refusal) => return Ok(Some(Heard::Refusal(refusal))),
            Tell::Log { level, text } => (cx.log)(Level::of(level), &plain(&text)),
            Tell::At { text } => self.at = plain(&text),
            // The first comes before anything of the plugin runs; it could say what it likes afterwards.
            Tell::ShutIn { level } => drop(self.sandbox.get_or_insert(level)),
        }
        Ok(None)
    }

    /// Hears what the process says until it answers or ends.
    fn listen(&mut self, cx: &CallContext<'_>, at_most: Duration) -> io::Result<Heard> {
        let mut watch = Watch::new(&self.output, at_most);
        self.is_asked_to_stop = false;
        let mut has_ended = false;
        loop {
            let mut is_quiet = false;
            for _ in 0..LINES_A_LOOK {
                let Some(line) = self.process.line()? else {
                    is_quiet = true;
                    break;
                };
                if let Some(heard) = self.hear(&line, cx)? {
                    self.overhear(cx);
                    return Ok(heard);
                }
            }
            if has_ended && is_quiet {
                self.overhear_last(cx);
                return self.process.end().map(Heard::End);
            }
            has_ended = self.process.wait(TICK)?;
            if self.process.has_hung_up() && !has_ended {
                has_ended = self.process.ends_within(ABORT);
                if !has_ended {
                    return Err(io::Error::other("hung up"));
                }
            }
            self.overhear(cx);
            if let Some(how) = self.watch(&mut watch, cx) {
                self.overhear_last(cx);
                return Ok(Heard::End(how));
            }
        }
    }

    /// Tells the log what it has printed before it ended, a line that it did not end with it.
    fn overhear_last(&mut self, cx: &CallContext<'_>) {
        for _ in 0..LAST_PRINTS {
            if !self.overhear(cx) {
                break;
            }
        }
        if let Some(line) = self.process.rest() {
            (cx.log)(Level::Info, &line);
            self.last_words = line;
        }
    }

    /// As much of the last line as is kept with a death.
    fn take_last_words(&mut self) -> String {
        let mut line = std::mem::take(&mut self.last_words);
        if let Some((end, _)) = line.char_indices().nth(LAST_WORDS_MAX) {
            line.truncate(end);
            line.push('…');
        }
        line
    }

    /// Tells the log what was printed; whether there was something.
    fn overhear(&mut self, cx: &CallContext<'_>) -> bool {
        let mut has_heard = false;
        for line in self.process.prints() {
            (cx.log)(Level::Info, &line);
            (self.last_words, has_heard) = (line, true);
        }
        has_heard
    }
}

/// What a request led to.
enum Heard {
    Answer(Answer),
    Refusal(Refusal),
    End(Ended),
}
