//! How a job says how far it is, and how it is told to stop.

/// Whether a job goes on, or stops soon and keeps what can be kept.
pub use honami_host::Flow;

/// Whoever watches a job; called from the job's thread.
pub trait Progress: Sync {
    /// `done` of `total` steps are done; `what` names them: `frame`, `pairs`.
    fn report(&self, done: u64, total: u64, what: &str) -> Flow;
}

/// Nobody watches, and the job runs to its end.
impl Progress for () {
    fn report(&self, _done: u64, _total: u64, _what: &str) -> Flow {
        Flow::Continue
    }
}
