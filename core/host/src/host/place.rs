//! Where a plugin works: as it came, as its user wishes, and as what became of it here allows.

use super::{Host, Hosting};
use crate::error::HostError;
use crate::in_process;
use crate::quarantine::Quarantine;
use crate::registry::{PluginInfo, Trust};

impl Host {
    /// Before the first instruction of a library runs, whose constructors may be what is wrong with it.
    pub(super) fn leave_trail(&self, info: &PluginInfo) -> Result<(), HostError> {
        if self.leaves_trails && info.trust != Trust::Shipped {
            let sha256 = in_process::keep_same(info, &self.store)?.sha256;
            // Where nothing can be written there is none.
            Quarantine::beside(&self.store)
                .leave_trail(&sha256, &info.short_name, &info.library)
                .unwrap_or_default();
        }
        Ok(())
    }

    /// Where a plugin works.
    pub(crate) fn hosting_of(&self, info: &PluginInfo) -> Hosting {
        if self.is_kept_out(info) { Hosting::Isolated } else { self.wished(info) }
    }

    /// Whether a plugin works in a process of its own against the user's wish: this one has died with it inside.
    pub(crate) fn is_kept_out(&self, info: &PluginInfo) -> bool {
        let is_bare = info.trust != Trust::Shipped && self.wished(info) == Hosting::InProcess;
        let out = |sha256: String| Quarantine::beside(&self.store).is_kept_out(&sha256);
        self.leaves_trails && is_bare && info.sha256().is_ok_and(out)
    }

    /// Where a plugin is to work.
    fn wished(&self, info: &PluginInfo) -> Hosting {
        // A program has a process of its own by its nature.
        if info.is_program() {
            return Hosting::Isolated;
        }
        let usual = if info.trust == Trust::Shipped { Hosting::InProcess } else { Hosting::Isolated };
        let settled = || self.settled.get(&info.id).or_else(|| self.settled.get(&info.short_name));
        self.hosting.or_else(|| settled().copied()).unwrap_or(usual)
    }
}
