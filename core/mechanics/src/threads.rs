//! Threads that wait for work.

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
    /// So many; with one, work is done by whoever asks for it.
    ///
    /// # Errors
    /// [`ThreadsError`].
    pub fn new(n: usize) -> Result<Self, ThreadsError> {
        if n < 2 {
            return Ok(Self(None));
        }
        let builder = rayon::ThreadPoolBuilder::new().num_threads(n).thread_name(|k| format!("forest-{k}"));
        builder.build().map(|pool| Self(Some(pool))).map_err(|source| ThreadsError { n, source })
    }

    /// Does all pieces of work, in any order.
    pub(crate) fn each<W: Send>(
        &self,
        pieces: impl Iterator<Item = W> + Send,
        work: impl Fn(W) + Sync + Send,
    ) {
        let work = &work;
        match &self.0 {
            None => pieces.for_each(work),
            Some(pool) => pool.scope(|scope| pieces.for_each(|piece| scope.spawn(move |_| work(piece)))),
        }
    }
}
