//! Recipes written out on nalgebra's own decomposition, what no distance may depend on, and tracks that hardly move.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};

use super::*;

const N: usize = 24;
const T: usize = 90;

/// Branches of six tracks that swing with two frequencies of their own, each track with amounts of its own, and noise.
fn branches(noise_px: f64, seed: u64) -> Positions {
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    let mut positions = Positions::new(N, T);
    for track in 0..N {
        let branch = (track / 6) as f64;
        let amounts: [f64; 4] = std::array::from_fn(|_| rng.random_range(2.0..4.0));
        let place = [rng.random_range(0.0..500.0), rng.random_range(0.0..500.0)];
        for frame in 0..T {
            let t = frame as f64;
            let swing = [((0.2 + 0.07 * branch) * t + branch).sin(), ((0.6 + 0.11 * branch) * t).cos()];
            let at: [f64; 2] = std::array::from_fn(|axis| {
                let moved = amounts[axis] * swing[0] + amounts[2 + axis] * swing[1] * (1.0 - axis as f64);
                place[axis] + moved + noise_px * rng.random_range(-1.7..1.7)
            });
            positions.set(track, frame, at.map(|v| v as f32));
        }
    }
    positions
}

/// What distances are made of, and the distances of all pairs, neither smoothed nor whitened.
struct Found {
    tracks: Tracks,
    condensed: Vec<f64>,
}

fn of(positions: &Positions, likeness: Likeness, position_weight: f64) -> Found {
    let options =
        Options { likeness, position_weight, n_neighbours: 0, flutter: Flutter::Keep, ..Options::default() };
    let table = Table::new(positions, &mut |_| true).unwrap();
    let tracks = Tracks::new(&table, &options, &mut |_| true).unwrap();
    let pairs = Pairs::new(&tracks.features, &tracks.places, position_weight);
    let condensed = pairs.distances(&mut |_| true).unwrap();
    Found { tracks, condensed }
}

/// Distances divided by their standard deviation over all N x N entries, plus a weight times those of places.
fn joined(feature: &DMatrix<f64>, places: &[[f64; 2]], weight: f64) -> Vec<f64> {
    let place =
        DMatrix::from_fn(N, N, |i, j| (places[i][0] - places[j][0]).hypot(places[i][1] - places[j][1]));
    let scaled = |d: &DMatrix<f64>| d / d.variance().sqrt();
    let sum = scaled(feature) + weight * scaled(&place);
    (0..N).flat_map(|i| (i + 1..N).map(move |j| (i, j))).map(|(i, j)| sum[(i, j)]).collect()
}

