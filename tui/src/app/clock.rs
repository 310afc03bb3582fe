//! Which frame a clip that plays has come to: the clock decides, and pictures that come late are dropped.
//!
//! The times of the frames count, so clips of varying frame rate play as they were taken.

use std::time::Duration;

/// Clip times closer than this are one, seconds.
const GRAIN_S: f64 = 1e-9;

/// Playing on to the end, or there and back in a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Play {
    /// Seconds of the clip per second, negative backwards.
    pub rate: f64,
    /// When it began.
    pub since: Duration,
    /// Frame from which it began; the middle of a loop.
    pub from: u32,
    /// A loop reaches this many frames to both sides, as far as there are any.
    pub around: Option<u32>,
}

impl Play {
    /// The frame to be shown, for the times of all frames in seconds, rising, at least one.
    #[must_use]
    pub fn frame(&self, times_s: &[f64], now: Duration) -> u32 {
        let frame = match self.around {
            None => self.straight(times_s, now),
            Some(_) => {
                let turn = Turn::of(self, times_s);
                turn.frame(turn.events_before(turn.phase_s(self, now)).0)
            }
        };
        u32::try_from(frame).unwrap_or(u32::MAX)
    }

    /// When the next frame is due; `None` at the end.
    #[must_use]
    pub fn next(&self, times_s: &[f64], now: Duration) -> Option<Duration> {
        let ahead_s = match self.around {
            None => {
                let here = self.straight(times_s, now);
                let next = if self.rate >= 0.0 { here + 1 } else { here.checked_sub(1)? };
                (times_s.get(next)? - times_s[self.first(times_s)]) / self.rate
            }
            Some(_) => {
                let turn = Turn::of(self, times_s);
                let phase_s = turn.phase_s(self, now);
                (turn.next_event_s(phase_s)? - turn.start_s(self)) / self.rate.abs()
            }
        };
        // Rounded up: at that time the frame is due.
        Some(self.since + Duration::from_secs_f64(ahead_s.max(0.0)) + Duration::from_nanos(1))
    }

    /// When the clock comes to a frame of playing straight on.
    #[must_use]
    pub fn due(&self, times_s: &[f64], frame: u32) -> Option<Duration> {
        let ahead_s = (times_s.get(frame as usize)? - times_s[self.first(times_s)]) / self.rate;
        let ahead = Duration::try_from_secs_f64(ahead_s.max(0.0)).ok()?;
        self.around.is_none().then_some(self.since + ahead)
    }

    /// Number of frames that have become due since the beginning.
    #[must_use]
    pub fn n_due(&self, times_s: &[f64], now: Duration) -> u64 {
        match self.around {
            None => self.straight(times_s, now).abs_diff(self.first(times_s)) as u64,
            Some(_) => {
                let turn = Turn::of(self, times_s);
                let count = |phase_s| {
                    let (events, turns) = turn.events_before(phase_s);
                    turns * 2 * (turn.times_s.len() as u64 - 1) + events as u64
                };
                count(turn.phase_s(self, now)) - count(turn.start_s(self))
            }
        }
    }

    /// The frames of the loop.
    #[must_use]
    pub fn loop_frames(&self, n_frames: u32) -> Option<std::ops::RangeInclusive<u32>> {
        let around = self.around?;
        Some(self.from.saturating_sub(around)..=self.from.saturating_add(around).min(n_frames.max(1) - 1))
    }

    fn first(&self, times_s: &[f64]) -> usize {
        (self.from as usize).min(times_s.len().saturating_sub(1))
    }

    fn elapsed_s(&self, now: Duration) -> f64 {
        now.saturating_sub(self.since).as_secs_f64() * self.rate
    }

    fn straight(&self, times_s: &[f64], now: Duration) -> usize {
        let t_s = times_s[self.first(times_s)] + self.elapsed_s(now);
        // The frame on screen at a time is the last that has begun; backwards, the first still to end.
        let begun = times_s.partition_point(|&t| t <= t_s + GRAIN_S);
        let ahead = times_s.partition_point(|&t| t < t_s - GRAIN_S);
        let frame = if self.rate >= 0.0 { begun.saturating_sub(1) } else { ahead };
        frame.min(times_s.len() - 1)
    }
}

/// One way there and back over the frames of a loop. A phase is clip time since its first frame.
struct Turn<'a> {
    first: usize,
    times_s: &'a [f64],
}

impl<'a> Turn<'a> {
    fn of(play: &Play, times_s: &'a [f64]) -> Self {
        let n = u32::try_from(times_s.len()).unwrap_or(u32::MAX);
        let frames = play.loop_frames(n).unwrap_or(0..=0);
        let (first, last) = (*frames.start() as usize, *frames.end() as usize);
        Self { first: first.min(last), times_s: &times_s[first.min(last)..=last] }
    }

    /// How long one way takes.
    fn way_s(&self) -> f64 {
        self.times_s[self.times_s.len() - 1] - self.times_s[0]
    }

    /// Where it begins: at the middle, forwards; backwards is the same on the way back.
    fn start_s(&self, play: &Play) -> f64 {
        let there =
            self.times_s[(play.from as usize - self.first).min(self.times_s.len() - 1)] - self.times_s[0];
        if play.rate >= 0.0 { there } else { 2.0 * self.way_s() - there }
    }

    /// The phase, not wrapped.
    fn phase_s(&self, play: &Play, now: Duration) -> f64 {
        self.start_s(play) + play.elapsed_s(now).abs()
    }

    /// Phases within one turn at which another frame begins: there, then back.
    fn events_s(&self) -> impl Iterator<Item = f64> + '_ {
        let (start, end) = (self.times_s[0], self.times_s[self.times_s.len() - 1]);
        let there = self.times_s.iter().skip(1).map(move |t| t - start);
        let back = self.times_s.iter().rev().skip(1).map(move |t| 2.0 * end - start - t);
        there.chain(back)
    }

    /// Frames begun in the turn of a phase, and turns before it.
    fn events_before(&self, phase_s: f64) -> (usize, u64) {
        let turn_s = 2.0 * self.way_s();
        if turn_s <= 0.0 {
            return (0, 0);
        }
        let turns = ((phase_s + GRAIN_S) / turn_s).floor();
        let within = phase_s - turns * turn_s;
        (self.events_s().take_while(|event| *event <= within + GRAIN_S).count(), turns as u64)
    }

    /// The next phase at which another frame begins; `None` for a loop of one frame.
    fn next_event_s(&self, phase_s: f64) -> Option<f64> {
        let turn_s = 2.0 * self.way_s();
        let (events, turns) = self.events_before(phase_s);
        Some(turns as f64 * turn_s + self.events_s().nth(events)?)
    }

    fn frame(&self, events: usize) -> usize {
        let last = self.times_s.len() - 1;
        self.first + if events <= last { events } else { 2 * last - events.min(2 * last) }
    }
}

/// A rate in words: `½x`, `2x`, `30 %`; empty for real time.
#[must_use]
pub fn rate_words(percent: u32) -> String {
    match percent {
        100 => String::new(),
        25 => "¼x".to_owned(),
        50 => "½x".to_owned(),
        75 => "¾x".to_owned(),
        percent if percent.is_multiple_of(100) => format!("{}x", percent / 100),
        percent => format!("{percent} %"),
    }
}

#[cfg(test)]
mod tests;
