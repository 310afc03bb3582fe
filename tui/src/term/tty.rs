//! The terminal device: taken over for a session, given back exactly once, whatever happens.
//!
//! The terminal is opened anew (`/dev/tty`), so that non-blocking writes are ours alone and a plugin that prints
//! does not print into the screen: descriptors 1 and 2 are a pipe for the session.

use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::path::Path;
use std::sync::{Mutex, Once, PoisonError};
use std::thread::ThreadId;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags};
use rustix::termios::{self, OptionalActions, Termios};

use super::prints::{Log, Prints};
use super::signals::Waker;

/// Alternate screen, no cursor, mouse presses and drags, bracketed paste, unambiguous Esc where kitty's
/// protocol is spoken.
pub const ENTER: &[u8] = b"\x1b[?1049h\x1b[?25l\x1b[?1000h\x1b[?1002h\x1b[?1006h\x1b[?2004h\x1b[>1u";
/// [`ENTER`] over itself: what it has pushed before, if that is still there, is not there twice.
pub const RESUME: &[u8] = b"\x1b[?1049h\x1b[<u\x1b[?25l\x1b[?1000h\x1b[?1002h\x1b[?1006h\x1b[?2004h\x1b[>1u";
/// Undoes [`ENTER`], and whatever a frame cut in half has left.
pub const LEAVE: &[u8] =
    b"\x1b[?2026l\x1b[<u\x1b[?2004l\x1b[?1006l\x1b[?1002l\x1b[?1000l\x1b[m\x1b[?25h\x1b[?1049l";

/// Mouse presses and drags come to us.
pub const MOUSE_ON: &[u8] = b"\x1b[?1000h\x1b[?1002h\x1b[?1006h";
/// The mouse is the terminal's own.
pub const MOUSE_OFF: &[u8] = b"\x1b[?1006l\x1b[?1002l\x1b[?1000l";

/// How long the terminal has for taking [`LEAVE`].
const LEAVE_WITHIN: Duration = Duration::from_millis(500);

/// What is needed to give the terminal back; in one place, so that only one can take it.
struct Saved {
    device: OwnedFd,
    modes: Termios,
    stdout: Option<OwnedFd>,
    stderr: Option<OwnedFd>,
    owner: ThreadId,
}

static SAVED: Mutex<Option<Saved>> = Mutex::new(None);

/// The terminal while it is ours. Dropping it gives it back.
#[derive(Debug)]
pub struct Tty {
    device: OwnedFd,
    raw: Termios,
    prints: Prints,
}

impl Tty {
    /// Takes the terminal over: raw mode, output of everybody else to [`printed`](Self::printed) and to the log file,
    /// or where that cannot be written to one in the folder for temporary files, or nowhere.
    ///
    /// # Errors
    /// When the process has no terminal.
    pub fn enter(log: &Path, waker: Waker) -> io::Result<Self> {
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC | OFlags::NONBLOCK;
        let device = rustix::fs::open("/dev/tty", flags, Mode::empty()).map_err(|error| {
            let what = "a terminal is wanted, this process has none; for work without one see `honami help`";
            io::Error::new(io::ErrorKind::NotFound, format!("{what} ({error})"))
        })?;
        let modes = termios::tcgetattr(&device)?;
        let spare = rustix::io::fcntl_dupfd_cloexec(&device, 3)?;
        let (pipe, print_to) = rustix::pipe::pipe_with(rustix::pipe::PipeFlags::CLOEXEC)?;
        let prints = Prints::begin(pipe, Log::open_any(log)?, waker)?;
        let stdout = redirect(rustix::stdio::stdout(), || rustix::stdio::dup2_stdout(&print_to))?;
        let stderr = match redirect(rustix::stdio::stderr(), || rustix::stdio::dup2_stderr(&print_to)) {
            Ok(stderr) => stderr,
            Err(error) => {
                stdout.map_or(Ok(()), rustix::stdio::dup2_stdout)?;
                return Err(error);
            }
        };
        let owner = std::thread::current().id();
        *SAVED.lock().unwrap_or_else(PoisonError::into_inner) =
            Some(Saved { device: spare, modes: modes.clone(), stdout, stderr, owner });
        hook_panics();
        let mut raw = modes;
        raw.make_raw();
        let tty = Self { device, raw, prints };
        tty.set_raw()?;
        Ok(tty)
    }

