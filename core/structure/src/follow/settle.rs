//! The places of tracks beside the centre of their group, where not all are seen all the time.

use std::collections::BTreeMap;

use super::{Path, less, mean, means, more};

/// What is left to correct, pixels: places are found.
const SETTLED: f64 = 1e-9;
/// Rounds at most. There are as many as ways in which tracks overlap, and a few where they hardly do.
const MAX_ROUNDS: u32 = 1000;

/// Places as far as frames tell in which several are seen: the least squares, centres left out of them, by conjugate
/// gradients, which also end where tracks hardly overlap (Hestenes and Stiefel 1952).
pub(super) fn places(paths: &[&Path], n_frames: usize) -> Vec<[f64; 2]> {
    let weights: Vec<f64> = paths.iter().map(|path| path.seen().count().max(1) as f64).collect();
    let scaled =
        |of: &[[f64; 2]]| of.iter().zip(&weights).map(|(of, n)| of.map(|v| v / n)).collect::<Vec<_>>();
    let mut places = vec![[0.0; 2]; paths.len()];
    let mut left = beside_means(paths, n_frames, |_, at| at);
    let mut way = scaled(&left);
    let mut power = product(&left, &way);
    for _ in 0..MAX_ROUNDS {
        let bent = beside_means(paths, n_frames, |k, _| way[k]);
        let bend = product(&way, &bent);
        // Nothing bends where no tracks are seen together.
        if bend <= 0.0 || way.iter().all(|way| way[0].hypot(way[1]) < SETTLED) {
            break;
        }
        let step = power / bend;
        for k in 0..paths.len() {
            places[k] = more(places[k], way[k].map(|v| step * v));
            left[k] = less(left[k], bent[k].map(|v| step * v));
        }
        let next = scaled(&left);
        let before = std::mem::replace(&mut power, product(&left, &next));
        way = next.iter().zip(&way).map(|(next, way)| more(*next, way.map(|v| power / before * v))).collect();
    }
    places
}

/// How far something of each track is from its mean over all that are seen, summed over the track's frames.
fn beside_means(paths: &[&Path], n_frames: usize, of: impl Fn(usize, [f64; 2]) -> [f64; 2]) -> Vec<[f64; 2]> {
    let means = means(paths, n_frames, &of);
    let beside = |k: usize, path: &Path| {
        let apart = path.seen().filter_map(|(frame, at)| Some(less(of(k, at), means[frame]?)));
        apart.fold([0.0; 2], more)
    };
    paths.iter().enumerate().map(|(k, path)| beside(k, path)).collect()
}

fn product(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a[0] * b[0] + a[1] * b[1]).sum()
}

/// Takes away the jumps from tracks to others that are never seen with them; as a whole the centre stays where it was.
pub(super) fn join(paths: &[&Path], centre: &mut [Option<[f64; 2]>]) {
    let was = whole(paths, centre);
    let (mut shifts, mut before) = (BTreeMap::new(), None);
    for (at, chain) in centre.iter_mut().zip(chains(paths)) {
        let (Some(at), Some(chain)) = (at.as_mut(), chain) else { continue };
        let shift =
            shifts.entry(chain).or_insert_with(|| before.map_or([0.0; 2], |before| less(before, *at)));
        *at = more(*at, *shift);
        before = Some(*at);
    }
    if shifts.len() > 1 {
        let by = less(was, whole(paths, centre));
        centre.iter_mut().flatten().for_each(|at| *at = more(*at, by));
    }
}

/// The mean of the centre over all samples.
fn whole(paths: &[&Path], centre: &[Option<[f64; 2]>]) -> [f64; 2] {
    mean(paths.iter().flat_map(|path| path.seen()).filter_map(|(frame, _)| centre[frame])).unwrap_or_default()
}

/// For every frame in which anything is seen the first of the tracks that are seen together, or by way of others.
fn chains(paths: &[&Path]) -> Vec<Option<usize>> {
    let n_frames = paths.iter().map(|path| path.at.len()).max().unwrap_or_default();
    let mut of: Vec<usize> = (0..paths.len()).collect();
    let mut seen = vec![None; n_frames];
    for (k, path) in paths.iter().enumerate() {
        for (frame, _) in path.seen() {
            let with = *seen[frame].get_or_insert(k);
            let (a, b) = (first(&mut of, with), first(&mut of, k));
            of[a.max(b)] = a.min(b);
        }
    }
    seen.into_iter().map(|k| k.map(|k| first(&mut of, k))).collect()
}

fn first(of: &mut [usize], mut k: usize) -> usize {
    while of[k] != k {
        of[k] = of[of[k]];
        k = of[k];
    }
    k
}
