//! A list to choose from by typing a part of a name: the palette, the help, the tracks.

use std::path::{Path, PathBuf};

use honami_model::clip::FrameTimes;
use honami_model::document::RunId;
use honami_model::track::TrackId;
use honami_workbench::versus::{Entrant, last_builds};

use super::action::{Action, Context, TABLE};
use super::files::{Lead, Listing};
use super::form::Plugin;
use super::fuzzy;
use super::groups::Groups;
use super::keymap::KeyMap;
use super::state::{Mode, State};
use super::tracks::TrackRow;
use super::typing;

/// What a row does when it is chosen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Choice {
    /// Calls an action.
    Action(Action),
    /// Selects a track.
    Track(TrackId),
    /// Swaps the selected track with it.
    Swap(TrackId),
    /// Joins it to the selected track.
    Join(TrackId),
    /// Merges the selected track's group with it, which counts from 0.
    MergeGroup(u32),
    /// Takes the picked tracks, else the selected one, into it.
    TakeInto(u32),
    /// Makes this run the first of two beside each other.
    First(RunId),
    /// Puts these two runs beside each other.
    Second(RunId, RunId),
    /// Goes to a frame.
    Frame(u32),
    /// Opens the form of the plugin with this place in the list.
    Plugin(usize),
    /// Opens a file, or lists another folder.
    File(Lead),
}

/// A row of a menu.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    /// What it is called.
    pub label: String,
    /// What it does or is.
    pub detail: String,
    /// Keys that do the same without the menu.
    pub keys: String,
    /// What choosing it does.
    pub choice: Choice,
}

/// A menu and what was typed into it.
#[derive(Clone, Debug)]
pub struct Menu {
    /// What it lists.
    pub title: &'static str,
    /// What was typed.
    pub typed: String,
    /// Position of the chosen row among the matching ones.
    pub at: usize,
    /// What keys meant before, and will again.
    pub below: Mode,
    /// The folder whose files it lists.
    folder: Option<PathBuf>,
    rows: Vec<Row>,
    matching: Vec<usize>,
}

impl Menu {
    fn new(title: &'static str, rows: Vec<Row>, below: Mode) -> Self {
        let matching = (0..rows.len()).collect();
        Self { title, typed: String::new(), at: 0, below, folder: None, rows, matching }
    }

    /// Every action that works in a place, as the palette or the help.
    #[must_use]
    pub fn of_actions(asked: Action, keys: &KeyMap, context: Context) -> Self {
        let title = if asked == Action::Help { "what works here" } else { "actions" };
        let rows = TABLE.iter().filter(|info| info.action.word_in(context).is_some());
        let rows = rows.map(|info| Row {
            label: info.name.replace('-', " "),
            detail: info.doc.to_owned(),
            keys: keys.all_keys_of(context, info.action).join("  "),
            choice: Choice::Action(info.action),
        });
        Self::new(title, rows.collect(), Mode::Review)
    }

    /// The same over what is open, which keys will mean again.
    #[must_use]
    pub fn over(self, below: Mode) -> Self {
        Self { below, ..self }
    }

    /// Every shown track.
    #[must_use]
    pub fn of_tracks(state: &State) -> Self {
        Self::of_rows(state, "tracks", state.listed(), Choice::Track)
    }

    /// Every shown track but the selected one, to do something with.
    #[must_use]
    pub fn of_others(state: &State, title: &'static str, choice: fn(TrackId) -> Choice) -> Self {
        let others = state.listed().into_iter().filter(|row| Some(row.id) != state.selected);
        Self::of_rows(state, title, others.collect(), choice)
    }

    fn of_rows(
        state: &State,
        title: &'static str,
        rows: Vec<&TrackRow>,
        choice: fn(TrackId) -> Choice,
    ) -> Self {
        let rows = rows.into_iter().map(|row| {
            let group = state.groups.as_ref().and_then(|g| g.of(row.id));
            let doubt = state.review.queue.of_track(row.id).next();
            let doubt = doubt.map_or_else(String::new, |item| format!("worst at {}", item.worst));
            Row {
                label: format!("track {} {}", row.id, row.name.as_deref().unwrap_or_default()),
                detail: group.map_or(doubt.clone(), |g| format!("group {}  {doubt}", g + 1)),
                keys: String::new(),
                choice: choice(row.id),
            }
        });
        Self::new(title, rows.collect(), Mode::Review)
    }

    /// Every group but one, to do something with.
    #[must_use]
    pub fn of_groups(groups: &Groups, but: u32, title: &'static str, choice: fn(u32) -> Choice) -> Self {
        let rows = (0..).zip(groups.sizes()).filter(|(group, _)| *group != but).map(|(group, size)| {
            let name = groups.names.get(group as usize).and_then(Option::as_deref).unwrap_or_default();
            Row {
                label: format!("group {} {name}", group + 1),
                detail: format!("{size} {}", if size == 1 { "track" } else { "tracks" }),
                keys: String::new(),
                choice: choice(group),
            }
        });
        Self::new(title, rows.collect(), Mode::Review)
    }

    /// The key-frames of a track.
    #[must_use]
    pub fn of_key_frames(track: &TrackRow, times: &FrameTimes) -> Self {
        let rows = track.keys.iter().map(|&frame| {
            let [x, y] = track.at(frame).unwrap_or_default();
            Row {
                label: format!("frame {frame}"),
                detail: format!("{:.2} s at {x:.1}, {y:.1}", times.get(frame).unwrap_or_default()),
                keys: String::new(),
                choice: Choice::Frame(frame),
            }
        });
        Self::new("key-frames", rows.collect(), Mode::Review)
    }

