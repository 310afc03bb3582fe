//! Actions, each by its place.

use std::ops::Range;
use std::path::PathBuf;

use super::{
    Action, Effect, Mode, State, choose, complain, edit, groups, history, look, motion, mouse, moving,
    open_menu, paint, pick, queue, ranges, recovery, say, scale, shaping, skeleton, sketch, time, tracks,
    versus, window,
};
use honami_model::judgement::Verdict;
use honami_model::track::{Status, TrackSet};
use honami_workbench::cluster::ClusterRequest;
use honami_workbench::progress::Patience;
use honami_workbench::retrack;
use honami_workbench::track::{Area, PointSource, TrackRequest};

use super::time::Pace;
use crate::app::before::Before;
use crate::app::correcting::nudge_px;
use crate::app::files::Lead;
use crate::app::form::{Features, Form, Plugin, Task, Wanted};
use crate::app::lesson::Lesson;
use crate::app::menu::Choice;
use crate::app::panel::Panel;
use crate::app::state::Notice;
use crate::app::tracks::TrackRow;
use crate::app::typing;

/// Does an action. The count, if one was typed, is still in the state.
pub(super) fn act(state: &mut State, action: Action) -> Vec<Effect> {
    let head = state.history.head;
    state.lesson.iter_mut().for_each(|lesson| lesson.note(action, head));
    state.before = Before::doing(action, state).map(Box::new);
    match action {
        Action::Left => return steer(state, -1.0, 0.0, 1.0),
        Action::Right => return steer(state, 1.0, 0.0, 1.0),
        Action::Up => return steer(state, 0.0, -1.0, 1.0),
        Action::Down => return steer(state, 0.0, 1.0, 1.0),
        Action::FineLeft => return steer(state, -1.0, 0.0, 0.25),
        Action::FineRight => return steer(state, 1.0, 0.0, 0.25),
        Action::FineUp => return steer(state, 0.0, -1.0, 0.25),
        Action::FineDown => return steer(state, 0.0, 1.0, 0.25),
        Action::Accept => return accept(state),
        Action::Back => return back(state),
        Action::Quit if matches!(state.mode, Mode::Review) => return vec![Effect::Leave],
        Action::Quit => return back(state),
        Action::Leave => return leave(state),
        Action::Erase | Action::EraseLine => return erase(state, action),
        Action::PlayPause => time::play(state, Pace::Real, 1.0),
        Action::PlayBackwards => time::play(state, Pace::Real, -1.0),
        Action::SlowForward => time::play(state, Pace::Slow, 1.0),
        Action::SlowBackward => time::play(state, Pace::Slow, -1.0),
        Action::Loop => time::repeat(state),
        Action::StepForward => forward(state, count(state)),
        Action::StepBack => time::step(state, -count(state)),
        Action::LeapForward => time::step(state, 10 * count(state)),
        Action::LeapBack => time::step(state, -10 * count(state)),
        Action::GoStart => time::go(state, 0),
        Action::GoEnd => time::go(state, state.last_frame()),
        Action::GoFrame => match state.count {
            Some(frame) => time::go(state, frame),
            None => state.mode = Mode::Prompt(String::new()),
        },
        Action::GoTrack => time::go_track(state),
        Action::NextItem => step_item(state, count(state)),
        Action::PreviousItem => step_item(state, -count(state)),
        Action::WorstFrame => queue::open_worst(state),
        Action::Bisect => queue::bisect(state),
        Action::Reject => return queue::judge(state, Some(Verdict::Rejected)),
        Action::Later => return queue::judge(state, Some(Verdict::Later)),
        Action::NextKey => time::go_key(state, count(state)),
        Action::PreviousKey => time::go_key(state, -count(state)),
        Action::AddFeature => edit::begin_place(state),
        Action::ClearKey => return edit::clear_key(state),
        Action::GoLabel => pick::label(state),
        Action::GoKey => pick::key_frame(state),
        Action::GoPlugin => pick::plugin(state),
        Action::Tutorial => return vec![Effect::Teach],
        Action::GoFile => return vec![Effect::Follow(Lead::Folder(PathBuf::from(".")))],
        Action::Sort => time::sort(state),
        Action::DeleteTrack => return edit::delete(state),
        Action::MoreGroups => return more(state, count(state)),
        Action::FewerGroups => return more(state, -count(state)),
        Action::Undo => return edit::repeat(state, Effect::Undo),
        Action::Redo => return edit::repeat(state, Effect::Redo),
        Action::RetrackBoth => return edit::retrack(state, retrack::Way::Both),
        Action::RetrackForward => return edit::retrack(state, retrack::Way::Forward),
        Action::RetrackBackward => return edit::retrack(state, retrack::Way::Backward),
        Action::RunTracker => open_form(state, Task::Track),
        Action::RunClusterer => open_form(state, Task::Cluster),
        Action::Palette | Action::Help => open_menu(state, action),
        Action::Redraw => return vec![Effect::Redraw],
        Action::Suspend => return vec![Effect::Suspend],
        Action::Mouse => return turn_mouse(state),
        Action::History => history::toggle(state),
        Action::SaveLog => return vec![Effect::SaveLog(state.log.text())],
        other => return look_about(state, other),
    }
    Vec::new()
}

