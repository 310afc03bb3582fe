//! The frames of a run on their way into the project: what its user is told of is there already, however honami ends.

use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use honami_model::track::{Status, TrackSet};
use honami_store::RunWriter;

use crate::drive::Rows;
use crate::error::WorkbenchError;
use crate::progress::{Flow, Level, Patience, Progress, Silence};

/// Frames that are written at a time, at most.
const CHUNK: usize = 64;
/// Frames before a seam that a rebuilt tracker does again, to be compared.
const BESIDE: usize = 50;
/// After a write the next waits for so many times as long as that took,
const WAIT_PER_WRITE: u32 = 100;
/// but no shorter, for what is written in small pieces takes longer to be put together;
const WAIT_MIN: Duration = Duration::from_millis(250);
/// nor longer: before its user is told that a plugin is silent, all frames before are written;
const WAIT_MAX: Duration = Duration::from_secs(1);
/// unless the disk is so slow that a run would be written for much of its time.
const WAIT_PER_SLOW_WRITE: u32 = 10;

/// Frames that are tracked, and the pen that keeps them a chunk at a time.
pub(super) struct Kept {
    pub(super) writer: RunWriter,
    /// The first frame that is not written.
    pub(super) first_frame: u32,
    /// The first of the run.
    start: u32,
    frames: Vec<Rows>,
    /// The last frames.
    recent: VecDeque<(u32, Rows)>,
    /// When the next are written, however few they are.
    due: Option<Instant>,
    /// Tracks that are hidden in the first frame; the tracker, which was told where they are, takes them to be seen.
    hidden: TrackSet,
}

impl Kept {
    pub(super) fn new(writer: RunWriter, first_frame: u32, hidden: TrackSet) -> Self {
        let (start, frames, recent) = (first_frame, Vec::new(), VecDeque::new());
        Self { writer, first_frame, start, frames, recent, due: None, hidden }
    }

    pub(super) fn add(&mut self, frame: u32, rows: &Rows) -> Result<(), WorkbenchError> {
        let mut rows = rows.clone();
        // Only of the first frame is that known.
        let hidden = std::mem::take(&mut self.hidden);
        for (_, sample) in rows.iter_mut().filter(|(track, _)| hidden.contains(*track)) {
            sample.status = Status::Occluded;
        }
        if self.recent.len() == BESIDE {
            self.recent.pop_front();
        }
        self.recent.push_back((frame, rows.clone()));
        self.frames.push(rows);
        if self.frames.len() == CHUNK { self.flush() } else { Ok(()) }
    }

    /// Of the last frames those from this one on.
    pub(super) fn recent(&self, from: u32) -> Vec<(u32, Rows)> {
        self.recent.iter().filter(|(frame, _)| *frame >= from).cloned().collect()
    }

    pub(super) fn flush(&mut self) -> Result<(), WorkbenchError> {
        let begun = Instant::now();
        let written = self.writer.append(self.first_frame, &self.frames);
        self.due = Some(Instant::now() + wait_after(begun.elapsed()));
        written?;
        self.first_frame += u32::try_from(self.frames.len()).unwrap_or(u32::MAX);
        self.frames.clear();
        Ok(())
    }

    /// Writes what has come, if it is time; how many frames are written.
    fn look(&mut self, now: Instant) -> u32 {
        let is_due = self.due.is_none_or(|due| now >= due);
        if is_due && !self.frames.is_empty() {
            // They are not lost: the next write has them, too, and whoever asks for that is told.
            drop(self.flush());
        }
        self.first_frame - self.start
    }
}

/// How long the next write waits after one that took so long.
fn wait_after(write: Duration) -> Duration {
    (write * WAIT_PER_WRITE).clamp(WAIT_MIN, WAIT_MAX.max(write * WAIT_PER_SLOW_WRITE))
}

/// Several have the run in hand: who tracks, and who looks whether frames are to be written.
pub(super) fn hand<'a, T: ?Sized>(kept: &'a Mutex<T>) -> MutexGuard<'a, T> {
    kept.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Sees to it that frames are written soon, also while the tracker takes its time, and tells only of those that are.
pub(super) struct Keeper<'a> {
    pub(super) kept: &'a Mutex<&'a mut Kept>,
    pub(super) progress: &'a dyn Progress,
}

impl Progress for Keeper<'_> {
    fn report(&self, done: u64, total: u64, what: &str) -> Flow {
        let n_written = hand(self.kept).look(Instant::now());
        // What a tracker has not answered yet, or has done on trial, is nobody's yet.
        self.progress.report(done.min(u64::from(n_written)), total, what)
    }

    fn part(&self, name: &str) {
        self.progress.part(name);
    }

    fn hear(&self, plugin: &str, frame: Option<u32>, level: Level, line: &str) {
        self.progress.hear(plugin, frame, level, line);
    }

    fn at(&self, frame: u32) {
        self.progress.at(frame);
    }

    fn died(&self, plugin: &str, frame: u32, how: &str, then: Option<&str>) {
        self.progress.died(plugin, frame, how, then);
    }

    fn silent(&self, plugin: &str, frame: Option<u32>, at: &str, silence: Option<Silence>) -> Patience {
        self.progress.silent(plugin, frame, at, silence)
    }

    fn say(&self, line: &str) {
        self.progress.say(line);
    }
}

#[cfg(test)]
mod tests;
