//! What is done goes into the log, and what the log says can be done again.

use std::time::Duration;

use honami_model::track::TrackId;
use honami_workbench::offer::Model;
use honami_workbench::scene::control::Event;

use super::{Action, Context, Effect, Mode, Msg, State, actions, offers, on_text, time, update};
use crate::app::action::TABLE;
use crate::app::command_log::{Here, Line, Touch, What};
use crate::app::layout::Lens;
use crate::app::skeleton::Skeletal;
use crate::app::state::Notice;
use crate::term::input::{Mouse, MouseKind};

/// An action is about to be done. The palette and the help leave no lines: what is chosen there does. Nor do the ways to
/// other projects: the session ends with them.
pub(super) fn action(state: &mut State, action: Action) {
    if is_unlogged(state)
        || matches!(action, Action::Palette | Action::Help | Action::GoFile | Action::Tutorial)
    {
        return;
    }
    let chosen = match &state.mode {
        Mode::Menu(menu) if action == Action::Accept => menu.chosen().map(|row| row.label.clone()),
        // Which model was offered first was up to the time that it takes to try them.
        Mode::Move(moving) if action == Action::Accept => moving.model().map(|model| model.word().to_owned()),
        _ => None,
    };
    let sketched = match &state.mode {
        Mode::Sketch(sketching) if action == Action::Accept => Some(sketching.ended(state.now)),
        _ => None,
    };
    let what = What::Action(action.info().name.to_owned());
    push_line(state, what, |here| Here { chosen, sketched, ..here });
}

/// Text has come. Digits of a count have no line of their own: it is in that of its action.
pub(super) fn text(state: &mut State, text: &str) {
    let context = state.mode.context();
    let is_kept = context.is_text() || context == Context::Form;
    if is_kept && !is_unlogged(state) {
        push(state, What::Text(text.to_owned()));
    }
}

/// The mouse is about to do something. What is drawn leaves one line, when it is kept; and a button that goes up does
/// something only where is drawn.
pub(super) fn mouse(state: &mut State, mouse: Mouse) {
    let is_sketch = matches!(state.mode, Mode::Sketch(_));
    let is_silent = match mouse.kind {
        MouseKind::Drag(_) => is_sketch,
        MouseKind::Release(_) => !is_sketch,
        _ => false,
    };
    if !is_silent && !is_unlogged(state) {
        let at = Lens::shown(state).point_of(mouse.column, mouse.row);
        push(state, What::Mouse(Touch { kind: mouse.kind, cell: (mouse.column, mouse.row), at }));
    }
}

/// Something was chosen in the viewer's window, or asked for there.
pub(super) fn window(state: &mut State, event: &Event) {
    push(state, What::Window(event.clone()));
}

/// The terminal has another size.
pub(super) fn screen(state: &mut State) {
    let (columns, rows) = state.size;
    push_bare(state, What::Screen(columns, rows));
}

/// A job has ended.
pub(super) fn ended(state: &mut State, plugin: String) {
    push_bare(state, What::Ended(plugin));
}

/// Something was said.
pub(super) fn said(state: &mut State, notice: &Notice) {
    let line = Line::said(state.now.as_secs_f64(), notice);
    state.log.push(line);
}

fn is_unlogged(state: &State) -> bool {
    matches!(&state.mode, Mode::Menu(menu) if menu.is_unlogged())
}

fn push(state: &mut State, what: What) {
    push_line(state, what, |here| here);
}

fn push_line(state: &mut State, what: What, more: impl FnOnce(Here) -> Here) {
    let here = Here {
        place: state.mode.context().name().to_owned(),
        frame: state.frame,
        track: state.selected.map(|track| track.0),
        zoom: Some(state.zoom).filter(|zoom| *zoom > 0),
        count: state.count.filter(|_| matches!(what, What::Action(_))),
        chosen: None,
        judged: None,
        sketched: None,
        growing: Skeletal::is_growing(state),
    };
    state.log.push(Line { t_s: state.now.as_secs_f64(), what, here: Some(more(here)) });
}

