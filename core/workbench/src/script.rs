//! Corrections as lines of words: what a script says, and what the command log writes.
//!
//! One table holds every word with what it takes and what it does; the help is made of it.

mod arguments;
#[cfg(test)]
mod tests;
mod words;

use honami_model::brief::counted;
use honami_model::edit::Transaction;
use honami_model::history::{Entry, EntryId};
use honami_store::StoreError;

use crate::error::WorkbenchError;
use crate::session::Session;
use arguments::Arguments;

pub use words::WORDS;

/// One edit that a script may ask for.
pub struct Word {
    /// What the line begins with.
    pub name: &'static str,
    /// What follows, in capitals what the user fills in: `TRACK FRAME X Y`.
    pub takes: &'static str,
    /// What it does, for the help.
    pub does: &'static str,
    act: fn(&mut Session, &Arguments<'_>) -> Result<Act, ScriptError>,
}

/// What a word wants done.
enum Act {
    Commit(Transaction),
    /// It has committed itself.
    Committed(EntryId),
    Undo,
    Redo,
}

/// A step that is in the project file.
#[derive(Clone, Debug)]
pub struct Done {
    /// `edit`, `undo` or `redo`.
    pub what: &'static str,
    /// The entry of the history that was made, undone or done again.
    pub entry: Entry,
}

/// Why a line of a script cannot be done.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScriptError {
    /// No word of the table begins it.
    #[error("this is no edit\n{}", help())]
    Unknown,
    /// It has too few words, or too many.
    #[error("wanted {name} {takes}")]
    Form {
        /// Its first word.
        name: &'static str,
        /// What must follow.
        takes: &'static str,
    },
    /// A word is not what it should be.
    #[error("wanted {wanted}, got {got}")]
    Wrong {
        /// What was wanted.
        wanted: String,
        /// What came.
        got: String,
    },
    /// A position is none of the clip: no tracker could go on from it.
    #[error(
        "({x}, {y}) in frame {frame} is not in the clip of {width}x{height} pixels and {n_frames} frames"
    )]
    Outside {
        /// Pixels, right, as typed.
        x: String,
        /// Pixels, down, as typed.
        y: String,
        /// The frame.
        frame: u32,
        /// Of the clip, pixels.
        width: u32,
        /// Of the clip, pixels.
        height: u32,
        /// Of the clip.
        n_frames: u32,
    },
    /// There are not so many tracks to group.
    #[error("{} make 1 to {}, not {groups}", counted(*n_tracks, "track"), counted(*n_tracks, "group"))]
    Groups {
        /// Groups asked for.
        groups: u32,
        /// Tracks that are grouped.
        n_tracks: usize,
    },
    /// The history ends here.
    #[error("there is nothing to {0}")]
    Nothing(&'static str),
    /// A use-case failed.
    #[error(transparent)]
    Workbench(#[from] WorkbenchError),
}

impl From<StoreError> for ScriptError {
    fn from(error: StoreError) -> Self {
        Self::Workbench(error.into())
    }
}

impl From<honami_model::correct::Refused> for ScriptError {
    fn from(refused: honami_model::correct::Refused) -> Self {
        Self::Workbench(refused.into())
    }
}

/// The words of a line: without its remark, none when nothing is left.
#[must_use]
pub fn words(line: &str) -> Vec<&str> {
    line.split('#').next().unwrap_or_default().split_whitespace().collect()
}

/// Does one line; when this returns, it survives a kill.
///
/// # Errors
/// [`ScriptError`] when it is no edit, or cannot be done; nothing has changed then.
pub fn step(session: &mut Session, words: &[&str]) -> Result<Done, ScriptError> {
    let Some((name, rest)) = words.split_first() else { return Err(ScriptError::Unknown) };
    let word = WORDS.iter().find(|word| word.name == *name).ok_or(ScriptError::Unknown)?;
    let arguments = Arguments::of(word, rest)?;
    let act = (word.act)(session, &arguments)?;
    let project = &mut session.project;
    let made = match act {
        Act::Commit(transaction) => project.commit(transaction)?,
        Act::Committed(entry) => entry,
        Act::Undo => {
            let entry = project.undo()?.ok_or(ScriptError::Nothing("undo"))?;
            return Ok(Done { what: "undo", entry });
        }
        Act::Redo => {
            let entry = project.redo()?.ok_or(ScriptError::Nothing("redo"))?;
            return Ok(Done { what: "redo", entry });
        }
    };
    let entry = project.history().get(made).cloned().ok_or(StoreError::NoSuchEntry(made))?;
    Ok(Done { what: "edit", entry })
}

/// What a script may say, a line a word.
#[must_use]
pub fn help() -> String {
    let mut help = String::from(
        "Edits (frames count from 0; FIRST and LAST are both meant; pixels, (0,0) is the centre of the top-left \
         pixel; # begins a remark):\n",
    );
    let said = |word: &Word| format!("{} {}", word.name, word.takes);
    let width = WORDS.iter().map(|word| said(word).len()).filter(|&n| n <= 34).max().unwrap_or(0);
    for word in WORDS {
        let said = said(word);
        let said = said.trim_end();
        if said.len() > width {
            help += &format!("  {said}\n  {:width$}  {}\n", "", word.does);
        } else {
            help += &format!("  {said:width$}  {}\n", word.does);
        }
    }
    help.trim_end().to_owned()
}
