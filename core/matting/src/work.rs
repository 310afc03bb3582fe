//! Work that is shared among threads, and gives the same bits for any number of them.

use rayon::prelude::*;

/// Fewer nodes than this are not worth a second thread.
const WORTH_A_THREAD: usize = 4096;

/// Calls `work` with the number of every row and the row.
pub(crate) fn rows<T: Send>(values: &mut [T], width: usize, work: impl Fn(usize, &mut [T]) + Sync + Send) {
    let least = WORTH_A_THREAD.div_ceil(width);
    values.par_chunks_mut(width).with_min_len(least).enumerate().for_each(|(y, row)| work(y, row));
}

/// As many values as asked for, each by its number.
pub(crate) fn made<T: Send>(n: usize, make: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    (0..n).into_par_iter().with_min_len(WORTH_A_THREAD).map(make).collect()
}

/// Sum of the products of two vectors: by parts of one length, which are added in their order.
pub(crate) fn dot<const K: usize>(a: &[[f64; K]], b: &[[f64; K]]) -> f64 {
    let parts = a.par_chunks(WORTH_A_THREAD).zip(b.par_chunks(WORTH_A_THREAD));
    let part = |(a, b): (&[[f64; K]], &[[f64; K]])| {
        let products = a.as_flattened().iter().zip(b.as_flattened());
        products.map(|(a, b)| a * b).sum::<f64>()
    };
    parts.map(part).collect::<Vec<f64>>().iter().sum()
}

/// Changes every number of a vector by those at its place in two others.
pub(crate) fn each<const K: usize>(
    x: &mut [[f64; K]],
    a: &[[f64; K]],
    b: &[[f64; K]],
    change: impl Fn(&mut f64, f64, f64) + Sync + Send,
) {
    let parts = x.par_chunks_mut(WORTH_A_THREAD);
    parts.zip(a.par_chunks(WORTH_A_THREAD)).zip(b.par_chunks(WORTH_A_THREAD)).for_each(|((x, a), b)| {
        let numbers = x.as_flattened_mut().iter_mut().zip(a.as_flattened()).zip(b.as_flattened());
        numbers.for_each(|((x, a), b)| change(x, *a, *b));
    });
}