/// Actions that change only what is seen.
fn look_about(state: &mut State, action: Action) -> Vec<Effect> {
    match action {
        Action::ZoomIn => look::zoom(state, count(state)),
        Action::ZoomOut => look::zoom(state, -count(state)),
        Action::PanLeft => return pan(state, -1.0, 0.0),
        Action::PanDown => return pan(state, 0.0, 1.0),
        Action::PanUp => return pan(state, 0.0, -1.0),
        Action::PanRight => return pan(state, 1.0, 0.0),
        Action::Centre => look::centre(state),
        Action::Follow => look::follow(state),
        Action::MotionColours => motion::turn_on(state),
        Action::MotionGainUp => motion::gain(state, count(state)),
        Action::MotionGainDown => motion::gain(state, -count(state)),
        Action::MotionDial => motion::open_dial(state),
        Action::MotionSource => return motion::change_source(state),
        Action::Versus => return versus::toggle(state),
        Action::VersusFlick => versus::flick(state),
        Action::VersusRuns => return vec![Effect::Entrants(None)],
        Action::PanelVersus => show_panel(state, Panel::Versus),
        Action::Skeleton => skeleton::toggle(state),
        Action::Window => return window::toggle(state),
        Action::OrbitLeft => shaping::orbit(state, -count(state)),
        Action::OrbitRight => shaping::orbit(state, count(state)),
        Action::Front => shaping::front(state),
        Action::Marks => state.marks_all = !state.marks_all,
        Action::Column if matches!(state.mode, Mode::Move(_)) => moving::next_model(state),
        Action::Column if matches!(state.mode, Mode::Paint(_)) => paint::next_brush(state),
        Action::Column => state.panel = Panel::after(state.panel),
        Action::PanelQueue => show_panel(state, Panel::Queue),
        Action::PanelTracks => show_panel(state, Panel::Tracks),
        Action::PanelGroups => show_panel(state, Panel::Groups),
        Action::PanelSkeleton => skeleton::show_bones(state),
        Action::PanelKeyFrames => show_panel(state, Panel::KeyFrames),
        Action::PanelPlots => show_panel(state, Panel::Plots),
        Action::PlotGroup => look::plot_group(state),
        Action::WidePanel => state.panel_is_wide = !state.panel_is_wide,
        Action::PanelPrints => show_panel(state, Panel::Prints),
        Action::PanelLog => show_panel(state, Panel::Log),
        Action::Glyphs => turn_glyphs(state),
        Action::Stills => turn_stills(state),
        Action::NextTheme => next_theme(state),
        other => return correct(state, other),
    }
    Vec::new()
}

/// The item of the queue so many further on; of two runs beside each other, the disagreement.
fn step_item(state: &mut State, by: i64) {
    if state.versus.is_some() {
        versus::step(state, by);
    } else {
        queue::step(state, by);
    }
}

/// Frames forward; the point that a hand leads stays behind in the one that is left.
fn forward(state: &mut State, frames: i64) {
    match state.mode {
        Mode::Sketch(_) => sketch::put(state, frames),
        _ => time::step(state, frames),
    }
}

