//! Parts that cover everything once, and looks as often as the work is long.

use super::*;

#[test]
fn parts_cover_every_row_once_for_any_number_of_threads() {
    for (width, height) in [(1, 0), (1, 1), (1, 500), (3, 2100), (400, 3)] {
        for n_threads in [0, 1, 2, 3, 7, 1000] {
            let (mut a, mut b) = (vec![0; width * height], vec![0; width * height]);
            shared([&mut a, &mut b], width, n_threads, |first, [a, b]| {
                assert_eq!((a.len() % width, a.len()), (0, b.len()));
                for (y, row) in (first..).zip(a.chunks_exact_mut(width)) {
                    row.iter_mut().for_each(|v| *v += y + 1);
                }
                b.iter_mut().for_each(|v| *v += 1);
            });
            assert!(a.chunks_exact(width).zip(1..).all(|(row, y)| row.iter().all(|v| *v == y)));
            assert!(b.iter().all(|v| *v == 1));
        }
    }
}

#[test]
fn threads_are_as_many_as_the_work_is_worth() {
    for (n, cost_ns, max_threads, want) in
        [(0, 1e9, 4, 1), (1, 1e9, 4, 1), (3, 1e9, 4, 3), (64, 4e3, 4, 1), (640, 4e3, 4, 4), (9, 1.0, 0, 1)]
    {
        assert_eq!(threads(n, cost_ns, max_threads), want, "{n} things of {cost_ns} ns");
    }
}

#[test]
fn looks_come_as_often_as_the_work_is_long_and_each_no_counts() {
    let items: Vec<u32> = (0..1000).collect();
    // A quarter of a look's work, two looks' work, and so cheap that memory is what limits it.
    for (cost_ns, n_looks) in
        [(A_LOOK_NS / 4.0, 250), (2.0 * A_LOOK_NS, 1000), (1e-3, 1), (f64::INFINITY, 1000)]
    {
        let mut shares = Vec::new();
        let mut until = |limit: usize| {
            shares.clear();
            let done = in_looks(
                &items,
                cost_ns,
                &mut |share| {
                    shares.push(share);
                    shares.len() < limit
                },
                |part| part.iter().map(|n| n + 1).collect(),
            );
            (done, shares.clone())
        };
        let (done, shares) = until(usize::MAX);
        assert!(done.is_some_and(|done| done.iter().eq((1..=1000).collect::<Vec<_>>().iter())));
        assert_eq!(shares.len(), n_looks);
        assert!(shares.is_sorted() && shares.iter().all(|share| (0.0..1.0).contains(share)));
        assert_eq!(until(1).0, None);
        assert_eq!(until(n_looks).0, None);
    }
    assert_eq!(in_looks(&[], 1.0, &mut |_| false, |part: &[u8]| part.to_vec()), Some(vec![]));
}

/// Pixels of windows that are searched between two looks, at the smallest, the usual and the largest settings: a few
/// nanoseconds each.
#[test]
fn a_look_of_klt_is_no_longer_with_larger_windows_and_more_levels() {
    use crate::klt::Params;
    for (radius_px, levels) in [(1, 1), (10, 4), (31, 6), (100, 10)] {
        let params = Params { radius_px, levels, ..Params::default() };
        let n = a_look(params.cost_ns());
        let pixels = n * (2 * radius_px as usize + 1).pow(2) * levels as usize;
        assert!(pixels <= 10_000_000, "{n} points with windows of {radius_px} px on {levels} levels");
    }
}