    /// Keys as they are pressed, unseen and unread by the system.
    ///
    /// # Errors
    /// When the terminal is gone.
    pub fn set_raw(&self) -> io::Result<()> {
        Ok(termios::tcsetattr(&self.device, OptionalActions::Now, &self.raw)?)
    }

    /// Lines that were printed by others since it was asked last, as they were printed; none where output goes to files.
    #[must_use]
    pub fn printed(&self) -> Vec<String> {
        self.prints.take()
    }

    /// Columns and rows; 80x24 where the terminal does not say.
    #[must_use]
    pub fn size(&self) -> (u16, u16) {
        match termios::tcgetwinsize(&self.device) {
            Ok(size) if size.ws_col > 0 && size.ws_row > 0 => (size.ws_col, size.ws_row),
            _ => (80, 24),
        }
    }
}

impl AsFd for Tty {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.device.as_fd()
    }
}

impl Drop for Tty {
    fn drop(&mut self) {
        restore();
        self.prints.end();
    }
}

/// Gives the terminal back; does nothing the second time.
pub fn restore() {
    let saved = SAVED.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let Some(saved) = saved {
        saved.restore();
    }
}

impl Saved {
    /// Best effort: a terminal that is gone takes nothing back, and there is nobody to tell.
    fn restore(self) {
        write_all(&self.device, LEAVE, LEAVE_WITHIN);
        // Flush: answers to queries still on their way must not end up in the shell.
        termios::tcsetattr(&self.device, OptionalActions::Flush, &self.modes).ok();
        if let Some(stdout) = self.stdout {
            rustix::stdio::dup2_stdout(stdout).ok();
        }
        if let Some(stderr) = self.stderr {
            rustix::stdio::dup2_stderr(stderr).ok();
        }
    }
}

/// Writes to a non-blocking descriptor for as long as it takes something within `patience`.
fn write_all(fd: &OwnedFd, mut bytes: &[u8], patience: Duration) {
    let patience = Timespec { tv_sec: 0, tv_nsec: i64::from(patience.subsec_nanos()) };
    while !bytes.is_empty() {
        match rustix::io::write(fd, bytes) {
            Ok(n) => bytes = &bytes[n..],
            Err(rustix::io::Errno::INTR) => {}
            Err(rustix::io::Errno::AGAIN) => {
                let mut fds = [PollFd::new(fd, PollFlags::OUT)];
                if !matches!(poll(&mut fds, Some(&patience)), Ok(1..)) {
                    return;
                }
            }
            Err(_) => return,
        }
    }
}

/// Points a standard descriptor elsewhere if it is a terminal; returns the old one.
fn redirect(
    fd: BorrowedFd<'_>,
    point: impl FnOnce() -> rustix::io::Result<()>,
) -> io::Result<Option<OwnedFd>> {
    if !termios::isatty(fd) {
        return Ok(None);
    }
    let old = rustix::io::fcntl_dupfd_cloexec(fd, 3)?;
    point()?;
    Ok(Some(old))
}

/// From now on a panic of the thread that holds the terminal gives it back before it is reported.
///
/// A panic of another thread is a failed job: its report goes to the log, the screen stays.
fn hook_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let report = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            let is_ours = SAVED
                .try_lock()
                .is_ok_and(|saved| saved.as_ref().is_some_and(|s| s.owner == std::thread::current().id()));
            if is_ours {
                restore();
            }
            report(info);
        }));
    });
}
