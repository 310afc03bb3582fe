//! The viewer's window: its scenes grow behind the screen, its program starts there, and what it says waits to be heard.

use std::collections::VecDeque;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Stdio;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use honami_workbench::WorkbenchError;
use honami_workbench::scene::control::{self, Command, Event, PROTOCOL};
use honami_workbench::scene::{Scene, SkeletonScene};

use super::behind::Behind;
use super::growing::{Grower, Stop};
use super::state::Notice;
use crate::term::signals::Waker;
use crate::viewer::{self, Heard, Scenes, Teller, usual_size};

/// A window, from when it is opened until it is gone.
pub(super) struct Viewing {
    behind: Behind<Lot>,
    /// Stops what grows.
    stop: Arc<Stop>,
    scenes: Arc<Mutex<Option<Scenes>>>,
    inbox: Arc<Mutex<Inbox>>,
    tell: Option<Teller>,
    /// What is to be said in the window with the next scene.
    line: Option<String>,
}

/// What has become of work behind the screen.
enum Lot {
    /// The program was started.
    Opened(Teller),
    /// It was not, and why.
    NotOpened(String),
    /// A newer scene is there.
    Shown(PathBuf),
    /// There is none, and why.
    NotShown(String),
    /// A newer one has taken its place.
    Stopped,
}

/// What a window has said and nobody has heard.
#[derive(Default)]
struct Inbox(VecDeque<Heard>);

impl Inbox {
    /// Takes in what was said. Of frames that pass the last counts alone: whoever draws slowly leaves some out.
    fn push(&mut self, heard: Heard) {
        let is_passing = |heard: &Heard| matches!(heard, Heard::Said(Event::Passing(_)));
        match self.0.back_mut().filter(|last| is_passing(last) && is_passing(&heard)) {
            Some(last) => *last = heard,
            None => self.0.push_back(heard),
        }
    }
}

impl Viewing {
    /// Opens one, behind the screen.
    ///
    /// # Errors
    /// Where the system has no thread left.
    pub(super) fn open(grower: Grower, waker: Waker) -> std::io::Result<Self> {
        let mut behind = Behind::new("viewer's scenes", waker.clone());
        let (stop, scenes, inbox) = (Arc::<Stop>::default(), Arc::default(), Arc::<Mutex<Inbox>>::default());
        let (growing, written, heard_in) = (Arc::clone(&stop), Arc::clone(&scenes), Arc::clone(&inbox));
        let hear = move |heard| {
            lock(&heard_in).push(heard);
            waker.wake();
        };
        behind.ask(move || match begin(&grower, &growing, &written, hear) {
            Ok(tell) => Lot::Opened(tell),
            Err(_) if growing.is_told() => Lot::Stopped,
            Err(why) => Lot::NotOpened(format!("{why:#}")),
        })?;
        Ok(Self { behind, stop, scenes, inbox, tell: None, line: None })
    }

    /// Shows the skeleton as it is now, as soon as it has grown.
    ///
    /// # Errors
    /// Where the system has no thread left.
    pub(super) fn show(&mut self, grower: Grower) -> std::io::Result<()> {
        // What it begins with is shown in any case: before, there is nobody to show a newer one to.
        if self.tell.is_some() {
            self.stop.tell();
        }
        let (stop, scenes) = (Arc::<Stop>::default(), Arc::clone(&self.scenes));
        self.stop = Arc::clone(&stop);
        self.behind.ask(move || {
            let grown = grower.scene(&*stop).map_err(anyhow::Error::from);
            match grown.and_then(|(scene, _)| write(&scenes, scene)) {
                Ok(path) => Lot::Shown(path),
                Err(_) if stop.is_told() => Lot::Stopped,
                Err(why) => Lot::NotShown(format!("no skeleton: {why:#}")),
            }
        })
    }

