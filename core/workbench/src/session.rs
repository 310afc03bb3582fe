//! A session: a project, its clip and the plugins at hand.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use honami_host::{Host, Registry, SearchPath};
use honami_media::{Media, OpenOptions, Step};
use honami_model::edit::Transaction;
use honami_store::{Access, ClipRecord, Project, StoreError};

use crate::error::WorkbenchError;
use crate::track::any_reaches;

/// What a session starts with.
#[derive(Clone, Debug, Default)]
pub struct SessionOptions {
    /// Files and folders in which plugins are looked for first.
    pub plugin_paths: Vec<PathBuf>,
    /// One's own build trees, in which plugins are looked for next, and trusted.
    pub dev: Vec<PathBuf>,
    /// Only look: never lock the project.
    pub read_only: bool,
    /// How plugins are started.
    pub host: Host,
}

impl SessionOptions {
    /// Looks for the plugins that there are now.
    #[must_use]
    pub fn registry(&self) -> Registry {
        Registry::scan_path(&SearchPath::of_process(&self.plugin_paths).with_dev(&self.dev))
    }
}

/// An open project with its clip and the plugins at hand.
pub struct Session {
    /// The project file.
    pub project: Project,
    /// The clip.
    pub media: Arc<Media>,
    /// The plugins.
    pub registry: Arc<Registry>,
    /// What it started with.
    pub options: SessionOptions,
    /// What was found unfinished when the project was opened, and what became of it: one line each.
    pub notes: Vec<String>,
}

impl Session {
    /// Opens a project and finds its clip.
    ///
    /// # Errors
    /// When the project is locked by another session, is none, or its clip is missing or has changed.
    pub fn open(path: &Path, options: &SessionOptions) -> Result<Self, WorkbenchError> {
        Self::open_with(path, options, &mut |_, _| {})
    }

    /// Looks for the plugins again: those that were rebuilt may take other parameters.
    pub fn look_for_plugins(&mut self) {
        self.registry = Arc::new(self.options.registry());
    }

    /// [`open`](Self::open), telling which step is taken with which clip: a long one takes seconds to read.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_with(
        path: &Path,
        options: &SessionOptions,
        on_step: &mut dyn FnMut(&Path, Step),
    ) -> Result<Self, WorkbenchError> {
        let access = if options.read_only { Access::Read } else { Access::Write };
        let mut project = Project::open(path, access)?;
        // Before the clip, which may be missing.
        let notes = if options.read_only { Vec::new() } else { show_interrupted(&mut project)? };
        let media = Arc::new(open_clip_of(&project, on_step)?);
        let (registry, options) = (Arc::new(options.registry()), options.clone());
        Ok(Self { project, media, registry, options, notes })
    }

    /// Opens a project to write, or to look where another session writes; tells its steps as
    /// [`open_with`](Self::open_with).
    ///
    /// # Errors
    /// As [`open`](Self::open), but never because of a lock.
    pub fn open_or_look(
        path: &Path,
        options: &SessionOptions,
        on_step: &mut dyn FnMut(&Path, Step),
    ) -> Result<Self, WorkbenchError> {
        match Self::open_with(path, options, on_step) {
            Err(WorkbenchError::Store(StoreError::Locked { .. })) => {
                Self::open_with(path, &SessionOptions { read_only: true, ..options.clone() }, on_step)
            }
            other => other,
        }
    }

    /// Makes a project of a clip; `fps` where the user knows better than the container.
    ///
    /// # Errors
    /// When the clip cannot be read, or the project file is there already; nothing is left behind.
    pub fn create(
        project: &Path,
        clip: &Path,
        fps: Option<f64>,
        options: &SessionOptions,
    ) -> Result<Self, WorkbenchError> {
        Self::create_with(project, clip, fps, options, &mut |_, _| {})
    }

    /// [`create`](Self::create), telling which step is taken.
    ///
    /// # Errors
    /// As [`create`](Self::create).
    pub fn create_with(
        project: &Path,
        clip: &Path,
        fps: Option<f64>,
        options: &SessionOptions,
        on_step: &mut dyn FnMut(&Path, Step),
    ) -> Result<Self, WorkbenchError> {
        if project.exists() {
            return Err(StoreError::Exists(project.to_owned()).into());
        }
        let open = OpenOptions { fps, ..OpenOptions::default() };
        let media = honami_media::open_with(clip, &open, &mut |step| on_step(clip, step))?;
        let record = ClipRecord {
            path: clip.to_owned(),
            sha256: media.sha256(),
            fps_override: fps,
            clip: media.clip().clone(),
        };
        let project = Project::create(project, &record)?;
        let (registry, options) = (Arc::new(options.registry()), options.clone());
        Ok(Self { project, media: Arc::new(media), registry, options, notes: Vec::new() })
    }
}

/// Shows what killed sessions had tracked, as an edit that undo takes back.
fn show_interrupted(project: &mut Project) -> Result<Vec<String>, WorkbenchError> {
    let mut notes = Vec::new();
    for run in project.interrupted().to_vec() {
        let info = project.run(run)?;
        // As with a run that was stopped: half of one is not laid over tracks that reach further.
        if info.tracks.is_empty() || any_reaches(project, &info.tracks, info.found.end)? {
            continue;
        }
        let (tracks, last) = (info.tracks.to_string(), info.found.end.saturating_sub(1));
        project.commit(Transaction::show_run(run, info.tracks))?;
        notes.push(format!("run {run} was interrupted at frame {last}: its {tracks} are kept and shown"));
    }
    Ok(notes)
}

/// Opens the clip of a project, wherever it has moved to within reach.
fn open_clip_of(project: &Project, on_step: &mut dyn FnMut(&Path, Step)) -> Result<Media, WorkbenchError> {
    let record = project.clip();
    let options = OpenOptions { fps: record.fps_override, ..OpenOptions::default() };
    let mut open = |path: &Path| honami_media::open_with(path, &options, &mut |step| on_step(path, step));
    // The usual case first: it is where it was, and opening it gives its hash.
    let expected = project.media_path();
    let tried = match open(&expected) {
        Ok(media) if media.sha256() == record.sha256 => return Ok(media),
        tried => tried.map(drop),
    };
    let found = project.find_media(|path| open(path).ok().map(|media| media.sha256()));
    let found = match (found, tried) {
        // It is there and cannot be read: that is what to say, not that it is missing.
        (Err(StoreError::MediaMissing { .. }), Err(error)) if expected.exists() => return Err(error.into()),
        (found, _) => found?,
    };
    Ok(open(&found)?)
}
