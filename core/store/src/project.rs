//! A project that is open: its document, its history, and the one connection that writes edits.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use honami_model::document::{Document, RunId};
use honami_model::edit::{Edit, Transaction, apply};
use honami_model::history::{Entry, EntryId, History, Step};
use honami_model::track::TrackSet;
use rusqlite::Connection;

use crate::error::StoreError;
use crate::lock::{Holder, Lock, holder_of};
use crate::media::ClipRecord;
use crate::shown::Shown;
use crate::{journal, run, schema};

mod make;
mod seat;

/// What a session may do with a project.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Read and write; one session at a time.
    Write,
    /// Look at what was committed when it was opened.
    Read,
}

/// An open project. `Send`, not `Sync`: one thread edits; runs write through their own connections.
#[derive(Debug)]
pub struct Project {
    path: PathBuf,
    // Declared before the lock, so that the last connection closes before the lock is let go.
    pub(crate) conn: Connection,
    lock: Option<Arc<Lock>>,
    holder: Option<Holder>,
    author: String,
    clip: ClipRecord,
    document: Document,
    history: History,
    interrupted: Vec<RunId>,
    pub(crate) shown: Shown,
}

impl Project {
    /// Makes a project of a clip and opens it for writing. `record.path` is as the user gave it.
    ///
    /// # Errors
    /// [`StoreError::Exists`]: a file is never overwritten. On any error nothing is left behind.
    pub fn create(path: &Path, record: &ClipRecord) -> Result<Self, StoreError> {
        let path = make::real_path(path)?;
        make::check_free(&path)?;
        let lock = Lock::acquire(&path)?;
        make::check_free(&path)?;
        make::make(&path, record, &lock.holder.user)?;
        Self::load(path, Some(Arc::new(lock)), None)
    }

    /// Opens a project.
    ///
    /// # Errors
    /// [`StoreError::Locked`] names the session that writes: open with [`Access::Read`] then;
    /// [`StoreError::NotAProject`], [`StoreError::Newer`], [`StoreError::Corrupt`], [`StoreError::Io`].
    pub fn open(path: &Path, access: Access) -> Result<Self, StoreError> {
        let io = |source| StoreError::Io { what: "cannot open the project", source, path: path.to_owned() };
        let path = path.canonicalize().map_err(io)?;
        if !path.is_file() {
            return Err(StoreError::NotAProject(path));
        }
        match access {
            Access::Write => {
                // Looked at before it is locked: no lock file appears beside what is no project.
                schema::version(&schema::connect(&path, false)?, &path)?;
                let lock = Lock::acquire(&path)?;
                Self::load(path, Some(Arc::new(lock)), None)
            }
            Access::Read => {
                let holder = holder_of(&path);
                Self::load(path, None, holder)
            }
        }
    }

    fn load(path: PathBuf, lock: Option<Arc<Lock>>, other: Option<Holder>) -> Result<Self, StoreError> {
        let mut conn = schema::connect(&path, lock.is_some())?;
        schema::bring_up(&mut conn, lock.is_some(), &path)?;
        let interrupted = if lock.is_some() { run::interrupted(&mut conn)? } else { Vec::new() };
        let clip = ClipRecord::load(&conn)?;
        let (history, document) = journal::load(&conn, clip.clip.n_frames())?;
        let holder = lock.as_ref().map(|lock| lock.holder.clone()).or(other);
        let author = lock.as_ref().map_or_else(String::new, |lock| lock.holder.user.clone());
        let shown = Shown::default();
        Ok(Self { path, conn, lock, holder, author, clip, document, history, interrupted, shown })
    }

    /// The project file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What this session may do.
    #[must_use]
    pub fn access(&self) -> Access {
        if self.lock.is_some() { Access::Write } else { Access::Read }
    }

    /// Who writes: this session, or for a reader the one that did when it opened; `None`: nobody did.
    #[must_use]
    pub fn holder(&self) -> Option<&Holder> {
        self.holder.as_ref()
    }

    /// The clip.
    #[must_use]
    pub fn clip(&self) -> &ClipRecord {
        &self.clip
    }

