//! The other side of isolation: one plugin, served to the host at standard input until it hangs up.
//!
//! `honami-plughost` is little more than [`serve`]. The process keeps nothing: it ends with the host, when the
//! host says nothing more, and with the plugin.

mod ear;
mod program;
mod sandbox;

use crate::context::{CallContext, Flow, Level};
use crate::error::HostError;
use crate::in_process;
use crate::instance::Instance;
use crate::isolated::MEMORY;
use crate::registry::{PluginInfo, Registry, SearchPath};
use crate::reply::Reply;
use crate::wire::memory::{Inbox, Output};
use crate::wire::{self, Answer, Ask, Columns, Refusal, Tell};
use ear::Ear;
use sandbox::Programs;
pub(crate) use sandbox::{ROOM, foresee};
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::Ordering::Relaxed;

/// First word of the arguments when the plugin is a program,
pub(crate) const EXEC: &str = "--exec";
/// and when it is one that starts others.
pub(crate) const EXEC_AND_OTHERS: &str = "--exec-and-others";

/// What `honami-plughost` does with its arguments: serves a plugin of a library, or runs a program
/// that does. Returns what the process ends with.
///
/// # Errors
/// When the arguments are not those that a host gives, there is no host at standard input, or it says what nobody
/// understands.
pub fn serve(args: impl Iterator<Item = OsString>) -> io::Result<ExitCode> {
    sandbox::close_inherited();
    let memory = std::env::var(MEMORY).ok().map(|bytes| bytes.parse()).transpose();
    sandbox::limit(memory.map_err(|error| io::Error::other(format!("{MEMORY}: {error}")))?);
    let mut args = args.peekable();
    let mut command = Vec::new();
    let flag = args.next_if(|word| word == EXEC || word == EXEC_AND_OTHERS);
    let starts_others = flag.as_ref().is_some_and(|word| word == EXEC_AND_OTHERS);
    if flag.is_some() {
        let n = args.next().and_then(|n| n.to_str()?.parse().ok()).unwrap_or(0);
        command.extend(args.by_ref().take(n));
    }
    let file = args.next().map(PathBuf::from).ok_or_else(|| {
        io::Error::other("this is the process that plugins run in, and honami starts it: wanted a library")
    })?;
    let read: Vec<PathBuf> = args.map(PathBuf::from).collect();
    match command.split_first() {
        None => serve_library(&file, &read).map(|()| ExitCode::SUCCESS),
        Some((program, args)) => program::run(&file, program, args, read, starts_others),
    }
}

/// Serves a plugin of this library, a copy in the store that the host has vouched for; it may read these files, too.
fn serve_library(library: &Path, read: &[PathBuf]) -> io::Result<()> {
    let (mut ear, hello, [input, output]) = Ear::of_stdin()?;
    let Ask::Hello { honami: wire::VERSION, plugin } = serde_json::from_str(&hello)? else {
        return Err(io::Error::other(format!(
            "wanted the host's hello, version {}, got {hello}",
            wire::VERSION
        )));
    };
    let level = shut_in(library, read).to_owned();
    ear.tell(&Tell::ShutIn { level })?;
    ear.end_with_host()?;
    let (inbox, mut output) = (Inbox::of(&input)?, Output::of(output)?);
    let (info, mut instance) = match make(library, &plugin, &ear, &output) {
        Ok(made) => made,
        Err(error) => return ear.tell(&Tell::Refused(refusal(error))),
    };
    ear.tell(&Tell::Done(Answer::default()))?;
    let mut reply = Reply::default();
    while let Some(line) = ear.line()? {
        let ask: Ask = serde_json::from_str(&line)?;
        let kind_of = |id: &str| info.params.iter().find(|param| param.id == id).map_or(0, |p| p.kind.abi());
        let heard = wire::hear(&ask, &inbox, kind_of, |request| {
            with_listener(&ear, &output, |cx| instance.invoke(request, cx, &mut reply));
        });
        heard.map_err(io::Error::other)?;
        let answer = answer(&mut reply, &mut output)?;
        ear.tell(&Tell::Done(answer))?;
    }
    Ok(())
}

/// Gives up all that a plugin's process gives up before it loads this library: for good, and for this thread and those
/// it starts. How far this system could: `full`, `partial` or `none`.
pub fn shut_in(library: &Path, read: &[PathBuf]) -> &'static str {
    sandbox::enter(library, read, &Programs::Refused).word()
}

fn make(
    library: &Path,
    plugin: &str,
    ear: &Ear,
    output: &Output,
) -> Result<(PluginInfo, Box<dyn Instance>), HostError> {
    let named = SearchPath { named: vec![library.to_owned()], ..SearchPath::default() };
    let registry = Registry::scan_path(&named);
    let info = registry.plugins().iter().find(|info| info.id == plugin).cloned();
    let info = info.ok_or_else(|| HostError::File {
        path: library.to_owned(),
        why: format!("has no plugin {plugin:?}"),
    })?;
    let loaded = in_process::load_copy(&info, library)?;
    let mut made = None;
    with_listener(ear, output, |cx| made = Some(in_process::create(&info, loaded, cx)));
    let instance =
        made.unwrap_or_else(|| Err(HostError::Usage { plugin: plugin.into(), what: "was not made".into() }))?;
    Ok((info, instance))
}

fn refusal(error: HostError) -> Refusal {
    match error {
        HostError::Failed { code, text, .. } => Refusal::Failed { code: code.0, text },
        HostError::Misbehaved { function, what, .. } => {
            Refusal::Misbehaved { function: function.into(), what }
        }
        HostError::File { why, .. } => Refusal::Unusable { why },
        other => Refusal::Unusable { why: other.to_string() },
    }
}

/// Makes a call of which the host hears.
fn with_listener(ear: &Ear, output: &Output, call: impl FnOnce(&CallContext<'_>)) {
    let last = Mutex::new(String::new());
    let progress = |fraction: f64, text: &str| {
        output.beat(fraction);
        let mut last = last.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if *last != text {
            text.clone_into(&mut last);
            // A host that is gone ends this process anyway.
            drop(ear.tell(&Tell::At { text: text.to_owned() }));
        }
        if output.cancel().load(Relaxed) == 0 { Flow::Continue } else { Flow::Stop }
    };
    let log = |level: Level, text: &str| {
        output.beat(output.fraction());
        drop(ear.tell(&Tell::Log { level: level as i32, text: text.to_owned() }));
    };
    call(&CallContext { progress: &progress, log: &log, ..CallContext::silent() });
}

/// Lays the committed tables down where the host sees them.
fn answer(reply: &mut Reply, output: &mut Output) -> io::Result<Answer> {
    output.clear();
    let mut answer = Answer {
        code: reply.code,
        text: std::mem::take(&mut reply.text),
        faults: std::mem::take(&mut reply.faults),
        ..Answer::default()
    };
    for table in reply.committed() {
        let mut columns = Columns { rows: table.rows() as u64, ..Columns::default() };
        for (name, bytes) in table.columns() {
            columns.at.insert(name.to_owned(), output.put(bytes)?);
        }
        answer.tables.insert(table.id(), columns);
    }
    Ok(answer)
}
