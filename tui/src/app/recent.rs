//! Projects opened lately, newest first: `$XDG_STATE_HOME/honami/recent`.
//!
//! A line each: seconds since 1970, number of tracks (and of segments still to be reviewed: `135/12`), path, with
//! tabs between. Nothing needs to be opened to show them.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use super::config;

/// More are not kept.
const N_MAX: usize = 20;

/// A project that was opened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recent {
    /// The project file, absolute.
    pub path: PathBuf,
    /// Tracks it showed when it was left.
    pub n_tracks: usize,
    /// Segments that were still to be reviewed then, where that was known.
    pub n_open: Option<usize>,
    /// When it was last open, seconds since 1970.
    pub when_s: u64,
}

impl Recent {
    fn of_line(line: &str) -> Option<Self> {
        let mut parts = line.splitn(3, '\t');
        let (when_s, counts) = (parts.next()?.parse().ok()?, parts.next()?);
        let (n_tracks, n_open) = counts.split_once('/').map_or((counts, None), |(n, open)| (n, Some(open)));
        let n_open = n_open.map(str::parse).transpose().ok()?;
        let n_tracks = n_tracks.parse().ok()?;
        let path = parts.next().map(PathBuf::from).filter(|path| path.is_absolute())?;
        Some(Self { path, n_tracks, n_open, when_s })
    }

    /// How long ago it was open: `yesterday`.
    #[must_use]
    pub fn ago(&self, now_s: u64) -> String {
        let s = now_s.saturating_sub(self.when_s);
        let (minute, hour, day) = (60, 3600, 86_400);
        let some = |n: u64, unit: &str| format!("{n} {unit}{} ago", if n == 1 { "" } else { "s" });
        match s {
            _ if s < minute => "just now".to_owned(),
            _ if s < hour => some(s / minute, "minute"),
            _ if s < day => some(s / hour, "hour"),
            _ if s < 2 * day => "yesterday".to_owned(),
            _ if s < 60 * day => some(s / day, "day"),
            _ => some(s / (30 * day), "month"),
        }
    }
}

/// The projects of a text; lines that are none are passed over.
#[must_use]
pub fn of(text: &str) -> Vec<Recent> {
    text.lines().filter_map(Recent::of_line).take(N_MAX).collect()
}

/// The list after a project was open, as text.
#[must_use]
pub fn after(mut list: Vec<Recent>, newest: Recent) -> String {
    list.retain(|recent| recent.path != newest.path);
    list.insert(0, newest);
    list.truncate(N_MAX);
    // A path that is no text, or has a line break, has no line.
    let line = |recent: &Recent| {
        let path = recent.path.to_str().filter(|path| !path.contains('\n'))?;
        let open = recent.n_open.map_or_else(String::new, |n| format!("/{n}"));
        Some(format!("{}\t{}{open}\t{path}\n", recent.when_s, recent.n_tracks))
    };
    list.iter().filter_map(line).collect()
}

/// The projects that are still there.
#[must_use]
pub fn load() -> Vec<Recent> {
    let mut list = file().and_then(|file| fs::read_to_string(file).ok()).map_or_else(Vec::new, |t| of(&t));
    list.retain(|recent| recent.path.exists());
    list
}

/// Notes that a project is open, or was until now. Lost without harm: nobody is told.
pub(super) fn note(project: &Path, n_tracks: usize, n_open: Option<usize>) {
    let (Some(file), Ok(path)) = (file(), project.canonicalize()) else { return };
    let text = after(load(), Recent { path, n_tracks, n_open, when_s: now_s() });
    fs::create_dir_all(file.parent().unwrap_or(Path::new("/"))).ok();
    // Whole or not at all, also where two sessions end at once.
    let new = file.with_extension(std::process::id().to_string());
    if fs::write(&new, text).is_err() || fs::rename(&new, &file).is_err() {
        fs::remove_file(&new).ok();
    }
}

/// Seconds since 1970.
#[must_use]
pub fn now_s() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |t| t.as_secs())
}

fn file() -> Option<PathBuf> {
    config::folder("XDG_STATE_HOME", ".local/state").map(|folder| folder.join("recent"))
}

#[cfg(test)]
mod tests;