fn push_bare(state: &mut State, what: What) {
    state.log.push(Line { t_s: state.now.as_secs_f64(), what, here: None });
}

/// Chooses the model by which a line keeps what is moved; what must be worked out for it is in the effects.
pub fn stand_by(state: &mut State, line: &Line) -> Vec<Effect> {
    let chosen = line.here.as_ref().and_then(|here| here.chosen.as_deref());
    let model = Model::ALL.into_iter().find(|model| chosen == Some(model.word()));
    let State { mode, clip, .. } = &mut *state;
    if let (Mode::Move(moving), Some(model)) = (mode, model) {
        moving.choose(model);
        moving.preview(&clip.times);
    }
    offers::asks(state)
}

/// Does again what a line of a log says, at the same time of the clock, the same frame and the same track.
///
/// # Errors
/// A line that says why it cannot be done now.
pub fn again(state: &mut State, line: &Line) -> Result<Vec<Effect>, String> {
    let now = Duration::try_from_secs_f64(line.t_s)
        .map_err(|error| format!("{} s is no time of a session: {error}", line.t_s))?;
    time::on_clock(state, now);
    if let What::Screen(columns, rows) = line.what {
        return Ok(update(state, Msg::Resize(columns, rows)));
    }
    let Some(here) = &line.here else { return Ok(Vec::new()) };
    stand(state, here)?;
    match &line.what {
        What::Action(name) => {
            let known = TABLE.iter().find(|info| info.name == name).map(|info| info.action);
            let called = known.ok_or_else(|| format!("there is no action {name}"))?;
            if called.word_in(state.mode.context()).is_none() {
                return Err(format!("{name} does nothing in {}", here.place));
            }
            if let (Mode::Menu(menu), Some(chosen)) = (&mut state.mode, &here.chosen)
                && !menu.choose(chosen)
            {
                return Err(format!("{chosen} is not in the list of {}", menu.title));
            }
            if let (Mode::Sketch(sketching), Some(strokes)) = (&mut state.mode, &here.sketched) {
                sketching.take(strokes.clone());
            }
            state.count = here.count;
            action(state, called);
            if let Some(judge) = &here.judged {
                return Ok(vec![Effect::Judge(judge.clone())]);
            }
            let mut effects = actions::act(state, called);
            state.count = None;
            effects.extend(offers::asks(state));
            Ok(effects)
        }
        What::Text(typed) => {
            on_text(state, typed);
            Ok(Vec::new())
        }
        What::Mouse(touch) => point(state, touch),
        What::Window(event) => {
            window(state, event);
            Ok(super::window::act(state, event.clone()))
        }
        _ => Ok(Vec::new()),
    }
}

/// Takes the user where they were.
fn stand(state: &mut State, here: &Here) -> Result<(), String> {
    let place = state.mode.context().name();
    if place != here.place {
        return Err(format!("this was done in {}, and now it would be done in {place}", here.place));
    }
    if here.frame > state.last_frame() {
        return Err(format!("there is no frame {}", here.frame));
    }
    let track = here.track.map(TrackId);
    if let Some(track) = track.filter(|track| state.row(*track).is_none()) {
        return Err(format!("there is no track {track}"));
    }
    state.frame = here.frame;
    state.selected = track;
    state.opened = None;
    state.zoom = here.zoom.unwrap_or(0);
    time::keep_in_view(state);
    Ok(())
}

/// The mouse at the image point where it was, or beside the picture in the same cell.
fn point(state: &mut State, touch: &Touch) -> Result<Vec<Effect>, String> {
    let mut cell = touch.cell;
    if let Some([x, y]) = touch.at {
        let lens = Lens::shown(state);
        let (across, down) = lens
            .place_of([x, y], (1, 1))
            .ok_or_else(|| format!("the point {x:.1}, {y:.1} is not seen now"))?;
        let beside = |edge: u16, n: u32| edge.saturating_add(u16::try_from(n).unwrap_or(u16::MAX));
        cell = (beside(lens.area.x, across), beside(lens.area.y, down));
    }
    Ok(update(state, Msg::Mouse(Mouse { kind: touch.kind, column: cell.0, row: cell.1 })))
}
