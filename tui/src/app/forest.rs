//! A forest in the terminal: copies of a plant in the wind, seen from wherever keys and mouse go.
//!
//! What keys do is pure; `Forest::watch` is the only part that knows the screen and the thread that moves and draws.

mod moving;
#[cfg(test)]
mod tests;

use std::time::Duration;

use honami_workbench::plant::weather;
use honami_workbench::scene::{ForestScene, Orbit};

use super::action::{Action, Context};
use super::config::Config;
use super::keymap::{KeyMap, Read};
use super::menu::{Choice, Menu};
use super::typing::{self, TYPED_MAX};
use super::view::{self, theme::Theme};
use crate::term::glyph::Glyphs;
use crate::term::input::{Event, Mouse, MouseKind};
use crate::term::key::Key;
use crate::term::screen::{End, Screen};
use moving::{Order, Worker};

/// Between two pictures at least: more cost the link more than they show.
const APART: Duration = Duration::from_millis(50);
/// Keys turn the eye by so much, radians.
const TURN: f32 = 0.13;
/// Or it goes so many times as near.
const NEARER: f32 = 1.0 / 1.25;
/// Radians by a cell that the mouse drags.
const BY_CELL: f32 = 0.03;
/// Of the eye above the ground, radians.
const ELEVATIONS: [f32; 2] = [0.0, 1.5];
/// Keys make a wind so many times as strong; one that is still becomes one of so much, metres per second.
const STRONGER: f64 = 1.25;
const LEAST_SPEED: f64 = 0.5;
/// No keys make it stronger than hurricanes are; one that was typed so stays so.
const MOST_SPEED: f64 = 60.0;
/// And turn it by so much, degrees.
const VEER: f64 = 15.0;

/// What a forest looked like at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Shot {
    /// Pixels, across and down.
    pub size: [u32; 2],
    /// Row by row.
    pub pixels: Vec<[u8; 3]>,
    /// Seconds since it was first shown.
    pub time: f64,
    /// The wind at the crown of the first copy, metres per second.
    pub wind: [f64; 3],
}

/// The state of the screen.
#[derive(Clone, Debug)]
pub struct Forest {
    /// What the plant is called.
    pub name: String,
    /// What there is: `100 copies, 25 modes`.
    pub told: String,
    /// From where it is seen.
    pub orbit: Orbit,
    /// From where it is seen at first.
    begun: Orbit,
    /// The wind, as it is typed.
    pub wind: String,
    /// How many have been typed: each begins anew.
    n_typed: u32,
    /// Whether time goes on.
    pub is_playing: bool,
    /// Steps that are to be taken while it does not.
    steps: u32,
    /// A list over the picture: the palette, or the help.
    pub menu: Option<Menu>,
    /// What is being typed as another wind.
    pub typed: Option<String>,
    /// What was typed last and is none.
    refused: String,
    /// What went wrong.
    pub complaint: Option<String>,
    /// The picture at hand.
    pub shot: Option<Shot>,
    /// Columns and rows of the terminal.
    pub size: (u16, u16),
    /// The live key map.
    pub keys: KeyMap,
    /// Keys of a sequence that is not whole yet.
    pub pending: Vec<Key>,
    /// The colours.
    pub theme: Option<Theme>,
    /// Which characters show the picture.
    pub glyphs: Glyphs,
    /// Cell at which the mouse last was while it drags.
    dragged: Option<(u16, u16)>,
}

/// What is to be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Paint the screen anew.
    Redraw,
    /// Stop the program until it is continued.
    Suspend,
    /// Leave.
    Leave,
}

impl Forest {
    /// A forest that goes on, from where its scene has its eye.
    #[must_use]
    pub fn new(scene: &ForestScene, config: &Config) -> Self {
        let (n_copies, n_modes) = (scene.places.len(), scene.stirring.n_modes());
        let copies = if n_copies == 1 { "1 plant".to_owned() } else { format!("{n_copies} plants") };
        Self {
            name: scene.name.clone(),
            told: format!("{copies}, {n_modes} modes"),
            orbit: scene.orbit,
            begun: scene.orbit,
            wind: scene.wind.clone(),
            n_typed: 0,
            is_playing: true,
            steps: 0,
            menu: None,
            typed: None,
            refused: String::new(),
            complaint: config.complaint(),
            shot: None,
            size: (80, 24),
            keys: config.keys.clone(),
            pending: Vec::new(),
            theme: config.themes.get(config.theme).cloned(),
            glyphs: Glyphs::default(),
            dragged: None,
        }
    }

    /// Where keys are read.
    #[must_use]
    pub fn context(&self) -> Context {
        match (&self.menu, &self.typed) {
            (Some(_), _) => Context::Menu,
            (None, Some(_)) => Context::Prompt,
            (None, None) => Context::Forest,
        }
    }

