//! How much the link to the terminal carries, and when the next frame may go.
//!
//! Every frame ends with a query; its answer says that the frame is on screen. The link is modelled as one queue
//! with a constant delay: a frame is served from the moment when it can have arrived or its predecessor was done,
//! whichever is later, until its answer. Bytes over service time is the goodput; the least time from sending to
//! answer is the delay. From both follow the bytes of a frame and how many frames may be on their way.

use std::collections::VecDeque;
use std::time::Duration;

/// Frames are meant to follow each other like this while something moves.
const INTERVAL: Duration = Duration::from_millis(40);
/// No two frames are closer than this.
const MIN_INTERVAL: Duration = Duration::from_millis(16);
/// Part of the goodput that frames may use; the rest drains queues.
const USE: f64 = 0.87;
/// Bytes of a frame, least and most.
const BUDGET: (usize, usize) = (1 << 10, 32 << 10);
/// Bytes of a frame while nothing is known of the link.
const FIRST_BUDGET: usize = 8 << 10;
/// What TCP lets go at once after a pause: ten segments, as Linux begins (RFC 6928), less what ssh adds. Of frames
/// that follow each other within the delay, the second one's rest would wait for the first one's acknowledgement.
const FIRST_BURST: usize = 12_600;
/// A pause after which TCP begins anew, at the earliest: its least time-out.
const PAUSE: Duration = Duration::from_millis(200);
/// Frames on their way, least and most.
const WINDOW: (usize, usize) = (2, 8);
/// Frames smaller than this say nothing about the goodput.
const SAMPLE_MIN: usize = 1 << 10;
/// Goodput is measured over so many frames.
const SAMPLES: usize = 16;
/// A delay measured longer ago than this is measured anew, on an empty queue.
const DELAY_AGE: Duration = Duration::from_secs(60);
/// A terminal that has not answered for this long is silent, or the link is down.
const PATIENCE: Duration = Duration::from_secs(2);
/// After a silence, answers still to come may be to queries given up; no sooner than this are they taken at their word.
const CALM: Duration = Duration::from_secs(1);
/// What a terminal gets whose answers do not say when a frame was seen, bytes per second: 2 Mbit/s carry it.
const RELAYED_RATE: f64 = 180e3;
/// A terminal that has given so many answers to nothing is not to be believed.
const LIES: u32 = 3;
/// What a silent terminal gets, bytes per second.
const SILENT_RATE: f64 = 64.0 * 1024.0;

/// A frame on its way.
#[derive(Clone, Copy, Debug)]
struct Flight {
    sent: Duration,
    n_bytes: usize,
}

/// The link's model. Times count from any fixed instant.
#[derive(Debug, Default)]
pub struct Link {
    flights: VecDeque<Flight>,
    /// Frames that were sent so far.
    n_sent: u64,
    last_sent: Option<Duration>,
    /// Bytes of the frame sent last.
    n_bytes: usize,
    last_answer: Option<Duration>,
    /// Least time from sending to answer, and when it was seen.
    delay: Option<(Duration, Duration)>,
    /// Bytes and service seconds of the latest large frames.
    served: VecDeque<(usize, f64)>,
    /// When sending began after the last pause.
    resumed: Option<Duration>,
    /// Whether the terminal owes an answer that it may never give.
    silent: bool,
    /// Whether an answer may be to a query that was given up: then it says nothing of the link.
    doubtful: bool,
    /// Whether answers do not come from where the frames are seen.
    relayed: bool,
    /// Answers to nothing.
    n_surplus: u32,
}

impl Link {
    /// Answers come from something on this side of the link, such as tmux: it says nothing of what lies behind.
    pub fn relay(&mut self) {
        self.relayed = true;
    }

    /// A frame has been handed to the terminal.
    pub fn sent(&mut self, now: Duration, n_bytes: usize) {
        self.n_sent += 1;
        if self.has_paused(now, PAUSE) {
            self.resumed = Some(now);
        }
        self.doubtful &= self.silent || !self.has_paused(now, CALM);
        self.flights.push_back(Flight { sent: now, n_bytes });
        (self.last_sent, self.n_bytes) = (Some(now), n_bytes);
        if self.silent {
            self.flights.clear();
            self.flights.push_back(Flight { sent: now, n_bytes });
        }
    }

    /// The terminal has answered a frame's query.
    pub fn answered(&mut self, now: Duration) {
        self.silent = false;
        let flight = self.flights.pop_front();
        if flight.is_none() && !self.doubtful {
            self.n_surplus += 1;
            self.relayed |= self.n_surplus >= LIES;
            return;
        }
        let before = self.last_answer.replace(now);
        let Some(flight) = flight.filter(|_| !self.doubtful) else { return };
        let trip = now.saturating_sub(flight.sent);
        if self.delay.is_none_or(|(least, _)| trip <= least) {
            self.delay = Some((trip, now));
        } else if self.delay_is_old(now) && before.is_none_or(|last| last <= flight.sent) {
            // It met an empty queue: what is left of its trip without its own bytes is the delay.
            let own = self.goodput().map_or(0.0, |rate| flight.n_bytes as f64 / rate);
            self.delay = Some((trip.saturating_sub(Duration::from_secs_f64(own)), now));
        }
        if flight.n_bytes >= SAMPLE_MIN {
            let arrived = flight.sent + self.delay.map_or(Duration::ZERO, |(least, _)| least);
            let begun = before.map_or(arrived, |last| last.max(arrived));
            // No terminal takes more than 100 MB/s: a shorter service is a clock's grain.
            let seconds = now.saturating_sub(begun).as_secs_f64().max(flight.n_bytes as f64 / 1e8);
            self.served.push_back((flight.n_bytes, seconds));
            if self.served.len() > SAMPLES {
                self.served.pop_front();
            }
        }
    }