    /// What the edits so far have made.
    #[must_use]
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The undo tree.
    #[must_use]
    pub fn history(&self) -> &History {
        &self.history
    }

    /// Runs of killed sessions that no edit has ever shown, whichever session found them; a reader, which
    /// cannot show them, has none.
    #[must_use]
    pub fn interrupted(&self) -> &[RunId] {
        &self.interrupted
    }

    /// The entry the document stands at: what provenance calls the input revision.
    #[must_use]
    pub fn revision(&self) -> EntryId {
        self.history.head()
    }

    /// Who the next edits are by; at first the log-in name.
    pub fn set_author(&mut self, author: impl Into<String>) {
        self.author = author.into();
    }

    /// Does a transaction and keeps it; when this returns, it survives a kill.
    ///
    /// # Errors
    /// [`StoreError::Edit`] when the document refuses it, [`StoreError::NoSuchRun`] and the like when it
    /// names what does not exist, or what SQLite met. Nothing has changed then.
    pub fn commit(&mut self, transaction: Transaction) -> Result<EntryId, StoreError> {
        self.writer()?;
        for edit in &transaction.edits {
            self.check_reference(edit)?;
        }
        let inverse = apply(&mut self.document, &transaction)?;
        let (id, time) = (self.history.next_id(), crate::now());
        let place = (id, self.history.head());
        let kept = journal::append(&mut self.conn, place, (&transaction, &inverse), &self.author, &time);
        if let Err(error) = kept {
            self.take_back(&[inverse]);
            return Err(error);
        }
        self.shown.forget(&transaction.touched());
        self.shown.forget(&inverse.touched());
        let shows =
            |id| transaction.edits.iter().any(|edit| matches!(edit, Edit::ShowRun { run, .. } if *run == id));
        self.interrupted.retain(|&run| !shows(run));
        Ok(self.history.push(transaction.label, self.author.clone(), time))
    }

    /// Goes back one entry; returns what was undone, `None` at the root.
    ///
    /// # Errors
    /// What SQLite met; nothing has changed then.
    pub fn undo(&mut self) -> Result<Option<Entry>, StoreError> {
        let undone = self.history.get(self.history.head()).cloned();
        let Some(to) = self.history.undo_target() else { return Ok(None) };
        self.jump(to)?;
        Ok(undone)
    }

    /// Goes forward along the branch visited last; returns what was done again, `None` at its end.
    ///
    /// # Errors
    /// What SQLite met; nothing has changed then.
    pub fn redo(&mut self) -> Result<Option<Entry>, StoreError> {
        let Some(to) = self.history.redo_target() else { return Ok(None) };
        self.jump(to)?;
        Ok(self.history.get(to).cloned())
    }

    /// Goes to any entry of the undo tree.
    ///
    /// # Errors
    /// [`StoreError::NoSuchEntry`], or what SQLite met; nothing has changed then.
    pub fn jump(&mut self, to: EntryId) -> Result<(), StoreError> {
        self.writer()?;
        let path = self.history.path(self.history.head(), to).ok_or(StoreError::NoSuchEntry(to))?;
        let mut inverses = Vec::with_capacity(path.len());
        let mut touched = Vec::new();
        let mut go = || {
            for &step in &path {
                let transaction = journal::transaction(&self.conn, step)?;
                let inverse = apply(&mut self.document, &transaction)?;
                touched.extend([transaction.touched(), inverse.touched()]);
                inverses.push(inverse);
            }
            journal::walk(&mut self.conn, &path, to)
        };
        if let Err(error) = go() {
            self.take_back(&inverses);
            return Err(error);
        }
        self.history.walk(&path);
        touched.iter().for_each(|tracks| self.shown.forget(tracks));
        Ok(())
    }

    /// Whether an entry does nothing but show results of programs: it holds no work by hand.
    ///
    /// # Errors
    /// [`StoreError::NoSuchEntry`], or what SQLite met.
    pub fn shows_results(&self, id: EntryId) -> Result<bool, StoreError> {
        let is_result = |edit: &Edit| {
            matches!(
                edit,
                Edit::ShowRun { .. }
                    | Edit::ShowClustering { clustering: Some(_) }
                    | Edit::ShowSpace { space: Some(_) }
                    | Edit::KeepMatte { matte: Some(_), .. }
            )
        };
        Ok(journal::transaction(&self.conn, Step::Forward(id))?.edits.iter().all(is_result))
    }

