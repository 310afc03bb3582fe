//! How late pictures are seen: from when the clip's clock comes to a frame until the terminal says that it is on screen.

use std::collections::VecDeque;
use std::time::Duration;

/// Pictures that wait for the terminal's answer.
#[derive(Debug, Default)]
pub(super) struct Late {
    /// Which answer says that it is on screen, and when it was due.
    awaited: VecDeque<(u64, Duration)>,
    last: Option<u32>,
}

impl Late {
    /// The picture of a frame, due then, was painted; the `nth` answer acknowledges that. Only the first time counts.
    pub(super) fn painted(&mut self, frame: u32, due: Duration, nth: u64) {
        if self.last.replace(frame) != Some(frame) {
            self.awaited.push_back((nth, due));
        }
    }

    /// So many answers have come by now; how late the last picture was that they acknowledge.
    pub(super) fn answered(&mut self, n: u64, now: Duration) -> Option<Duration> {
        let mut late = None;
        while let Some((_, due)) = self.awaited.pop_front_if(|(nth, _)| *nth <= n) {
            late = Some(now.saturating_sub(due));
        }
        late
    }

    /// Nothing plays: what is on its way does not count.
    pub(super) fn forget(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_late_by_the_answer_to_its_first_paint() {
        let at = Duration::from_millis;
        let mut late = Late::default();
        late.painted(3, at(100), 7);
        late.painted(3, at(100), 8);
        late.painted(4, at(180), 9);
        late.painted(5, at(260), 10);
        assert_eq!(late.answered(6, at(190)), None);
        assert_eq!(late.answered(7, at(200)), Some(at(100)));
        assert_eq!(late.answered(8, at(210)), None, "painted again, exactly");
        assert_eq!(late.answered(10, at(350)), Some(at(90)), "two at once: the later one is seen");
        late.painted(6, at(340), 11);
        late.forget();
        assert_eq!(late.answered(11, at(900)), None);
    }
}