    /// A key was pressed.
    pub fn on_key(&mut self, key: Key) -> Option<Wish> {
        match self.keys.read(self.context(), &mut self.pending, key) {
            Read::Action(action) => {
                self.complaint = None;
                return self.act(action);
            }
            Read::Text(c) => self.on_text(c.encode_utf8(&mut [0; 4])),
            Read::Nothing => {}
        }
        None
    }

    /// Text was typed or pasted.
    pub fn on_text(&mut self, text: &str) {
        match (&mut self.menu, &mut self.typed) {
            (Some(menu), _) => menu.type_in(text.chars()),
            (None, Some(typed)) => typing::append(typed, text.chars(), TYPED_MAX),
            (None, None) => {}
        }
    }

    /// The mouse goes round the forest, its wheel nearer and farther away; in a list they choose.
    pub fn on_mouse(&mut self, mouse: Mouse) -> Option<Wish> {
        let at = (mouse.column, mouse.row);
        let pointed = view::forest::row_at(self, mouse.row);
        match (mouse.kind, &mut self.menu) {
            (MouseKind::WheelUp, Some(menu)) => menu.step(-1),
            (MouseKind::WheelDown, Some(menu)) => menu.step(1),
            (MouseKind::Press(0), Some(menu)) => {
                menu.at = pointed?;
                return self.choose();
            }
            (_, Some(_)) => self.dragged = None,
            (_, None) => self.look_about(mouse.kind, at),
        }
        None
    }

    fn look_about(&mut self, kind: MouseKind, at: (u16, u16)) {
        match kind {
            MouseKind::WheelUp => self.orbit.zoom(NEARER),
            MouseKind::WheelDown => self.orbit.zoom(1.0 / NEARER),
            MouseKind::Press(0) => self.dragged = Some(at),
            MouseKind::Drag(0) => {
                let Some((column, row)) = self.dragged.replace(at) else { return };
                let by = |to: u16, from: u16| f32::from(to) - f32::from(from);
                // A cell is twice as high as wide.
                self.go_round(-BY_CELL * by(at.0, column), 2.0 * BY_CELL * by(at.1, row));
            }
            _ => self.dragged = None,
        }
    }

    fn act(&mut self, action: Action) -> Option<Wish> {
        if self.menu.as_mut().is_some_and(|menu| menu.act(action)) {
            return None;
        }
        match action {
            Action::Left | Action::OrbitLeft => self.go_round(-TURN, 0.0),
            Action::Right | Action::OrbitRight => self.go_round(TURN, 0.0),
            Action::Up => self.go_round(0.0, TURN),
            Action::Down => self.go_round(0.0, -TURN),
            Action::ZoomIn => self.orbit.zoom(NEARER),
            Action::ZoomOut => self.orbit.zoom(1.0 / NEARER),
            Action::Front => self.orbit = self.begun,
            Action::PlayPause => self.is_playing ^= true,
            Action::StepForward => {
                self.is_playing = false;
                self.steps += 1;
            }
            Action::MoreGroups => self.turn_wind("speed", stronger),
            Action::FewerGroups => self.turn_wind("speed", |v| v / STRONGER),
            Action::FineLeft => self.turn_wind("towards", |v| (v + VEER).rem_euclid(360.0)),
            Action::FineRight => self.turn_wind("towards", |v| (v - VEER).rem_euclid(360.0)),
            Action::Wind => self.typed = Some(std::mem::take(&mut self.refused)),
            Action::Palette | Action::Help => {
                self.menu = Some(Menu::of_actions(action, &self.keys, Context::Forest));
            }
            Action::Accept if self.menu.is_some() => return self.choose(),
            Action::Accept => {
                let typed = self.typed.take().map(|typed| typed.trim().to_owned());
                if let Some(typed) = typed.filter(|typed| !typed.is_empty()) {
                    self.wind = typed;
                    self.n_typed += 1;
                }
            }
            Action::Erase | Action::EraseLine => {
                self.typed.iter_mut().for_each(|typed| typing::take_back(typed, action));
            }
            Action::Glyphs => self.glyphs = self.glyphs.next(),
            Action::Back if self.menu.take().is_some() || self.typed.take().is_some() => {}
            Action::Back => {
                let quit = self.keys.keys_of(Context::Forest, Action::Quit).unwrap_or_default();
                self.complaint = Some(format!("{quit} leaves"));
            }
            Action::Quit | Action::Leave => return Some(Wish::Leave),
            Action::Redraw => return Some(Wish::Redraw),
            Action::Suspend => return Some(Wish::Suspend),
            // The rest does not work here.
            _ => {}
        }
        None
    }

