//! When a picture is painted roughly, as one of many, and when it is refined until it is exact.
//!
//! A picture that follows another within a moment is likely to be followed by a third: bytes spent on refining it would
//! stand in that one's way. So a new picture is painted for as many bytes as a frame may have, with colours near the
//! wanted, and refined once no other has come for longer than they came apart; a single picture soon.

use std::time::Duration;

use super::layout::Lens;

/// Pictures further apart than this are single ones.
const APART: Duration = Duration::from_millis(150);
/// A single picture may be the first of many: a held key repeats after so long. TCP begins anew after a pause, with
/// room for little more than two pictures: a refinement would take the second one's.
const REPEAT: Duration = Duration::from_millis(45);
/// Another picture is expected for this much longer than the last two came apart.
const LONGER: f64 = 1.25;

/// Remembers which pictures were painted, and when.
#[derive(Debug, Default)]
pub(super) struct Pace {
    /// Frame and lens of the picture on screen, and when it was first painted.
    painted: Option<(u32, Lens, Duration)>,
    /// Until then another picture is expected.
    busy_until: Duration,
}

impl Pace {
    /// Whether a picture is painted as one of many: it is new, or another is expected.
    pub(super) fn is_moving(&self, now: Duration, picture: Option<(u32, Lens)>) -> bool {
        let known = self.painted.map(|(frame, lens, _)| (frame, lens));
        picture != known || now < self.busy_until
    }

    /// A picture has been painted.
    pub(super) fn painted(&mut self, now: Duration, (frame, lens): (u32, Lens)) {
        let apart = match self.painted {
            Some((known, seen, _)) if (known, seen) == (frame, lens) => return,
            Some((_, _, since)) if now.saturating_sub(since) < APART => (now - since).mul_f64(LONGER),
            _ => REPEAT,
        };
        self.busy_until = now + apart;
        self.painted = Some((frame, lens, now));
    }

    /// When the picture on screen is refined; `None` when it may be now.
    pub(super) fn rest(&self, now: Duration) -> Option<Duration> {
        Some(self.busy_until).filter(|until| *until > now)
    }
}

#[cfg(test)]
mod tests {
    use ratatui::layout::Rect;

    use super::*;

    #[test]
    fn single_pictures_are_refined_soon_and_streams_when_they_end() {
        let area = Rect::new(0, 0, 1, 1);
        let lens = Lens { x: 0.0, y: 0.0, width: 1.0, height: 1.0, area, grid: (1, 2) };
        let at = Duration::from_millis;
        // When each picture comes, and until when it is left as it is.
        for (pictures, rest) in
            [(&[0][..], 45), (&[0, 500], 545), (&[0, 40], 90), (&[0, 40, 80, 120], 170), (&[0, 40, 500], 545)]
        {
            let mut pace = Pace::default();
            for (frame, &ms) in (0..).zip(pictures) {
                assert!(pace.is_moving(at(ms), Some((frame, lens))), "a new picture moves");
                pace.painted(at(ms), (frame, lens));
                pace.painted(at(ms + 20), (frame, lens));
            }
            let last = pictures[pictures.len() - 1];
            assert_eq!(pace.rest(at(last)), Some(at(rest)), "{pictures:?}");
            let shown = Some((pictures.len() as u32 - 1, lens));
            assert!(pace.is_moving(at(rest - 1), shown));
            assert!(!pace.is_moving(at(rest), shown));
        }
    }
}
