//! The plugin under test, and handles to it.

use crate::Fault;
use honami_host::{
    CallContext, Clusterer, Host, HostError, Hosting, Kind, Origin, PluginInfo, Simulator, Structure,
    Tracker, Values, shut_in,
};
use rand_pcg::Pcg64;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// A plugin under test.
#[derive(Clone, Debug)]
pub struct Subject {
    /// As its manifest describes it.
    pub info: PluginInfo,
    /// Of every random choice of a check.
    pub seed: u64,
    host: Host,
    /// See [`Subject::copy`].
    copy: OnceLock<PathBuf>,
}

impl Subject {
    /// A plugin that `host` is to start; where it works is up to each check.
    #[must_use]
    pub fn new(info: PluginInfo, host: Host, seed: u64) -> Self {
        Self { info, seed, host, copy: OnceLock::new() }
    }

    /// The copy that its library is loaded from, as honami does it: in the store, under the name of its hash. Once this
    /// process is shut in the library itself cannot be read any more.
    ///
    /// # Errors
    /// When it is not trusted, cannot be read, or has another manifest by now.
    pub(crate) fn copy(&self) -> Result<&Path, Fault> {
        if let Some(copy) = self.copy.get() {
            return Ok(copy);
        }
        let copy = self.host.copy_of(&self.info)?;
        Ok(self.copy.get_or_init(|| copy))
    }

    /// Where it comes to work when it is started there, whatever its kind.
    ///
    /// # Errors
    /// What keeps it from starting.
    pub fn origin(&self, hosting: Hosting) -> Result<Origin, Fault> {
        let (host, cx, values) = (self.host(hosting)?, CallContext::silent(), Values::default());
        Ok(match self.info.kind {
            Kind::Tracker => host.tracker(&self.info, &values, &cx)?.1,
            Kind::Clusterer => host.clusterer(&self.info, &values, &cx)?.1,
            Kind::Structure => host.structure(&self.info, &values, &cx)?.1,
            Kind::Simulator => host.simulator(&self.info, &values, &cx)?.1,
        })
    }

    /// A tracker at work with these values, where the others have their defaults.
    ///
    /// # Errors
    /// What keeps it from starting.
    pub fn tracker(&self, hosting: Hosting, values: &Values) -> Result<Tracker, HostError> {
        Ok(self.host(hosting)?.tracker(&self.info, values, &CallContext::silent())?.0)
    }

    /// A clusterer at work with these values, where the others have their defaults.
    ///
    /// # Errors
    /// What keeps it from starting.
    pub fn clusterer(&self, hosting: Hosting, values: &Values) -> Result<Clusterer, HostError> {
        Ok(self.host(hosting)?.clusterer(&self.info, values, &CallContext::silent())?.0)
    }

    /// A structure builder at work with these values, where the others have their defaults.
    ///
    /// # Errors
    /// What keeps it from starting.
    pub fn structure(&self, hosting: Hosting, values: &Values) -> Result<Structure, HostError> {
        Ok(self.host(hosting)?.structure(&self.info, values, &CallContext::silent())?.0)
    }

    /// A simulator at work with these values, where the others have their defaults.
    ///
    /// # Errors
    /// What keeps it from starting.
    pub fn simulator(&self, hosting: Hosting, values: &Values) -> Result<Simulator, HostError> {
        Ok(self.host(hosting)?.simulator(&self.info, values, &CallContext::silent())?.0)
    }

    /// Who starts it there. Before anything of it runs in this process the process is shut in, for good: a check that
    /// starts it in a process of its own, too, does that first.
    fn host(&self, hosting: Hosting) -> Result<Host, HostError> {
        static SHUT_IN: OnceLock<&str> = OnceLock::new();
        if hosting == Hosting::InProcess && !self.info.is_program() && SHUT_IN.get().is_none() {
            let copy = self.host.copy_of(&self.info)?;
            // How much of it the kernel could do is said by the check that starts it as honami does.
            SHUT_IN.get_or_init(|| shut_in(&copy, std::slice::from_ref(&self.info.library)));
        }
        Ok(self.host.clone().hosting(hosting))
    }

    /// Chance for one check: another stream for each id, the same for the same seed.
    #[must_use]
    pub fn chance(&self, check: &str) -> Pcg64 {
        let stream = check.bytes().fold(0, |sum: u128, byte| sum.wrapping_mul(257).wrapping_add(byte.into()));
        Pcg64::new(self.seed.into(), stream)
    }
}
