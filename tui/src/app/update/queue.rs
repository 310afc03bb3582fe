//! The queue: from item to item, and what is found of them.

use std::ops::Range;

use honami_model::history::EntryId;
use honami_model::judgement::{Effort, Verdict};
use honami_model::track::TrackId;
use honami_workbench::review::{Item, Rank};
use serde::{Deserialize, Serialize};

use super::{Action, Effect, Mode, State, complain, edit, say, time};
use crate::app::panel::Panel;
use crate::app::queue::{Opened, overlap};

/// A verdict to be kept: the world adds who and when.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Judge {
    /// The track.
    pub track: TrackId,
    /// The segment.
    pub frames: Range<u32>,
    /// What was found.
    pub verdict: Verdict,
    /// Why it was looked at.
    pub reasons: Vec<String>,
    /// What it took.
    pub effort: Effort,
}

/// Opens the item so many further on, from where the last one was or is.
pub(super) fn step(state: &mut State, by: i64) {
    let queue = &state.review.queue;
    let mut found = None;
    let mut from = state.opened.as_ref().map(|opened| opened.item.rank());
    for _ in 0..by.unsigned_abs().min(queue.len() as u64) {
        let next = match from {
            None => queue.first(),
            Some(rank) if by > 0 => queue.after(rank),
            Some(rank) => queue.before(rank),
        };
        let Some(item) = next else { break };
        (found, from) = (Some(item.clone()), Some(item.rank()));
    }
    match found {
        Some(item) => open(state, item),
        None => nothing(state, by),
    }
}

fn nothing(state: &mut State, by: i64) {
    let progress = state.review.progress();
    let line = match () {
        () if state.tracks.is_empty() => {
            "there are no tracks yet: t r follows features, a adds one by hand".to_owned()
        }
        () if state.review.queue.is_empty() && progress.total() > 0 => {
            format!("nothing is left to review: {} of {} done", progress.judged.done(), progress.total())
        }
        () if state.review.queue.is_empty() => "nothing is doubtful".to_owned(),
        () if by > 0 => format!("this was the last item; {} are left, p goes back", state.review.queue.len()),
        () => "this is the first item, the most doubtful".to_owned(),
    };
    say(state, line);
}

/// Opens the item with this rank, where it is still there.
pub(super) fn open_rank(state: &mut State, rank: Rank) {
    if let Some(item) = state.review.queue.get(rank).cloned() {
        open(state, item);
    }
}

/// What an action means: to accept on a doubtful track whose item is not open is to open that, but for the lines of the
/// prints, to which it goes; among bones, where none is open, to shape the chosen one. Up and down in the queue go to its items.
pub(super) fn meant(state: &State, action: Action) -> Action {
    let panel = state.panel.filter(|_| matches!(state.mode, Mode::Review));
    match (panel, action) {
        (Some(Panel::Skeleton), Action::Accept)
            if state.opened().is_none() && state.skeleton.pose.is_some() =>
        {
            return Action::ShapeBone;
        }
        // Rows of the queue are its items; the current one is opened before one goes on.
        (Some(Panel::Queue), _) if state.versus.is_some() || state.review.queue.is_empty() => {}
        (Some(Panel::Queue), Action::Down | Action::Up)
            if state.opened().is_none() && state.current_item().is_some() =>
        {
            return Action::WorstFrame;
        }
        (Some(Panel::Queue), Action::Down) => return Action::NextItem,
        (Some(Panel::Queue), Action::Up) => return Action::PreviousItem,
        (Some(Panel::Queue), Action::Accept) if state.current_item().is_none() => return Action::NextItem,
        _ => {}
    }
    let is_over_prints = state.panel == Some(Panel::Prints);
    let opens = action == Action::Accept && matches!(state.mode, Mode::Review) && !is_over_prints;
    let is_closed = opens && state.opened().is_none() && state.current_item().is_some();
    if is_closed && state.read_only.is_none() { Action::WorstFrame } else { action }
}

/// A key counts for the item of the track that is worked on, also where nobody has opened it.
pub(super) fn visit(state: &mut State) {
    let open = state.opened.as_ref().map(|opened| opened.item.track);
    let at = state.selected.filter(|track| Some(*track) != open).and_then(|track| state.row(track)).cloned();
    let before = state.looked.visited().and_then(|visited| state.row(visited.item.track)).cloned();
    let worst = at.as_ref().and_then(|row| state.review.queue.of_track(row.id).next()).cloned();
    state.looked.visit(before.as_ref(), at.as_ref().zip(worst.as_ref()), state.now);
}

fn open(state: &mut State, item: Item) {
    let Some(row) = state.row(item.track).cloned() else { return };
    let new = Opened::new(item.clone(), &row, state.now);
    if let Some(left) = state.opened.take() {
        state.looked.leave(left);
    }
    state.opened = Some(state.looked.open(new, &row));
    time::stop(state);
    time::select(state, item.track);
    time::go(state, item.worst);
    say(state, words_of(&item, (0, 1)));
}