/// More or less of what there is: groups, colour at the dial, the step of a hand that draws.
fn more(state: &mut State, by: i64) -> Vec<Effect> {
    match state.mode {
        Mode::Dial(_) => motion::gain(state, by),
        Mode::Sketch(_) => sketch::scale_step(state, by),
        Mode::Paint(_) => paint::widen(state, by),
        Mode::Shape(_) => shaping::gain(state, by),
        _ => return edit::cut(state, by),
    }
    Vec::new()
}

/// Ctrl and the arrows: finest nudges where a point is moved, else what is seen.
fn pan(state: &mut State, dx: f32, dy: f32) -> Vec<Effect> {
    match state.mode {
        Mode::Place(_) | Mode::Root(_) | Mode::Move(_) => return steer(state, dx, dy, 0.1),
        _ => look::pan(state, dx.into(), dy.into()),
    }
    Vec::new()
}

/// The actions that correct, and what is done about plugins that fail.
fn correct(state: &mut State, action: Action) -> Vec<Effect> {
    match action {
        Action::MoveSample => return moving::begin(state),
        Action::Sketch => return sketch::begin(state),
        Action::Paint => return paint::begin(state),
        Action::Pen => paint::pen(state),
        Action::ScaleBar => scale::begin(state),
        Action::RemoveScaleBar => return scale::remove(state),
        Action::CorrectTime => return moving::begin_slide(state),
        Action::WalkForward => moving::walk(state, count(state)),
        Action::WalkBack => moving::walk(state, -count(state)),
        Action::Pin if matches!(state.mode, Mode::Review) => return edit::confirm(state),
        Action::Pin => moving::pin(state),
        Action::Range => ranges::begin_or_end(state),
        Action::MarkLost => return ranges::lost(state),
        Action::MarkOccluded => return ranges::mark(state, Status::Occluded),
        Action::MarkOutside => return ranges::mark(state, Status::Outside),
        Action::DeleteRange => return ranges::delete(state),
        Action::Pick => tracks::pick(state),
        Action::PickGroup => tracks::pick_group(state),
        Action::Split => return tracks::split(state),
        Action::Swap => tracks::choose_other(state, "swap with", Choice::Swap),
        Action::Join => tracks::choose_other(state, "join with", Choice::Join),
        Action::Duplicate => return tracks::duplicate(state),
        Action::Average => return tracks::average(state),
        Action::TakeA => return versus::take(state, 0),
        Action::TakeB => return versus::take(state, 1),
        Action::NameTrack => tracks::begin_name(state),
        Action::MergeGroups => groups::choose_other(state, "merge with", Choice::MergeGroup),
        Action::SplitGroup => return groups::split(state),
        Action::TakeIntoGroup => groups::choose_other(state, "take into", Choice::TakeInto),
        Action::NameGroup => groups::begin_name(state),
        Action::PlaceRoot => skeleton::begin_root(state),
        Action::ShapeBone => return shaping::begin(state),
        Action::ReleaseSkeleton => return skeleton::release(state),
        Action::ReleaseGroups => return groups::release(state),
        Action::GoOn => return recovery::go_on(state),
        Action::WaitOn => return recovery::answer(state, Patience::Wait),
        Action::EndPlugin => return recovery::answer(state, Patience::End),
        other => debug_assert!(false, "{other:?} is done nowhere"),
    }
    Vec::new()
}

/// The number typed before the command, 1 if none.
pub(super) fn count(state: &State) -> i64 {
    i64::from(state.count.unwrap_or(1))
}

/// hjkl and the arrows: what they move depends on the place.
fn steer(state: &mut State, dx: f32, dy: f32, px: f32) -> Vec<Effect> {
    let n = count(state);
    let (columns, rows) = (n * dx as i64, n * dy as i64);
    let by = [dx, dy].map(|d| d * px * n as f32);
    match &mut state.mode {
        Mode::Review if columns != 0 => time::step(state, columns),
        // Rows that are no tracks.
        Mode::Review if matches!(state.panel, Some(Panel::Prints | Panel::Skeleton)) => {
            mouse::step_list(state, rows)
        }
        Mode::Review => time::step_track(state, rows),
        Mode::Place(at) | Mode::Root(at) => {
            let px = nudge_px(state.zoom);
            *at = edit::within(&state.clip, [at[0] + by[0] * px, at[1] + by[1] * px]);
        }
        Mode::Shape(_) => shaping::steer(state, [dx, dy].map(f64::from), px.into()),
        Mode::Move(_) => moving::nudge(state, by),
        Mode::Sketch(_) => sketch::steer(state, by),
        Mode::Paint(_) => paint::steer(state, [dx, dy].map(|d| d * n as f32), px < 1.0),
        Mode::Scale(_) => scale::steer(state, by),
        Mode::Form(form) if columns != 0 => form.change(columns, px < 1.0),
        Mode::Form(form) => form.step(rows),
        Mode::Menu(menu) => menu.step(rows),
        Mode::Dial(_) => motion::steer(state, f64::from(dx), f64::from(dy)),
        Mode::History { .. } => history::step(state, rows),
        Mode::Prompt(_) | Mode::Name(_) | Mode::GroupName(_) | Mode::Label(_) => {}
    }
    Vec::new()
}

