//! Two runs beside each other: chosen, flicked, gone through from the worst disagreement on, one of them taken.

use std::sync::Arc;

use honami_model::document::RunId;
use honami_model::track::TrackId;
use honami_workbench::correct::Step;
use honami_workbench::versus::{Compared, Entrant, Place, Sight};

use super::{Effect, Hint, Mode, State, UNDO, actions, complain, edit, ranges, say, time};
use crate::app::form::Task;
use crate::app::menu::Menu;
use crate::app::panel::Panel;
use crate::app::versus::{LETTERS, Sides, Versus};

/// Shows two runs over the picture, or the tracks again.
pub(super) fn toggle(state: &mut State) -> Vec<Effect> {
    if state.versus.is_none() {
        return vec![Effect::Versus(None)];
    }
    close(state);
    say(state, "the tracks as they are shown");
    Vec::new()
}

/// Shows the tracks again.
pub(super) fn close(state: &mut State) {
    state.versus = None;
    state.panel = state.panel.filter(|panel| *panel != Panel::Versus);
}

/// These two are to be shown; where there are none, another tracker has to follow the same tracks first.
pub(super) fn on_runs(state: &mut State, runs: Option<[Entrant; 2]>) {
    match runs {
        Some(runs) => {
            let [a, b] = [runs[0].run, runs[1].run];
            say(state, format!("A is run {a}, B run {b}: n goes to the worst place, F flicks, A ends it"));
            state.versus = Some(Box::new(Versus::new(runs, state.selected)));
            state.panel = Some(Panel::Versus);
        }
        None if state.job.is_some() => {
            let plugin = state.job.as_ref().map_or("", |job| &job.plugin);
            let line =
                format!("{plugin} is still running; when it is done, A shows two runs of the same tracks");
            say(state, line);
        }
        None if state.tracks.is_empty() => {
            complain(state, "there are no tracks yet: t r follows features, and again with another tracker");
        }
        None => {
            second_run(state);
            complain(
                state,
                "no two runs of the same tracks: let another tracker follow them, then A shows both",
            );
        }
    }
}

/// Opens the form of another tracker than that whose run is on top.
fn second_run(state: &mut State) {
    if state.read_only.is_some() || !matches!(state.mode, Mode::Review) {
        return;
    }
    let on_top = state.tracker.as_deref().and_then(|tracker| tracker.split(' ').next()).unwrap_or_default();
    let others = || state.plugins.iter().filter(|plugin| plugin.task == Task::Track && plugin.name != on_top);
    // The one that is most unlike: what drifts beside what does not.
    let unlike = if on_top == "anchored" { "klt" } else { "anchored" };
    let other = others().find(|plugin| plugin.name == unlike).or_else(|| others().next());
    let other = other.map(|plugin| plugin.name.clone());
    actions::open_form(state, Task::Track);
    if let (Mode::Form(form), Some(other)) = (&mut state.mode, other) {
        form.choose(&other);
    }
}

/// What has become of the comparison.
pub(super) fn on_compared(state: &mut State, runs: [RunId; 2], compared: Result<Arc<Compared>, String>) {
    let State { versus, tracks, .. } = state;
    let Some(versus) = versus.as_deref_mut().filter(|versus| versus.numbers() == runs) else { return };
    match compared {
        Ok(compared) => {
            versus.compared = Some(compared);
            (versus.place, versus.taken) = (None, None);
            versus.look_at_keys(tracks);
        }
        Err(error) => {
            close(state);
            // Of its own time, not an answer to a key: it has no place in the log.
            let text = format!("the runs cannot be compared: {error}");
            state.notice = Some(crate::app::state::Notice { text, is_error: true });
        }
    }
}

/// Their key-frames may be others now.
pub(super) fn on_tracks(state: &mut State) {
    let State { versus, tracks, .. } = state;
    versus.iter_mut().for_each(|versus| versus.look_at_keys(tracks));
}

/// Draws A, B or both.
pub(super) fn flick(state: &mut State) {
    let Some(versus) = shown(state) else { return };
    versus.sides = versus.sides.next();
    let line = match versus.sides {
        Sides::Both => "A and B".to_owned(),
        Sides::One(side) => format!("only {}: {}", LETTERS[side], versus.runs[side].name()),
    };
    say(state, line);
}

/// The two runs that are shown; says how they come to be, where there are none.
fn shown(state: &mut State) -> Option<&mut Versus> {
    if state.versus.is_none() {
        complain(state, "no two runs are beside each other: A shows them");
    }
    state.versus.as_deref_mut()
}

