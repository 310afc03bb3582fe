//! What can go wrong between the workbench and a plugin, in sentences for the user.

use crate::isolated::Ended;
use crate::manifest::Kind;
use crate::shell::quoted;
use honami_abi::code;
use std::path::PathBuf;

/// Why a plugin could not be found, loaded or used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HostError {
    /// No plugin of that kind has that name.
    #[error("there is no {kind} {name:?}{}; there are: {known}{problems}", alike(name, known))]
    NotFound {
        /// What was asked for.
        kind: Kind,
        /// As it was asked for.
        name: String,
        /// The names that exist, comma-separated.
        known: String,
        /// What files could not be used, and why; empty for none.
        problems: String,
    },
    /// A short name that several plugins share.
    #[error("{name:?} may be any of {ids}: say the full id")]
    Ambiguous {
        /// As it was asked for.
        name: String,
        /// The candidates, comma-separated.
        ids: String,
    },
    /// A file that the user named cannot be used, and what has that name elsewhere may be another.
    #[error("{problem}; {name} is in {}, too, which is not taken in its place: mend the one, or do not name it", library.display())]
    Instead {
        /// As it was asked for.
        name: String,
        /// The plugin elsewhere.
        library: PathBuf,
        /// What is wrong with the file, and which it is.
        problem: String,
    },
    /// A plugin that nobody has vouched for.
    #[error("{} is not trusted: {why}", path.display())]
    NotTrusted {
        /// The library.
        path: PathBuf,
        /// What to do about it.
        why: String,
    },
    /// A file that is no usable plugin library.
    #[error("{}: {why}", path.display())]
    File {
        /// The library.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// A parameter value that the plugin does not take.
    #[error(transparent)]
    Value(#[from] crate::values::ValueError),
    /// The plugin could not do it and says why.
    #[error("{plugin}: {function}: {text}{}", code.aside())]
    Failed {
        /// Its id.
        plugin: String,
        /// The function of the ABI.
        function: &'static str,
        /// What kind of failure.
        code: Code,
        /// In the plugin's words.
        text: String,
    },
    /// The user stopped it.
    #[error("{plugin}: stopped")]
    Cancelled {
        /// Its id.
        plugin: String,
    },
    /// The plugin broke the contract; nothing of its answer was used.
    #[error("{plugin} misbehaves in {function}: {what}")]
    Misbehaved {
        /// Its id.
        plugin: String,
        /// The function of the ABI.
        function: &'static str,
        /// What it did.
        what: String,
    },
    /// The plugin's process has ended; what it had answered before stands.
    #[error("{plugin} {how} in {function}{}{}", of_frame(*frame), after(last_words))]
    Ended {
        /// Its id.
        plugin: String,
        /// The function of the ABI.
        function: &'static str,
        /// The frame that it was given.
        frame: Option<i64>,
        /// By itself, or by whom.
        how: Ended,
        /// The last line that it printed; empty for none.
        last_words: String,
    },
    /// The plugin has failed too often lately.
    #[error(
        "{plugin} has failed three times within ten minutes and is not started again ({why}) until its file has changed; \
         as it is it is started after `honami plugin retry {}`",
        quoted(library)
    )]
    Quarantined {
        /// Its id.
        plugin: String,
        /// Its file.
        library: PathBuf,
        /// What became of it last.
        why: String,
    },
    /// The caller asked for what is not possible now.
    #[error("{plugin}: {what}")]
    Usage {
        /// Its id.
        plugin: String,
        /// What was asked, and what is possible.
        what: String,
    },
}

impl HostError {
    /// How the plugin's process ended, and what it last printed, where that is what went wrong:
    /// `died of SIGABRT (it gave up); it last printed: no weights`.
    #[must_use]
    pub fn end(&self) -> Option<String> {
        match self {
            Self::Ended { how, last_words, .. } => Some(format!("{how}{}", after(last_words))),
            _ => None,
        }
    }
}

fn of_frame(frame: Option<i64>) -> String {
    frame.map_or_else(String::new, |frame| format!(" of frame {frame}"))
}

pub(crate) fn after(last_words: &str) -> String {
    if last_words.is_empty() { String::new() } else { format!("; it last printed: {last_words}") }
}

/// A failure code of the ABI, shown as a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code(pub i32);

impl Code {
    /// What it adds to the plugin's own words; that it has failed is told by these.
    fn aside(self) -> String {
        if self.0 == code::FAILED { String::new() } else { format!(" ({self})") }
    }
}

/// Which of the names, comma-separated, was likely meant: ` (did you mean anchored?)`, or nothing. One mistake in three
/// letters is likely, and so is a name that was not typed to its end.
pub(crate) fn alike(name: &str, known: &str) -> String {
    let mistakes = |known: &str| match known.starts_with(name) {
        true => 1,
        false => strsim::damerau_levenshtein(name, known),
    };
    let best = known.split(", ").min_by_key(|known| mistakes(known));
    let best = best.filter(|known| mistakes(known) <= name.chars().count() / 3);
    best.map_or_else(String::new, |known| format!(" (did you mean {known}?)"))
}

impl std::fmt::Display for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self.0 {
            code::UNSUPPORTED => "unsupported",
            code::ARGUMENT => "wrong argument",
            code::STATE => "not now",
            code::DATA => "unusable data",
            code::MEMORY => "no memory",
            code::IO => "file trouble",
            code::CANCELLED => "cancelled",
            code::INTERNAL => "a fault in the plugin",
            other => return write!(f, "failed, code {other}"),
        })
    }
}