    /// Closes the list and does what was chosen in it.
    fn choose(&mut self) -> Option<Wish> {
        match self.menu.take()?.choice()? {
            Choice::Action(action) => self.act(action),
            _ => None,
        }
    }

    fn go_round(&mut self, by: f32, up: f32) {
        let full = std::f32::consts::TAU;
        self.orbit.azimuth = (self.orbit.azimuth + by).rem_euclid(full);
        self.orbit.elevation = (self.orbit.elevation + up).clamp(ELEVATIONS[0], ELEVATIONS[1]);
    }

    /// Changes a value of the wind, where it has one of that name.
    fn turn_wind(&mut self, name: &str, turned: impl Fn(f64) -> f64) {
        // To a hundredth: nobody wants to read more.
        let value = weather::value(&self.wind, name).map(|v| (turned(v) * 100.0).round() / 100.0);
        match value.and_then(|value| weather::with_value(&self.wind, name, value)) {
            Some(wind) => self.wind = wind,
            None => self.complaint = Some(format!("{} has no {name} to change: choose another", self.wind)),
        }
    }

    /// Shows it until somebody leaves.
    ///
    /// # Errors
    /// What the terminal met; that there is no thread; what the scene cannot be.
    pub(super) fn watch(mut self, scene: ForestScene, screen: &mut Screen) -> anyhow::Result<Option<End>> {
        self.glyphs = Glyphs::from_env(|name| std::env::var(name).ok()).unwrap_or_default();
        let mut worker = Worker::new(scene, screen.waker());
        let (mut painted, mut last) = (None, Duration::ZERO);
        screen.forget();
        loop {
            self.size = screen.size();
            let now = screen.now();
            match worker.news()? {
                Some(Ok(shot)) => {
                    self.shot = Some(shot);
                    painted = None;
                }
                Some(Err(why)) => {
                    self.complaint = Some(why);
                    // What blows on is the wind before; what was typed is there to be mended.
                    self.refused = std::mem::replace(&mut self.wind, worker.wind().to_owned());
                    painted = None;
                }
                None => {}
            }
            let is_due = !worker.is_busy() && screen.has_slot() && now >= last + APART;
            if let Some(order) = self.order(screen.is_mono()).filter(|order| is_due && worker.wants(order)) {
                worker.ask(order, now)?;
                (self.steps, last) = (0, now);
            }
            let is_moving = self.is_playing || worker.is_busy();
            if painted != Some(true) && screen.has_slot() && (painted.is_none() || !is_moving) {
                let is_exact = screen.paint(&view::forest::draw(&self, screen.is_mono()), is_moving)?;
                painted = Some(is_exact && !is_moving);
            }
            let next = (self.is_playing && !worker.is_busy()).then_some(last + APART);
            let happened = screen.wait(next, painted != Some(true))?;
            if happened.end.is_some() {
                return Ok(happened.end);
            }
            let mut suspends = happened.suspend;
            for event in happened.events {
                if !matches!(event, Event::Reply(_)) {
                    painted = None;
                }
                match self.hear(event) {
                    Some(Wish::Leave) => return Ok(None),
                    Some(Wish::Suspend) => suspends = true,
                    Some(Wish::Redraw) => screen.forget(),
                    None => {}
                }
            }
            if suspends {
                screen.suspend()?;
            }
            if happened.resized || suspends {
                screen.forget();
                painted = None;
            }
        }
    }

    fn hear(&mut self, event: Event) -> Option<Wish> {
        match event {
            Event::Key(key) => return self.on_key(key),
            Event::Mouse(mouse) => return self.on_mouse(mouse),
            Event::Paste(text) => self.on_text(&typing::pasted(&text)),
            Event::Reply(_) => {}
        }
        None
    }

    /// What is to be seen now.
    fn order(&self, is_mono: bool) -> Option<Order> {
        let area = view::forest::picture(self);
        let (across, down) = self.shown_glyphs(is_mono).grid();
        let size = [across * u32::from(area.width), down * u32::from(area.height)];
        (size[0] > 0 && size[1] > 0).then(|| Order {
            orbit: self.orbit,
            wind: self.wind.clone(),
            n_typed: self.n_typed,
            size,
            // A cell is twice as high as wide.
            n_square: 2 * across * u32::from(area.height),
            is_playing: self.is_playing,
            n_steps: self.steps,
        })
    }

    /// The characters that show the picture: without colours, one brightness a cell.
    #[must_use]
    pub fn shown_glyphs(&self, is_mono: bool) -> Glyphs {
        if is_mono { Glyphs::Halves } else { self.glyphs }
    }
}

/// A speed made stronger, the way it blows.
fn stronger(speed: f64) -> f64 {
    let most = MOST_SPEED.max(speed.abs());
    (speed.abs() * STRONGER).clamp(LEAST_SPEED, most).copysign(speed)
}
