//! Skeletons grow behind the screen, one at a time: a newer one stops the one before.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use honami_workbench::WorkbenchError;
use honami_workbench::grow::{GrowRequest, grow};
use honami_workbench::plugins::{Host, Kind, PluginInfo};
use honami_workbench::progress::{Flow, Progress};
use honami_workbench::scene::SkeletonScene;
use honami_workbench::session::Session;
use honami_workbench::store::{Access, Project};

use super::behind::Behind;
use super::skeleton::{Bones, Skeletal};
use super::state::State;
use super::update::Fact;
use crate::term::signals::Waker;
use crate::viewer;

/// The structure builder.
const BUILDER: &str = "diener";

/// A revision, and what has become of growing it.
type Lot = (u64, Result<Arc<Bones>, String>);

/// What grows.
pub(super) struct Growing {
    behind: Behind<Lot>,
    stop: Arc<Stop>,
}

/// All that it takes, on any thread.
pub(super) struct Grower {
    project: PathBuf,
    is_writable: bool,
    host: Host,
    plugin: PluginInfo,
}

/// Tells a growth to stop.
#[derive(Default)]
pub(super) struct Stop(AtomicBool);

impl Stop {
    pub(super) fn tell(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    pub(super) fn is_told(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

impl Progress for Stop {
    fn report(&self, _done: u64, _total: u64, _what: &str) -> Flow {
        if self.is_told() { Flow::Stop } else { Flow::Continue }
    }
}

impl Growing {
    pub(super) fn new(waker: Waker) -> Self {
        Self { behind: Behind::new("skeleton", waker), stop: Arc::default() }
    }

    /// Has grown what a state shows, and tells what has become of it.
    pub(super) fn look(&mut self, state: &mut State, session: &Session) -> std::io::Result<Option<Fact>> {
        let request = Skeletal::request(state);
        if request.is_some() || state.skeleton.awaited.is_none() {
            self.stop.tell();
        }
        if let Some(revision) = request {
            let grower = match Grower::of(session) {
                Ok(grower) => grower,
                Err(error) => return Ok(Some(Fact::Grown(revision, Err(error.to_string())))),
            };
            let stop = Arc::<Stop>::default();
            self.stop = Arc::clone(&stop);
            self.behind.ask(move || (revision, grower.grow(&*stop)))?;
        }
        Ok(self.behind.news()?.map(|(revision, grown)| Fact::Grown(revision, grown)))
    }
}

impl Drop for Growing {
    fn drop(&mut self) {
        // Nobody waits for it any more.
        self.stop.tell();
    }
}

impl Grower {
    pub(super) fn of(session: &Session) -> Result<Self, WorkbenchError> {
        let plugin = session.registry.find(Kind::Structure, BUILDER)?.clone();
        let project = session.project.path().to_owned();
        let is_writable = session.project.access() == Access::Write;
        Ok(Self { project, is_writable, host: session.options.host.clone(), plugin })
    }

    /// The skeleton of the shown groups for the viewer, and what is to be said of it.
    pub(super) fn scene(
        &self,
        progress: &dyn Progress,
    ) -> Result<(SkeletonScene, Vec<String>), WorkbenchError> {
        let project = Project::open(&self.project, Access::Read)?;
        let by = (&self.host, &self.plugin);
        viewer::skeleton(&project, by, &GrowRequest::default(), self.is_writable, progress)
    }

    /// Grows the skeleton of the shown groups.
    fn grow(&self, progress: &dyn Progress) -> Result<Arc<Bones>, String> {
        let grown = Project::open(&self.project, Access::Read).map_err(WorkbenchError::from);
        let grown = grown.and_then(|project| {
            // Hand work on bones is laid over what has grown when that is drawn.
            let request =
                GrowRequest { root: project.document().root(), as_grown: true, ..GrowRequest::default() };
            grow(&project, &self.host, &self.plugin, &request, progress)
        });
        grown.map(|growth| Arc::new(Bones::of(growth))).map_err(|error| error.to_string())
    }

    /// What becomes of a revision, at once.
    pub(super) fn fact(&self, revision: u64) -> Fact {
        Fact::Grown(revision, self.grow(&Stop::default()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::term::signals;

    #[test]
    fn what_nobody_waits_for_stops() {
        let (waker, _woken) = signals::pair().unwrap();
        let growing = Growing::new(waker);
        let stop = Arc::clone(&growing.stop);
        assert!(matches!(stop.report(0, 1, "growing"), Flow::Continue));
        drop(growing);
        assert!(matches!(stop.report(0, 1, "growing"), Flow::Stop));
    }
}
