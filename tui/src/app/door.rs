//! One screen from the first byte to the last: the start screen, projects one after the other, and the end.

use std::path::PathBuf;
use std::time::Duration;

use anyhow::Context as _;
use honami_workbench::scene::ForestScene;
use honami_workbench::session::SessionOptions;

use super::command_log::LogFile;
use super::config::Config;
use super::effects::World;
use super::forest::Forest;
use super::opening::{Opened, Opening, Plan};
use super::run::{App, Next, Turned};
use super::seat::Seat;
use super::start::{Start, Wanted};
use crate::term::screen::{End, Screen};
use crate::term::signals;

/// So long a job may take to stop when the session is ended from outside.
const LAST_WAIT: Duration = Duration::from_millis(800);

/// What can be had besides files.
pub struct Offers {
    /// With what projects are opened.
    pub options: SessionOptions,
    /// Rows of the start screen.
    pub rows: Vec<Offer>,
    /// The tutorial.
    pub lesson: Box<dyn Fn() -> Plan>,
    /// What this machine has, in a few words; may take a moment to find out.
    pub machine: fn() -> String,
}

/// A row of the start screen.
pub struct Offer {
    /// Its name.
    pub name: &'static str,
    /// What it is.
    pub doc: &'static str,
    /// What choosing it gives.
    pub gives: Gives,
}

/// What choosing something gives.
pub enum Gives {
    /// A session.
    Plan(Box<dyn Fn() -> Plan>),
    /// A text to read.
    Text(Box<dyn Fn() -> String>),
}

/// Shows the start screen, or what `first` opens, and then whatever is chosen, until the user leaves or the terminal
/// does; returns what ended it against its user's wish.
///
/// # Errors
/// When there is no terminal, or `first` cannot be opened. What is chosen on screen and cannot be opened is said there.
pub fn run(first: Option<Plan>, offers: &Offers) -> anyhow::Result<Option<End>> {
    let config = Config::load().beginning();
    let mut screen = Screen::open(&log_path()).context("the terminal UI cannot start")?;
    if !config.mouse {
        screen.set_mouse(false)?;
    }
    let mut last = None;
    let outcome = go_about(first, offers, &config, &mut screen, &mut last);
    let closed = screen.close();
    signals::end_as_usual()?;
    if let Some((world, seat)) = last {
        // Nobody waits for a job whose terminal is gone, and what ends a session may soon end it by force.
        let is_wished = !matches!(outcome, Ok(Some(_)));
        world.close(seat, (!is_wished).then_some(LAST_WAIT))?;
    }
    let end = outcome?;
    closed?;
    Ok(end)
}

/// Shows a forest until its user leaves or the terminal does; returns what ended it against its user's wish.
///
/// # Errors
/// When there is no terminal, or it cannot be shown.
pub fn forest(scene: ForestScene) -> anyhow::Result<Option<End>> {
    let config = Config::load().beginning();
    let mut screen = Screen::open(&log_path()).context("the terminal UI cannot start")?;
    if !config.mouse {
        screen.set_mouse(false)?;
    }
    let outcome = Forest::new(&scene, &config).watch(scene, &mut screen);
    let closed = screen.close();
    signals::end_as_usual()?;
    let end = outcome?;
    closed?;
    Ok(end)
}

/// Opens one after the other. What is open at the end stays in `last`: closing it may take a while.
fn go_about(
    first: Option<Plan>,
    offers: &Offers,
    config: &Config,
    screen: &mut Screen,
    last: &mut Option<(World, Seat)>,
) -> anyhow::Result<Option<End>> {
    // What cannot be opened at first is the command's to say.
    let mut is_first = first.is_some();
    let (mut next, mut typed, mut complaint) = (first, Vec::new(), None);
    // What its user has left to be opened behind the start screen.
    let mut aside: Option<(PathBuf, Opening)> = None;
    loop {
        let plan = match next.take() {
            Some(plan) => plan,
            None => match Start::new(config, complaint.take()).watch(screen, offers)? {
                Wanted::Open(plan, more) => {
                    typed = more;
                    plan
                }
                Wanted::Leave(end) => return Ok(end),
            },
        };
        let log_file = plan.log.as_deref().map(|path| {
            LogFile::create(path).with_context(|| format!("no log can be begun at {}", path.display()))
        });
        let log_file = log_file.transpose()?;
        let place = plan.path.clone();
        // What goes on is opened twice by nobody; anything else chosen instead lets go of it.
        let opening = match aside.take().filter(|(path, _)| place.as_ref() == Some(path)) {
            Some((_, opening)) => opening,
            None => Opening::start(plan, screen.waker()).context("no thread for opening")?,
        };
        let has_way_back = !is_first && place.is_some();
        let before = std::mem::take(&mut typed);
        let (ready, typed) = match opening.watch(screen, &config.keys, before, has_way_back) {
            Ok(Opened::Ready(ready, typed)) => (ready, typed),
            Ok(Opened::Aside(opening)) => {
                aside = place.map(|path| (path, opening));
                continue;
            }
            Ok(Opened::Left(end)) => return Ok(end),
            Err(error) if is_first => return Err(error),
            Err(error) => {
                complaint = Some(format!("{error:#}"));
                continue;
            }
        };
        is_first = false;
        let (mut world, state) = *ready;
        let mut app = App::new(state, config, &world, screen)?;
        app.write_log(log_file);
        let turned = app.turn(screen, &mut world, typed);
        config.keep(app.state());
        app.note(&world);
        let seat = Seat::of(app.state());
        if let Ok(Turned::Next(wanted)) = turned {
            // Its last picture is no part of what comes.
            screen.drop_still();
            complaint = world.close(seat, None).err().map(|error| error.to_string());
            next = complaint.is_none().then(|| match wanted {
                Next::File(path) => Plan::of(&path, &offers.options),
                Next::Lesson => (offers.lesson)(),
            });
            continue;
        }
        *last = Some((world, seat));
        return turned.map(Turned::end);
    }
}

/// Where output goes that would tear the screen: `$XDG_STATE_HOME/honami/session.log`.
fn log_path() -> PathBuf {
    let home = || std::env::var_os("HOME").map(|home| PathBuf::from(home).join(".local/state"));
    let state = std::env::var_os("XDG_STATE_HOME").map(PathBuf::from).filter(|path| path.is_absolute());
    state.or_else(home).unwrap_or_else(std::env::temp_dir).join("honami/session.log")
}
