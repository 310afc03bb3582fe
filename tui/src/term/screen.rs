//! A terminal session: the device, its signals, what it sends and what it shows, in one `wait` and one `paint`.

use std::io;
use std::path::Path;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use signal_hook::consts::{SIGCONT, SIGHUP, SIGTSTP, SIGWINCH};

use super::capabilities::{Around, Capabilities, Pixels};
use super::colour::Depth;
use super::encode::Frame;
use super::input::{Decoder, Event, Unfinished};
use super::link::Link;
use super::signals::{Signals, Waker};
use super::still::Still;
use super::tty::{self, Tty};
use super::writer::Writer;

/// How long an `ESC` may be the beginning of more: on this machine, and over ssh.
const ESC_DELAY: [Duration; 2] = [Duration::from_millis(10), Duration::from_millis(60)];
/// A sequence of which nothing more has come for so long was cut off. Long enough for a link that stalls: the rest
/// of an answer must not be taken for keys.
const SEQUENCE_PATIENCE: Duration = Duration::from_secs(3);
/// A paste of which nothing more has come for so long is over: its end was lost.
const PASTE_PATIENCE: Duration = Duration::from_secs(1);
/// How long answers still on their way are awaited before the terminal is given back.
const LAST_ANSWERS: Duration = Duration::from_millis(400);

/// A terminal that is ours.
#[derive(Debug)]
pub struct Screen {
    tty: Option<Tty>,
    log: std::path::PathBuf,
    signals: Signals,
    decoder: Decoder,
    writer: Writer,
    esc_delay: Duration,
    /// Whether the mouse is ours.
    mouse: bool,
    /// What is unfinished, and until when more may come of it.
    unfinished: Option<(Unfinished, Duration)>,
    /// The terminal has refused bytes.
    is_gone: bool,
    start: Instant,
}

/// What a wait has brought.
#[derive(Debug, Default)]
pub struct Happened {
    /// What the terminal has sent.
    pub events: Vec<Event>,
    /// The terminal has another size, or was somebody else's for a while: nothing is on it.
    pub resized: bool,
    /// Somebody wants the program stopped for a while.
    pub suspend: bool,
    /// The session is over, and why.
    pub end: Option<End>,
}

/// Why a session ends without its user's wish.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// This signal came.
    Signal(i32),
    /// The terminal is gone.
    Hangup,
}

impl End {
    /// The exit status of a program that this has ended, as shells count it: 128 and the signal.
    #[must_use]
    pub fn status(self) -> u8 {
        let signal = match self {
            Self::Signal(signal) => signal,
            Self::Hangup => SIGHUP,
        };
        u8::try_from(128 + signal).unwrap_or(u8::MAX)
    }
}

impl Screen {
    /// Takes the terminal over and asks it what it can do, without waiting for answers.
    ///
    /// # Errors
    /// When there is no terminal.
    pub fn open(log: &Path) -> io::Result<Self> {
        let var = |name: &str| std::env::var(name).ok();
        // Catch signals before anything needs to be undone.
        let signals = Signals::catch()?;
        let capabilities = Capabilities::new(Around::from_env(var));
        let mut screen = Self {
            tty: None,
            log: log.to_owned(),
            signals,
            decoder: Decoder::default(),
            writer: Writer::new(Depth::from_env(var), capabilities),
            esc_delay: ESC_DELAY[usize::from(var("SSH_CONNECTION").is_some())],
            mouse: true,
            unfinished: None,
            is_gone: false,
            start: Instant::now(),
        };
        screen.enter()?;
        Ok(screen)
    }

    fn enter(&mut self) -> io::Result<()> {
        let now = self.now();
        let tty = self.tty.insert(Tty::enter(&self.log, self.signals.waker())?);
        self.writer.begin(tty, tty::ENTER, now)?;
        self.set_mouse(self.mouse)
    }

    /// Takes the mouse, or leaves it to the terminal, where it selects text.
    ///
    /// # Errors
    /// When the terminal is gone.
    pub fn set_mouse(&mut self, ours: bool) -> io::Result<()> {
        let changed = ours != self.mouse || !ours;
        self.mouse = ours;
        let sent = match &self.tty {
            Some(tty) if changed => self.writer.send(tty, if ours { tty::MOUSE_ON } else { tty::MOUSE_OFF }),
            _ => Ok(()),
        };
        self.unless_gone(sent, ())
    }

