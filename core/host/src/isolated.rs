//! Plugins in a process of their own: what they do there cannot hurt this one.
#![allow(unsafe_code, reason = "results are copied to where the reply has made room")]

mod process;

pub use process::Ended;

use crate::context::{CallContext, Flow, Level};
use crate::error::{Code, HostError};
use crate::instance::{Instance, Request};
use crate::plain::plain;
use crate::plughost;
use crate::registry::PluginInfo;
use crate::reply::{Reply, Schema};
use crate::wire::memory::{Outbox, Output};
use crate::wire::{self, Answer, Ask, Columns, Refusal, Tell};
use honami_abi::{code, dtype};
pub(crate) use process::MEMORY;
use process::Process;
use rustix::process::Signal;
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering::Relaxed;
use std::time::{Duration, Instant};

/// How often the host looks whether the user wants to stop,
const TICK: Duration = Duration::from_millis(20);
/// and after how many lines at the latest, however quickly they come.
const LINES_A_LOOK: usize = 256;
/// So many pieces of what it has printed are read after its end.
const LAST_PRINTS: usize = 64;
/// No answer of a process takes more: it may name any number of rows, and each costs memory here.
const ANSWER_BYTES_MAX: usize = 1 << 30;

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

/// After an abort, which leaves a trace for the plugin's author, it is killed.
const ABORT: Duration = Duration::from_secs(1);

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

/// Starts a process for a plugin of the library that the store keeps at `copy`.
pub(crate) fn create(
    info: &PluginInfo,
    copy: &Path,
    read: Vec<PathBuf>,
    limits: Limits,
    cx: &CallContext<'_>,
) -> Result<(Box<dyn Instance>, String), HostError> {
    let program = program()?;
    let failed = |what: &str, error: io::Error| HostError::File {
        path: program.clone(),
        why: format!("{what} for {}: {error}", info.id),
    };
    let process = Process::start(&program, &arguments(info, copy, read), limits.memory_bytes)
        .map_err(|error| failed("cannot be started", error))?;
    let memories = Outbox::new().and_then(|input| Ok((input, Output::new()?)));
    let (input, output) = memories.map_err(|error| failed("no memory to share", error))?;
    let mut made = Isolated {
        process,
        input,
        output,
        limits,
        at: String::new(),
        last_words: String::new(),
        sandbox: "none".to_owned(),
        is_asked_to_stop: false,
    };
    let hello = Ask::Hello { honami: wire::VERSION, plugin: info.id.clone() };
    match made
        .say(&hello)
        .and_then(|()| made.listen(cx, limits.start))
        .map_err(|error| failed("does not answer", error))?
    {
        Heard::Answer(_) => {
            let sandbox = made.sandbox.clone();
            Ok((Box::new(made), sandbox))
        }
        Heard::Refusal(refusal) => Err(refused(info, refusal)),
        Heard::End(Ended::Stopped) => Err(HostError::Cancelled { plugin: info.id.clone() }),
        Heard::End(how) => Err(HostError::Ended {
            plugin: info.id.clone(),
            function: "create",
            frame: None,
            how,
            last_words: made.last_words,
        }),
    }
}

/// What the process is told: its library, or the folder of its program and how that is started; then what it may read.
fn arguments(info: &PluginInfo, copy: &Path, read: Vec<PathBuf>) -> Vec<OsString> {
    let mut args = Vec::new();
    if !info.exec.is_empty() {
        args.push(plughost::EXEC.into());
        args.push(info.exec.len().to_string().into());
        args.extend(info.exec.iter().map(OsString::from));
    }
    args.push(copy.into());
    args.extend(read.into_iter().map(OsString::from));
    args
}

fn refused(info: &PluginInfo, refusal: Refusal) -> HostError {
    let plugin = info.id.clone();
    match refusal {
        Refusal::Failed { code, text } => {
            HostError::Failed { plugin, function: "create", code: Code(code), text: plain(&text) }
        }
        Refusal::Misbehaved { function, what } => {
            let function = if function == "create" { "create" } else { "get_interface" };
            HostError::Misbehaved { plugin, function, what: plain(&what) }
        }
        Refusal::Unusable { why } => HostError::File { path: info.library.clone(), why: plain(&why) },
    }
}