fn accept(state: &mut State) -> Vec<Effect> {
    match &mut state.mode {
        Mode::Review if state.panel == Some(Panel::Prints) => go_to_print(state),
        Mode::Review => match state.opened() {
            Some(_) => queue::judge(state, None),
            None => edit::confirm(state),
        },
        Mode::Place(_) => edit::place(state),
        Mode::Root(_) => skeleton::place_root(state),
        Mode::Shape(_) => shaping::keep(state),
        Mode::Move(_) => moving::keep(state),
        Mode::Sketch(_) => sketch::keep(state),
        Mode::Paint(_) => paint::accept(state),
        Mode::Scale(_) => scale::accept(state),
        Mode::Menu(_) => choose(state),
        Mode::Dial(_) => {
            state.mode = Mode::Review;
            Vec::new()
        }
        Mode::Prompt(typed) => {
            let frame = typed.parse().ok();
            state.mode = Mode::Review;
            if let Some(frame) = frame {
                time::go(state, frame);
            }
            Vec::new()
        }
        Mode::Name(_) => tracks::name(state),
        Mode::GroupName(_) => groups::name(state),
        Mode::History { .. } => history::jump(state),
        Mode::Label(_) => Vec::new(),
        Mode::Form(form) if form.typed.is_some() => {
            if let Err(line) = form.take_typed() {
                complain(state, line);
            }
            Vec::new()
        }
        Mode::Form(_) => run(state),
    }
}

/// Goes to the frame that the line looked at was printed in.
fn go_to_print(state: &mut State) -> Vec<Effect> {
    let line = state.prints.current().and_then(|i| state.prints.lines().get(i));
    match line.and_then(|line| line.frame) {
        Some(frame) => time::go(state, frame),
        None => complain(state, "this line was printed in no frame: Enter goes to a line's frame".to_owned()),
    }
    Vec::new()
}

fn run(state: &mut State) -> Vec<Effect> {
    if let Some(job) = &state.job {
        let line =
            format!("{} is still running: wait for it, or stop it with Esc while reviewing", job.plugin);
        complain(state, line);
        return Vec::new();
    }
    let Mode::Form(form) = std::mem::replace(&mut state.mode, Mode::Review) else { return Vec::new() };
    let (plugin, params) = (form.plugin().name.clone(), form.values());
    if form.task == Task::Cluster {
        return vec![Effect::Cluster(ClusterRequest { plugin, params, groups: None })];
    }
    let points = match (form.features(), state.selected) {
        (Features::Selected, Some(track)) => PointSource::Tracks(TrackSet::from(track)),
        (Features::Here | Features::Selected, _) => PointSource::Existing,
        (Features::Found, _) => PointSource::Detect,
    };
    state.corrected = None;
    let (frames, every, area) = (form.frames(), form.every(), Area::Usual);
    vec![Effect::Track(TrackRequest { plugin, params, points, frames, every, area })]
}