    /// Sets `n` track numbers aside that were never used, at once and for good.
    ///
    /// # Errors
    /// [`StoreError::ReadOnly`], or what SQLite met.
    pub fn reserve_tracks(&mut self, n: u32) -> Result<Range<u32>, StoreError> {
        reserve_tracks(self.writer()?, n)
    }

    /// Sets these very track numbers aside: those of a user's list of points.
    ///
    /// # Errors
    /// [`StoreError::TrackTaken`] when one of them is not free.
    pub fn claim_tracks(&mut self, tracks: &TrackSet) -> Result<(), StoreError> {
        let conn = self.writer()?;
        let (Some(first), Some(last)) = (tracks.iter().next(), tracks.iter().last()) else { return Ok(()) };
        let sql = "UPDATE state SET next_track = ?1 WHERE next_track <= ?2";
        if conn.execute(sql, [i64::from(last.0) + 1, i64::from(first.0)])? == 0 {
            let free = conn.query_row("SELECT next_track FROM state", [], |row| row.get(0))?;
            return Err(StoreError::TrackTaken(first, free));
        }
        Ok(())
    }

    /// Looks the whole file over: what SQLite finds wrong, nothing when all is well. Slow on large projects.
    ///
    /// # Errors
    /// What SQLite met while looking.
    pub fn integrity(&self) -> Result<Vec<String>, StoreError> {
        let mut statement = self.conn.prepare("PRAGMA integrity_check")?;
        let lines = statement.query_map([], |row| row.get(0))?.collect::<Result<Vec<String>, _>>()?;
        Ok(lines.into_iter().filter(|line| line != "ok").collect())
    }

    pub(crate) fn folder(&self) -> &Path {
        folder_of(&self.path)
    }

    pub(crate) fn clip_moved(&mut self, path: PathBuf) {
        self.clip.path = path;
    }

    pub(crate) fn writer(&mut self) -> Result<&mut Connection, StoreError> {
        if self.lock.is_some() { Ok(&mut self.conn) } else { Err(StoreError::ReadOnly) }
    }

    pub(crate) fn lock(&self) -> Result<Arc<Lock>, StoreError> {
        self.lock.clone().ok_or(StoreError::ReadOnly)
    }

    /// Edits name results by number; a document cannot know which exist.
    fn check_reference(&self, edit: &Edit) -> Result<(), StoreError> {
        match edit {
            Edit::ShowRun { run, tracks, .. } => self.check_run(*run, tracks),
            Edit::ShowClustering { clustering: Some(shown) } => self.check_clustering(shown.id),
            Edit::ShowSpace { space: Some(id) } => self.check_space(*id),
            Edit::NameGroup { clustering, .. }
            | Edit::HoldGroups { clustering, .. }
            | Edit::ShapeBone { clustering, .. } => self.check_clustering(*clustering),
            Edit::KeepMatte { matte: Some(matte), .. } => self.matte_info(*matte).map(drop),
            _ => Ok(()),
        }
    }

    fn take_back(&mut self, inverses: &[Transaction]) {
        for inverse in inverses.iter().rev() {
            let undone = apply(&mut self.document, inverse);
            debug_assert!(undone.is_ok(), "{inverse:?} takes back what was just done: {undone:?}");
        }
    }
}

pub(crate) fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new("/"))
}

/// Sets `n` track numbers aside, in one statement: two connections never get the same.
pub(crate) fn reserve_tracks(conn: &Connection, n: u32) -> Result<Range<u32>, StoreError> {
    let sql = "UPDATE state SET next_track = next_track + ?1 RETURNING next_track";
    let end: u32 = conn.query_row(sql, [n], |row| row.get(0))?;
    Ok(end - n..end)
}

#[cfg(test)]
mod tests;
