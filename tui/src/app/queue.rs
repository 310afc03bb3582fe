//! The item of the queue that is being looked at, and what looking at it takes.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

use honami_model::history::EntryId;
use honami_model::judgement::{Effort, Verdict};
use honami_model::track::{Sample, Source, Span, Status, TrackId};
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

    /// A key was pressed while another track was looked at: that is none of its time.
    pub fn waited(&mut self, now: Duration) {
        self.last = now;
    }

    /// Whether the track is no longer as it was when it was opened.
    fn is_worked_on(&self, row: &TrackRow) -> bool {
        !Arc::ptr_eq(&self.span, &row.span) && self.span != row.span
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

    /// What accepting it says: what the samples say of themselves, or how they were corrected.
    #[must_use]
    pub fn verdict(&self, row: &TrackRow) -> Verdict {
        const GONE: [Status; 2] = [Status::Lost, Status::Outside];
        let all = |wanted: &[Status]| {
            let is_so = |frame| row.span.get(frame).is_none_or(|sample| wanted.contains(&sample.status));
            self.item.frames.clone().all(is_so)
        };
        let is =
            |sample: Option<&Sample>, wanted: &[Status]| sample.is_some_and(|s| wanted.contains(&s.status));
        let pairs = || self.item.frames.clone().map(|frame| (self.span.get(frame), row.span.get(frame)));
        let has_become = |wanted: &[Status]| pairs().any(|(then, now)| is(now, wanted) && !is(then, wanted));
        let is_moved = |(then, now): (Option<&Sample>, Option<&Sample>)| {
            then.map(|s| [s.x, s.y]) != now.map(|s| [s.x, s.y])
        };
        match () {
            () if all(&[Status::Occluded]) => Verdict::Occluded,
            () if all(&GONE) => Verdict::Lost,
            // Right up to some frame, and marked as lost from there to the end of the segment.
            () if has_become(&GONE) && pairs().next_back().is_some_and(|(_, now)| is(now, &GONE)) => {
                Verdict::Lost
            }
            () if has_become(&[Status::Occluded]) && !pairs().any(is_moved) => Verdict::Occluded,
            () if pairs().any(|(then, now)| then != now) => Verdict::Fixed,
            () if self.effort(row).key_frames > 0 => Verdict::Fixed,
            () => Verdict::Accepted,
        }
    }
}

/// Items that were opened before the present one.
#[derive(Clone, Debug, Default)]
pub struct Looked {
    /// Those that were left without a verdict, by track and first frame: what they took is not forgotten.
    left: BTreeMap<(TrackId, u32), Opened>,
    /// One that nobody has opened, while its track is looked at.
    visited: Option<Opened>,
    /// The one whose verdict is on its way into the project.
    judging: Option<Opened>,
    /// Those that were judged, by the edits that keep the verdicts.
    judged: BTreeMap<EntryId, Opened>,
}

impl Looked {
    /// An item is left without a verdict.
    pub fn leave(&mut self, opened: Opened) {
        self.left.insert((opened.item.track, opened.item.frames.start), opened);
    }

    /// An item is opened: what was done for it before counts, whether it was left or its track worked on with none open.
    /// By such work it may have become another: then it is the one that lay there.
    #[must_use]
    pub fn open(&mut self, new: Opened, row: &TrackRow) -> Opened {
        let (track, frames) = (new.item.track, new.item.frames.clone());
        let is_it = |old: &Opened| old.item.track == track && overlap(&old.item.frames, &frames);
        if let Some(visited) = self
            .visited
            .take_if(|visited| visited.item.track == track)
            .filter(|visited| visited.is_worked_on(row))
        {
            let visited = self.joined(visited);
            return Opened { item: new.item, last: new.last, ..visited };
        }
        let exact = Some((track, frames.start)).filter(|key| self.left.contains_key(key));
        let lay_there = |(_, old): &(_, &Opened)| is_it(old) && old.is_worked_on(row);
        let key = exact.or_else(|| self.left.iter().find(lay_there).map(|(key, _)| *key));
        match key.and_then(|key| self.left.remove(&key)) {
            Some(left) => Opened { item: new.item, last: new.last, ..left },
            None => new,
        }
    }

    /// The item of the track that is looked at, which nobody has opened.
    #[must_use]
    pub fn visited(&self) -> Option<&Opened> {
        self.visited.as_ref()
    }

    /// A key is pressed while a track is looked at, which has this item. What was done for the one before is kept if its
    /// track, which is `before` now, was worked on; looking at it was passing by.
    pub fn visit(&mut self, before: Option<&TrackRow>, at: Option<(&TrackRow, &Item)>, now: Duration) {
        let goes_on = |visited: &Opened| at.is_some_and(|(row, _)| row.id == visited.item.track);
        if let Some(left) = self.visited.take_if(|visited| !goes_on(visited))
            && before.is_some_and(|row| left.is_worked_on(row))
        {
            let left = self.joined(left);
            self.leave(left);
        }
        if let Some((row, item)) = at {
            self.visited.get_or_insert_with(|| Opened::new(item.clone(), row, now)).pressed(now);
        }
    }

    /// With what was done for the same item on earlier visits.
    fn joined(&mut self, visited: Opened) -> Opened {
        match self.left.remove(&(visited.item.track, visited.item.frames.start)) {
            Some(left) => Opened {
                keystrokes: left.keystrokes + visited.keystrokes,
                active: left.active + visited.active,
                last: visited.last,
                ..left
            },
            None => visited,
        }
    }

    /// A verdict on an item is to be kept.
    pub fn judge(&mut self, opened: Opened) {
        self.judging = Some(opened);
    }

    /// The verdict is kept by this edit.
    pub fn is_kept(&mut self, by: EntryId) {
        if let Some(opened) = self.judging.take() {
            self.judged.insert(by, opened);
        }
    }

    /// The verdict is not kept.
    pub fn is_refused(&mut self) {
        self.judging = None;
    }

    /// The item whose verdict an edit keeps.
    #[must_use]
    pub fn judged_by(&self, entry: EntryId) -> Option<&Opened> {
        self.judged.get(&entry)
    }
}

impl State {
    /// The item being looked at: as long as its track is the selected one.
    #[must_use]
    pub fn opened(&self) -> Option<&Opened> {
        self.opened.as_ref().filter(|opened| Some(opened.item.track) == self.selected)
    }

    /// What is doubtful still of the open item; with none open, the worst of the selected track.
    #[must_use]
    pub fn doubt(&self) -> Option<&Item> {
        let is_it =
            |item: &&Item| self.opened().is_none_or(|opened| overlap(&opened.item.frames, &item.frames));
        self.review.queue.of_track(self.selected?).find(is_it)
    }

    /// The item that the screen speaks of: what is doubtful, else the open one as it was.
    #[must_use]
    pub fn current_item(&self) -> Option<&Item> {
        self.doubt().or_else(|| self.opened().map(|opened| &opened.item))
    }
}

/// Whether some frame is in both.
#[must_use]
pub fn overlap(a: &Range<u32>, b: &Range<u32>) -> bool {
    a.start < b.end && b.start < a.end
}
