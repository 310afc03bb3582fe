//! Plugins that are programs: the process gives up what it must, starts the program, and sees to it that nothing of it
//! outlives the host.

use super::sandbox::{self, Level, Programs};
use crate::wire::Tell;
use rustix::event::{PollFd, PollFlags, poll};
use rustix::io::Errno;
use rustix::net::{SendFlags, send};
use rustix::process::{
    Pid, PidfdFlags, Signal, getpid, kill_current_process_group, kill_process, pidfd_open,
};
use rustix::stdio::{dup2_stdin, stdin, stdout};
use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io;
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, ExitStatus, Stdio};

/// What loads programs for the kernel.
const LOADERS: [&str; 4] = [
    "/lib64/ld-linux-x86-64.so.2",
    "/lib/ld-linux-aarch64.so.1",
    "/lib/ld-musl-x86_64.so.1",
    "/lib/ld-musl-aarch64.so.1",
];

/// Starts a program, whose own files are in `folder`, and waits for its end, which is then this one's. It gets the socket
/// at standard input, and is in this process's group.
pub(super) fn run(
    folder: &Path,
    program: &OsStr,
    args: &[OsString],
    mut read: Vec<PathBuf>,
    starts_others: bool,
) -> io::Result<ExitCode> {
    let is_bare = Path::new(program).components().count() == 1;
    let Some(mut program) = find(program) else {
        return Err(io::Error::other(format!("there is no program {}", program.display())));
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
    shut_in(level)?;
    let own = |arg: &OsString| {
        let file = folder.join(arg);
        if file.is_file() { file.into_os_string() } else { arg.clone() }
    };
    let child = Command::new(program)
        .args(args.iter().map(own))
        .env("PYTHONPATH", folder)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .spawn()?;
    // The host is to see when the program hangs up.
    dup2_stdin(File::open("/dev/null")?)?;
    // An abort of the group is for the program, which may leave a trace of it.
    dispose(libc::SIGABRT, libc::SIG_IGN);
    let status = wait(child)?;
    Ok(end_as(status))
}

/// Waits for its end; without a host this whole group is killed, with all that the program has started.
fn wait(mut child: Child) -> io::Result<ExitStatus> {
    let over = pidfd_open(Pid::from_child(&child), PidfdFlags::empty())?;
    // The host reads what is printed: a pipe that nobody reads is in error, whatever the program does with the socket.
    let printed = stdout();
    loop {
        let mut wanted =
            [PollFd::from_borrowed_fd(printed, PollFlags::empty()), PollFd::new(&over, PollFlags::IN)];
        match poll(&mut wanted, None) {
            Err(Errno::INTR) => {}
            Err(error) => return Err(error.into()),
            Ok(_) if wanted[0].revents().contains(PollFlags::ERR) => {
                kill_current_process_group(Signal::KILL)?;
            }
            Ok(_) => return child.wait(),
        }
    }
}

/// Ends this process as that one has ended: by the same signal, or with the code that this returns.
fn end_as(status: ExitStatus) -> ExitCode {
    let Some(signal) = status.signal() else {
        return ExitCode::from(status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(1));
    };
    dispose(signal, libc::SIG_DFL);
    if let Some(named) = Signal::from_named_raw(signal) {
        kill_process(getpid(), named).unwrap_or_default();
    }
    // What a shell says of it, for the signals that this process cannot send.
    ExitCode::from(u8::try_from(128 + signal).unwrap_or(1))
}

#[expect(unsafe_code, reason = "there is no safe call for what a signal does")]
fn dispose(signal: libc::c_int, how: libc::sighandler_t) {
    // SAFETY: neither of the two dispositions runs any code of this process.
    unsafe { libc::signal(signal, how) };
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
