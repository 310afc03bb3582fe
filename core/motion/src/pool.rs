//! Work on threads of its own, while whoever asked for it is told how far it is.

use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::Duration;

use crate::MotionError;

/// How often who waits is asked whether to go on, also where a step takes longer.
const BEAT: Duration = Duration::from_millis(100);

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
