//! Rows shared among threads.

/// Fewer values than this are not worth a thread.
const VALUES_A_THREAD: usize = 1 << 15;

/// Calls `work` on bands of rows of several arrays of one size, each band on a thread of its own: with the number of its
/// first row, and its part of every array.
pub(crate) fn bands<const N: usize>(
    arrays: [&mut [f32]; N],
    width: usize,
    n_threads: usize,
    work: impl Fn(usize, [&mut [f32]; N]) + Sync,
) {
    let n = arrays.first().map_or(0, |array| array.len());
    let height = n / width.max(1);
    let n_bands = n_threads.min(n / VALUES_A_THREAD).max(1);
    let rows = height.div_ceil(n_bands);
    let mut rest = arrays;
    let work = &work;
    std::thread::scope(|scope| {
        for first in (rows..height).step_by(rows.max(1)) {
            // What is split off here begins `rows` before `first`.
            let band = rest.each_mut().map(|array| {
                let (band, rest) = std::mem::take(array).split_at_mut(rows * width);
                *array = rest;
                band
            });
            scope.spawn(move || work(first - rows, band));
        }
        // The last band is this thread's.
        let done = height.saturating_sub(1) / rows.max(1) * rows;
        work(done, rest);
    });
}