/// Says what was found of the open item, and goes on to the next; `None`: what its samples say of themselves.
pub(super) fn judge(state: &mut State, verdict: Option<Verdict>) -> Vec<Effect> {
    if !edit::is_writable(state) {
        return Vec::new();
    }
    let found = state.opened().zip(state.selected_row()).map(|(opened, row)| {
        let verdict = verdict.unwrap_or_else(|| opened.verdict(row));
        // A track of no use is so as a whole.
        let frames =
            if verdict == Verdict::Rejected { row.span.frames() } else { opened.item.frames.clone() };
        let reasons = opened.item.reasons.codes().map(str::to_owned).collect();
        Judge { track: row.id, frames, verdict, reasons, effort: opened.effort(row) }
    });
    let Some(found) = found else {
        complain(state, "no item is open: w opens the selected track's, n the most doubtful");
        return Vec::new();
    };
    let judged = state.opened.take();
    let rank = judged.as_ref().map(|opened| opened.item.rank());
    judged.into_iter().for_each(|opened| state.looked.judge(opened));
    // It has left, also before the world has noticed.
    let rest = state.review.queue.of_track(found.track).filter(|item| !overlap(&item.frames, &found.frames));
    let rest: Vec<Item> = rest.cloned().collect();
    state.review.queue.set(found.track, rest);
    let queue = &state.review.queue;
    if let Some(next) = rank.and_then(|rank| queue.after(rank)).or_else(|| queue.first()).cloned() {
        open(state, next);
    }
    state.log.judged(&found);
    vec![Effect::Judge(found)]
}

/// The document stands elsewhere: a new edit may keep a verdict; where verdicts were undone, the item of the first of
/// them is looked at again.
pub(super) fn on_history(state: &mut State, from: EntryId, has_grown: bool) {
    if has_grown {
        return state.looked.is_kept(state.history.head);
    }
    let undone = state.history.undone(from, state.history.head);
    let judged = undone.iter().rev().find_map(|entry| state.looked.judged_by(*entry)).cloned();
    if let Some(mut opened) = judged.filter(|opened| state.row(opened.item.track).is_some()) {
        time::stop(state);
        time::select(state, opened.item.track);
        time::go(state, opened.item.worst);
        opened.waited(state.now);
        if let Some(left) = state.opened.replace(opened) {
            state.looked.leave(left);
        }
    }
}

/// Opens the selected track's item that holds the frame, else its most doubtful one, at its worst frame; where that is
/// open already and looked at, the track's next.
pub(super) fn open_worst(state: &mut State) {
    let Some(track) = state.selected else {
        return complain(state, "select a track first: j takes the next");
    };
    let items: Vec<Item> = state.review.queue.of_track(track).cloned().collect();
    let here = state.frame;
    let is_open =
        |item: &Item| state.opened().is_some_and(|opened| overlap(&opened.item.frames, &item.frames));
    let at = match (items.iter().position(is_open), state.opened()) {
        (Some(at), _) if items[at].worst == here => Some((at + 1) % items.len()),
        (Some(at), _) => Some(at),
        // Its samples are no longer doubtful.
        (None, Some(opened)) if items.is_empty() || opened.item.worst != here => None,
        (None, _) => items.iter().position(|item| item.frames.contains(&here)).or(Some(0)),
    };
    let opened = state.opened().map(|opened| opened.item.worst);
    match (at.and_then(|at| Some((at, items.get(at)?))), opened) {
        (Some((at, item)), _) if is_open(item) => {
            time::go(state, item.worst);
            say(state, words_of(item, (at, items.len())));
        }
        (Some((at, item)), _) => {
            open(state, item.clone());
            say(state, words_of(item, (at, items.len())));
        }
        (None, Some(worst)) => {
            time::go(state, worst);
            say(state, format!("track {track}: the open item is no longer doubtful"));
        }
        (None, None) => say(state, format!("track {track}: nothing is doubtful")),
    }
}

/// What is opened; where the track has several items also which.
fn words_of(item: &Item, (at, n): (usize, usize)) -> String {
    let (first, last) = (item.frames.start, item.frames.end - 1);
    let which = if n > 1 { format!(", item {} of {n} of the track", at + 1) } else { String::new() };
    format!("track {}: frames {first}-{last}, {} ({:.2}){which}", item.track, item.reasons, item.suspicion)
}

/// Goes half-way between the key-frames around, or the ends of the track.
pub(super) fn bisect(state: &mut State) {
    let Some(row) = state.selected_row().filter(|row| !row.span.samples.is_empty()) else {
        return complain(state, "select a track first: j takes the next");
    };
    let frames = row.span.frames();
    let here = state.frame;
    let before = row.keys.iter().rev().find(|key| **key <= here).copied().unwrap_or(frames.start);
    let after = row.keys.iter().find(|key| **key > here).copied().unwrap_or(frames.end - 1);
    let middle = before + after.saturating_sub(before) / 2;
    time::go(state, middle);
    say(state, format!("half-way between {before} and {after}"));
}