/// Recipes R1, G15 and denoised |rho|, word for word, over the frames in which all are seen.
fn as_written(positions: &Positions, likeness: Likeness, weight: f64) -> Vec<f64> {
    let seen: Vec<usize> = (0..T).filter(|&frame| positions.get(0, frame).is_some()).collect();
    let n_seen = seen.len();
    let at = |track: usize, k: usize| positions.get(track, seen[k]).unwrap().map(f64::from);
    let mut table = DMatrix::from_fn(n_seen, 2 * N, |frame, column| at(column % N, frame)[column / N]);
    let means: Vec<f64> = (0..2 * N).map(|column| table.column(column).mean()).collect();
    (0..2 * N).for_each(|column| table.column_mut(column).add_scalar_mut(-means[column]));
    let svd = table.svd(true, true);
    let (u, s, v) = (svd.u.unwrap(), svd.singular_values, svd.v_t.unwrap());
    let edge = crate::bod::noise::edge(s.as_slice(), n_seen, 2 * N);
    let n_above = s.iter().filter(|s| **s > edge).count();
    let loading = |track: usize, k: usize| [v[(k, track)], v[(k, N + track)]];
    let share = |k: usize| (1.0 - (edge / s[k]).powi(2)).max(0.0).sqrt();
    let feature = match likeness {
        Likeness::Loadings => {
            let row = |track: usize| -> DVector<f64> {
                let n = n_above.clamp(4, 30);
                let weighted =
                    (0..n).flat_map(|k| loading(track, k).map(|v| share(k) * (s[k] / s[0]).powf(0.25) * v));
                DVector::from_iterator(2 * n, weighted).normalize()
            };
            DMatrix::from_fn(N, N, |i, j| (row(i) - row(j)).norm())
        }
        Likeness::Turned => {
            let square = |track: usize| {
                let n = n_above.clamp(4, 15);
                let own = DMatrix::from_fn(n, 2, |k, axis| share(k) * loading(track, k)[axis]);
                let product = &own * own.transpose();
                let trace = product.trace();
                product / trace
            };
            DMatrix::from_fn(N, N, |i, j| (square(i) - square(j)).norm())
        }
        Likeness::Steps => {
            let n = n_above.max(4);
            let smooth = DMatrix::from_fn(n_seen, 2 * N, |frame, column| {
                (0..n).map(|k| u[(frame, k)] * s[k] * v[(k, column)]).sum::<f64>()
            });
            let steps = |column: usize| {
                let follow = (1..n_seen).filter(|&k| seen[k] == seen[k - 1] + 1);
                let steps = follow.map(|k| smooth[(k, column)] - smooth[(k - 1, column)]).collect();
                let steps = DVector::from_vec(steps);
                let mean = steps.mean();
                steps.add_scalar(-mean)
            };
            DMatrix::from_fn(N, N, |i, j| {
                let [a, b, c, d] = [i, N + i, j, N + j].map(steps);
                let (re, im) = (a.dot(&c) + b.dot(&d), b.dot(&c) - a.dot(&d));
                let lengths = (a.norm_squared() + b.norm_squared()) * (c.norm_squared() + d.norm_squared());
                if i == j { 0.0 } else { (1.0 - re.hypot(im) / lengths.sqrt()).max(0.0).sqrt() }
            })
        }
    };
    let places: Vec<[f64; 2]> = (0..N).map(|track| [means[track], means[N + track]]).collect();
    joined(&feature, &places, weight)
}

#[test]
fn the_recipes_are_those_that_are_written_down() {
    // The second is unseen in the middle, and everything is elsewhere afterwards.
    for (seed, unseen) in [(1, 0..0), (2, 40..47)] {
        let mut positions = branches(0.2, seed);
        for (track, frame) in (0..N).flat_map(|track| (unseen.start..T).map(move |frame| (track, frame))) {
            if !unseen.is_empty() {
                let jump = if unseen.contains(&frame) { f32::NAN } else { 3.0 + track as f32 };
                positions.set(track, frame, positions.get(track, frame).unwrap().map(|v| v + jump));
            }
        }
        for (likeness, weight) in [(Likeness::Loadings, 0.6), (Likeness::Turned, 0.5), (Likeness::Steps, 1.0)]
        {
            let (got, wanted) = (of(&positions, likeness, weight), as_written(&positions, likeness, weight));
            assert!(got.tracks.n_above >= 6, "{}", got.tracks.n_above);
            for (k, (got, wanted)) in got.condensed.iter().zip(&wanted).enumerate() {
                assert!((got - wanted).abs() < 1e-5, "{likeness:?} pair {k}: {got}, wanted {wanted}");
            }
        }
    }
}

/// In a picture that is turned, and with every track going the other way, G and |rho| are what they were.
#[test]
fn two_likenesses_do_not_change_when_the_picture_or_a_movement_turns() {
    let positions = branches(0.2, 3);
    let (sin, cos) = 0.7_f64.sin_cos();
    let mut other = Positions::new(N, T);
    for track in 0..N {
        let start = positions.get(track, 0).unwrap().map(f64::from);
        for frame in 0..T {
            let [x, y] = positions.get(track, frame).unwrap().map(f64::from);
            let [x, y] = [x - start[0], y - start[1]];
            other.set(track, frame, [(-(cos * x - sin * y)) as f32, (-(sin * x + cos * y)) as f32]);
        }
    }
    for likeness in [Likeness::Turned, Likeness::Steps] {
        let (a, b) = (of(&positions, likeness, 0.0), of(&other, likeness, 0.0));
        let far = a.condensed.iter().zip(&b.condensed).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(far < 1e-3, "{likeness:?}: {far}");
    }
}

