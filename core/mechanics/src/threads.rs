//! Threads that wait for work.

use std::sync::atomic::{AtomicUsize, Ordering::Acquire, Ordering::Release};
use std::sync::{Mutex, PoisonError};

/// Looks at what others still do before whoever asked goes to sleep: about as long as a piece of work takes.
const LOOKS: usize = 20_000;

/// Threads for poses and steps: started once, so that a frame of microseconds does not wait for them.
#[derive(Debug)]
pub struct Threads(Option<rayon::ThreadPool>);

/// The system gave no threads.
#[derive(Debug, thiserror::Error)]
#[error("the system starts no {n} threads: {source}")]
pub struct ThreadsError {
    n: usize,
    source: rayon::ThreadPoolBuildError,
}

impl Threads {
    /// So many, with that of whoever asks for work.
    ///
    /// # Errors
    /// [`ThreadsError`].
    pub fn new(n: usize) -> Result<Self, ThreadsError> {
        if n < 2 {
            return Ok(Self(None));
        }
        let builder =
            rayon::ThreadPoolBuilder::new().num_threads(n - 1).thread_name(|k| format!("forest-{k}"));
        builder.build().map(|pool| Self(Some(pool))).map_err(|source| ThreadsError { n, source })
    }

    /// Does all pieces of work, in any order.
    pub(crate) fn each<W: Send>(
        &self,
        pieces: impl Iterator<Item = W> + Send,
        work: impl Fn(W) + Sync + Send,
    ) {
        let Some(pool) = &self.0 else { return pieces.for_each(work) };
        // Whoever is free takes the next: one wake-up a thread, however many pieces there are.
        let pieces = Mutex::new(pieces);
        let next = || pieces.lock().unwrap_or_else(PoisonError::into_inner).next();
        let all = || {
            while let Some(piece) = next() {
                work(piece);
            }
        };
        let at_work = AtomicUsize::new(pool.current_num_threads());
        pool.in_place_scope(|scope| {
            for _ in 0..pool.current_num_threads() {
                scope.spawn(|_| {
                    all();
                    at_work.fetch_sub(1, Release);
                });
            }
            all();
            for _ in 0..LOOKS {
                if at_work.load(Acquire) == 0 {
                    break;
                }
                std::hint::spin_loop();
            }
        });
    }
}
