//! Corrections are worked out behind the screen, on a thread of its own: the newest wish first, then the errors of the
//! models. What is not wanted any more is stopped, and nothing of it is kept.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};

use honami_workbench::WorkbenchError;
use honami_workbench::offer::{self, Errors, Granted, Wish};
use honami_workbench::progress::{Flow, Progress};
use honami_workbench::retrack::Study;

use super::correcting::{Answer, Ask};
use crate::term::signals::Waker;

/// The thread's desk, and what it found last.
pub(super) struct Offering {
    desk: Arc<Desk>,
    granted: Option<(Wish, Granted)>,
}

struct Desk {
    papers: Mutex<Papers>,
    arrived: Condvar,
    /// What is being worked out is not wanted any more.
    called: AtomicBool,
    waker: Waker,
}

#[derive(Default)]
struct Papers {
    study: Option<Arc<Study>>,
    wish: Option<Wish>,
    /// The frame round which the models are tried.
    frame: Option<u32>,
    told: Vec<Told>,
    is_closed: bool,
}

enum Task {
    Grant(Wish),
    Try(u32),
}

enum Told {
    Granted(Wish, Result<Granted, WorkbenchError>),
    Errors(Result<Errors, WorkbenchError>),
}

impl Offering {
    pub(super) fn start(waker: Waker) -> std::io::Result<Self> {
        let (papers, arrived, called) = Default::default();
        let desk = Arc::new(Desk { papers, arrived, called, waker });
        let at = Arc::clone(&desk);
        // It ends when the desk is closed; nobody waits for it.
        std::thread::Builder::new().name("offers".to_owned()).spawn(move || at.work())?;
        Ok(Self { desk, granted: None })
    }

    /// From now on this is the track; what was found of another, or of this one as it was, is forgotten.
    pub(super) fn study(&mut self, study: Study) {
        self.granted = None;
        let mut papers = self.desk.papers();
        *papers = Papers { study: Some(Arc::new(study)), frame: papers.frame, ..Papers::default() };
        self.desk.call();
    }

    /// Works this out next.
    pub(super) fn ask(&mut self, ask: Ask) {
        let mut papers = self.desk.papers();
        match ask {
            Ask::Errors(_, frame) => papers.frame = Some(frame),
            Ask::Ghost(wish) => {
                self.granted = None;
                papers.wish = wish;
                self.desk.call();
            }
        }
        self.desk.arrived.notify_one();
    }

    /// What was worked out since it was last asked.
    pub(super) fn news(&mut self) -> Vec<Answer> {
        let mut papers = self.desk.papers();
        let track = papers.study.as_ref().map(|study| study.track());
        let told = std::mem::take(&mut papers.told);
        drop(papers);
        let answer = |told| match told {
            Told::Errors(errors) => {
                track.map(|track| Answer::Errors(track, errors.map_err(|error| error.to_string())))
            }
            Told::Granted(wish, Err(error)) => Some(Answer::Ghost(wish, Err(error.to_string()))),
            Told::Granted(wish, Ok(granted)) => {
                let ghost = Ok(Arc::new(granted.correction().clone()));
                self.granted = Some((wish.clone(), granted));
                Some(Answer::Ghost(wish, ghost))
            }
        };
        told.into_iter().filter_map(answer).collect()
    }

    /// Hands over what was found for a wish, once.
    pub(super) fn take(&mut self, wish: &Wish) -> Option<Granted> {
        self.granted.take_if(|(known, _)| known == wish).map(|(_, granted)| granted)
    }
}

impl Drop for Offering {
    fn drop(&mut self) {
        self.desk.papers().is_closed = true;
        self.desk.call();
    }
}

impl Desk {
    fn papers(&self) -> std::sync::MutexGuard<'_, Papers> {
        self.papers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn call(&self) {
        self.called.store(true, Ordering::Relaxed);
        self.arrived.notify_one();
    }

    fn work(&self) {
        while let Some((study, task)) = self.take() {
            let told = match task {
                Task::Grant(wish) => match sound(|| offer::grant(&study, &wish, self)) {
                    Err(WorkbenchError::Stopped) => continue,
                    granted => Told::Granted(wish, granted),
                },
                Task::Try(frame) => match sound(|| offer::errors(&study, frame, self)) {
                    Err(WorkbenchError::Stopped) => {
                        self.again(&study, frame);
                        continue;
                    }
                    errors => Told::Errors(errors),
                },
            };
            let mut papers = self.papers();
            // What was found of a track as it was says nothing of it as it is.
            if papers.study.as_ref().is_some_and(|now| Arc::ptr_eq(now, &study)) {
                papers.told.push(told);
                self.waker.wake();
            }
        }
    }

    /// A wish came between: the models are tried again after it.
    fn again(&self, study: &Arc<Study>, frame: u32) {
        let mut papers = self.papers();
        if papers.study.as_ref().is_some_and(|now| Arc::ptr_eq(now, study)) {
            papers.frame = papers.frame.or(Some(frame));
        }
    }

    /// Waits for something to do; `None` when the desk is closed.
    fn take(&self) -> Option<(Arc<Study>, Task)> {
        let mut papers = self.papers();
        loop {
            if papers.is_closed {
                return None;
            }
            self.called.store(false, Ordering::Relaxed);
            if let Some(study) = papers.study.clone() {
                let wish = papers.wish.take().map(Task::Grant);
                if let Some(task) = wish.or_else(|| papers.frame.take().map(Task::Try)) {
                    return Some((study, task));
                }
            }
            papers = self.arrived.wait(papers).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// A fault of the work is told as an error is: who waits for it goes on, and so does the thread. What the work reads
/// nobody changes, so that it is whole whatever happens.
fn sound<T>(work: impl FnOnce() -> Result<T, WorkbenchError>) -> Result<T, WorkbenchError> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or(Err(WorkbenchError::Fault))
}

impl Progress for Desk {
    fn report(&self, _done: u64, _total: u64, _what: &str) -> Flow {
        if self.called.load(Ordering::Relaxed) { Flow::Stop } else { Flow::Continue }
    }
}

#[cfg(test)]
mod tests;
