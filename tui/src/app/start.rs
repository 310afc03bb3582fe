//! The start screen: for those who have opened nothing yet.
//!
//! Its state and what keys and mouse do to it are pure; `Start::watch` is the only part that looks at the disk.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use super::action::{Action, Context};
use super::config::Config;
use super::door::{Gives, Offers};
use super::files::{self, Lead};
use super::keymap::{KeyMap, Read};
use super::menu::{Choice, Menu};
use super::opening::Plan;
use super::recent::{self, Recent};
use super::typing;
use super::view::{self, theme::Theme};
use crate::term::glyph::Glyphs;
use crate::term::input::{Event, Mouse, MouseKind};
use crate::term::key::Key;
use crate::term::screen::{End, Screen};

/// The rows before those of the offers.
const FILES: [(&str, &str); 2] =
    [("open…", "a project or a clip"), ("new from a clip…", "a project, also where the clip has one")];

/// The state of the start screen.
#[derive(Clone, Debug)]
pub struct Start {
    /// Projects opened lately, newest first.
    pub recent: Vec<Recent>,
    /// Names and descriptions of the rows below them.
    pub rows: Vec<(String, String)>,
    /// The chosen row, of all.
    pub at: usize,
    /// A list of files over it.
    pub menu: Option<Menu>,
    /// A text over it: its title, its lines, and the first that is shown.
    pub page: Option<(String, Vec<String>, usize)>,
    /// What went wrong.
    pub complaint: Option<String>,
    /// What this machine and this terminal have.
    pub about: String,
    /// The time, seconds since 1970.
    pub now_s: u64,
    /// Columns and rows of the terminal.
    pub size: (u16, u16),
    /// The live key map.
    pub keys: KeyMap,
    /// Keys of a sequence that is not whole yet.
    pub pending: Vec<Key>,
    /// The colours.
    pub theme: Option<Theme>,
    /// Whether what is found becomes a new project.
    is_new: bool,
}

/// What is to be done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Open this project.
    Open(PathBuf),
    /// Follow a lead among files.
    Follow(Lead),
    /// Give the offer with this place in the list.
    Offer(usize),
    /// Paint the screen anew.
    Redraw,
    /// Stop the program until it is continued.
    Suspend,
    /// Leave.
    Leave,
}

/// What the start screen has come to.
pub(super) enum Wanted {
    /// This is to be opened; these were typed after it.
    Open(Plan, Vec<Event>),
    /// Its user has left, or the terminal.
    Leave(Option<End>),
}

impl Start {
    /// A start screen with what was opened lately; `complaint` says what could not be opened.
    #[must_use]
    pub fn new(config: &Config, complaint: Option<String>) -> Self {
        Self {
            recent: Vec::new(),
            rows: FILES.iter().map(|(name, doc)| ((*name).to_owned(), (*doc).to_owned())).collect(),
            at: 0,
            menu: None,
            page: None,
            complaint: complaint.or_else(|| config.complaint()),
            about: String::new(),
            now_s: 0,
            size: (80, 24),
            keys: config.keys.clone(),
            pending: Vec::new(),
            theme: config.themes.get(config.theme).cloned(),
            is_new: false,
        }
    }

    /// Where keys are read.
    #[must_use]
    pub fn context(&self) -> Context {
        if self.menu.is_some() { Context::Menu } else { Context::Start }
    }

    /// Number of rows to choose from.
    #[must_use]
    pub fn n_rows(&self) -> usize {
        self.recent.len() + self.rows.len()
    }

    /// A key was pressed.
    pub fn on_key(&mut self, key: Key) -> Option<Wish> {
        match self.keys.read(self.context(), &mut self.pending, key) {
            Read::Action(action) => {
                self.complaint = None;
                return self.act(action);
            }
            Read::Text(c) => self.menu.iter_mut().for_each(|menu| menu.type_in([c].into_iter())),
            Read::Nothing => {}
        }
        None
    }

    /// Text was pasted.
    pub fn on_paste(&mut self, text: &str) {
        self.menu.iter_mut().for_each(|menu| menu.type_in(typing::pasted(text).chars()));
    }

    /// The mouse did something.
    pub fn on_mouse(&mut self, mouse: Mouse) -> Option<Wish> {
        match mouse.kind {
            MouseKind::WheelUp => self.step(-1),
            MouseKind::WheelDown => self.step(1),
            MouseKind::Press(0) => {
                let at = view::start::row_at(self, mouse.row)?;
                match &mut self.menu {
                    Some(menu) => menu.at = at,
                    None => self.at = at,
                }
                return self.accept();
            }
            _ => {}
        }
        None
    }

    fn act(&mut self, action: Action) -> Option<Wish> {
        if self.menu.as_mut().is_some_and(|menu| menu.act(action)) {
            return None;
        }
        match action {
            Action::Up => self.step(-1),
            Action::Down => self.step(1),
            Action::Accept => return self.accept(),
            Action::GoFile => return Some(self.browse(false)),
            Action::Back | Action::Quit if self.menu.is_some() || self.page.is_some() => {
                (self.menu, self.page) = (None, None);
            }
            Action::Back | Action::Quit | Action::Leave => return Some(Wish::Leave),
            Action::Redraw => return Some(Wish::Redraw),
            Action::Suspend => return Some(Wish::Suspend),
            // The rest does not work here.
            _ => {}
        }
        None
    }

