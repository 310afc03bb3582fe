//! The item of the queue that is being looked at, and what looking at it takes.

use std::sync::Arc;
use std::time::Duration;

use honami_model::judgement::{Effort, Verdict};
use honami_model::track::{Source, Span, Status};
use honami_workbench::review::Item;

use super::state::State;
use super::tracks::TrackRow;

/// Nobody thinks about a sample longer than this without touching a key: the rest is a pause.
const PAUSE: Duration = Duration::from_secs(60);

/// An item that was opened.
#[derive(Clone, Debug, PartialEq)]
pub struct Opened {
    /// The item, as it was then.
    pub item: Item,
    /// The track's samples then.
    span: Arc<Span>,
    keystrokes: u32,
    active: Duration,
    /// When a key was pressed last.
    last: Duration,
}

impl Opened {
    /// Opens an item.
    #[must_use]
    pub fn new(item: Item, row: &TrackRow, now: Duration) -> Self {
        let span = Arc::clone(&row.span);
        Self { item, span, keystrokes: 0, active: Duration::ZERO, last: now }
    }

    /// A key was pressed, or the mouse.
    pub fn pressed(&mut self, now: Duration) {
        let waited = now.saturating_sub(self.last);
        self.active += if waited > PAUSE { Duration::ZERO } else { waited };
        self.keystrokes += 1;
        self.last = now;
    }

    /// What it has taken so far.
    #[must_use]
    pub fn effort(&self, row: &TrackRow) -> Effort {
        let is_new = |frame: &&u32| {
            let now = row.span.get(**frame);
            self.span.get(**frame).is_none_or(|old| old.source != Source::Key || Some(old) != now)
        };
        let key_frames = u32::try_from(row.keys.iter().filter(is_new).count()).unwrap_or(u32::MAX);
        Effort { keystrokes: self.keystrokes, key_frames, seconds: self.active.as_secs_f32() }
    }

    /// What accepting it says: what the samples say of themselves, or whether they were corrected.
    #[must_use]
    pub fn verdict(&self, row: &TrackRow) -> Verdict {
        let all = |wanted: &[Status]| {
            let is_so = |frame| row.span.get(frame).is_none_or(|sample| wanted.contains(&sample.status));
            self.item.frames.clone().all(is_so)
        };
        let frames = || self.item.frames.clone();
        match () {
            () if all(&[Status::Occluded]) => Verdict::Occluded,
            () if all(&[Status::Lost, Status::Outside]) => Verdict::Lost,
            () if row.span.seal(frames()) != self.span.seal(frames()) => Verdict::Fixed,
            () if self.effort(row).key_frames > 0 => Verdict::Fixed,
            () => Verdict::Accepted,
        }
    }
}

impl State {
    /// The item being looked at: as long as its track is the selected one.
    #[must_use]
    pub fn opened(&self) -> Option<&Opened> {
        self.opened.as_ref().filter(|opened| Some(opened.item.track) == self.selected)
    }

    /// The item that the screen speaks of: the opened one, or the worst of the selected track.
    #[must_use]
    pub fn current_item(&self) -> Option<&Item> {
        let worst = || self.review.queue.of_track(self.selected?).next();
        self.opened().map(|opened| &opened.item).or_else(worst)
    }
}