#[test]
fn branches_are_found_through_noise_without_any_place() {
    let truth: Vec<u32> = (0..N as u32).map(|track| track / 6).collect();
    for likeness in [Likeness::Loadings, Likeness::Turned, Likeness::Steps] {
        let found = of(&branches(0.3, 4), likeness, 0.0);
        let tree = crate::linkage(found.condensed, N, crate::Criterion::Ward).unwrap();
        assert_eq!(crate::score::adjusted_rand_index(&tree.cut(4), &truth), Some(1.0), "{likeness:?}");
    }
}

#[test]
fn where_nothing_moves_place_alone_tells_tracks_apart() {
    let mut positions = Positions::new(4, 30);
    for (track, x) in [0.0, 1.0, 10.0, 30.0].into_iter().enumerate() {
        (0..30).for_each(|frame| positions.set(track, frame, [x, 5.0]));
    }
    for likeness in [Likeness::Loadings, Likeness::Turned, Likeness::Steps] {
        let found = of(&positions, likeness, 0.6);
        assert_eq!(found.tracks.n_used, 0);
        let scale = found.condensed[0];
        let wanted = [1.0, 10.0, 30.0, 9.0, 29.0, 20.0];
        assert!(found.condensed.iter().zip(wanted).all(|(d, far)| (d / scale - far).abs() < 1e-9));
        assert!(of(&positions, likeness, 0.0).condensed.iter().all(|d| *d == 0.0));
    }
    // All in one place, all the same way: no distance at all.
    let mut same = Positions::new(5, 30);
    for track in 0..5 {
        (0..30).for_each(|frame| same.set(track, frame, [(0.2 * frame as f32).sin(), 1.0]));
    }
    assert!(of(&same, Likeness::Loadings, 0.6).condensed.iter().all(|d| *d < 1e-6));
}

#[test]
fn tracks_at_rest_are_alike_and_those_never_seen_are_farthest_from_all() {
    let positions = some_at_rest(&branches(0.0, 5));
    let found = of(&positions, Likeness::Loadings, 0.0);
    let d = |i: usize, j: usize| found.condensed[i * (2 * N - i - 1) / 2 + j - i - 1];
    assert!(d(0, 1).max(d(0, 2)).max(d(1, 2)) < 1e-12);
    assert!(d(0, 20) > 0.0);
    let largest = found.condensed.iter().fold(0.0_f64, |a, &b| a.max(b));
    assert!((0..7).all(|k| d(k, 7) >= largest) && (8..N).all(|k| d(7, k) >= largest));
}

/// The weights of two neighbours written out; where both are in one place all count the same, and alone one stays as it is.
#[test]
fn a_neighbourhood_is_weighed_by_its_farthest() {
    let nearest = vec![vec![(1, 1.0), (2, 2.0)], vec![(0, 0.0), (2, 0.0)], Vec::new()];
    let means = smooth::Neighbourhoods::new(nearest).means(&[1.0, 10.0, 100.0]);
    let (near, far) = ((-0.25_f64).exp(), (-1.0_f64).exp());
    let wanted = [(1.0 + 10.0 * near + 100.0 * far) / (1.0 + near + far), 111.0 / 3.0, 100.0];
    assert!(
        means.iter().zip(wanted).all(|(got, wanted)| (got - wanted).abs() < 1e-12),
        "{means:?} {wanted:?}"
    );
}

