//! A plugin's own process: how it begins, what it says, and that it ends.

use super::TICK;
use crate::plain::plain;
use crate::plughost::ROOM;
use crate::wire::memory::{Outbox, Output};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{OFlags, fcntl_setfl};
use rustix::io::{Errno, read};
use rustix::net::{
    AddressFamily, SendAncillaryBuffer, SendAncillaryMessage, SendFlags, SocketFlags, SocketType, sendmsg,
    socketpair,
};
use rustix::process::{Pid, PidfdFlags, Signal, kill_process_group, pidfd_open};
use std::ffi::OsString;
use std::io::{self, IoSlice, Write as _};
use std::mem::MaybeUninit;
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::net::UnixStream;
use std::os::unix::process::{CommandExt as _, ExitStatusExt as _};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A process says no longer line than this.
const LINE_BYTES_MAX: usize = 1 << 20;
/// What it prints is read in pieces of this size, so that one that prints without end does not keep the host from all else.
const PRINT_BYTES: usize = 1 << 14;

/// Environment variable with the bytes that the process may take.
pub(crate) const MEMORY: &str = "HONAMI_PLUGIN_MEMORY";

/// How a process ended.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Ended {
    /// By a signal.
    Signal(i32),
    /// By itself.
    Exit(i32),
    /// By the host, after so many seconds without a sign of life.
    Silent(u64),
    /// By the host, because it was asked to stop and did not.
    Stopped,
}

impl Ended {
    /// How a process ended by itself.
    #[must_use]
    pub fn of(status: ExitStatus) -> Self {
        status.signal().map_or_else(|| Self::Exit(status.code().unwrap_or(-1)), Self::Signal)
    }
}

impl std::fmt::Display for Ended {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Silent(seconds) => write!(f, "was ended after {seconds} s without a sign of life"),
            Self::Stopped => f.write_str("was ended because it did not stop"),
            Self::Exit(code) => write!(f, "ended its process with status {code}"),
            Self::Signal(number) => match signal_name(*number) {
                Some((name, words)) => write!(f, "died of {name} ({words})"),
                None => write!(f, "died of signal {number}"),
            },
        }
    }
}

/// Name and meaning of the signals that plugins die of.
fn signal_name(number: i32) -> Option<(&'static str, &'static str)> {
    let known = [
        (Signal::SEGV, "SIGSEGV", "it used memory that is not its own"),
        (Signal::ABORT, "SIGABRT", "it gave up"),
        (Signal::BUS, "SIGBUS", "it used memory that is not there"),
        (Signal::FPE, "SIGFPE", "a division by zero"),
        (Signal::ILL, "SIGILL", "an instruction that this processor does not know"),
        (Signal::KILL, "SIGKILL", "somebody killed it, or memory ran out"),
        (Signal::SYS, "SIGSYS", "it called what it must not call"),
        (Signal::TERM, "SIGTERM", "somebody ended it"),
        (Signal::XCPU, "SIGXCPU", "its time ran out"),
    ];
    known.iter().find(|(signal, ..)| signal.as_raw() == number).map(|(_, name, words)| (*name, *words))
}

/// A process with a plugin, from its start to its end; when it is dropped nothing of it is left.
pub(crate) struct Process {
    child: Child,
    group: Pid,
    pidfd: OwnedFd,
    socket: UnixStream,
    /// What has come of the line that is not whole.
    heard: Vec<u8>,
    /// Whether it says nothing more.
    has_hung_up: bool,
    /// Bytes of `heard` that no newline is in.
    searched: usize,
    prints: OwnedFd,
    /// What has been printed of the line that is not whole.
    printed: Vec<u8>,
    /// Whether it may print more.
    can_print: bool,
    /// Whether it has been waited for.
    is_over: bool,
    /// The folder in which it may write; goes after it.
    _room: TempDir,
}