    /// The plugins that have a form.
    #[must_use]
    pub fn of_plugins(plugins: &[Plugin]) -> Self {
        let rows = plugins.iter().enumerate().map(|(at, plugin)| Row {
            label: plugin.name.clone(),
            detail: format!("{} {}", plugin.task.word(), plugin.version),
            keys: String::new(),
            choice: Choice::Plugin(at),
        });
        Self::new("plugins", rows.collect(), Mode::Review)
    }

    /// Runs to choose A from; or, where that is chosen, B.
    #[must_use]
    pub fn of_runs(a: Option<RunId>, entrants: &[Entrant]) -> Self {
        let rows = entrants.iter().map(|one| {
            let (first, last) = (one.frames.start, one.frames.end.saturating_sub(1));
            let hidden = if one.is_shown { "" } else { ", hidden" };
            Row {
                label: one.name(),
                detail: format!("{}, frames {first}-{last}{hidden}", one.tracks),
                keys: String::new(),
                choice: a.map_or(Choice::First(one.run), |a| Choice::Second(a, one.run)),
            }
        });
        // Nobody wants to look for these two among all.
        let builds = a.is_none().then(|| last_builds(entrants)).flatten().map(|[a, b]| Row {
            label: format!("the last two builds of {}", b.tracker),
            detail: format!("A {}, B {}", a.name(), b.name()),
            keys: String::new(),
            choice: Choice::Second(a.run, b.run),
        });
        let rows = builds.into_iter().chain(rows);
        let title = if a.is_none() { "A: the first of two runs" } else { "B: the run beside it" };
        Self::new(title, rows.collect(), Mode::Review)
    }

    /// The projects and clips of a folder.
    #[must_use]
    pub fn of_files(listing: Listing) -> Self {
        let rows = listing.rows.into_iter().map(|(label, detail, lead)| Row {
            label,
            detail,
            keys: String::new(),
            choice: Choice::File(lead),
        });
        let menu = Self::new("a project or a clip, or its path", rows.collect(), Mode::Review);
        Self { folder: Some(listing.folder), ..menu }
    }

    /// What was chosen; among files, a path may have been typed.
    #[must_use]
    pub fn choice(&self) -> Option<Choice> {
        let row = self.chosen().map(|row| row.choice.clone());
        let Some(folder) = &self.folder else { return row };
        let typed = self.typed.trim();
        if !typed.contains('/') && typed != "~" && (row.is_some() || typed.is_empty()) {
            return row;
        }
        let path = if typed.starts_with('~') { Path::new(typed).to_owned() } else { folder.join(typed) };
        Some(Choice::File(Lead::Typed(path)))
    }

    /// Whether what is done in it stays out of the log: in the palette and the help, of which there is what was chosen,
    /// and among files, where the session ends.
    #[must_use]
    pub fn is_unlogged(&self) -> bool {
        let is_of_actions = |row: &Row| matches!(row.choice, Choice::Action(_));
        self.folder.is_some() || self.rows.first().is_some_and(is_of_actions)
    }

    /// Chooses the row with this label, whatever was typed; whether there is one.
    pub fn choose(&mut self, label: &str) -> bool {
        let Some(at) = self.rows.iter().position(|row| row.label == label) else { return false };
        self.matching = (0..self.rows.len()).collect();
        self.at = at;
        true
    }

    /// The rows that match what was typed, best first.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &Row> {
        self.matching.iter().map(|&i| &self.rows[i])
    }

    /// The chosen row.
    #[must_use]
    pub fn chosen(&self) -> Option<&Row> {
        self.matching.get(self.at).map(|&i| &self.rows[i])
    }

    /// Changes what was typed, and with it the rows.
    pub fn retype(&mut self, change: impl FnOnce(&mut String)) {
        let before = self.typed.clone();
        change(&mut self.typed);
        if self.typed == before {
            return;
        }
        let lower = self.typed.to_lowercase();
        let mut scored: Vec<(i32, usize)> = Vec::new();
        for (i, row) in self.rows.iter().enumerate() {
            // A name counts for more than a key, a key for more than a word of the description.
            let name = fuzzy::score(&self.typed, &row.label).map(|s| s + 20);
            let key = (!self.typed.is_empty() && row.keys.split("  ").any(|k| k == self.typed)).then_some(90);
            let words = row.detail.split_whitespace();
            let detail = words.filter(|w| w.to_lowercase().starts_with(&lower)).count();
            let detail = (detail > 0).then_some(5);
            if let Some(score) = [name, key, detail].into_iter().flatten().max() {
                scored.push((score, i));
            }
        }
        if !self.typed.is_empty() {
            scored.sort_by_key(|&(score, i)| (std::cmp::Reverse(score), i));
        }
        self.matching = scored.into_iter().map(|(_, i)| i).collect();
        self.at = 0;
    }

    /// Types more into it.
    pub fn type_in(&mut self, more: impl Iterator<Item = char>) {
        self.retype(|typed| typing::append(typed, more, typing::TYPED_MAX));
    }

    /// Does what an action does in any list; whether it does anything there.
    pub fn act(&mut self, action: Action) -> bool {
        match action {
            Action::Up => self.step(-1),
            Action::Down => self.step(1),
            Action::Erase | Action::EraseLine => self.retype(|typed| typing::take_back(typed, action)),
            _ => return false,
        }
        true
    }

    /// Moves the choice by so many rows, staying in the list.
    pub fn step(&mut self, rows: i64) {
        let last = self.matching.len().saturating_sub(1);
        let at = i64::try_from(self.at).unwrap_or(0) + rows;
        self.at = usize::try_from(at).unwrap_or(0).min(last);
    }
}