    /// Number of frames that were handed to the terminal so far.
    #[must_use]
    pub fn n_sent(&self) -> u64 {
        self.n_sent
    }

    /// Number of those whose answers have come, or are not waited for any more.
    #[must_use]
    pub fn n_answered(&self) -> u64 {
        self.n_sent - self.flights.len() as u64
    }

    /// Delay there and back of an empty queue; `None` while unknown.
    #[must_use]
    pub fn delay(&self) -> Option<Duration> {
        self.delay.filter(|_| !self.relayed).map(|(least, _)| least)
    }

    /// Bytes per second that the link carries, or is taken to carry where it cannot be measured; `None` while unknown.
    #[must_use]
    pub fn goodput(&self) -> Option<f64> {
        if self.relayed {
            return Some(RELAYED_RATE);
        }
        let (bytes, seconds) = self.served.iter().fold((0.0, 0.0), |(b, s), &(n, t)| (b + n as f64, s + t));
        (!self.served.is_empty()).then(|| bytes / seconds)
    }

    /// Whether the terminal does not answer.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        self.silent
    }

    /// Whether frames are on their way whose answers are still to come.
    #[must_use]
    pub fn is_waiting(&self) -> bool {
        !self.silent && !self.flights.is_empty()
    }

    /// How long the frame that was sent first of those on their way has been so, and the bytes of the last; `None` when
    /// none is.
    #[must_use]
    pub fn on_its_way(&self, now: Duration) -> Option<(Duration, usize)> {
        let (oldest, newest) = self.flights.front().zip(self.flights.back())?;
        Some((now.saturating_sub(oldest.sent), newest.n_bytes))
    }

    /// Whether nothing has been on its way, and nothing has come, for so long.
    fn has_paused(&self, now: Duration, pause: Duration) -> bool {
        let last = self.last_answer.max(self.last_sent);
        self.flights.is_empty() && last.is_none_or(|last| now.saturating_sub(last) >= pause)
    }

    /// Bytes that a frame sent now may have.
    #[must_use]
    pub fn budget_at(&self, now: Duration) -> usize {
        let resumed =
            self.resumed.zip(self.delay()).is_some_and(|(at, delay)| now.saturating_sub(at) < delay);
        let is_far = self.delay().is_some_and(|delay| delay > MIN_INTERVAL);
        let is_first = self.has_paused(now, PAUSE) || resumed;
        if is_far && is_first { self.budget().min(FIRST_BURST / 2) } else { self.budget() }
    }

    /// Bytes that a frame may have once the link is busy.
    #[must_use]
    pub fn budget(&self) -> usize {
        if self.silent {
            return (SILENT_RATE * INTERVAL.as_secs_f64()) as usize;
        }
        match self.goodput() {
            Some(rate) if self.relayed => (rate * INTERVAL.as_secs_f64()) as usize,
            Some(rate) => ((rate * USE * INTERVAL.as_secs_f64()) as usize).clamp(BUDGET.0, BUDGET.1),
            None => FIRST_BUDGET,
        }
    }

    /// Frames that may be on their way at once: as many as fill the delay, and the one being served.
    #[must_use]
    pub fn window(&self) -> usize {
        match (self.goodput(), self.delay()) {
            (Some(rate), Some(delay)) => {
                let frames = 1.0 + rate * delay.as_secs_f64() / self.budget() as f64;
                (frames.ceil() as usize).clamp(WINDOW.0, WINDOW.1)
            }
            _ => WINDOW.0,
        }
    }

    /// When the next frame may go, as far as time alone decides: `None` until an answer comes.
    #[must_use]
    pub fn next_slot(&self, now: Duration) -> Option<Duration> {
        let Some(last) = self.last_sent else { return Some(now) };
        if self.silent {
            let debt = self.flights.back().map_or(0, |f| f.n_bytes) as f64 / SILENT_RATE;
            return Some(last + Duration::from_secs_f64(debt).max(MIN_INTERVAL));
        }
        // A delay grown old is measured on an empty queue: wait until all answers are in.
        let window = if self.delay_is_old(now) { 1 } else { self.window() };
        (self.flights.len() < window).then(|| last + self.service().max(MIN_INTERVAL))
    }

    /// How long the link is taken up by the frame sent last. One that follows sooner would only wait in a queue, where
    /// nothing can overtake it: the next key's picture least of all.
    fn service(&self) -> Duration {
        let seconds = self.goodput().map_or(0.0, |rate| self.n_bytes as f64 / rate);
        Duration::from_secs_f64(seconds)
    }

    fn delay_is_old(&self, now: Duration) -> bool {
        self.delay.is_some_and(|(_, seen)| now.saturating_sub(seen) > DELAY_AGE)
    }

    /// When the terminal must have answered, or be taken for silent.
    #[must_use]
    pub fn deadline(&self) -> Option<Duration> {
        let oldest = self.flights.front().filter(|_| !self.silent)?;
        let since = self.last_answer.map_or(oldest.sent, |answer| answer.max(oldest.sent));
        Some(since + PATIENCE + 10 * self.delay().unwrap_or_default())
    }

    /// Looks at the clock: past the deadline nothing is waited for any more.
    ///
    /// A terminal that has never answered is silent and gets a fixed rate. One that used to answer is asked again
    /// with the next frame: a detached session may have lost the query.
    pub fn check(&mut self, now: Duration) {
        if self.deadline().is_some_and(|deadline| now >= deadline) {
            self.flights.clear();
            (self.silent, self.doubtful) = (true, true);
        }
    }
}

#[cfg(test)]
mod tests;
