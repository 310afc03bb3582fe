//! What the world tells the state.

use std::sync::Arc;
use std::time::Duration;

use honami_model::correct::Layers;
use honami_model::document::RunId;
use honami_model::history::{Entry, EntryId};
use honami_workbench::matting::{Mark, Parts};
use honami_workbench::review::Told;

use super::{
    Mode, State, actions, logged, motion, moving, offers, paint, queue, skeleton, sketch, tell, time, versus,
};
use crate::app::correcting::Answer;
use crate::app::dense::FieldOf;
use crate::app::files::Listing;
use crate::app::form::{Plugin, Used};
use crate::app::groups::Groups;
use crate::app::in_space::InSpace;
use crate::app::menu::Menu;
use crate::app::plotted::Subject;
use crate::app::prints::Print;
use crate::app::recovery::Recovery;
use crate::app::skeleton::{Bones, Hand};
use crate::app::state::{Display, Job, Link, Notice};
use crate::app::tracks::TrackRow;
use crate::viewer::Heard;
use honami_workbench::plots::Plots;
use honami_workbench::scale::ScaleBar;
use honami_workbench::versus::{Compared, Entrant};

/// Something that has changed in the world.
#[derive(Clone, Debug)]
pub enum Fact {
    /// The tracks are these now, in order of their numbers.
    Tracks(Vec<TrackRow>),
    /// This has changed of the review.
    Review(Vec<Told>),
    /// The shown clustering is this now.
    Groups(Option<Box<Groups>>),
    /// This was done by hand to the skeleton of the shown groups.
    Hand(Hand),
    /// These tracks in space are kept now.
    Space(Option<InSpace>),
    /// This scale bar is kept now.
    Scale(Option<ScaleBar>),
    /// The tracker whose run is on top.
    Tracker(Option<String>),
    /// What a track is made from; `None` where it is not shown any more.
    Layers(Option<Arc<Layers>>),
    /// Something was worked out for the sample that is moved.
    Offered(Answer),
    /// A new track was placed: it becomes the selected one.
    Placed(honami_model::track::TrackId),
    /// A correction was made, and with it perhaps a new track: that becomes the selected one.
    Corrected(Option<honami_model::track::TrackId>),
    /// This track is there again, by undo or redo: it becomes the selected one.
    ThereAgain(honami_model::track::TrackId),
    /// A job began, went on, or ended.
    Job(Option<Job>),
    /// Plugins have printed or logged this.
    Printed(Vec<Print>),
    /// This can be done about what has ended early.
    Recovery(Option<Recovery>),
    /// These plugins there are from now on.
    Plugins(Vec<Plugin>),
    /// Plugins were told this last.
    Used(Vec<Used>),
    /// Something has become of a job on its way.
    Happened(String),
    /// Something worth a line.
    Said(Notice),
    /// What is known of the link.
    Link(Link),
    /// A picture of the clip that plays was on screen so late.
    Late(Duration),
    /// Pictures per second that were shown and that were due, where some were dropped.
    Dropped(Option<[u32; 2]>),
    /// What is known of the terminal.
    Display(Display),
    /// Curves were worked out.
    Plots((Subject, u64), std::sync::Arc<Plots>),
    /// This tracker measures dense motion from now on.
    Measures(String),
    /// The dense motion that is shown; `None` while it is being measured.
    Dense(Option<FieldOf>),
    /// Dense motion cannot be measured, for this reason.
    NotMeasured(String),
    /// These two runs are beside each other from now on; `None`: there are no two of the same tracks.
    Versus(Option<Box<[Entrant; 2]>>),
    /// These runs can be beside each other, or beside the one that was chosen first.
    Entrants(Option<RunId>, Vec<Entrant>),
    /// What became of comparing these two runs.
    Compared([RunId; 2], Result<Arc<Compared>, String>),
    /// The project keeps this matte of this frame: its marks, its parts.
    Matte(u32, Arc<Vec<Mark>>, Arc<Parts>),
    /// The matte of this frame was found, of so many strokes; with the line that says so.
    Matted((u32, usize), Arc<Parts>, String),
    /// What became of growing the skeleton of this revision.
    Grown(u64, Result<Arc<Bones>, String>),
    /// This was heard of the viewer's window.
    Window(Heard),
    /// So many frames can be shown without waiting.
    Ready(u32),
    /// The undo tree has these entries more, and the document stands there.
    History(Vec<Entry>, EntryId),
    /// These files there are to choose from.
    Files(Listing),
    /// What was asked for has failed: nothing has changed.
    Refused,
}