/// Leaves honami; asks first where something would be lost that is not kept yet.
fn leave(state: &mut State) -> Vec<Effect> {
    let open = match &state.mode {
        Mode::Move(moving) if moving.has_moved() => "a move is not kept: Enter keeps",
        Mode::Sketch(sketching) if !sketching.strokes.is_empty() => "a sketch is not kept: Enter keeps",
        Mode::Paint(painting) if !painting.strokes.is_empty() => "what is painted is not kept: Enter keeps",
        Mode::Scale(scaling) if !scaling.ends.is_empty() => "a scale bar is not kept: Enter keeps",
        Mode::Shape(shaping) if shaping.shape != state.skeleton.hand.shape(shaping.bone.node) => {
            "a bone's shape is not kept: Enter keeps"
        }
        Mode::Form(_) => "a form has not been run: Enter runs",
        _ => return vec![Effect::Leave],
    };
    if state.is_leaving {
        return vec![Effect::Leave];
    }
    state.is_leaving = true;
    complain(state, format!("{open}, Esc drops, Q again leaves"));
    Vec::new()
}

/// Leaves what is open; while reviewing, stops what runs: first the clip, then the job; then gives up the range, then
/// the picks, and then the two runs.
fn back(state: &mut State) -> Vec<Effect> {
    match &mut state.mode {
        Mode::Review if state.play.is_some() => time::stop(state),
        Mode::Review => {
            if let Some(job) = state.job.as_mut().filter(|job| !job.is_stopping) {
                job.is_stopping = true;
                return vec![Effect::StopJob];
            }
            if skeleton::stop(state) || shaping::leave_round(state) || state.range.take().is_some() {
                return Vec::new();
            }
            if !state.picked.is_empty() {
                state.picked.clear();
            } else if state.versus.is_some() {
                versus::close(state);
            } else if state.job.is_none() {
                state.lesson.iter_mut().for_each(Lesson::close);
            }
        }
        Mode::Form(form) if form.typed.is_some() => form.typed = None,
        Mode::Dial(before) => {
            state.motion = *before;
            state.mode = Mode::Review;
        }
        Mode::Menu(menu) => state.mode = std::mem::replace(&mut menu.below, Mode::Review),
        Mode::History { .. } => history::close(state),
        Mode::Sketch(_) => sketch::back(state),
        Mode::Paint(_) => return paint::back(state),
        _ => state.mode = Mode::Review,
    }
    Vec::new()
}

fn erase(state: &mut State, action: Action) -> Vec<Effect> {
    match &mut state.mode {
        Mode::Menu(menu) => drop(menu.act(action)),
        Mode::Prompt(typed) | Mode::Name(typed) | Mode::GroupName(typed) => typing::take_back(typed, action),
        Mode::Form(form) => form.typed.iter_mut().for_each(|typed| typing::take_back(typed, action)),
        Mode::Scale(scaling) if scaling.is_typing() && !scaling.typed.is_empty() => {
            typing::take_back(&mut scaling.typed, action);
        }
        Mode::Scale(_) => scale::take_back(state),
        Mode::Sketch(_) => sketch::take_back(state),
        Mode::Paint(_) => paint::take_back(state),
        Mode::Review
        | Mode::Place(_)
        | Mode::Root(_)
        | Mode::Shape(_)
        | Mode::Move(_)
        | Mode::Dial(_)
        | Mode::Label(_)
        | Mode::History { .. } => {}
    }
    Vec::new()
}

/// Opens the form of the plugin with this place in the list.
pub(super) fn open_plugin(state: &mut State, at: usize) {
    let Some(plugin) = state.plugins.get(at).cloned() else { return };
    open_form(state, plugin.task);
    if let Mode::Form(form) = &mut state.mode {
        form.choose(&plugin.name);
    }
}

fn next_theme(state: &mut State) {
    state.theme = (state.theme + 1) % state.themes.len().max(1);
    if let Some(theme) = state.themes.get(state.theme) {
        let line = format!("theme {}", theme.name);
        say(state, line);
    }
}

/// Takes the mouse, or leaves it to the terminal, where it selects text.
fn turn_mouse(state: &mut State) -> Vec<Effect> {
    state.mouse = !state.mouse;
    say(state, if state.mouse { "the mouse selects and places" } else { "the mouse is the terminal's" });
    vec![Effect::Mouse(state.mouse)]
}

pub(super) fn open_form(state: &mut State, task: Task) {
    let plugin = match task {
        Task::Track => "tracker-anchored",
        Task::Cluster => "clusterer-bod",
    };
    if !edit::is_writable(state) {
        return;
    }
    if task == Task::Cluster && state.tracks.len() < 2 {
        return complain(state, "two tracks or more can be grouped; t r follows features first");
    }
    match form(state, task) {
        Some(form) => state.mode = Mode::Form(Box::new(form)),
        None => complain(
            state,
            format!("no {} was found; `honami doctor` says where {plugin} is looked for", task.word()),
        ),
    }
}

