//! Time: it goes on by the clock while something plays, and begins anew after the last frame.

/// Where in a motion one is.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Player {
    /// Whether it goes on.
    pub(super) is_playing: bool,
    /// Times of frames, seconds from the first.
    times: Vec<f64>,
    now: f64,
}

impl Player {
    /// At the first frame.
    pub(super) fn new(times: Vec<f64>) -> Self {
        Self { is_playing: false, times, now: 0.0 }
    }

    /// Other frames, as near as may be to where it was.
    pub(super) fn take(&mut self, times: Vec<f64>) {
        self.times = times;
        self.now = self.now.min(self.last());
    }

    /// Seconds from the first frame.
    pub(super) fn now(&self) -> f64 {
        self.now
    }

    /// The row of the frame that is shown: the last that has begun.
    pub(super) fn row(&self) -> usize {
        self.times.partition_point(|time| *time <= self.now).saturating_sub(1)
    }

    /// Frames.
    pub(super) fn n_frames(&self) -> usize {
        self.times.len()
    }

    /// Goes to a frame, the last at most.
    pub(super) fn go(&mut self, row: usize) {
        self.now = self.times.get(row).copied().unwrap_or_else(|| self.last());
    }

    /// So many seconds have gone.
    pub(super) fn tick(&mut self, seconds: f64) {
        if !self.is_playing {
            return;
        }
        // The last frame is shown as long as the one before.
        let step = self.times.windows(2).last().map_or(1.0, |pair| pair[1] - pair[0]);
        self.now += seconds;
        if self.now >= self.last() + step {
            self.now = 0.0;
        }
    }

    fn last(&self) -> f64 {
        self.times.last().copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::Player;

    #[test]
    fn time_goes_on_while_something_plays_and_begins_anew() {
        let mut player = Player::new(vec![0.0, 0.1, 0.3]);
        player.tick(5.0);
        assert_eq!(player.row(), 0, "it stands");
        player.is_playing = true;
        let mut rows = Vec::new();
        for _ in 0..6 {
            player.tick(0.09);
            rows.push(player.row());
        }
        // 0.09, 0.18, 0.27, 0.36, 0.45, and 0.54, which is beyond the 0.2 s of the last.
        assert_eq!(rows, [0, 1, 1, 2, 2, 0]);
        player.go(2);
        assert_eq!(player.row(), 2);
        player.go(9);
        assert_eq!(player.row(), 2);
        player.take(vec![0.0, 0.1]);
        assert_eq!((player.row(), player.n_frames()), (1, 2));
    }
}