    /// Time since the session began.
    #[must_use]
    pub fn now(&self) -> Duration {
        self.start.elapsed()
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> (u16, u16) {
        self.tty.as_ref().map_or((80, 24), Tty::size)
    }

    /// Something with which another thread ends [`wait`](Self::wait).
    #[must_use]
    pub fn waker(&self) -> Waker {
        self.signals.waker()
    }

    /// Lines that others have printed since it was asked last, as they were printed.
    #[must_use]
    pub fn printed(&self) -> Vec<String> {
        self.tty.as_ref().map_or_else(Vec::new, Tty::printed)
    }

    /// Whether the terminal shows no colours.
    #[must_use]
    pub fn is_mono(&self) -> bool {
        self.writer.depth() == Depth::Mono
    }

    /// The colours that the terminal shows.
    #[must_use]
    pub fn depth(&self) -> Depth {
        self.writer.depth()
    }

    /// Width and height of a cell in pixels, where the terminal says.
    #[must_use]
    pub fn cell_px(&self) -> Option<(u16, u16)> {
        self.writer.capabilities().cell_px(self.size())
    }

    /// How pixels get to the terminal, if they do.
    #[must_use]
    pub fn pixels(&self) -> Option<Pixels> {
        self.writer.capabilities().pixels(self.size()).filter(|_| !self.is_mono())
    }

    /// What is known of the link.
    #[must_use]
    pub fn link(&self) -> &Link {
        self.writer.link()
    }

    /// Whether a frame may go now.
    #[must_use]
    pub fn has_slot(&self) -> bool {
        let now = self.now();
        self.writer.next_slot(now).is_some_and(|slot| slot <= now)
    }

    /// Nothing is known of the screen any more; the next frame paints all of it.
    pub fn forget(&mut self) {
        self.writer.forget();
    }

    /// Brings the screen nearer to the frame; returns whether it shows the frame exactly. Needs a free slot.
    ///
    /// # Errors
    /// When the terminal is gone.
    pub fn paint(&mut self, frame: &Frame, moving: bool) -> io::Result<bool> {
        let now = self.now();
        let painted = self.tty.as_ref().map_or(Ok(0), |tty| self.writer.paint(tty, frame, moving, now));
        self.unless_gone(painted.map(|n_wrong| n_wrong == 0), true)
    }

    /// A terminal that is gone takes no bytes: that is no fault, [`wait`](Self::wait) tells of it.
    fn unless_gone<T>(&mut self, sent: io::Result<T>, instead: T) -> io::Result<T> {
        match sent {
            Err(error) if error.raw_os_error() == Some(Errno::IO.raw_os_error()) => {
                self.is_gone = true;
                Ok(instead)
            }
            sent => sent,
        }
    }

    /// Begins to show a still over a frame that is on screen.
    pub fn show_still(&mut self, still: Still, frame: &Frame) {
        self.writer.show_still(still, frame);
    }

    /// Whether a still is there, or is being sent.
    #[must_use]
    pub fn has_still(&self) -> bool {
        self.writer.has_still()
    }

    /// Gives the still up; the next frame takes away what is there of it.
    pub fn drop_still(&mut self) {
        self.writer.drop_still();
    }

    /// Whether pieces of a still wait to be sent.
    #[must_use]
    pub fn is_sending(&self) -> bool {
        self.writer.is_sending()
    }

    /// Sends the next pieces of the still. Needs a free slot.
    ///
    /// # Errors
    /// When the terminal is gone.
    pub fn send_still(&mut self) -> io::Result<()> {
        let now = self.now();
        let sent = self.tty.as_ref().map_or(Ok(()), |tty| self.writer.send_still(tty, now));
        self.unless_gone(sent, ())
    }

    /// Waits until something happens: input, a signal, a wake-up, the time `until`, or (with `for_slot`) a free
    /// slot for a frame.
    ///
    /// # Errors
    /// When the system cannot wait; a terminal that is gone is [`End::Hangup`].
    pub fn wait(&mut self, until: Option<Duration>, for_slot: bool) -> io::Result<Happened> {
        if self.is_gone {
            return Ok(Happened { end: Some(End::Hangup), ..Happened::default() });
        }
        let now = self.now();
        let slot = if for_slot { self.writer.next_slot(now) } else { None };
        let deadline = self.writer.check(now);
        let more = self.unfinished.map(|(_, until)| until);
        let until = [until, slot, deadline, more].into_iter().flatten().min();
        let mut happened = Happened::default();
        let has_read = self.poll(until.map(|t| t.saturating_sub(now)), &mut happened)?;
        for signal in self.signals.take() {
            match signal {
                SIGWINCH => happened.resized = true,
                SIGTSTP => happened.suspend = true,
                SIGCONT if self.resume().is_err() => happened.end = Some(End::Hangup),
                SIGCONT => happened.resized = true,
                SIGHUP => happened.end = Some(End::Hangup),
                _ => happened.end = Some(End::Signal(signal)),
            }
        }
        let now = self.now();
        self.writer.check(now);
        if has_read {
            self.await_more(now);
        } else if self.unfinished.is_some_and(|(_, until)| until <= now) {
            self.unfinished = None;
            self.decoder.flush(&mut happened.events);
        }
        for event in &happened.events {
            if let Event::Reply(reply) = event {
                self.writer.answered(reply, now);
            }
        }
        Ok(happened)
    }

    /// Something was read: what is unfinished now may wait for more.
    fn await_more(&mut self, now: Duration) {
        let before = self.unfinished;
        self.unfinished = self.decoder.unfinished().map(|unfinished| match (unfinished, before) {
            // Whatever is typed into half a sequence gives it no more time.
            (Unfinished::Sequence(_), Some((same, until))) if same == unfinished => (unfinished, until),
            (Unfinished::Sequence(_), _) => (unfinished, now + SEQUENCE_PATIENCE),
            (Unfinished::Escape, _) => (unfinished, now + self.esc_delay),
            (Unfinished::Paste, _) => (unfinished, now + PASTE_PATIENCE),
        });
    }

    /// Waits for the devices; returns whether bytes were read.
    fn poll(&mut self, timeout: Option<Duration>, happened: &mut Happened) -> io::Result<bool> {
        let Some(tty) = &self.tty else { return Ok(false) };
        let timeout = timeout.map(|t| Timespec {
            tv_sec: i64::try_from(t.as_secs()).unwrap_or(i64::MAX),
            tv_nsec: i64::from(t.subsec_nanos()),
        });
        let blocked = if self.writer.is_blocked() { PollFlags::OUT } else { PollFlags::empty() };
        let mut fds = [PollFd::new(tty, PollFlags::IN | blocked), PollFd::new(&self.signals, PollFlags::IN)];
        match poll(&mut fds, timeout.as_ref()) {
            Ok(_) | Err(Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
        let ready = fds[0].revents();
        if ready.contains(PollFlags::OUT) && self.writer.flush(tty).is_err() {
            happened.end = Some(End::Hangup);
        }
        if ready.intersects(PollFlags::IN | PollFlags::HUP | PollFlags::ERR) {
            let mut bytes = [0; 4096];
            match rustix::io::read(tty, &mut bytes) {
                Ok(0) => happened.end = Some(End::Hangup),
                Ok(n) => {
                    self.decoder.feed(&bytes[..n], &mut happened.events);
                    return Ok(true);
                }
                Err(Errno::AGAIN | Errno::INTR) => {}
                Err(_) => happened.end = Some(End::Hangup),
            }
        }
        Ok(false)
    }

    /// Takes the terminal back after somebody else has stopped and continued the program.
    fn resume(&mut self) -> io::Result<()> {
        let now = self.now();
        let Some(tty) = &self.tty else { return Ok(()) };
        tty.set_raw()?;
        self.writer.begin(tty, tty::RESUME, now)?;
        self.set_mouse(self.mouse)
    }

    /// Gives the terminal back, stops the program until it is continued, and takes the terminal again.
    ///
    /// # Errors
    /// When the terminal cannot be taken again.
    pub fn suspend(&mut self) -> io::Result<()> {
        self.close()?;
        signal_hook::low_level::emulate_default_handler(SIGTSTP)?;
        self.signals.take();
        self.enter()
    }

    /// Awaits the answers still on their way, so that they do not end up in the shell; gives the terminal back.
    ///
    /// # Errors
    /// When the system cannot wait.
    pub fn close(&mut self) -> io::Result<()> {
        if let Some(tty) = &self.tty {
            // A terminal that is gone shows no still either.
            self.writer.end_still(tty).ok();
        }
        let until = self.now() + LAST_ANSWERS;
        while self.tty.is_some() && self.link().is_waiting() && self.now() < until {
            if self.wait(Some(until), false)?.end.is_some() {
                break;
            }
        }
        self.tty = None;
        Ok(())
    }
}