/// Takes in plugins that were read anew. An open form keeps what was filled in, as far as they take it.
pub(super) fn on_plugins(state: &mut State, plugins: Vec<Plugin>) {
    let name = |plugin: &Plugin| (plugin.task, plugin.name.clone());
    let is_new = |plugin: &&Plugin| !state.plugins.contains(plugin);
    let new: Vec<String> =
        plugins.iter().filter(is_new).map(|p| format!("{} {}", p.name, p.version)).collect();
    let gone = state.plugins.iter().filter(|old| !plugins.iter().any(|new| name(new) == name(old)));
    let gone: Vec<String> = gone.map(|old| format!("{} is gone", old.name)).collect();
    let has_names = !(new.is_empty() && gone.is_empty());
    let what = match (new.is_empty(), gone.is_empty()) {
        (true, true) => "a plugin was rebuilt".to_owned(),
        (true, false) => gone.join(", "),
        (false, true) => format!("rebuilt: {}", new.join(", ")),
        (false, false) => format!("rebuilt: {}; {}", new.join(", "), gone.join(", ")),
    };
    state.plugins = plugins;
    if let Mode::Form(old) = &state.mode {
        let mode = form(state, old.task).map(|mut new| {
            new.take(old);
            Mode::Form(Box::new(new))
        });
        state.mode = mode.unwrap_or(Mode::Review);
    }
    let notice = Notice { text: what, is_error: false };
    // What says no more than that something changed replaces nothing, such as how a run has ended.
    if has_names || state.notice.is_none() {
        state.notice = Some(notice);
    }
}

/// The form of a task, as it is likely to be filled in; `None` where no plugin does it.
fn form(state: &State, task: Task) -> Option<Form> {
    let features: &[Features] = match state.selected {
        None if state.tracks.is_empty() => &[Features::Found],
        None => &[Features::Here, Features::Found],
        Some(_) if state.corrected == state.selected => {
            &[Features::Selected, Features::Here, Features::Found]
        }
        Some(_) => &[Features::Here, Features::Selected, Features::Found],
    };
    let (frames, n_frames) = (likely_frames(state), state.clip.n_frames());
    let wanted = Wanted { features, frames, n_frames, used: &state.used };
    let mut form = Form::new(task, &state.plugins, &wanted)?;
    // Likely the one whose run is on top.
    let last = state.tracker.as_deref().and_then(|tracker| tracker.split_whitespace().next());
    last.into_iter().for_each(|name| form.choose(name));
    Some(form)
}

/// The frames that a run is likely for: the marked range, else those that were tracked before, else all.
fn likely_frames(state: &State) -> Range<u32> {
    if let Some(range) = state.range {
        return range.frames(state.frame);
    }
    let tracked = state.tracks.iter().filter_map(TrackRow::tracked);
    let all = 0..state.clip.n_frames();
    tracked.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)).unwrap_or(all)
}

/// Shows a panel; the one that is shown goes.
pub(super) fn show_panel(state: &mut State, panel: Panel) {
    state.panel = Some(panel).filter(|panel| state.panel != Some(*panel));
}

fn turn_glyphs(state: &mut State) {
    if state.mono {
        return complain(state, "without colours the picture is letters");
    }
    state.glyphs = state.glyphs.next();
    let stills = match state.display.pixels {
        Some(pixels) if state.stills => format!("stills by {pixels}"),
        Some(_) => "no stills (v s)".to_owned(),
        None => "no stills: the terminal offers no pixels".to_owned(),
    };
    say(state, format!("{}, {}, {stills}", state.glyphs, state.display.depth));
}

fn turn_stills(state: &mut State) {
    state.stills = !state.stills;
    let line = match (state.stills, state.display.pixels) {
        (false, _) => "stills off: the picture stays in characters".to_owned(),
        (true, Some(pixels)) => format!("stills on: a picture that stays is shown by {pixels}"),
        (true, None) => "stills on, but the terminal offers no pixels".to_owned(),
    };
    say(state, line);
}