/// Tracks 0 to 2 are at rest, and 7 is never seen.
fn some_at_rest(moving: &Positions) -> Positions {
    let mut positions = Positions::new(moving.n_tracks(), T);
    for track in (0..moving.n_tracks()).filter(|track| *track != 7) {
        for frame in 0..T {
            let at = moving.get(track, if track < 3 { 0 } else { frame }).unwrap();
            positions.set(track, frame, at);
        }
    }
    positions
}

/// Against all distances sorted.
#[test]
fn the_nearest_are_those_that_move_and_are_nearest() {
    for (positions, resting) in [(branches(0.3, 7), 0), (some_at_rest(&branches(0.3, 7)), 3)] {
        for likeness in [Likeness::Loadings, Likeness::Steps] {
            let Found { tracks, condensed } = of(&positions, likeness, 0.6);
            let pairs = Pairs::new(&tracks.features, &tracks.places, 0.6);
            let scales = pairs.scales(&mut |_| true).unwrap();
            let found = pairs.nearest(5, scales, &mut |_| true).unwrap();
            let is_other = |track: usize| track >= resting && (resting == 0 || track != 7);
            for (i, found) in found.iter().enumerate() {
                let d = |j: usize| condensed[i.min(j) * (2 * N - i.min(j) - 1) / 2 + i.max(j) - i.min(j) - 1];
                let mut all: Vec<(u32, f64)> =
                    (0..N).filter(|&j| j != i && is_other(j)).map(|j| (j as u32, d(j))).collect();
                all.sort_by(|a, b| a.1.total_cmp(&b.1));
                all.truncate(if is_other(i) { 5 } else { 0 });
                assert_eq!(found, &all, "{likeness:?} {i}");
            }
        }
    }
}

/// A stem that has half of the tracks, and eight branches of ten that sway with it and each a little by itself.
fn conifer(noise_px: f64, seed: u64) -> (Positions, Vec<u32>) {
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    let truth: Vec<u32> = (0..160).map(|track: u32| if track < 80 { 0 } else { (track - 70) / 10 }).collect();
    let mut positions = Positions::new(truth.len(), T);
    for (track, branch) in truth.iter().map(|branch| f64::from(*branch)).enumerate() {
        let [all, own]: [f64; 2] = [rng.random_range(2.0..4.0), rng.random_range(0.6..1.2)];
        let place = if branch == 0.0 {
            [rng.random_range(-40.0..40.0), rng.random_range(0.0..600.0)]
        } else {
            let side = if branch % 2.0 == 0.0 { -80.0 } else { 80.0 };
            [side + rng.random_range(-60.0..60.0), 75.0 * (branch - 0.5) + rng.random_range(-60.0..60.0)]
        };
        for frame in 0..T {
            let t = frame as f64;
            let mut moved = all * (0.23 * t).sin();
            if branch > 0.0 {
                moved += own * ((0.5 + 0.09 * branch) * t + branch).sin();
            }
            let at: [f64; 2] = std::array::from_fn(|axis| {
                let noise = noise_px * (0..3).map(|_| rng.random_range(-1.0..1.0)).sum::<f64>();
                place[axis] + (1.0 - 0.5 * axis as f64) * moved + noise
            });
            positions.set(track, frame, at.map(|v| v as f32));
        }
    }
    (positions, truth)
}

fn score(positions: &Positions, truth: &[u32], options: &Options) -> f64 {
    let tree = grouped(positions, options, &mut |_| true).unwrap().tree;
    let n_groups = truth.iter().max().unwrap() + 1;
    crate::score::adjusted_rand_index(&tree.cut(n_groups), truth).unwrap()
}

