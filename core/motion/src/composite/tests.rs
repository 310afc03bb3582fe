//! The fast passes against the formulas written out, and what must hold whatever the tracks.

use proptest::prelude::*;
use rand::{RngExt, SeedableRng};

use super::*;

/// Random walks with steps now and then repeated as zero, and samples missing.
fn walks(n_tracks: usize, n_frames: usize, missing: f64, seed: u64) -> Positions {
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    let mut positions = Positions::new(n_tracks, n_frames);
    for track in 0..n_tracks {
        let mut at = [rng.random_range(0.0..900.0_f32), rng.random_range(0.0..700.0)];
        for frame in 0..n_frames {
            if rng.random_range(0.0..1.0) >= missing {
                positions.set(track, frame, at);
            }
            if rng.random_range(0.0..1.0) < 0.9 {
                at = at.map(|c| c + rng.random_range(-3.0..3.0));
            }
        }
    }
    positions
}

fn of(positions: &Positions, options: &Options) -> Composite {
    composite(positions, options, &mut |_| true).expect("distances")
}

fn index(n: usize, i: usize, j: usize) -> usize {
    i * (2 * n - i - 1) / 2 + j - i - 1
}

/// Thesis 4.3.1 with errata E13, E14 and E16 word for word: every distance kept, two passes, arccos.
fn as_printed(positions: &Positions, options: &Options) -> (Vec<f64>, Vec<u32>) {
    let (n, n_steps) = (positions.n_tracks(), positions.n_frames() - 1);
    let step = |i: usize, t: usize| {
        let (here, there) = (positions.get(i, t)?, positions.get(i, t + 1)?);
        let [x, y] = here.map(f64::from);
        Some([x, y, f64::from(there[0]) - x, f64::from(there[1]) - y])
    };
    let pairs: Vec<(usize, usize)> = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))).collect();
    let place = |(i, j): (usize, usize), t| {
        let (a, b) = (step(i, t)?, step(j, t)?);
        Some((a[0] - b[0]).hypot(a[1] - b[1]))
    };
    let movement = |(i, j): (usize, usize), t| {
        let (a, b) = (step(i, t)?, step(j, t)?);
        let speeds = a[2].hypot(a[3]) * b[2].hypot(b[3]);
        (speeds > 0.0).then(|| ((a[2] * b[2] + a[3] * b[3]) / speeds).clamp(-1.0, 1.0).acos())
    };
    let mean_sd = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt())
    };
    let everywhere = |distance: &dyn Fn((usize, usize), usize) -> Option<f64>| -> Vec<f64> {
        (0..n_steps).flat_map(|t| pairs.iter().filter_map(move |&pair| distance(pair, t))).collect()
    };
    let (_, sd_place) = mean_sd(&everywhere(&place));
    let (mean_angle, sd_angle) = mean_sd(&everywhere(&movement));
    let (k_place, k_angle) = (options.position_weight / sd_place, options.movement_weight / sd_angle);
    let over = |values: Vec<f64>| (!values.is_empty()).then(|| mean_sd(&values).0);
    let frame_mean = |t: usize| {
        let angle = over(pairs.iter().filter_map(|&pair| movement(pair, t)).collect()).unwrap_or(mean_angle);
        Some(k_place * over(pairs.iter().filter_map(|&pair| place(pair, t)).collect())? + k_angle * angle)
    };
    let frame_means: Vec<Option<f64>> = (0..n_steps).map(frame_mean).collect();
    let (mean, sd) = mean_sd(&frame_means.iter().flatten().copied().collect::<Vec<_>>());
    let is_out = |t: &usize| {
        let far = |d: f64| options.outlier_sd.is_some_and(|factor| (d - mean).abs() > factor * sd);
        frame_means[*t].is_some_and(far)
    };
    let (out, kept): (Vec<usize>, Vec<usize>) = (0..n_steps).partition(is_out);
    let distance = |&pair: &(usize, usize)| {
        let places: Vec<f64> = kept.iter().filter_map(|&t| place(pair, t)).collect();
        let angle = over(kept.iter().filter_map(|&t| movement(pair, t)).collect()).unwrap_or(mean_angle);
        over(places).map(|place| k_place * place + k_angle * angle)
    };
    let distances: Vec<Option<f64>> = pairs.iter().map(distance).collect();
    let largest = distances.iter().flatten().fold(0.0_f64, |a, &b| a.max(b));
    (distances.iter().map(|d| d.unwrap_or(largest)).collect(), out.iter().map(|&t| t as u32).collect())
}