/// Goes to the place of disagreement so many further on, from the worst.
pub(super) fn step(state: &mut State, by: i64) {
    let Some(versus) = shown(state) else { return };
    let Some(compared) = &versus.compared else {
        return say(state, "the two runs are still being compared");
    };
    let places = &compared.found.places;
    let before = versus.place.map_or(-1, |at| i64::try_from(at).unwrap_or(i64::MAX));
    let last = i64::try_from(places.len()).unwrap_or(i64::MAX) - 1;
    let next = usize::try_from(before.saturating_add(by).clamp(0, last.max(0))).unwrap_or(0);
    let is_end = versus.place == Some(next);
    let Some(place) = places.get(next).cloned() else {
        return say(state, "A and B agree everywhere within 2 px, and on what is seen");
    };
    versus.place = Some(next);
    let line = match (is_end, by > 0) {
        (false, _) => place_words(&place, next, places.len()),
        (true, true) => "this was the last place of disagreement; p goes back".to_owned(),
        (true, false) => "this is the worst disagreement".to_owned(),
    };
    open(state, place.track, place.worst);
    say(state, line);
}

/// Goes to a frame of a track.
pub(super) fn open(state: &mut State, track: TrackId, frame: u32) {
    if state.row(track).is_some() {
        time::stop(state);
        time::select(state, track);
        time::go(state, frame);
    }
}

/// Where it is and what they say there: `track 42: 14.3 px apart at 187 (158-203), place 1 of 31`.
fn place_words(place: &Place, at: usize, n: usize) -> String {
    let Place { track, frames, worst, sight } = place;
    let what = match sight {
        Sight::Both(px) => format!("{px:.1} px apart at {worst}"),
        Sight::Alone(side) => format!("only {} sees it from {worst} on", LETTERS[*side]),
        Sight::Neither => format!("neither sees it at {worst}"),
    };
    format!("track {track}: {what} ({}-{}), place {} of {n}", frames.start, frames.end - 1, at + 1)
}

/// Lists the runs to choose A from; then those to choose B from.
pub(super) fn on_entrants(state: &mut State, first: Option<RunId>, mut entrants: Vec<Entrant>) {
    let a = first.and_then(|first| entrants.iter().position(|one| one.run == first));
    let a = a.map(|at| entrants.remove(at));
    entrants.retain(|one| a.as_ref().is_none_or(|a| a.shares_tracks(one)));
    if entrants.len() + usize::from(a.is_some()) < 2 {
        return match a {
            Some(a) => complain(state, format!("{} has no track that another run has", a.name())),
            None => on_runs(state, None),
        };
    }
    state.mode = Mode::Menu(Box::new(Menu::of_runs(first, &entrants)));
}

/// Lays what one of the two found over the range; without one over the place of disagreement that is on the screen, and
/// the second time, or at no such place, over all of the track; of picked tracks over all of each.
pub(super) fn take(state: &mut State, side: usize) -> Vec<Effect> {
    if !edit::is_writable(state) {
        return Vec::new();
    }
    let Some((run, is_known)) = shown(state).map(|v| (v.numbers()[side], v.compared.is_some())) else {
        return Vec::new();
    };
    if !is_known {
        say(state, "the two runs are still being compared");
        return Vec::new();
    }
    let Some(tracks) = ranges::targets(state) else { return Vec::new() };
    let here = (state.range.is_none() && state.picked.is_empty()).then(|| place_here(state)).flatten();
    let again = |versus: &Versus| here.is_some() && versus.taken == here.map(|at| (at, side));
    let is_again = state.versus.as_deref().is_some_and(again);
    let Some(versus) = state.versus.as_deref_mut() else { return Vec::new() };
    versus.taken = here.map(|at| (at, side)).filter(|_| !is_again);
    let place = versus.taken.and_then(|(at, _)| versus.place_at(at)).map(|place| place.frames.clone());
    let hint = if place.is_some() { AGAIN[side] } else { UNDO };
    let all = 0..state.clip.n_frames();
    let frames = place.or_else(|| Some(state.range?.frames(state.frame))).unwrap_or(all);
    time::stop(state);
    vec![Effect::Correct(Step::Take { tracks, frames, run }, hint)]
}

/// What taking a place again does.
const AGAIN: [Hint; 2] = ["e A again: the whole track, u undoes", "e B again: the whole track, u undoes"];

/// The place of disagreement of the selected track that the current frame lies in, by its rank.
fn place_here(state: &State) -> Option<usize> {
    let (track, frame) = (state.selected?, state.frame);
    let places = &state.versus.as_deref()?.compared.as_ref()?.found.places;
    places.iter().position(|place| place.track == track && place.frames.contains(&frame))
}