impl Process {
    /// Starts a program with these arguments in a process group of its own.
    pub(crate) fn start(program: &Path, args: &[OsString], memory_bytes: Option<u64>) -> io::Result<Self> {
        let (ours, theirs) = socketpair(AddressFamily::UNIX, SocketType::STREAM, SocketFlags::CLOEXEC, None)?;
        let (prints, print_to) = rustix::pipe::pipe_with(rustix::pipe::PipeFlags::CLOEXEC)?;
        fcntl_setfl(&prints, OFlags::NONBLOCK)?;
        fcntl_setfl(&ours, OFlags::NONBLOCK)?;
        let room = tempfile::Builder::new().prefix("honami-plugin-").tempdir()?;
        let mut child = Command::new(program)
            .args(args)
            .stdin(Stdio::from(theirs))
            .stdout(Stdio::from(print_to.try_clone()?))
            .stderr(Stdio::from(print_to))
            .process_group(0)
            // Nothing is to be slipped in before the plugin.
            .env_remove("LD_PRELOAD")
            .env_remove("LD_LIBRARY_PATH")
            .env_remove("LD_AUDIT")
            // What is said to this process is this one's to understand.
            .env_remove(MEMORY)
            .env(ROOM, room.path())
            .envs(memory_bytes.map(|bytes| (MEMORY, bytes.to_string())))
            .spawn()?;
        let group = Pid::from_child(&child);
        let pidfd = match pidfd_open(group, PidfdFlags::empty()) {
            Ok(pidfd) => pidfd,
            Err(error) => {
                child.kill()?;
                child.wait()?;
                return Err(error.into());
            }
        };
        let (heard, printed) = (Vec::new(), Vec::new());
        Ok(Self {
            child,
            group,
            pidfd,
            socket: UnixStream::from(ours),
            heard,
            has_hung_up: false,
            searched: 0,
            prints,
            printed,
            can_print: true,
            is_over: false,
            _room: room,
        })
    }