#[test]
fn equals_the_formulas_written_out() {
    let thesis = Options::default();
    let cases = [
        (walks(40, 30, 0.0, 1), thesis),
        (walks(37, 90, 0.05, 2), thesis),
        (walks(17, 200, 0.3, 3), Options { outlier_sd: None, ..thesis }),
        (walks(16, 40, 0.8, 4), Options { outlier_sd: Some(1.0), ..thesis }),
        (walks(33, 50, 0.1, 5), Options { position_weight: 0.0, ..thesis }),
        (
            walks(33, 50, 0.1, 6),
            Options { movement_weight: 0.0, position_weight: 3.0, outlier_sd: Some(1.5), n_threads: 2 },
        ),
        (walks(3, 5, 0.0, 7), thesis),
    ];
    for (case, (positions, options)) in cases.iter().enumerate() {
        let got = of(positions, options);
        let (wanted, out) = as_printed(positions, options);
        assert_eq!(got.outlier_frames, out, "case {case}");
        assert_eq!(got.condensed.len(), wanted.len());
        for (k, (a, b)) in got.condensed.iter().zip(&wanted).enumerate() {
            assert!((a - b).abs() < 1e-5 * (1.0 + b), "case {case}, pair {k}: {a}, wanted {b}");
        }
    }
}

#[test]
fn three_tracks_by_hand() {
    // Two go right side by side, 3 apart; the third goes up, 4 beside the first. The second step doubles
    // the distances to the third.
    let mut positions = Positions::new(3, 2);
    for (track, at, to) in
        [(0, [0.0, 0.0], [1.0, 0.0]), (1, [0.0, 3.0], [1.0, 3.0]), (2, [4.0, 0.0], [4.0, -1.0])]
    {
        positions.set(track, 0, at);
        positions.set(track, 1, to);
    }
    let got = of(&positions, &Options::default());
    let spread = |d: [f64; 3]| {
        let mean = d.iter().sum::<f64>() / 3.0;
        (d.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / 3.0).sqrt()
    };
    let (place, angle) = ([3.0, 4.0, 5.0], [0.0, 90.0_f64.to_radians(), 90.0_f64.to_radians()]);
    assert!((got.position_sd_px - spread(place)).abs() < 1e-6);
    assert!((got.movement_sd_rad - spread(angle)).abs() < 1e-6);
    for k in 0..3 {
        let wanted = place[k] / spread(place) + angle[k] / spread(angle);
        assert!((got.condensed[k] - wanted).abs() < 1e-5, "{k}: {} {wanted}", got.condensed[k]);
    }
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let positions = walks(301, 80, 0.05, 11);
    let with = |n_threads| of(&positions, &Options { n_threads, ..Options::default() });
    let one = with(1);
    for threads in [0, 2, 3, 8] {
        assert!(with(threads) == one, "{threads} threads");
    }
}

#[test]
fn the_same_bits_with_and_without_the_processors_vectors() {
    let n = 75;
    let steps = Steps::of(&walks(n, 200, 0.05, 15));
    let blocks = steps.blocks(Place, &(0..199).collect::<Vec<_>>());
    let put = |total: &mut f64, _: usize, _: usize, sum: f64| *total = sum;
    let (mut dispatched, mut plain) = (vec![0.0; n * (n - 1) / 2], vec![0.0; n * (n - 1) / 2]);
    pairs::add::<Place>(n, &blocks, &mut dispatched, put, &mut |_| true).expect("sums");
    for (first, rows) in pairs::rows_by_block(&mut plain, n) {
        pairs::block_row::<Place>(&blocks, first, n, rows, &put);
    }
    assert!(dispatched == plain && plain.iter().all(|&sum| sum > 0.0));
}

#[test]
fn a_frame_that_throws_everything_about_is_left_out() {
    let mut positions = walks(20, 60, 0.0, 12);
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(4);
    for track in 0..20 {
        positions.set(track, 30, [rng.random_range(-9e3..9e3), rng.random_range(-9e3..9e3)]);
    }
    let got = of(&positions, &Options::default());
    assert_eq!(got.outlier_frames, [30]);
    assert!(of(&positions, &Options { outlier_sd: None, ..Options::default() }).outlier_frames.is_empty());
    // No factor is so small that nothing remains.
    let none_left = of(&positions, &Options { outlier_sd: Some(0.0), ..Options::default() });
    assert!(none_left.outlier_frames.is_empty());
}

#[test]
fn gaps_still_features_and_strangers() {
    let mut positions = walks(6, 40, 0.0, 13);
    for frame in 0..40 {
        positions.set(4, frame, [5.0, 5.0]); // never moves
        if frame < 20 {
            positions.set(0, frame, [f32::NAN, 0.0]); // seen in the second half only
        } else {
            positions.set(1, frame, [0.0, f32::INFINITY]); // seen in the first half only
        }
    }
    let got = of(&positions, &Options { position_weight: 0.0, outlier_sd: None, ..Options::default() });
    assert_eq!(got.n_apart, 1);
    let largest = got.condensed.iter().fold(0.0_f64, |a, &b| a.max(b));
    assert_eq!(got.condensed[index(6, 0, 1)].to_bits(), largest.to_bits());
    let to_still = got.condensed[index(6, 2, 4)];
    assert!((got.condensed[index(6, 3, 4)] - to_still).abs() < 1e-12, "a still feature is as far from all");
}

