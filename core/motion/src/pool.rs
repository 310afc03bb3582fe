//! Work on threads of its own, while whoever asked for it is told how far it is.

use std::ops::Range;
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::Duration;

use rayon::prelude::*;

use crate::MotionError;

/// How often who waits is asked whether to go on, also where a step takes longer.
const BEAT: Duration = Duration::from_millis(100);
/// Rows that a thread takes at a time, and those between two calls for progress.
const BLOCK: usize = 32;
const BATCH: usize = 256;

/// Does work on so many threads; 0: on those of the current rayon pool.
///
/// `keep_going` is called by the caller's thread, whenever the work tells its share and now and then between.
pub(crate) fn within<T: Send>(
    n_threads: usize,
    keep_going: &mut dyn FnMut(f64) -> bool,
    work: impl FnOnce(&mut dyn FnMut(f64) -> bool) -> Result<T, MotionError> + Send,
) -> Result<T, MotionError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).thread_name(|k| format!("motion-{k}"));
    // A system without threads to spare still has the pool that is there.
    let Some(pool) = Some(pool).filter(|_| n_threads > 0).and_then(|pool| pool.build().ok()) else {
        return work(keep_going);
    };
    let (tell, told) = sync_channel(0);
    let (answer, answered) = sync_channel(0);
    let mut result = Err(MotionError::Stopped);
    pool.in_place_scope(|scope| {
        let result = &mut result;
        scope.spawn(move |_| {
            *result = work(&mut |done| tell.send(done).is_ok() && answered.recv().unwrap_or(false));
        });
        let (mut last, mut goes_on) = (0.0, true);
        loop {
            match told.recv_timeout(BEAT) {
                Ok(done) => {
                    last = done;
                    goes_on = goes_on && keep_going(done);
                    if answer.send(goes_on).is_err() {
                        break;
                    }
                }
                Err(RecvTimeoutError::Timeout) => goes_on = goes_on && keep_going(last),
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
    });
    result
}

/// Does something with blocks of n rows, and returns what came of each row, in order. `keep_going` is told the share of the
/// work that is done; `false` stops.
pub(crate) fn blocks<R: Send>(
    n: usize,
    work: &(impl Fn(Range<usize>) -> Vec<R> + Sync),
    keep_going: &mut dyn FnMut(f64) -> bool,
) -> Result<Vec<R>, MotionError> {
    let mut results = Vec::with_capacity(n);
    for first in (0..n).step_by(BATCH) {
        let batch = first..(first + BATCH).min(n);
        let firsts: Vec<usize> = batch.clone().step_by(BLOCK).collect();
        let done: Vec<Vec<R>> =
            firsts.par_iter().map(|&first| work(first..(first + BLOCK).min(batch.end))).collect();
        results.extend(done.into_iter().flatten());
        if !keep_going(results.len() as f64 / n as f64) {
            return Err(MotionError::Stopped);
        }
    }
    Ok(results)
}