/// R1 is `Loadings` merged by Ward's criterion.
#[test]
fn smoothed_and_cut_more_is_found_than_by_recipe_r1() {
    let r1 = Options {
        likeness: Likeness::Loadings,
        n_neighbours: 0,
        making: Making::Merges(Criterion::Ward),
        ..Options::default()
    };
    let smoothed = Options { n_neighbours: 8, ..r1 };
    let mut sums = [0.0; 3];
    for seed in 0..4 {
        let (positions, truth) = conifer(0.6, 40 + seed);
        for (sum, options) in sums.iter_mut().zip([r1, smoothed, Options::default()]) {
            *sum += score(&positions, &truth, &options) / 4.0;
        }
    }
    let [r1, smoothed, cut] = sums;
    assert!(r1 < 0.75 && smoothed > r1 + 0.1 && cut > 0.95, "{sums:?}");
}

#[test]
fn at_rest_in_one_place_or_few_tracks_all_have_a_place_in_the_hierarchy() {
    let makings = [Making::Cuts, Making::Merges(Criterion::Ward)];
    let tree = |positions: &Positions, making| {
        let found = grouped(positions, &Options { making, ..Options::default() }, &mut |_| true).unwrap();
        assert_eq!(found.tree.merges().len() + 1, positions.n_tracks());
        let heights: Vec<f64> = found.tree.merges().iter().map(|merge| merge.height).collect();
        assert!(heights.is_sorted() && heights.iter().all(|height| height.is_finite()), "{heights:?}");
        found
    };
    let mut same = Positions::new(48, 30);
    (0..48 * 30).for_each(|k| same.set(k / 30, k % 30, [(0.5 * (k % 30) as f32).sin(), 1.0]));
    let mut still = Positions::new(6, 30);
    let x = [0.0, 1.0, 2.0, 500.0, 501.0, 502.0];
    (0..6 * 30).for_each(|k| still.set(k / 30, k % 30, [x[k / 30], 1.0]));
    let mut two = Positions::new(2, 2);
    (0..4).for_each(|k| two.set(k / 2, k % 2, [k as f32, 1.0]));
    for making in makings {
        assert!(tree(&same, making).tree.merges().iter().all(|merge| merge.height < 1e-6));
        let found = tree(&still, making);
        assert_eq!((found.n_used, found.tree.cut(2)), (0, vec![0, 0, 0, 1, 1, 1]));
        tree(&two, making);
        let found = tree(&some_at_rest(&branches(0.3, 9)), making);
        assert_eq!(found.n_unseen, 1);
    }
    for (n_tracks, wanted) in
        [(0, "grouping needs at least 2 tracks"), (1, "grouping needs at least 2 tracks")]
    {
        let error = grouped(&Positions::new(n_tracks, 9), &Options::default(), &mut |_| true).unwrap_err();
        assert!(error.to_string().starts_with(wanted), "{error}");
    }
}

#[test]
fn the_same_bits_for_any_number_of_threads_and_wrong_options_are_refused() {
    let positions = branches(0.3, 6);
    let with = |n_threads| {
        let options = Options { n_threads, flutter: Flutter::TakeDown, ..Options::default() };
        grouped(&positions, &options, &mut |_| true).unwrap()
    };
    let one = with(1);
    assert!(one.is_whitened && [0, 2, 3].iter().all(|&n| with(n) == one));
    let many = conifer(0.5, 3).0;
    let with =
        |n_threads| grouped(&many, &Options { n_threads, ..Options::default() }, &mut |_| true).unwrap();
    assert!([2, 3].iter().all(|&n| with(n) == with(1)));
    for came in [-1.0, f64::NAN, f64::INFINITY] {
        let options = Options { position_weight: came, ..Options::default() };
        let error = grouped(&positions, &options, &mut |_| true).unwrap_err();
        assert!(error.to_string().starts_with("the weight of position"), "{error}");
    }
    let mut shares = Vec::new();
    let stopped = grouped(&positions, &Options::default(), &mut |done| {
        shares.push(done);
        done < 0.9
    });
    assert_eq!(stopped.unwrap_err(), MotionError::Stopped);
    assert!(shares.is_sorted() && shares.iter().all(|done| (0.0..=1.0).contains(done)), "{shares:?}");
}
