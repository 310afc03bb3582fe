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

fn of(positions: &Positions, likeness: Likeness, position_weight: f64) -> Likenesses {
    let options = Options { likeness, position_weight, ..Options::default() };
    likenesses(positions, &options, &mut |_| true).unwrap()
}

/// Distances divided by their standard deviation over all N x N entries, plus a weight times those of places.
fn joined(feature: &DMatrix<f64>, places: &[[f64; 2]], weight: f64) -> Vec<f64> {
    let place =
        DMatrix::from_fn(N, N, |i, j| (places[i][0] - places[j][0]).hypot(places[i][1] - places[j][1]));
    let scaled = |d: &DMatrix<f64>| d / d.variance().sqrt();
    let sum = scaled(feature) + weight * scaled(&place);
    (0..N).flat_map(|i| (i + 1..N).map(move |j| (i, j))).map(|(i, j)| sum[(i, j)]).collect()
}

/// Recipes R1, G15 and denoised |rho|, word for word.
fn as_written(positions: &Positions, likeness: Likeness, weight: f64) -> Vec<f64> {
    let at = |track: usize, frame: usize| positions.get(track, frame).unwrap().map(f64::from);
    let mut table = DMatrix::from_fn(T, 2 * N, |frame, column| at(column % N, frame)[column / N]);
    let means: Vec<f64> = (0..2 * N).map(|column| table.column(column).mean()).collect();
    (0..2 * N).for_each(|column| table.column_mut(column).add_scalar_mut(-means[column]));
    let svd = table.svd(true, true);
    let (u, s, v) = (svd.u.unwrap(), svd.singular_values, svd.v_t.unwrap());
    let edge = crate::bod::noise::edge(s.as_slice(), T, 2 * N);
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
            let smooth = DMatrix::from_fn(T, 2 * N, |frame, column| {
                (0..n).map(|k| u[(frame, k)] * s[k] * v[(k, column)]).sum::<f64>()
            });
            let steps = |column: usize| {
                let steps = DVector::from_fn(T - 1, |t, _| smooth[(t + 1, column)] - smooth[(t, column)]);
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
    for seed in [1, 2] {
        let positions = branches(0.2, seed);
        for (likeness, weight) in [(Likeness::Loadings, 0.6), (Likeness::Turned, 0.5), (Likeness::Steps, 1.0)]
        {
            let (got, wanted) = (of(&positions, likeness, weight), as_written(&positions, likeness, weight));
            assert!(got.n_above >= 6 && got.n_filled == 0 && got.n_unseen == 0, "{got:?}");
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
        assert_eq!(found.n_used, 0);
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
    let moving = branches(0.0, 5);
    let mut positions = Positions::new(N, T);
    for track in 0..N {
        for frame in 0..T {
            let at = moving.get(track, if track < 3 { 0 } else { frame }).unwrap();
            if track != 7 {
                positions.set(track, frame, at);
            }
        }
    }
    let found = of(&positions, Likeness::Loadings, 0.0);
    assert_eq!(found.n_unseen, 1);
    let d = |i: usize, j: usize| found.condensed[i * (2 * N - i - 1) / 2 + j - i - 1];
    assert!(d(0, 1).max(d(0, 2)).max(d(1, 2)) < 1e-12);
    assert!(d(0, 20) > 0.0);
    let largest = found.condensed.iter().fold(0.0_f64, |a, &b| a.max(b));
    assert!((0..7).all(|k| d(k, 7) >= largest) && (8..N).all(|k| d(7, k) >= largest));
}

#[test]
fn the_same_bits_for_any_number_of_threads_and_wrong_options_are_refused() {
    let positions = branches(0.3, 6);
    let with = |n_threads| {
        let options = Options { n_threads, flutter: Flutter::TakeDown, ..Options::default() };
        likenesses(&positions, &options, &mut |_| true).unwrap()
    };
    let one = with(1);
    assert!(one.is_whitened && [0, 2, 3].iter().all(|&n| with(n) == one));
    for came in [-1.0, f64::NAN, f64::INFINITY] {
        let options = Options { position_weight: came, ..Options::default() };
        let error = likenesses(&positions, &options, &mut |_| true).unwrap_err();
        assert!(error.to_string().starts_with("the weight of position"), "{error}");
    }
    let mut shares = Vec::new();
    let stopped = likenesses(&positions, &Options::default(), &mut |done| {
        shares.push(done);
        done < 0.9
    });
    assert_eq!(stopped.unwrap_err(), MotionError::Stopped);
    assert!(shares.is_sorted() && shares.iter().all(|done| (0.0..=1.0).contains(done)), "{shares:?}");
}
