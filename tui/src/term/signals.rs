//! Signals and other threads, as something that `poll` can wait for.

use std::io::{self, Read as _, Write as _};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGCONT, SIGHUP, SIGINT, SIGTERM, SIGTSTP, SIGWINCH};

/// Wakes the thread that waits in [`Signals`]. Cheap to clone; any thread may call it.
#[derive(Clone, Debug)]
pub struct Waker(Arc<UnixStream>);

impl Waker {
    /// Ends the wait that is going on, or the next one.
    pub fn wake(&self) {
        // A full pipe wakes as well as one more byte; a closed one has nobody to wake.
        drop((&*self.0).write(&[0]));
    }

    /// Something for a thread to hold: when it is dropped, also by a panic, `ended` is set and the screen woken.
    ///
    /// A thread counts as finished only a moment after it has woken anybody: whoever is woken asks `ended`.
    #[must_use]
    pub fn at_end(&self, ended: &Arc<AtomicBool>) -> WakeAtEnd {
        WakeAtEnd(self.clone(), Arc::clone(ended))
    }
}

/// A waker without signals, and what it wakes: a read of the stream ends when it is called.
///
/// # Errors
/// When the system refuses a pipe.
pub fn pair() -> io::Result<(Waker, UnixStream)> {
    let (reader, writer) = UnixStream::pair()?;
    writer.set_nonblocking(true)?;
    Ok((Waker(Arc::new(writer)), reader))
}

/// Sets its flag and wakes when it is dropped.
#[derive(Debug)]
pub struct WakeAtEnd(Waker, Arc<AtomicBool>);

impl Drop for WakeAtEnd {
    fn drop(&mut self) {
        self.1.store(true, Ordering::Release);
        self.0.wake();
    }
}

/// From now on SIGINT and SIGTERM end the program at once, as they do without [`Signals`].
///
/// # Errors
/// When the system refuses a handler.
pub fn end_as_usual() -> io::Result<()> {
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register_conditional_default(signal, Arc::new(AtomicBool::new(true)))?;
    }
    Ok(())
}

/// The signals of a terminal program, counted while it waits for input.
#[derive(Debug)]
pub struct Signals {
    reader: UnixStream,
    waker: Waker,
    seen: Vec<(i32, Arc<AtomicBool>)>,
    ids: Vec<signal_hook::SigId>,
}

impl Signals {
    /// Catches SIGTERM, SIGHUP, SIGINT, SIGTSTP, SIGCONT and SIGWINCH until dropped.
    ///
    /// # Errors
    /// When the system refuses a pipe or a handler.
    pub fn catch() -> io::Result<Self> {
        let (waker, reader) = pair()?;
        reader.set_nonblocking(true)?;
        let mut signals = Self { reader, waker, seen: Vec::new(), ids: Vec::new() };
        for signal in [SIGTERM, SIGHUP, SIGINT, SIGTSTP, SIGCONT, SIGWINCH] {
            let flag = Arc::new(AtomicBool::new(false));
            // The flag first: whoever is woken must find it set.
            signals.ids.push(signal_hook::flag::register(signal, Arc::clone(&flag))?);
            signals.ids.push(signal_hook::low_level::pipe::register(signal, signals.waker.0.try_clone()?)?);
            signals.seen.push((signal, flag));
        }
        Ok(signals)
    }

    /// Something that wakes the waiting thread.
    #[must_use]
    pub fn waker(&self) -> Waker {
        self.waker.clone()
    }

    /// Forgets the wake-ups so far; returns the signals that have come, each once.
    pub fn take(&mut self) -> Vec<i32> {
        let mut bytes = [0; 64];
        while matches!(self.reader.read(&mut bytes), Ok(1..)) {}
        self.seen.iter().filter(|(_, flag)| flag.swap(false, Ordering::Relaxed)).map(|(s, _)| *s).collect()
    }
}

impl AsFd for Signals {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.reader.as_fd()
    }
}

impl Drop for Signals {
    fn drop(&mut self) {
        for id in self.ids.drain(..) {
            signal_hook::low_level::unregister(id);
        }
    }
}
