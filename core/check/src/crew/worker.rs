//! One check's process, from both sides.

use super::Plan;
use crate::{Check, Finding};
use honami_host::{Ended, plain};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{OFlags, fcntl_setfl};
use rustix::io::{Errno, read};
use rustix::pipe::{PipeFlags, pipe_with};
use rustix::process::{
    Pid, PidfdFlags, Signal, kill_process_group, pidfd_open, set_parent_process_death_signal,
};
use rustix::stdio::{dup2_stdin, stdin};
use std::fs::File;
use std::io::{self, Write as _};
use std::os::fd::{AsFd as _, OwnedFd};
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt as _;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// An answer is no longer.
const ANSWER_BYTES: usize = 1 << 16;
/// Of what a plugin prints so much is kept, from its end.
const PRINT_BYTES: usize = 1 << 12;
/// So many pieces of what it has printed are read after its end.
const LAST_PIECES: usize = 32;

/// The way back to whoever asked for a check.
#[derive(Debug)]
pub struct Asker(UnixStream);

impl Asker {
    /// Takes it from standard input, where the plugin would find it. From now on this process ends with its asker.
    ///
    /// # Errors
    /// When there is none.
    pub fn of_stdin() -> io::Result<Self> {
        set_parent_process_death_signal(Some(Signal::KILL))?;
        let socket = rustix::io::fcntl_dupfd_cloexec(stdin(), 3)?;
        dup2_stdin(File::open("/dev/null")?)?;
        Ok(Self(UnixStream::from(socket)))
    }

    /// Answers.
    ///
    /// # Errors
    /// When nobody is there to hear it.
    pub fn tell(mut self, finding: &Finding) -> io::Result<()> {
        let mut line = serde_json::to_string(finding)?;
        line.push('\n');
        self.0.write_all(line.as_bytes())
    }
}

/// Starts a process for a check, hears its answer, and sees to its end.
pub(super) fn ask(plan: &Plan, check: &Check) -> io::Result<Finding> {
    let (ours, theirs) = UnixStream::pair()?;
    let (prints, print_to) = pipe_with(PipeFlags::CLOEXEC)?;
    ours.set_nonblocking(true)?;
    fcntl_setfl(&prints, OFlags::NONBLOCK)?;
    let child = Command::new(&plan.program)
        .args(["plugin", "check"])
        .arg(&plan.file)
        .args([
            "--plugin-id",
            &plan.plugin,
            "--reproduce",
            &format!("{}:{}", check.id, plan.seed),
            "--answer",
        ])
        .stdin(Stdio::from(OwnedFd::from(theirs)))
        .stdout(Stdio::from(print_to.try_clone()?))
        .stderr(Stdio::from(print_to))
        .process_group(0)
        .env_remove("LD_PRELOAD")
        .env_remove("LD_LIBRARY_PATH")
        .env_remove("LD_AUDIT")
        .spawn()?;
    let mut worker = Worker { child, ours: ours.into(), prints, answer: Vec::new(), printed: Vec::new() };
    let in_time = worker.wait(check.deadline);
    // Whatever happened, nothing of its group stays.
    kill_process_group(Pid::from_child(&worker.child), Signal::KILL).unwrap_or_default();
    let ended = Ended::of(worker.child.wait()?);
    (0..LAST_PIECES).for_each(|_| worker.listen());
    if !in_time? {
        return Ok(Finding::Fails(format!(
            "did not end within {} s{}",
            check.deadline.as_secs(),
            worker.last_words()
        )));
    }
    Ok(worker.finding(&ended))
}

struct Worker {
    child: Child,
    ours: OwnedFd,
    prints: OwnedFd,
    answer: Vec<u8>,
    printed: Vec<u8>,
}

impl Worker {
    /// Listens until it has ended or its time is over; whether it has ended.
    fn wait(&mut self, deadline: Duration) -> io::Result<bool> {
        let pidfd = pidfd_open(Pid::from_child(&self.child), PidfdFlags::empty())?;
        let end = Instant::now() + deadline;
        // A socket or pipe that is closed would wake us for ever.
        let (mut is_heard, mut is_read) = (true, true);
        loop {
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(false);
            }
            let timeout = Timespec { tv_sec: left.as_secs() as i64, tv_nsec: i64::from(left.subsec_nanos()) };
            let ours = if is_heard { self.ours.as_fd() } else { pidfd.as_fd() };
            let prints = if is_read { self.prints.as_fd() } else { pidfd.as_fd() };
            let mut wanted =
                [pidfd.as_fd(), ours, prints].map(|file| PollFd::from_borrowed_fd(file, PollFlags::IN));
            match poll(&mut wanted, Some(&timeout)) {
                Ok(_) | Err(Errno::INTR) => {}
                Err(error) => return Err(error.into()),
            }
            if !wanted[0].revents().is_empty() {
                return Ok(true);
            }
            let closed = [&wanted[1], &wanted[2]].map(|file| {
                file.revents().contains(PollFlags::HUP) && !file.revents().contains(PollFlags::IN)
            });
            (is_heard, is_read) = (is_heard && !closed[0], is_read && !closed[1]);
            self.listen();
        }
    }

    /// Takes a piece of what it has answered and printed, if there is one.
    fn listen(&mut self) {
        let mut piece = [0; 1 << 14];
        if let Ok(n) = read(&self.ours, &mut piece)
            && self.answer.len() < ANSWER_BYTES
        {
            self.answer.extend_from_slice(&piece[..n]);
        }
        if let Ok(n) = read(&self.prints, &mut piece) {
            self.printed.extend_from_slice(&piece[..n]);
            let old = self.printed.len().saturating_sub(PRINT_BYTES);
            self.printed.drain(..old);
        }
    }

    fn finding(&self, ended: &Ended) -> Finding {
        let line = self.answer.split(|byte| *byte == b'\n').next().unwrap_or_default();
        match (serde_json::from_slice(line), ended) {
            (Ok(finding), Ended::Exit(0)) => finding,
            (Ok(Finding::Fails(why)), _) => Finding::Fails(why),
            (Ok(_), ended) => {
                Finding::Fails(format!("all was well, and then it {ended}{}", self.last_words()))
            }
            (Err(_), ended) => Finding::Fails(format!("{ended}{}", self.last_words())),
        }
    }

    fn last_words(&self) -> String {
        let text = String::from_utf8_lossy(&self.printed);
        let last = text.lines().map(plain).rfind(|line| !line.trim().is_empty());
        last.map_or_else(String::new, |line| format!("; it last printed: {line}"))
    }
}
