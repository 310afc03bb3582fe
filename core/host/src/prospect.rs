//! How a plugin will be kept apart here, told without running it.

use crate::host::{Host, Hosting};
use crate::plughost;
use crate::registry::{PluginInfo, Trust};

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
        let (level, mut why) = plughost::foresee(programs);
        if self.is_kept_out(info) {
            let file = info.library.display();
            let out =
                format!("honami has died with it inside, `honami plugin retry {file}` lets it in again");
            why = if why.is_empty() { out } else { format!("{out}; {why}") };
        }
        Prospect { hosting, sandbox: level.word(), why, is_bare: false }
    }
}
