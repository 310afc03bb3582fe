//! Where a plugin works: as it came, as its user wishes, and as what became of it here allows.

use super::{Host, Hosting};
use crate::error::HostError;
use crate::in_process;
use crate::quarantine::{Quarantine, Trail};
use crate::registry::{PluginInfo, Trust};

impl Host {
    /// Before the first instruction of a library runs, whose constructors may be what is wrong with it.
    pub(super) fn leave_trail(&self, info: &PluginInfo) -> Result<Option<Trail>, HostError> {
        if !self.leaves_trails || info.trust == Trust::Shipped {
            return Ok(None);
        }
        let sha256 = in_process::keep_same(info, &self.store)?.sha256;
        let trail = Quarantine::beside(&self.store).leave_trail(&sha256, &info.short_name, &info.library);
        // Where nothing can be written there is none.
        Ok(trail.ok())
    }

    /// Where a plugin works.
    pub(crate) fn hosting_of(&self, info: &PluginInfo) -> Hosting {
        if self.is_kept_out(info) { Hosting::Isolated } else { self.wished(info) }
    }

    /// Whether a plugin works in a process of its own against the user's wish: this one has ended while it was inside.
    pub(crate) fn is_kept_out(&self, info: &PluginInfo) -> bool {
        let is_bare = info.trust != Trust::Shipped && self.wished(info) == Hosting::InProcess;
        let out = |sha256: String| Quarantine::beside(&self.store).is_kept_out(&sha256);
        self.leaves_trails && is_bare && info.sha256().is_ok_and(out)
    }

    /// Why a plugin is not started, when it has failed too often.
    pub(crate) fn held(&self, info: &PluginInfo) -> Option<String> {
        let quarantine = Quarantine::beside(&self.store);
        if !self.has_quarantine || !quarantine.holds_any() {
            return None;
        }
        quarantine.why(&info.sha256().ok()?)
    }

    /// Whether only its short name lets a plugin work in this process that did not come with honami. Anybody may give that
    /// name to another plugin: full trust wants the whole id, and it works in a process of its own.
    #[must_use]
    pub fn is_named_too_shortly(&self, info: &PluginInfo) -> bool {
        let is_free = info.trust != Trust::Shipped && !info.is_program() && self.hosting.is_none();
        is_free
            && !self.settled.contains_key(&info.id)
            && self.settled.get(&info.short_name) == Some(&Hosting::InProcess)
    }

    /// Where a plugin is to work.
    fn wished(&self, info: &PluginInfo) -> Hosting {
        // A program has a process of its own by its nature.
        if info.is_program() {
            return Hosting::Isolated;
        }
        let usual = if info.trust == Trust::Shipped { Hosting::InProcess } else { Hosting::Isolated };
        let by_name = || self.settled.get(&info.short_name).filter(|_| !self.is_named_too_shortly(info));
        let settled = || self.settled.get(&info.id).or_else(by_name);
        self.hosting.or_else(|| settled().copied()).unwrap_or(usual)
    }
}