/// The program that plugins run in: `$HONAMI_PLUGHOST`, or what lies beside this one or was installed with it.
///
/// # Errors
/// [`HostError::File`], when there is none.
pub fn program() -> Result<PathBuf, HostError> {
    const NAME: &str = "honami-plughost";
    if let Some(named) = std::env::var_os("HONAMI_PLUGHOST") {
        return Ok(named.into());
    }
    let folder =
        std::env::current_exe().ok().and_then(|path| path.canonicalize().ok()?.parent().map(Path::to_owned));
    let folder = folder.unwrap_or_default();
    // Tests lie in a folder below the programs.
    let places =
        [folder.join(NAME), folder.join("../libexec/honami").join(NAME), folder.join("..").join(NAME)];
    places.iter().find(|place| place.is_file()).cloned().ok_or_else(|| HostError::File {
        path: places[0].clone(),
        why: "is missing, and plugins that did not come with honami run in it: install it beside honami, or name it in \
              $HONAMI_PLUGHOST"
            .into(),
    })
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

    /// Passes on how far it is, asks whether to go on, and ends what does not live or does not stop.
    fn watch(&mut self, watch: &mut Watch, cx: &CallContext<'_>) -> Option<Ended> {
        let silent = watch.silence(&self.output);
        let fraction = if watch.is_alive { self.output.fraction() } else { -1.0 };
        let words = if silent < self.limits.tell {
            self.at.clone()
        } else {
            format!("{} (no sign of life for {} s)", self.at, silent.as_secs()).trim_start().to_owned()
        };
        if (cx.progress)(fraction, &words) == Flow::Stop && watch.asked.is_none() {
            self.output.cancel().store(1, Relaxed);
            watch.asked = Some(Instant::now());
            self.is_asked_to_stop = true;
        }
        let is_late = watch.asked.map_or(silent > watch.at_most, |asked| asked.elapsed() > self.limits.stop);
        if !is_late || std::env::var_os("HONAMI_NO_WATCHDOG").is_some() || self.process.is_traced() {
            return None;
        }
        self.process.signal(Signal::ABORT);
        let begun = Instant::now();
        while begun.elapsed() < ABORT {
            if self.process.wait(TICK).unwrap_or(true) {
                break;
            }
        }
        self.process.kill();
        Some(if watch.asked.is_some() { Ended::Stopped } else { Ended::Silent(silent.as_secs()) })
    }

    /// Copies committed tables into the reply.
    fn take(&mut self, answer: Answer, schemas: &'static [&'static Schema], reply: &mut Reply) {
        let Answer { code, text, faults, tables } = answer;
        (reply.code, reply.text) = (code, plain(&text));
        reply.faults.extend(faults.iter().map(|fault| plain(fault)));
        for (id, columns) in &tables {
            let schema = schemas.iter().find(|schema| schema.id.to_bytes() == id.as_bytes());
            let taken = match schema {
                Some(schema) => self.copy(schema, columns, reply),
                None => Err(format!("answered with {id:?}, which is no result of this function")),
            };
            if let Err(fault) = taken {
                reply.faults.push(fault);
            }
        }
    }

    fn copy(&mut self, schema: &'static Schema, columns: &Columns, reply: &mut Reply) -> Result<(), String> {
        let id = schema.id.to_string_lossy();
        let known = schema.required.iter().chain(schema.optional);
        let known: Vec<_> = known.filter_map(|column| Some((column, *columns.at.get(column.0)?))).collect();
        if let Some(missing) = schema.required.iter().find(|column| !columns.at.contains_key(column.0)) {
            return Err(format!("answered with {id} without column {:?}", missing.0));
        }
        let rows = usize::try_from(columns.rows)
            .map_err(|_too_many| format!("answered with {} rows", columns.rows))?;
        let row_bytes =
            |column: &crate::reply::ColumnType| dtype::size(column.1).unwrap_or(0) * column.2 as usize;
        let bytes_a_row: usize = known.iter().map(|(column, _)| row_bytes(column)).sum();
        if rows.checked_mul(bytes_a_row).is_none_or(|bytes| bytes > ANSWER_BYTES_MAX) {
            return Err(format!("answered with {rows} rows of {id}, more than 1 GiB"));
        }
        let types = known.iter().map(|(column, _)| (Some(*column), row_bytes(column)));
        let table = reply.slot(schema);
        let starts =
            table.reserve(rows, types).ok_or_else(|| format!("answered with {rows} rows of {id}"))?;
        for ((column, at), start) in known.iter().zip(starts) {
            let n_bytes = rows * row_bytes(column);
            self.output
                .copy(*at, start.cast(), n_bytes)
                .ok_or_else(|| format!("answered with column {:?} of {id} outside its memory", column.0))?;
        }
        table.commit(columns.rows)
    }
}

/// What a request led to.
enum Heard {
    Answer(Answer),
    Refusal(Refusal),
    End(Ended),
}

/// When the plugin last gave a sign of life.
struct Watch {
    beat: u64,
    /// Whether there was one since the request.
    is_alive: bool,
    since: Instant,
    asked: Option<Instant>,
    /// How long it may be silent.
    at_most: Duration,
}

impl Watch {
    fn new(output: &Output, at_most: Duration) -> Self {
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