pub(super) fn on_fact(state: &mut State, fact: Fact) {
    match fact {
        Fact::Tracks(rows) => on_tracks(state, rows),
        Fact::Layers(layers) => {
            sketch::on_layers(state, layers.as_ref());
            moving::on_layers(state, layers);
        }
        Fact::Offered(answer) => offers::on_answer(state, answer),
        Fact::Late(by) => {
            if let Mode::Sketch(sketching) = &mut state.mode {
                sketching.late(by);
            }
        }
        Fact::Review(told) => {
            told.into_iter().for_each(|(track, segments)| state.review.set(track, segments));
        }
        Fact::Groups(groups) => on_groups(state, groups.map(|groups| *groups)),
        Fact::Plots(subject, plots) => state.plotted.plots = Some((subject, plots)),
        Fact::Hand(hand) => skeleton::on_hand(state, hand),
        Fact::Space(space) => state.space = space,
        Fact::Scale(bar) => state.scale = bar,
        Fact::Tracker(tracker) => state.tracker = tracker,
        Fact::Placed(track) => {
            state.selected = Some(track);
            state.corrected = Some(track);
        }
        Fact::Corrected(made) => {
            state.range = None;
            state.selected = made.or(state.selected);
        }
        Fact::ThereAgain(track) => {
            let missed = state.missed.take().filter(|missed| state.row(*missed).is_some());
            time::select(state, missed.unwrap_or(track));
        }
        Fact::Job(job) => on_job(state, job),
        Fact::Used(used) => state.used = used,
        Fact::Plugins(plugins) => actions::on_plugins(state, plugins),
        Fact::Happened(text) => happened(state, text, false),
        Fact::Said(notice) => tell(state, notice),
        Fact::Link(link) => state.link = link,
        Fact::Dropped(dropped) => state.dropped = dropped.filter(|_| state.play.is_some()),
        Fact::Display(display) => state.display = display,
        Fact::Measures(plugin) => motion::on_measures(state, plugin),
        Fact::Dense(field) => motion::on_field(state, field),
        Fact::NotMeasured(text) => {
            state.dense = None;
            happened(state, text, true);
        }
        Fact::Versus(runs) => versus::on_runs(state, runs.map(|runs| *runs)),
        Fact::Entrants(first, entrants) => versus::on_entrants(state, first, entrants),
        Fact::Compared(runs, compared) => versus::on_compared(state, runs, compared),
        Fact::Matte(frame, marks, parts) => paint::on_kept(state, frame, marks, parts),
        Fact::Matted(of, parts, line) => paint::on_found(state, of, parts, line),
        Fact::Grown(revision, grown) => skeleton::on_grown(state, revision, grown),
        // They ask for effects.
        Fact::Window(_) => {}
        Fact::Ready(n) => state.n_ready = n,
        Fact::History(new, head) => {
            let (from, has_grown) = (state.history.head, !new.is_empty());
            state.history.grow(new, head);
            queue::on_history(state, from, has_grown);
        }
        Fact::Recovery(recovery) => state.recovery = recovery,
        Fact::Printed(lines) => state.prints.add(lines),
        Fact::Refused => {
            if let Some(before) = state.before.take() {
                before.put_back(state);
                skeleton::pose(state);
            }
        }
        Fact::Files(listing) => state.mode = Mode::Menu(Box::new(Menu::of_files(listing))),
    }
}

/// What one job has left to be done is gone with the next.
fn on_job(state: &mut State, job: Option<Job>) {
    if let (Some(old), None) = (&state.job, &job) {
        let plugin = old.plugin.clone();
        logged::ended(state, plugin);
    }
    if state.job.is_none() && job.is_some() {
        state.recovery = None;
    }
    let was_stopping = state.job.as_ref().is_some_and(|old| old.is_stopping);
    state.job = job.map(|job| Job { is_stopping: job.is_stopping || was_stopping, ..job });
}

/// Says what has come about in its own time, and is no answer to a key: it has no place in the log.
pub(super) fn happened(state: &mut State, text: String, is_error: bool) {
    state.notice = Some(Notice { text, is_error });
}

fn on_groups(state: &mut State, groups: Option<Groups>) {
    if state.groups != groups {
        let of = |groups: &Option<Groups>| groups.as_ref().map(|groups| groups.clustering);
        let is_regrouped = of(&state.groups) != of(&groups);
        skeleton::on_groups(state, is_regrouped);
    }
    if groups.is_none() {
        state.skeleton.wither();
    }
    state.groups = groups;
    state.plotted.revision += 1;
}

fn on_tracks(state: &mut State, rows: Vec<TrackRow>) {
    let is_same = |(old, new): (&TrackRow, &TrackRow)| old.id == new.id && Arc::ptr_eq(&old.span, &new.span);
    if state.tracks.len() != rows.len() || !state.tracks.iter().zip(&rows).all(is_same) {
        state.skeleton.outdate();
        state.window.outdate();
    }
    state.tracks = rows;
    state.plotted.revision += 1;
    versus::on_tracks(state);
    let (tracks, picked) = (&state.tracks, &mut state.picked);
    picked.retain(|track| tracks.binary_search_by_key(track, |row| row.id).is_ok());
    if state.selected.is_none_or(|track| state.row(track).is_none()) {
        state.missed = state.selected.or(state.missed);
        state.selected = state.tracks.first().map(|row| row.id);
    }
    // The sample being moved is gone: there is nothing to keep.
    let track = match &state.mode {
        Mode::Move(moving) => Some(moving.track),
        Mode::Sketch(sketching) => Some(sketching.track),
        _ => None,
    };
    if track.is_some_and(|track| state.row(track).is_none()) {
        state.mode = Mode::Review;
        state.held.clear();
    }
}
