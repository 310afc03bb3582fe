//! Plugins that are programs: the process gives up what it must, and becomes the program.

use super::sandbox::{self, Level, Programs};
use crate::wire::Tell;
use rustix::net::{SendFlags, send};
use rustix::stdio::stdin;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::io;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What loads programs for the kernel.
const LOADERS: [&str; 4] = [
    "/lib64/ld-linux-x86-64.so.2",
    "/lib/ld-linux-aarch64.so.1",
    "/lib/ld-musl-x86_64.so.1",
    "/lib/ld-musl-aarch64.so.1",
];

/// Starts a program in place of this one; its own files are in `folder`. Returns only when that is not possible.
pub(super) fn become_it(
    folder: &Path,
    program: &OsStr,
    args: &[OsString],
    mut read: Vec<PathBuf>,
    starts_others: bool,
) -> io::Error {
    let is_bare = Path::new(program).components().count() == 1;
    let Some(mut program) = find(program) else {
        return io::Error::other(format!("there is no program {}", program.display()));
    };
    // Only the interpreter of the user's own search path may say where it imports from: it does so unfettered.
    if is_bare
        && program.file_name().is_some_and(|name| name.to_string_lossy().starts_with("python"))
        && let Some((real, folders)) = python(&program)
    {
        program = real;
        read.extend(folders);
    }
    // A program's libraries lie beside its folder: /opt/it/bin/it, /opt/it/lib.
    let places = [program.canonicalize().ok(), Some(program.clone())];
    read.extend(places.iter().flatten().filter_map(|path| path.parent()?.parent().map(Path::to_owned)));
    // Never all of what is the user's own.
    let home = std::env::var_os("HOME").map(PathBuf::from).unwrap_or_default();
    read.retain(|path| path.parent().is_some() && !home.starts_with(path));
    // A script has an interpreter, which may have another: which, only the kernel knows.
    let is_elf = fs::read(&program).is_ok_and(|bytes| bytes.starts_with(b"\x7fELF"));
    let programs = if starts_others || !is_elf {
        Programs::All
    } else {
        Programs::These(std::iter::once(program.clone()).chain(LOADERS.map(PathBuf::from)).collect())
    };
    let level = sandbox::enter(folder, &read, &programs);
    if let Err(error) = shut_in(level) {
        return error;
    }
    let own = |arg: &OsString| {
        let file = folder.join(arg);
        if file.is_file() { file.into_os_string() } else { arg.clone() }
    };
    Command::new(program)
        .args(args.iter().map(own))
        .env("PYTHONPATH", folder)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .exec()
}

/// A program on the search path of the user, or at its own path.
fn find(program: &OsStr) -> Option<PathBuf> {
    let path = Path::new(program);
    if path.components().count() > 1 {
        return path.is_absolute().then(|| path.to_owned());
    }
    let folders = std::env::var_os("PATH")?;
    std::env::split_paths(&folders).map(|folder| folder.join(program)).find(|place| place.is_file())
}

/// Tells the host before the plugin can tell it anything.
fn shut_in(level: Level) -> io::Result<()> {
    let mut line = serde_json::to_string(&Tell::ShutIn { level: level.word().to_owned() })?;
    line.push('\n');
    let sent = send(stdin(), line.as_bytes(), SendFlags::NOSIGNAL)?;
    if sent == line.len() { Ok(()) } else { Err(io::ErrorKind::WriteZero.into()) }
}

/// The interpreter behind a name, which may be a script that chooses one, and the folders that it imports from.
fn python(program: &Path) -> Option<(PathBuf, Vec<PathBuf>)> {
    let said = Command::new(program)
        // Where nothing lies that could be imported.
        .current_dir("/")
        .args(["-c", "import sys; print(sys.executable, *sys.path, sep='\\n')"])
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .output()
        .ok()?;
    let text = String::from_utf8(said.stdout).ok()?;
    let mut lines = text.lines().map(PathBuf::from).filter(|path| path.is_absolute());
    Some((lines.next()?, lines.collect()))
}