    /// What was heard of it.
    pub(super) fn news(&mut self) -> Vec<Heard> {
        let failed = |why: String| vec![Heard::Said(Event::Failed(why))];
        match self.behind.news() {
            Ok(Some(Lot::Opened(tell))) => self.tell = Some(tell),
            Ok(Some(Lot::NotOpened(why))) => return vec![Heard::Ended(Some(why))],
            Ok(Some(Lot::Shown(path))) => {
                let line = self.line.take().map(Command::Say);
                let scene = Command::Scene { protocol: PROTOCOL, path };
                return [scene]
                    .into_iter()
                    .chain(line)
                    .find_map(|told| self.tell(&told))
                    .into_iter()
                    .collect();
            }
            Ok(Some(Lot::NotShown(why))) => {
                self.line = None;
                self.tell(&Command::Say(why.clone()));
                return failed(why);
            }
            Ok(Some(Lot::Stopped) | None) => {}
            Err(why) => return failed(why.to_string()),
        }
        // Whoever answers must be able to.
        self.tell.as_ref().map_or_else(Vec::new, |_| lock(&self.inbox).0.drain(..).collect())
    }

    /// Tells it, without waiting; returns what is to be heard where it does not keep up.
    pub(super) fn tell(&self, command: &Command) -> Option<Heard> {
        let is_told = self.tell.as_ref().is_none_or(|tell| tell.tell(&control::line(command)));
        let line = || "it does not keep up, and what it shows is behind".to_owned();
        (!is_told).then(|| Heard::Said(Event::Failed(line())))
    }

    /// Says there what has become of an edit: with the scene that comes of it, or at once where nothing has changed.
    pub(super) fn answer(&mut self, notice: &Notice) {
        match notice.is_error {
            true => drop(self.tell(&Command::Say(notice.text.clone()))),
            false => self.line = Some(notice.text.clone()),
        }
    }

    /// Closes it, and lets go of it behind the screen.
    pub(super) fn close(self) {
        // Without a thread it goes here.
        drop(std::thread::Builder::new().name("viewer's end".to_owned()).spawn(move || drop(self)));
    }
}

impl Drop for Viewing {
    fn drop(&mut self) {
        self.stop.tell();
        self.behind.end();
    }
}

/// Grows the first scene and starts the program on it.
fn begin(
    grower: &Grower,
    stop: &Stop,
    scenes: &Mutex<Option<Scenes>>,
    hear: impl FnMut(Heard) + Send + 'static,
) -> anyhow::Result<Teller> {
    viewer::opens(|name| std::env::var_os(name))?;
    let (scene, notes) = grower.scene(stop)?;
    let [width, height] = usual_size(&scene);
    let path = write(scenes, scene)?;
    if stop.is_told() {
        return Err(WorkbenchError::Stopped.into());
    }
    let words: [OsString; 3] = [path.into(), format!("--size={width}x{height}").into(), "--control".into()];
    let tell = viewer::start(&words, Stdio::piped(), hear)?;
    if !notes.is_empty() {
        tell.pass(&control::line(&Command::Say(notes.join(" · "))));
    }
    Ok(tell)
}

fn write(scenes: &Mutex<Option<Scenes>>, scene: SkeletonScene) -> anyhow::Result<PathBuf> {
    let mut scenes = lock(scenes);
    let there = match scenes.take() {
        Some(there) => there,
        None => Scenes::new()?,
    };
    scenes.insert(there).write(&Scene::Skeleton(Box::new(scene)))
}

/// A panic that was told where it happened spoils nothing here.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_frames_that_pass_the_last_counts() {
        let mut inbox = Inbox::default();
        let events = [
            Event::Playing(true),
            Event::Passing(3),
            Event::Passing(4),
            Event::Passing(5),
            Event::Undo,
            Event::Passing(6),
            Event::Frame(6),
            Event::Frame(7),
        ];
        events.into_iter().for_each(|event| inbox.push(Heard::Said(event)));
        let said = |heard: &Heard| match heard {
            Heard::Said(event) => control::line(event),
            other => format!("{other:?}"),
        };
        let left: Vec<String> = inbox.0.iter().map(said).collect();
        let wanted = [
            Event::Playing(true),
            Event::Passing(5),
            Event::Undo,
            Event::Passing(6),
            Event::Frame(6),
            Event::Frame(7),
        ];
        assert_eq!(left, wanted.iter().map(control::line).collect::<Vec<_>>());
    }
}
