//! The socket to the host.

use crate::wire::Tell;
use rustix::event::{PollFd, PollFlags, poll};
use rustix::net::{RecvAncillaryBuffer, RecvAncillaryMessage, RecvFlags, recvmsg};
use rustix::process::{Signal, kill_current_process_group};
use rustix::stdio::{dup2_stdin, stdin};
use std::fs::File;
use std::io::{self, BufRead as _, BufReader, IoSliceMut, Write as _};
use std::mem::MaybeUninit;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;

/// The first line is no longer than this: it comes in one piece, with the memories.
const HELLO_BYTES: usize = 1 << 12;

pub(super) struct Ear {
    lines: BufReader<UnixStream>,
}

impl Ear {
    /// Takes the socket away from standard input, where the plugin would find it, and hears the first line.
    pub(super) fn of_stdin() -> io::Result<(Self, String, [OwnedFd; 2])> {
        let socket = rustix::io::fcntl_dupfd_cloexec(stdin(), 3)?;
        dup2_stdin(File::open("/dev/null")?)?;
        let mut bytes = [0; HELLO_BYTES];
        let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(2))];
        let mut control = RecvAncillaryBuffer::new(&mut space);
        let n = recvmsg(&socket, &mut [IoSliceMut::new(&mut bytes)], &mut control, RecvFlags::CMSG_CLOEXEC)?
            .bytes;
        let files = control.drain().find_map(|message| match message {
            RecvAncillaryMessage::ScmRights(files) => Some(files.collect::<Vec<_>>()),
            _ => None,
        });
        let memories = files.and_then(|files| <[OwnedFd; 2]>::try_from(files).ok());
        let hello = bytes[..n].strip_suffix(b"\n").and_then(|line| str::from_utf8(line).ok());
        match (hello, memories) {
            (Some(hello), Some(memories)) => {
                Ok((Self { lines: BufReader::new(UnixStream::from(socket)) }, hello.to_owned(), memories))
            }
            _ => Err(io::Error::other("wanted the host's hello and two memories at standard input")),
        }
    }

    /// From now on this process dies with its host, also while the plugin works.
    pub(super) fn end_with_host(&self) -> io::Result<()> {
        let socket = self.lines.get_ref().try_clone()?;
        let wait = move || {
            let mut gone = [PollFd::new(&socket, PollFlags::RDHUP)];
            while poll(&mut gone, None).is_err() || gone[0].revents().is_empty() {}
            kill_current_process_group(Signal::KILL).unwrap_or_default();
        };
        std::thread::Builder::new().name("host".into()).spawn(wait).map(drop)
    }

    /// The next line; `None` when the host has hung up.
    pub(super) fn line(&mut self) -> io::Result<Option<String>> {
        let mut line = String::new();
        Ok((self.lines.read_line(&mut line)? > 0).then_some(line))
    }

    /// Says something to the host, from any thread.
    pub(super) fn tell(&self, what: &Tell) -> io::Result<()> {
        let mut line = serde_json::to_string(what)?;
        line.push('\n');
        // One write a line, under a lock: lines of several threads do not mix.
        let mut socket = self.lines.get_ref();
        let _turn = TURN.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        socket.write_all(line.as_bytes())
    }
}

static TURN: std::sync::Mutex<()> = std::sync::Mutex::new(());
