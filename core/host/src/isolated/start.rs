//! How a plugin gets into a process of its own.

use super::process::{Ended, Process};
use super::{Heard, Isolated, Limits};
use crate::context::CallContext;
use crate::error::{Code, HostError};
use crate::instance::Instance;
use crate::plain::plain;
use crate::plughost;
use crate::registry::PluginInfo;
use crate::wire::memory::{Outbox, Output};
use crate::wire::{self, Ask, Refusal};
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};

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
        sandbox: None,
        is_asked_to_stop: false,
    };
    let hello = Ask::Hello { honami: wire::VERSION, plugin: info.id.clone() };
    match made
        .greet(&hello)
        .and_then(|()| made.listen(cx, limits.start))
        .map_err(|error| failed("does not answer", error))?
    {
        Heard::Answer(_) => {
            let sandbox = made.sandbox.take().map_or_else(|| "none".to_owned(), |level| plain(&level));
            Ok((Box::new(made), sandbox))
        }
        Heard::Refusal(refusal) => Err(refused(info, refusal)),
        Heard::End(Ended::Stopped) => Err(HostError::Cancelled { plugin: info.id.clone() }),
        Heard::End(how) => Err(HostError::Ended {
            plugin: info.id.clone(),
            function: "create",
            frame: None,
            how,
            last_words: made.take_last_words(),
        }),
    }
}

/// What the process is told: its library, or the folder of its program and how that is started; then what it may read.
fn arguments(info: &PluginInfo, copy: &Path, read: Vec<PathBuf>) -> Vec<OsString> {
    let mut args = Vec::new();
    if !info.exec.is_empty() {
        let flag = if info.needs.exec { plughost::EXEC_AND_OTHERS } else { plughost::EXEC };
        args.push(flag.into());
        args.push(info.exec.len().to_string().into());
        args.extend(info.exec.iter().map(OsString::from));
    }
    args.push(copy.into());
    args.extend(read.into_iter().map(OsString::from));
    if info.is_program() {
        args.extend(info.needs.read.iter().map(OsString::from));
    }
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
