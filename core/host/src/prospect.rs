//! How a plugin will be kept apart here, told without running it.

use crate::host::{Host, Hosting};
use crate::plughost;
use crate::registry::{PluginInfo, Trust};
use crate::shell::quoted;

/// Where a plugin works when it is started here, and how far it is shut in there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Prospect {
    /// Where it works.
    pub hosting: Hosting,
    /// How far it is shut in: `full`, `partial` or `none`.
    pub sandbox: &'static str,
    /// Why no farther, or why not where it was wished, for people; else empty.
    pub why: String,
    /// Whether it works in this process though it did not come with honami: full trust, which people are to see.
    pub is_bare: bool,
}

impl Host {
    /// What starting a plugin will come to here; none of its code runs, and nothing is given up. Whether it may be
    /// started is another question ([`PluginInfo::trust`]).
    #[must_use]
    pub fn prospect(&self, info: &PluginInfo) -> Prospect {
        let hosting = self.hosting_of(info);
        if hosting == Hosting::InProcess {
            let is_bare = info.trust != Trust::Shipped;
            let why = "it works in honami itself: whatever ends it ends both".to_owned();
            return Prospect { hosting, sandbox: "none", why, is_bare };
        }
        let programs = match (info.is_program(), info.needs.exec) {
            (false, _) => None,
            (true, false) => Some("it is a program, which must be started"),
            (true, true) => Some("it starts other programs"),
        };
        let (level, why) = plughost::foresee(programs);
        let reasons: Vec<String> = self.against(info).into_iter().chain(Some(why)).collect();
        let why = reasons.join("; ").trim_end_matches("; ").to_owned();
        Prospect { hosting, sandbox: level.word(), why, is_bare: false }
    }

    /// Why a plugin is not started at all, or works in a process of its own against its user's wish.
    fn against(&self, info: &PluginInfo) -> Option<String> {
        let file = quoted(&info.library);
        if let Some(why) = self.held(info) {
            return Some(format!(
                "it has failed three times within ten minutes and is not started ({why}), `honami plugin retry {file}` lets it \
                 start again"
            ));
        }
        if self.is_kept_out(info) {
            let let_in = format!("`honami plugin retry --in-process {file}` lets it in again");
            return Some(format!("honami has ended while it was inside, {let_in}"));
        }
        let wanted = || format!("to work in honami itself it is to be settled by its whole id, {}", info.id);
        self.is_named_too_shortly(info).then(wanted)
    }
}