#[test]
fn tracks_that_are_the_same_are_no_distance_apart() {
    let mut positions = walks(12, 100, 0.0, 14);
    for frame in 0..100 {
        let at = positions.get(3, frame).expect("seen");
        positions.set(7, frame, at); // in f64 the quotient of eq. 4.2 exceeds 1 for a quarter of these (E14)
    }
    let got = of(&positions, &Options::default());
    assert!(got.condensed[index(12, 3, 7)].abs() < 1e-12);
}

#[test]
fn what_cannot_be_grouped_says_why() {
    let apart = |frames: [usize; 2]| {
        let mut positions = Positions::new(2, 4);
        frames.iter().enumerate().for_each(|(track, &frame)| {
            positions.set(track, frame, [0.0, 0.0]);
            positions.set(track, frame + 1, [1.0, 0.0]);
        });
        positions
    };
    let thesis = Options::default();
    let cases = [
        (Positions::new(1, 9), thesis, "grouping needs at least 2 tracks, came 1"),
        (Positions::new(3, 1), thesis, "movement needs at least 2 frames, came 1"),
        (
            apart([0, 2]),
            thesis,
            "no two tracks are seen in the same two consecutive frames; track longer, or pick others",
        ),
        (
            apart([0, 0]),
            Options { movement_weight: -1.0, ..thesis },
            "the weight of movement must be a finite number, 0 or more, and not all weights 0; came -1",
        ),
    ];
    for (positions, options, wanted) in cases {
        assert_eq!(composite(&positions, &options, &mut |_| true).unwrap_err().to_string(), wanted);
    }
    let zero = Options { movement_weight: 0.0, position_weight: 0.0, ..thesis };
    assert!(composite(&apart([0, 0]), &zero, &mut |_| true).is_err());
    assert_eq!(composite(&walks(40, 9, 0.0, 1), &thesis, &mut |_| false), Err(MotionError::Stopped));
}

#[test]
fn progress_grows_to_one() {
    let mut last = 0.0;
    composite(&walks(600, 9, 0.0, 1), &Options::default(), &mut |done| {
        assert!(done >= last && done <= 1.0 + 1e-12);
        last = done;
        true
    })
    .expect("distances");
    assert!((last - 1.0).abs() < 1e-12);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn sorted_headings_give_the_sums_over_all_pairs(headings in proptest::collection::vec(-3.15_f64..3.15, 0..60)) {
        let headings: Vec<f64> = headings.into_iter().map(|h| h.clamp(-std::f64::consts::PI, std::f64::consts::PI)).collect();
        let mut wanted = Moments::default();
        for (i, a) in headings.iter().enumerate() {
            for b in &headings[i + 1..] {
                let angle = (a.cos() * b.cos() + a.sin() * b.sin()).clamp(-1.0, 1.0).acos();
                wanted = Moments { n_pairs: wanted.n_pairs + 1.0, sum: wanted.sum + angle, squares: wanted.squares + angle * angle };
            }
        }
        let got = headings::of_headings(headings);
        prop_assert!((got.n_pairs - wanted.n_pairs).abs() < 0.5);
        prop_assert!((got.sum - wanted.sum).abs() < 1e-6 && (got.squares - wanted.squares).abs() < 1e-6, "{got:?} {wanted:?}");
    }

    /// Errata E15: with no velocity zero and no gap, a pseudo-metric.
    #[test]
    fn the_triangle_inequality_holds(seed: u64) {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let mut positions = Positions::new(9, 12);
        for track in 0..9 {
            for frame in 0..12 {
                positions.set(track, frame, [rng.random_range(0.0..99.0), rng.random_range(0.0..99.0)]);
            }
        }
        let got = of(&positions, &Options::default());
        let d = |i: usize, j: usize| if i == j { 0.0 } else { got.condensed[index(9, i.min(j), i.max(j))] };
        for (i, j, k) in (0..9).flat_map(|i| (0..9).flat_map(move |j| (0..9).map(move |k| (i, j, k)))) {
            prop_assert!(d(i, j) <= d(i, k) + d(k, j) + 1e-5);
        }
    }

    /// Order of tracks, place of the origin, scale and direction of the image do not matter.
    #[test]
    fn only_the_movement_matters(seed: u64, turn in 0.0_f32..6.0, scale in 0.1_f32..4.0, shift in -500.0_f32..500.0) {
        let positions = walks(20, 30, 0.0, seed);
        let mut moved = Positions::new(20, 30);
        for track in 0..20 {
            for frame in 0..30 {
                let [x, y] = positions.get(track, frame).expect("seen");
                let (s, c) = turn.sin_cos();
                moved.set(19 - track, frame, [scale * (c * x - s * y) + shift, scale * (s * x + c * y) - shift]);
            }
        }
        let options = Options { outlier_sd: None, ..Options::default() };
        let (a, b) = (of(&positions, &options), of(&moved, &options));
        for i in 0..20 {
            for j in i + 1..20 {
                let (was, is) = (a.condensed[index(20, i, j)], b.condensed[index(20, 19 - j, 19 - i)]);
                prop_assert!((was - is).abs() < 2e-3, "{was} {is}");
            }
        }
    }
}
