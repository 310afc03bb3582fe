//! Work on many things: shared among threads, and done in parts between which somebody is asked whether to go on.

#[cfg(test)]
mod tests;

/// Less work than this is not worth a thread, nanoseconds: to start one takes some fifty thousand.
const WORTH_A_THREAD_NS: f64 = 2.5e5;
/// Between two looks at whether to go on there is no more work than this on one thread, nanoseconds.
const A_LOOK_NS: f64 = 2e7;

/// How many things to do between two looks at whether to go on, where each takes about this long on one thread,
/// nanoseconds; at least 1.
#[must_use]
pub fn a_look(cost_ns: f64) -> usize {
    // Many cheap ones would take their memory, not their time.
    (A_LOOK_NS / cost_ns).clamp(1.0, 8192.0) as usize
}

/// How many threads, of those there are, are worth it for `n` things that take about `cost_ns` nanoseconds each.
#[must_use]
pub(crate) fn threads(n: usize, cost_ns: f64, max_threads: usize) -> usize {
    max_threads.min((n as f64 * cost_ns / WORTH_A_THREAD_NS) as usize).clamp(1, n.max(1))
}

/// Does things in parts that take a look's time each; `None` where `go_on`, told before each part the share that is
/// done, said no.
pub fn in_looks<I, O>(
    items: &[I],
    cost_ns: f64,
    go_on: &mut dyn FnMut(f64) -> bool,
    mut work: impl FnMut(&[I]) -> Vec<O>,
) -> Option<Vec<O>> {
    let mut done = Vec::with_capacity(items.len());
    for part in items.chunks(a_look(cost_ns)) {
        if !go_on(done.len() as f64 / items.len() as f64) {
            return None;
        }
        done.extend(work(part));
    }
    Some(done)
}

/// Calls `work` on as many parts of several arrays of one length as there are threads, each part on a thread of its own:
/// with the number of its first row, and its rows of every array. A row is `width` values, which stay together.
pub(crate) fn shared<T: Send, const N: usize>(
    arrays: [&mut [T]; N],
    width: usize,
    n_threads: usize,
    work: impl Fn(usize, [&mut [T]; N]) + Sync,
) {
    let n_rows = arrays.first().map_or(0, |array| array.len()) / width.max(1);
    let rows = n_rows.div_ceil(n_threads.max(1)).max(1);
    let mut rest = arrays;
    let work = &work;
    std::thread::scope(|scope| {
        let mut first = 0;
        while first + rows < n_rows {
            let part = rest.each_mut().map(|array| {
                let (part, others) = std::mem::take(array).split_at_mut(rows * width);
                *array = others;
                part
            });
            scope.spawn(move || work(first, part));
            first += rows;
        }
        // The last part is this thread's.
        work(first, rest);
    });
}
