//! Plugins in a process of their own: what they do there cannot hurt this one.
//!
//! `process.rs` is the process, `start.rs` how a plugin gets into it, `watch.rs` who looks whether it lives, `results.rs`
//! what is taken from it.

mod process;
mod results;
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
use watch::Watch;

/// How often the host looks whether the user wants to stop,
const TICK: Duration = Duration::from_millis(20);
/// and after how many lines at the latest, however quickly they come.
const LINES_A_LOOK: usize = 256;
/// So many pieces of what it has printed are read after its end.
const LAST_PRINTS: usize = 64;

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

impl Default for Limits {
    fn default() -> Self {
        let [tell, end, start, stop] = [2, 10, 60, 3].map(Duration::from_secs);
        Self { tell, end, start, stop, memory_bytes: None }
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
    /// How far it has shut itself in.
    sandbox: String,
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
        let ended = self.say(ask).and_then(|()| self.listen(cx, self.limits.end));
        match ended {
            Ok(Heard::Answer(answer)) => {
                reply.stopped = self.is_asked_to_stop;
                self.take(answer, schemas, reply);
            }
            Ok(Heard::End(how)) => {
                (reply.ended, reply.last_words) = (Some(how), std::mem::take(&mut self.last_words));
            }
            Ok(Heard::Refusal(_)) => reply.faults.push("its process refuses what it has begun".into()),
            Err(error) => {
                self.process.kill();
                reply.faults.push(format!("its process {error}"));
            }
        }
    }

    fn say(&mut self, ask: &Ask) -> io::Result<()> {
        let mut line = serde_json::to_string(ask)?;
        line.push('\n');
        let said = match ask {
            Ask::Hello { .. } => self.process.greet(&line, &self.input, &self.output),
            _ => self.process.say(&line),
        };
        match said {
            // It has ended: how, `listen` hears.
            Err(error)
                if matches!(error.kind(), io::ErrorKind::BrokenPipe | io::ErrorKind::ConnectionReset) =>
            {
                Ok(())
            }
            said => said,
        }
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
                match serde_json::from_slice(&line) {
                    Ok(Tell::Done(answer)) => {
                        self.overhear(cx);
                        return Ok(Heard::Answer(answer));
                    }
                    Ok(Tell::Refused(refusal)) => return Ok(Heard::Refusal(refusal)),
                    Ok(Tell::Log { level, text }) => (cx.log)(Level::of(level), &plain(&text)),
                    Ok(Tell::At { text }) => self.at = plain(&text),
                    Ok(Tell::ShutIn { level }) => self.sandbox = plain(&level),
                    Err(error) => {
                        return Err(io::Error::other(format!("said what nobody understands: {error}")));
                    }
                }
            }
            if has_ended && is_quiet {
                for _ in 0..LAST_PRINTS {
                    if !self.overhear(cx) {
                        break;
                    }
                }
                return self.process.end().map(Heard::End);
            }
            has_ended = self.process.wait(TICK)?;
            self.overhear(cx);
            if let Some(how) = self.watch(&mut watch, cx) {
                return Ok(Heard::End(how));
            }
        }
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
