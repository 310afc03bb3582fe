//! A tracker in a comparison, and others like it for where its process dies.

use honami_host::{CallContext, Host, PluginInfo, Tracker, Values};
use honami_store::Seam;

use crate::drive::{Death, Relay};
use crate::error::WorkbenchError;
use crate::rebuilt::Made;

/// Who is at work.
pub(super) struct Racer {
    pub(super) tracker: Tracker,
    pub(super) spare: Spare,
}

impl Racer {
    pub(super) fn start(host: &Host, plugin: &PluginInfo, params: &Values) -> Result<Self, WorkbenchError> {
        let cx = CallContext::silent();
        let (tracker, made) = Made::start(host, plugin.clone(), params.clone(), &cx)?;
        Ok(Self { tracker, spare: Spare { host: host.clone(), made, n_deaths: 0 } })
    }

    /// What is measured beside the run itself: `None` where the tracker has died of it, and another one is there.
    pub(super) fn beside<T>(
        &mut self,
        measure: impl FnOnce(&mut Tracker) -> Result<Option<T>, WorkbenchError>,
    ) -> Result<Option<T>, WorkbenchError> {
        match measure(&mut self.tracker) {
            Err(WorkbenchError::Plugin(error)) if error.end().is_some() => {
                self.spare.n_deaths += 1;
                self.tracker = self.spare.another()?;
                Ok(None)
            }
            measured => measured,
        }
    }
}

/// Who takes its place. A run has the same: what dies twice in a frame loses that, and the third death within ten minutes
/// is the last.
pub(super) struct Spare {
    host: Host,
    made: Made,
    /// How often its process has died, in the run and beside it.
    pub(super) n_deaths: u32,
}

impl Spare {
    fn another(&self) -> Result<Tracker, WorkbenchError> {
        Ok(self.made.start_again(&self.host, &CallContext::silent())?.0)
    }
}

impl Relay for Spare {
    fn again(&mut self, _: &Seam, death: Death) -> Result<(Tracker, Death), WorkbenchError> {
        self.n_deaths += 1;
        Ok((self.another()?, death))
    }
}