    /// Says the first line, and hands over the memories.
    pub(crate) fn greet(&mut self, line: &str, input: &Outbox, output: &Output) -> io::Result<()> {
        let memories = [input.fd(), output.fd()];
        let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(2))];
        let mut control = SendAncillaryBuffer::new(&mut space);
        control.push(SendAncillaryMessage::ScmRights(&memories));
        let bytes = [IoSlice::new(line.as_bytes())];
        let sent = sendmsg(&self.socket, &bytes, &mut control, SendFlags::NOSIGNAL)?;
        if sent == line.len() { Ok(()) } else { Err(io::ErrorKind::WriteZero.into()) }
    }

    /// Says as much of this as it takes now, in bytes; it never waits.
    pub(crate) fn say(&mut self, left: &[u8]) -> io::Result<usize> {
        loop {
            match self.socket.write(left) {
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Ok(0),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                said => return said,
            }
        }
    }

    /// Waits until it takes more of what is said to it, ends, or so much time has passed; whether it has ended.
    pub(crate) fn wait_to_say(&mut self, at_most: Duration) -> io::Result<bool> {
        let mut wanted = [PollFd::new(&self.socket, PollFlags::OUT), PollFd::new(&self.pidfd, PollFlags::IN)];
        match poll(&mut wanted, Some(&timespec(at_most))) {
            Ok(_) => Ok(!wanted[1].revents().is_empty()),
            Err(Errno::INTR) => Ok(false),
            Err(error) => Err(error.into()),
        }
    }

    /// Waits until it says or prints something, ends, or so much time has passed; whether it has ended. What it said
    /// before that can still be heard.
    pub(crate) fn wait(&mut self, at_most: Duration) -> io::Result<bool> {
        // What is closed would wake the host for ever.
        let prints: &dyn AsFd = if self.can_print { &self.prints } else { &self.pidfd };
        let socket: &dyn AsFd = if self.has_hung_up { &self.pidfd } else { &self.socket };
        let mut wanted =
            [socket, prints, &self.pidfd].map(|file| PollFd::from_borrowed_fd(file.as_fd(), PollFlags::IN));
        match poll(&mut wanted, Some(&timespec(at_most))) {
            Ok(_) => Ok(!wanted[2].revents().is_empty()),
            Err(Errno::INTR) => Ok(false),
            Err(error) => Err(error.into()),
        }
    }

    /// Whether it ends within so much time.
    pub(crate) fn ends_within(&mut self, at_most: Duration) -> bool {
        let begun = Instant::now();
        while begun.elapsed() < at_most {
            if self.wait(TICK).unwrap_or(true) {
                return true;
            }
        }
        false
    }

    /// Whether it has closed its end: it says nothing more, and hears nothing.
    pub(crate) fn has_hung_up(&self) -> bool {
        self.has_hung_up
    }

    /// How it has ended.
    pub(crate) fn end(&mut self) -> io::Result<Ended> {
        // What it has started ends with it; the number of the group is its own until it is waited for.
        self.signal(Signal::KILL);
        let ended = self.child.wait().map(Ended::of)?;
        self.is_over = true;
        Ok(ended)
    }

    /// The next whole line that it has said, if there is one; it never waits.
    ///
    /// # Errors
    /// When a line is longer than any that is meant.
    pub(crate) fn line(&mut self) -> io::Result<Option<Vec<u8>>> {
        loop {
            if let Some(end) = self.heard[self.searched..].iter().position(|byte| *byte == b'\n') {
                let rest = self.heard.split_off(self.searched + end + 1);
                let mut line = std::mem::replace(&mut self.heard, rest);
                line.pop();
                self.searched = 0;
                return Ok(Some(line));
            }
            self.searched = self.heard.len();
            if self.heard.len() > LINE_BYTES_MAX {
                return Err(io::Error::other("said a line without end"));
            }
            let mut piece = [0; 1 << 14];
            match read(&self.socket, &mut piece) {
                Err(Errno::AGAIN) => return Ok(None),
                Ok(0) | Err(Errno::CONNRESET) => {
                    self.has_hung_up = true;
                    return Ok(None);
                }
                Ok(n) => self.heard.extend_from_slice(&piece[..n]),
                Err(Errno::INTR) => {}
                Err(error) => return Err(error.into()),
            }
        }
    }

    /// Whole lines that it has printed, without what moves a cursor or colours a screen; never more than a piece at once.
    pub(crate) fn prints(&mut self) -> Vec<String> {
        let mut piece = [0; PRINT_BYTES];
        if let Ok(n) = read(&self.prints, &mut piece) {
            self.can_print = n > 0;
            self.printed.extend_from_slice(&piece[..n]);
        }
        let mut lines = Vec::new();
        while let Some(end) = self.printed.iter().position(|byte| *byte == b'\n') {
            let line: Vec<u8> = self.printed.drain(..=end).collect();
            lines.push(plain(&String::from_utf8_lossy(&line[..end])));
        }
        // A line without end is cut.
        if self.printed.len() >= PRINT_BYTES {
            lines.push(plain(&String::from_utf8_lossy(&std::mem::take(&mut self.printed))));
        }
        lines
    }

    /// What it has printed of a line that it did not end.
    pub(crate) fn rest(&mut self) -> Option<String> {
        let rest = std::mem::take(&mut self.printed);
        (!rest.is_empty()).then(|| plain(&String::from_utf8_lossy(&rest)))
    }

    /// Whether a debugger holds it, or the program that it has started.
    pub(crate) fn is_traced(&self) -> bool {
        let pid = self.group.as_raw_nonzero().to_string();
        let started = std::fs::read_to_string(format!("/proc/{pid}/task/{pid}/children"));
        let started = started.unwrap_or_default();
        std::iter::once(pid.as_str()).chain(started.split_whitespace()).any(|pid| {
            let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
            let tracer = status.lines().find_map(|line| line.strip_prefix("TracerPid:"));
            tracer.is_some_and(|pid| pid.trim() != "0")
        })
    }

    /// Sends a signal to it and to all that it has started.
    pub(crate) fn signal(&self, signal: Signal) {
        // One that has ended already hears nothing, and needs not.
        kill_process_group(self.group, signal).unwrap_or_default();
    }

    /// Kills it, and waits for its end.
    pub(crate) fn kill(&mut self) -> Ended {
        self.end().unwrap_or(Ended::Signal(Signal::KILL.as_raw()))
    }
}

fn timespec(time: Duration) -> Timespec {
    Timespec { tv_sec: time.as_secs() as i64, tv_nsec: i64::from(time.subsec_nanos()) }
}

impl Drop for Process {
    fn drop(&mut self) {
        if !self.is_over {
            self.kill();
        }
    }
}

#[cfg(test)]
mod tests;