    /// Chooses a row so many further down, or reads on.
    fn step(&mut self, rows: i64) {
        let moved = |at: usize, n: usize| {
            at.saturating_add_signed(isize::try_from(rows).unwrap_or(0)).min(n.saturating_sub(1))
        };
        match (&mut self.menu, &mut self.page) {
            (Some(menu), _) => menu.step(rows),
            (None, Some((_, lines, first))) => *first = moved(*first, lines.len()),
            (None, None) => self.at = moved(self.at, self.n_rows()),
        }
    }

    fn accept(&mut self) -> Option<Wish> {
        if let Some(menu) = &self.menu {
            return match menu.choice()? {
                Choice::File(lead) => Some(Wish::Follow(lead)),
                _ => None,
            };
        }
        if self.page.take().is_some() {
            return None;
        }
        if let Some(recent) = self.recent.get(self.at) {
            return Some(Wish::Open(recent.path.clone()));
        }
        match self.at - self.recent.len() {
            0 => Some(self.browse(false)),
            1 => Some(self.browse(true)),
            n => Some(Wish::Offer(n - FILES.len())),
        }
    }

    fn browse(&mut self, is_new: bool) -> Wish {
        self.is_new = is_new;
        Wish::Follow(Lead::Folder(PathBuf::from(".")))
    }

    /// Shows it until something is chosen, or somebody leaves.
    pub(super) fn watch(mut self, screen: &mut Screen, offers: &Offers) -> anyhow::Result<Wanted> {
        self.rows.extend(offers.rows.iter().map(|row| (row.name.to_owned(), row.doc.to_owned())));
        (self.recent, self.now_s) = (recent::load(), recent::now_s());
        let machine = look_at_machine(screen, offers.machine)?;
        let glyphs = Glyphs::from_env(|name| std::env::var(name).ok()).unwrap_or_default();
        let mut is_shown = false;
        screen.forget();
        loop {
            let found = machine.lock().unwrap_or_else(PoisonError::into_inner).clone();
            let about = format!("{found}display: {glyphs}, {}", screen.depth());
            is_shown &= self.about == about && self.size == screen.size();
            (self.about, self.size) = (about, screen.size());
            if !is_shown && screen.has_slot() {
                is_shown = screen.paint(&view::start::draw(&self), false)?;
            }
            let happened = screen.wait(None, !is_shown)?;
            if happened.end.is_some() {
                return Ok(Wanted::Leave(happened.end));
            }
            let mut events = happened.events.into_iter();
            let mut suspends = happened.suspend;
            while let Some(event) = events.next() {
                is_shown &= matches!(event, Event::Reply(_));
                let wish = match event {
                    Event::Key(key) => self.on_key(key),
                    Event::Mouse(mouse) => self.on_mouse(mouse),
                    Event::Paste(text) => {
                        self.on_paste(&text);
                        None
                    }
                    Event::Reply(_) => None,
                };
                match wish {
                    Some(Wish::Leave) => return Ok(Wanted::Leave(None)),
                    Some(Wish::Suspend) => suspends = true,
                    Some(Wish::Redraw) => screen.forget(),
                    Some(wish) => {
                        if let Some(plan) = self.grant(wish, offers) {
                            return Ok(Wanted::Open(plan, events.collect()));
                        }
                    }
                    None => {}
                }
            }
            if suspends {
                screen.suspend()?;
            }
            if happened.resized || suspends {
                screen.forget();
                is_shown = false;
            }
        }
    }

    /// Does what is wished; returns what is to be opened.
    fn grant(&mut self, wish: Wish, offers: &Offers) -> Option<Plan> {
        match wish {
            Wish::Open(path) => return Some(Plan::of(&path, &offers.options)),
            Wish::Follow(lead) => match files::follow(&lead) {
                Ok(files::Found::File(path)) => return Some(self.plan(&path, offers)),
                Ok(files::Found::Folder(listing)) => self.menu = Some(Menu::of_files(listing)),
                Err(line) => self.complaint = Some(line),
            },
            Wish::Offer(at) => {
                let row = offers.rows.get(at)?;
                match &row.gives {
                    Gives::Plan(plan) => return Some(plan()),
                    Gives::Text(text) => {
                        let lines = text().lines().map(str::to_owned).collect();
                        self.page = Some((row.name.to_owned(), lines, 0));
                    }
                }
            }
            Wish::Redraw | Wish::Suspend | Wish::Leave => {}
        }
        None
    }

    fn plan(&self, path: &Path, offers: &Offers) -> Plan {
        let is_project = path.extension().is_some_and(|e| e == "honami");
        if self.is_new && !is_project {
            Plan::anew(path, &offers.options)
        } else {
            Plan::of(path, &offers.options)
        }
    }
}

/// Finds out what this machine has, without anybody waiting for it.
fn look_at_machine(screen: &Screen, look: fn() -> String) -> std::io::Result<Arc<Mutex<String>>> {
    let found = Arc::new(Mutex::new(String::new()));
    let (told, waker) = (Arc::clone(&found), screen.waker());
    std::thread::Builder::new().name("machine".to_owned()).spawn(move || {
        let line = format!("{} · ", look());
        *told.lock().unwrap_or_else(PoisonError::into_inner) = line;
        waker.wake();
    })?;
    Ok(found)
}

#[cfg(test)]
pub(in crate::app) mod tests;
