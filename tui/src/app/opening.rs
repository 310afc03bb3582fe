//! Opening a project or a clip: the screen is there at once, the project when it has been read.
//!
//! A thread of its own opens the session. Keys typed meanwhile are kept for the project; those that leave, leave.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use anyhow::Context as _;
use honami_workbench::WorkbenchError;
use honami_workbench::media::Step;
use honami_workbench::plugins::quoted;
use honami_workbench::session::{Session, SessionOptions};
use honami_workbench::store::StoreError;

use super::action::{Action, Context};
use super::effects::World;
use super::keymap::{Found, KeyMap};
use super::lesson::Lesson;
use super::state::State;
use super::view;
use crate::term::input::Event;
use crate::term::screen::{End, Screen};
use crate::term::signals::Waker;

/// So much typed ahead is kept.
const KEPT_MAX: usize = 4096;

/// How a session is made, telling what it is busy with.
type Open = Box<dyn FnOnce(&Tell<'_>) -> anyhow::Result<Session> + Send>;
/// Says what opening is busy with; any thread may.
pub type Tell<'a> = dyn Fn(String) + Sync + 'a;

/// A session that is to be opened.
pub struct Plan {
    /// What the title calls it meanwhile.
    pub name: String,
    open: Open,
    /// What is opened, where it is a file: chosen again, what was begun goes on.
    pub(super) path: Option<PathBuf>,
    /// Whether the tutorial is given on it.
    is_lesson: bool,
    /// Where its log is written while it goes on.
    pub(super) log: Option<PathBuf>,
}

impl Plan {
    /// Whatever opens a session.
    pub fn new(
        name: impl Into<String>,
        open: impl FnOnce(&Tell<'_>) -> anyhow::Result<Session> + Send + 'static,
    ) -> Self {
        Self { name: name.into(), open: Box::new(open), path: None, is_lesson: false, log: None }
    }

    /// The same, with the tutorial on it.
    #[must_use]
    pub fn with_lesson(self) -> Self {
        Self { is_lesson: true, ..self }
    }

    /// The same, with what is done in it written to a new file.
    #[must_use]
    pub fn logged(self, file: Option<PathBuf>) -> Self {
        Self { log: file, ..self }
    }

    /// A project, or the project that belongs to a clip; made where there is none yet.
    #[must_use]
    pub fn of(path: &Path, options: &SessionOptions) -> Self {
        let (path, options, place) = (path.to_owned(), options.clone(), Some(path.to_owned()));
        Self { path: place, ..Self::new(name_of(&path), move |tell| open(&path, &options, tell)) }
    }

    /// A new project of a clip, also where the clip has one: `sway-2.honami` beside `sway.honami`.
    #[must_use]
    pub fn anew(clip: &Path, options: &SessionOptions) -> Self {
        let (clip, options) = (clip.to_owned(), options.clone());
        Self::new(name_of(&clip), move |tell| {
            let first = project_of(&clip);
            let stem = first.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let others = (2..).map(|n: u32| first.with_file_name(format!("{stem}-{n}.honami")));
            let project = std::iter::once(first.clone()).chain(others).find(|path| !path.exists());
            let project = project.context("every name is taken")?;
            Ok(Session::create_with(&project, &clip, None, &options, &mut step_teller(tell))?)
        })
    }
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// Tells of the steps of opening a clip.
fn step_teller(tell: &Tell<'_>) -> impl FnMut(&Path, Step) {
    move |clip, step| {
        let clip = name_of(clip);
        tell(match step {
            Step::Hashing => format!("reading {clip}"),
            Step::Indexing => format!("finding the frames of {clip}"),
        });
    }
}

fn open(path: &Path, options: &SessionOptions, tell: &Tell<'_>) -> anyhow::Result<Session> {
    let is_project = path.extension().is_some_and(|e| e == "honami");
    let project = if is_project { path.to_owned() } else { project_of(path) };
    let mut on_step = step_teller(tell);
    let session = if is_project || project.exists() {
        Session::open_or_look(&project, options, &mut on_step)
            .map_err(|error| where_is_the_clip(error, &project))?
    } else {
        Session::create_with(&project, path, None, options, &mut on_step)?
    };
    if !is_project && session.media.source().canonicalize().ok() != path.canonicalize().ok() {
        let (project, clip) = (project.display(), path.display());
        anyhow::bail!(
            "{project} belongs to another clip: `honami new NAME.honami {clip}` makes one of its own"
        );
    }
    Ok(session)
}

/// The project that belongs to a clip opened without one: beside it, under its name.
#[must_use]
pub fn project_of(clip: &Path) -> PathBuf {
    let stem = if clip.is_dir() { clip.file_name() } else { clip.file_stem() };
    let name = stem.unwrap_or_default().to_string_lossy().replace(['%', '*', '?'], "");
    let name = if name.is_empty() { "clip".to_owned() } else { name };
    clip.with_file_name(format!("{name}.honami"))
}

/// Adds how to say where a clip is that is no longer found.
#[must_use]
pub fn where_is_the_clip(error: WorkbenchError, project: &Path) -> anyhow::Error {
    let lost = matches!(
        error,
        WorkbenchError::Store(StoreError::MediaMissing { .. } | StoreError::MediaDiffers { .. })
    );
    let error = anyhow::Error::from(error);
    if lost {
        error.context(format!("`honami relink {} CLIP` says where it is", quoted(project)))
    } else {
        error
    }
}

/// A session being opened.
pub(super) struct Opening {
    name: String,
    step: Arc<Mutex<String>>,
    ended: Arc<AtomicBool>,
    thread: JoinHandle<anyhow::Result<(World, State)>>,
}

/// What opening has come to.
pub(super) enum Opened {
    /// The project is there; these were typed meanwhile.
    Ready(Box<(World, State)>, Vec<Event>),
    /// Its user has gone back to choose something else; it goes on.
    Aside(Opening),
    /// Its user, or the terminal, has left.
    Left(Option<End>),
}

impl Opening {
    /// Begins to open.
    pub(super) fn start(plan: Plan, waker: Waker) -> std::io::Result<Self> {
        let step = Arc::new(Mutex::new(String::new()));
        let told = Arc::clone(&step);
        let (ended, Plan { name, open, is_lesson, .. }) = (Arc::new(AtomicBool::new(false)), plan);
        let flag = Arc::clone(&ended);
        let thread = std::thread::Builder::new().name("opening".to_owned()).spawn(move || {
            // Woken also when opening panics.
            let _end = waker.at_end(&flag);
            let session = open(&|what| {
                *told.lock().unwrap_or_else(PoisonError::into_inner) = what;
                waker.wake();
            })?;
            let mut world = World::new(session, waker);
            let mut state = world.state()?;
            state.lesson = is_lesson.then(|| Lesson::new(&state));
            Ok((world, state))
        })?;
        Ok(Self { name, step, ended, thread })
    }

    /// Shows that something is being opened until it is, or until somebody leaves, or goes back where `has_way_back`.
    /// What was `kept` was typed before.
    ///
    /// # Errors
    /// When it cannot be opened.
    pub(super) fn watch(
        self,
        screen: &mut Screen,
        keys: &KeyMap,
        mut kept: Vec<Event>,
        has_way_back: bool,
    ) -> anyhow::Result<Opened> {
        // What the screen shows, once it does.
        let mut shown = None;
        while !self.ended.load(Ordering::Acquire) {
            let what = self.step.lock().unwrap_or_else(PoisonError::into_inner).clone();
            let wanted = (what, screen.size());
            if screen.has_slot() && shown.as_ref() != Some(&wanted) {
                let frame = view::opening(&self.name, &wanted.0, keys, has_way_back, wanted.1);
                if screen.paint(&frame, false)? {
                    shown = Some(wanted.clone());
                }
            }
            let happened = screen.wait(None, shown.as_ref() != Some(&wanted))?;
            let asked = happened.events.iter().find_map(|event| leaving(keys, event));
            match asked {
                _ if happened.end.is_some() => return Ok(Opened::Left(happened.end)),
                Some(Action::Back) if has_way_back => return Ok(Opened::Aside(self)),
                Some(_) => return Ok(Opened::Left(None)),
                None => {}
            }
            kept.extend(happened.events.into_iter().filter(|event| !matches!(event, Event::Reply(_))));
            kept.truncate(KEPT_MAX);
            if happened.suspend {
                screen.suspend()?;
            }
            if happened.resized || happened.suspend {
                screen.forget();
                shown = None;
            }
        }
        let ready = self.thread.join().ok().context("opening stopped by a fault of its own")??;
        Ok(Opened::Ready(Box::new(ready), kept))
    }
}

/// The action by which something typed while opening leaves at once.
fn leaving(keys: &KeyMap, event: &Event) -> Option<Action> {
    let Event::Key(key) = event else { return None };
    let Found::Action(action) = keys.find(Context::Review, &[*key]) else { return None };
    [Action::Quit, Action::Leave, Action::Back].contains(&action).then_some(action)
}
