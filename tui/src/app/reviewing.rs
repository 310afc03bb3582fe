//! Suspicion is measured behind the screen, on a thread of its own, for as long as the project is open.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};

use honami_workbench::WorkbenchError;
use honami_workbench::media::Media;
use honami_workbench::progress::{Flow, Progress};
use honami_workbench::review::{Changes, Known, Reviewer, Told};
use honami_workbench::store::Project;

use crate::term::signals::Waker;

/// Threads that look at pictures: one, for the screen and the decoder are at work too.
const THREADS: usize = 1;

/// The reviewer's desk: changes lie on it until the thread takes them, what it finds until the screen does.
pub(super) struct Reviewing {
    known: Known,
    desk: Arc<Desk>,
}

struct Desk {
    papers: Mutex<Papers>,
    arrived: Condvar,
    /// The thread is wanted at the desk: it leaves the pictures.
    called: AtomicBool,
    waker: Waker,
}

#[derive(Default)]
struct Papers {
    changes: Vec<Changes>,
    told: Vec<Told>,
    failed: Option<WorkbenchError>,
    is_closed: bool,
}

impl Reviewing {
    pub(super) fn start(media: Arc<Media>, waker: Waker) -> std::io::Result<Self> {
        let (papers, arrived, called) = Default::default();
        let desk = Arc::new(Desk { papers, arrived, called, waker });
        let at = Arc::clone(&desk);
        // It ends when the desk is closed; nobody waits for it.
        std::thread::Builder::new().name("review".to_owned()).spawn(move || {
            let work = std::panic::AssertUnwindSafe(|| at.work(Reviewer::new(media, THREADS)));
            if std::panic::catch_unwind(work).is_err() {
                at.fail(WorkbenchError::Fault);
            }
        })?;
        Ok(Self { known: Known::default(), desk })
    }

    /// Hands over what has changed in the project.
    pub(super) fn look_at(&mut self, project: &Project) -> Result<(), WorkbenchError> {
        let changes = Changes::since(&mut self.known, project)?;
        if !changes.is_empty() {
            self.desk.papers().changes.push(changes);
            self.desk.called.store(true, Ordering::Relaxed);
            self.desk.arrived.notify_one();
        }
        Ok(())
    }

    /// What was found since it was last asked; once, why no more will be.
    pub(super) fn told(&self) -> (Vec<Told>, Option<WorkbenchError>) {
        let mut papers = self.desk.papers();
        (std::mem::take(&mut papers.told), papers.failed.take())
    }
}

impl Drop for Reviewing {
    fn drop(&mut self) {
        self.desk.papers().is_closed = true;
        self.desk.called.store(true, Ordering::Relaxed);
        self.desk.arrived.notify_one();
    }
}

impl Desk {
    fn papers(&self) -> std::sync::MutexGuard<'_, Papers> {
        self.papers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn work(&self, mut reviewer: Reviewer) {
        while let Some(changes) = self.take(reviewer.is_pending()) {
            let told = if changes.is_empty() {
                match reviewer.look(self) {
                    Ok(told) => told,
                    Err(error) => return self.fail(error),
                }
            } else {
                changes.into_iter().flat_map(|changes| reviewer.tell(changes)).collect()
            };
            if !told.is_empty() {
                self.papers().told.extend(told);
                self.waker.wake();
            }
        }
    }

    /// Nothing more will be found.
    fn fail(&self, error: WorkbenchError) {
        self.papers().failed = Some(error);
        self.waker.wake();
    }

    /// Waits for changes, unless there are pictures to look at; `None` when the desk is closed.
    fn take(&self, has_work: bool) -> Option<Vec<Changes>> {
        let mut papers = self.papers();
        while papers.changes.is_empty() && !papers.is_closed && !has_work {
            papers = self.arrived.wait(papers).unwrap_or_else(PoisonError::into_inner);
        }
        self.called.store(false, Ordering::Relaxed);
        (!papers.is_closed).then(|| std::mem::take(&mut papers.changes))
    }
}

impl Progress for Desk {
    fn report(&self, _done: u64, _total: u64, _what: &str) -> Flow {
        if self.called.load(Ordering::Relaxed) { Flow::Stop } else { Flow::Continue }
    }
}
