//! How many pictures are dropped while playing: those that were painted, of those that were due.

use std::time::Duration;

use super::clock::Play;

/// Counted over this long: the figure changes no more often, and a moment's hitch is not one.
const WINDOW: Duration = Duration::from_secs(1);

/// Counts while one and the same playing goes on.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    window: Option<Window>,
    dropped: Option<[u32; 2]>,
}

#[derive(Clone, Copy, Debug)]
struct Window {
    play: Play,
    since: Duration,
    n_due: u64,
    n_shown: u32,
    last: Option<u32>,
}

impl Tally {
    /// The picture of a frame was painted, whole or as far as the link's budget went.
    pub(super) fn painted(&mut self, frame: u32) {
        if let Some(window) = &mut self.window
            && window.last.replace(frame) != Some(frame)
        {
            window.n_shown += 1;
        }
    }

    /// Pictures per second that were shown and that were due in the last second; `None` where all were shown.
    pub(super) fn dropped(&mut self, play: Option<Play>, times_s: &[f64], now: Duration) -> Option<[u32; 2]> {
        let Some(play) = play else {
            *self = Self::default();
            return None;
        };
        let n_due = play.n_due(times_s, now);
        let window = match self.window {
            Some(window) if window.play == play => window,
            _ => {
                self.dropped = None;
                *self.window.insert(Window { play, since: now, n_due, n_shown: 0, last: None })
            }
        };
        let elapsed = now.saturating_sub(window.since);
        if elapsed >= WINDOW {
            let (shown, due) = (window.n_shown, u32::try_from(n_due - window.n_due).unwrap_or(u32::MAX));
            let per_second = |n: u32| (f64::from(n) / elapsed.as_secs_f64()).round() as u32;
            // One that was due at the very end belongs to the next second.
            self.dropped = (shown.saturating_add(1) < due).then(|| [per_second(shown), per_second(due)]);
            self.window = Some(Window { since: now, n_due, n_shown: 0, ..window });
        }
        self.dropped
    }
}

#[cfg(test)]
mod tests;
