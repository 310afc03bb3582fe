//! Decompositions known by hand, noise whose law is known, and tables that are no tables.

use rand::{RngExt, SeedableRng};
use realfft::num_complex::Complex;

use super::*;

type At = [f64; 2];

/// Tracks from what places them: `None` where they are not seen.
fn tracks(n_tracks: usize, n_frames: usize, at: impl Fn(usize, usize) -> Option<At>) -> Positions {
    let mut positions = Positions::new(n_tracks, n_frames);
    for track in 0..n_tracks {
        for frame in 0..n_frames {
            if let Some(at) = at(track, frame) {
                positions.set(track, frame, at.map(|v| v as f32));
            }
        }
    }
    positions
}

fn table(positions: &Positions) -> Table {
    Table::new(positions, &mut |_| true).unwrap()
}

fn numbers(n: usize, seed: u64) -> Vec<f64> {
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    // Twelve of these have the variance of a normal number.
    (0..n).map(|_| (0..12).map(|_| rng.random_range(-0.5..0.5)).sum()).collect()
}

/// Two swings that every track joins with amounts of its own, and noise, pixels.
fn two_swings(n_tracks: usize, n_frames: usize, noise_px: f64, seed: u64) -> impl Fn(usize, usize) -> At {
    let amounts = numbers(4 * n_tracks, seed);
    let noise = numbers(2 * n_tracks * n_frames, seed + 1);
    move |track, frame| {
        let swing = [(0.31 * frame as f64).sin(), (0.83 * frame as f64 + 1.0).sin()];
        [0, 1].map(|axis| {
            let moved: f64 = (0..2).map(|k| 3.0 * amounts[4 * track + 2 * axis + k] * swing[k]).sum();
            let place = 100.0 + 7.0 * ((track * (axis + 3)) % 41) as f64;
            place + moved + noise_px * noise[2 * (track * n_frames + frame) + axis]
        })
    }
}

fn rms(a: &Positions, of: impl Fn(usize, usize) -> At) -> f64 {
    let (mut sum, mut n) = (0.0, 0);
    for track in 0..a.n_tracks() {
        for frame in 0..a.n_frames() {
            if let Some(at) = a.get(track, frame) {
                let wanted = of(track, frame);
                sum += (0..2).map(|k| (f64::from(at[k]) - wanted[k]).powi(2)).sum::<f64>();
                n += 2;
            }
        }
    }
    (sum / f64::from(n)).sqrt()
}

/// Y = 12 u1 v1^T + 4 u2 v2^T with u1 = (1, 1, -1, -1) / 2, u2 = (1, -1, -1, 1) / 2, v1 = (1, 0, 1, 0) / sqrt 2 … worked
/// out by hand: track 0 goes right and down with the first, track 1 right with the second.
#[test]
fn a_table_known_by_hand() {
    let (slow, quick) = ([3.0, 3.0, -3.0, -3.0], [2.0, -2.0, -2.0, 2.0]);
    let positions = tracks(2, 4, |track, frame| {
        Some(if track == 0 { [10.0 + slow[frame], 20.0 + slow[frame]] } else { [30.0 + quick[frame], 40.0] })
    });
    let table = table(&positions);
    let places = [table.place(0), table.place(1)];
    assert_eq!(places, [Some([10.0, 20.0]), Some([30.0, 40.0])]);
    let bod = Bod::new(&table);
    let wanted = [72.0_f64.sqrt(), 4.0, 0.0, 0.0];
    for (got, wanted) in bod.singular.iter().zip(wanted) {
        assert!((got - wanted).abs() < 1e-12, "{:?}", bod.singular);
    }
    assert_eq!(bod.len(), 2);
    let root = 0.5_f64.sqrt();
    let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
    assert!(close(bod.chronos(0), &[0.5, 0.5, -0.5, -0.5]), "{:?}", bod.chronos(0));
    assert!(close(bod.chronos(1), &[0.5, -0.5, -0.5, 0.5]), "{:?}", bod.chronos(1));
    assert!(close(bod.topos(0)[0], &[root, 0.0]) && close(bod.topos(0)[1], &[root, 0.0]));
    assert!(close(bod.topos(1)[0], &[0.0, 1.0]) && close(bod.topos(1)[1], &[0.0, 0.0]));
    // 72 + 16 in all; right and down is a line that falls to the right, at 135 degrees.
    assert!((bod.portion(0) - 72.0 / 88.0).abs() < 1e-12);
    for (component, degrees) in [(0, 135.0), (1, 0.0)] {
        let axis = bod.axis(component);
        // 0 and 180 degrees are one line.
        let off = (axis.angle_rad.to_degrees() - degrees + 90.0).rem_euclid(180.0) - 90.0;
        assert!(off.abs() < 1e-9 && axis.straight > 1.0 - 1e-9, "{axis:?}");
        assert_eq!(bod.n_half(component), 1);
    }
}

/// Ten tracks that swing together: the first with 12.25 parts of 21.25; then in all directions alike.
#[test]
fn how_many_have_half_of_a_component_and_whether_it_has_a_line() {
    let swing = |frame: usize| (0.3 * frame as f64).sin();
    let uneven = tracks(10, 40, |track, frame| {
        Some([0.0, if track == 0 { 3.5 * swing(frame) } else { swing(frame) }])
    });
    let round = tracks(10, 40, |track, frame| {
        let (sin, cos) = (std::f64::consts::PI * track as f64 / 10.0).sin_cos();
        Some([cos * swing(frame), sin * swing(frame)])
    });
    let [uneven, round] = [uneven, round].map(|positions| Bod::new(&table(&positions)));
    assert_eq!((uneven.n_half(0), round.n_half(0)), (1, 5));
    assert!((uneven.axis(0).angle_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
    assert!(round.axis(0).straight < 1e-5, "{:?}", round.axis(0));
}

/// Against nalgebra's own decomposition of the table, more frames than coordinates and fewer.
#[test]
fn the_gram_matrix_gives_what_a_decomposition_of_the_table_gives() {
    for (n_tracks, n_frames) in [(9, 50), (40, 31), (8, 16), (3, 2)] {
        let at = two_swings(n_tracks, n_frames, 0.7, 5);
        let table = table(&tracks(n_tracks, n_frames, |track, frame| Some(at(track, frame))));
        let bod = Bod::new(&table);
        let whole = DMatrix::from_column_slice(n_frames, 2 * n_tracks, table.series());
        let svd = whole.svd(true, true);
        let (u, v) = (svd.u.unwrap(), svd.v_t.unwrap());
        for (k, s) in bod.singular.iter().enumerate() {
            assert!((s - svd.singular_values[k]).abs() < 1e-6 * bod.singular[0], "{k}: {s}");
        }
        for k in 0..bod.len() {
            let time: f64 = bod.chronos(k).iter().zip(u.column(k).iter()).map(|(a, b)| a * b).sum();
            let place: f64 = bod.topos(k).concat().iter().zip(v.row(k).iter()).map(|(a, b)| a * b).sum();
            assert!((time * place - 1.0).abs() < 1e-6, "component {k}: {time} {place}");
        }
    }
}

/// At beta = 1 the median angle solves a - sin a = pi / 2 and x = 2 + 2 cos a; the others follow from the thresholds
/// omega that Gavish and Donoho print (2014, table IV), omega = lambda / sqrt(mu).
#[test]
fn the_median_of_marchenko_and_pastur_is_that_of_the_literature() {
    let mut angle = 2.0_f64;
    for _ in 0..50 {
        angle -= (angle - angle.sin() - std::f64::consts::FRAC_PI_2) / (1.0 - angle.cos());
    }
    assert!((noise::median_square(1.0) - (2.0 + 2.0 * angle.cos())).abs() < 1e-6);
    for (beta, omega) in [(0.05, 1.5194), (0.1, 1.6089), (0.25, 1.8371), (0.5, 2.1711), (1.0, 2.8582)] {
        let lambda = (2.0 * (beta + 1.0)
            + 8.0 * beta / (beta + 1.0 + f64::sqrt(beta * beta + 14.0 * beta + 1.0)))
        .sqrt();
        let got = lambda / noise::median_square(beta).sqrt();
        assert!((got - omega).abs() < 4e-4, "{beta}: {got}, printed {omega}");
    }
    // Of a table that is all length, every value is the same.
    assert!((noise::median_square(1e-9) - 1.0).abs() < 1e-4);
}

#[test]
fn noise_alone_stays_below_its_edge() {
    for (n_tracks, n_frames) in [(150, 100), (40, 200)] {
        let noise = numbers(2 * n_tracks * n_frames, 3);
        let at = |track: usize, frame: usize| {
            let k = 2 * (track * n_frames + frame);
            Some([2.0 * noise[k], 2.0 * noise[k + 1]])
        };
        let bod = Bod::new(&table(&tracks(n_tracks, n_frames, at)));
        let wanted = 2.0 * ((n_frames as f64).sqrt() + (2.0 * n_tracks as f64).sqrt());
        assert!((bod.edge / wanted - 1.0).abs() < 0.02, "{} of {wanted}", bod.edge);
        // The largest of finitely many scatters about the edge.
        assert!(bod.singular[0] < 1.02 * bod.edge, "{} {}", bod.singular[0], bod.edge);
    }
}

#[test]
fn motion_of_two_components_is_found_exactly_and_through_noise() {
    let clean = two_swings(60, 120, 0.0, 9);
    for (noise_px, within) in [(0.0, 2e-5), (0.5, 0.2)] {
        let noisy = two_swings(60, 120, noise_px, 9);
        let positions = tracks(60, 120, |track, frame| Some(noisy(track, frame)));
        let bod = Bod::new(&table(&positions));
        let (smooth, n) = denoised(&positions, 0, &mut |_| true).unwrap();
        let off = rms(&smooth, &clean);
        assert!(off < within, "{noise_px} px of noise: {off} px");
        assert!(noise_px == 0.0 || (bod.n_above() == 2 && n == 4), "{} {n}", bod.n_above());
    }
}

/// Whether a track is seen: some start late, some end early, some have holes.
fn is_seen(track: usize, frame: usize) -> bool {
    match track % 4 {
        0 => true,
        1 => frame >= 40,
        2 => frame < 90,
        _ => !(20..50).contains(&frame) && frame % 7 != 3,
    }
}

#[test]
fn tracks_that_start_late_end_early_or_have_holes_are_filled_from_the_others() {
    let clean = two_swings(60, 120, 0.0, 9);
    for (noise_px, within) in [(0.0, 0.01), (0.3, 0.2)] {
        let noisy = two_swings(60, 120, noise_px, 9);
        let seen = tracks(60, 120, |track, frame| is_seen(track, frame).then(|| noisy(track, frame)));
        let table = table(&seen);
        assert!(table.n_filled() > 1000);
        let mut filled = Positions::new(60, 120);
        for track in 0..60 {
            for frame in 0..120 {
                let [x, y] = [track, 60 + track].map(|row| table.series()[row * 120 + frame]);
                let [mx, my] = table.place(track).unwrap();
                if !is_seen(track, frame) {
                    filled.set(track, frame, [(mx + x) as f32, (my + y) as f32]);
                }
            }
        }
        let off = rms(&filled, &clean);
        assert!(off < within, "{noise_px} px of noise: gaps are {off} px off");
        let (smooth, _) = denoised(&seen, 0, &mut |_| true).unwrap();
        assert!((0..60).all(|track| (0..120).all(|t| smooth.get(track, t).is_some() == is_seen(track, t))));
    }
}

#[test]
fn frames_in_which_one_track_is_alone_are_left_out() {
    let at = two_swings(4, 30, 0.0, 2);
    let alone = |track: usize, frame: usize| frame < 20 || (track == 2 && frame != 25);
    let positions = tracks(4, 30, |track, frame| alone(track, frame).then(|| at(track, frame)));
    assert_eq!(table(&positions).frames(), (0..20).collect::<Vec<_>>());
    let (smooth, _) = denoised(&positions, 0, &mut |_| true).unwrap();
    assert_eq!(smooth.get(2, 22), positions.get(2, 22), "it stays as it is");
    assert_eq!(smooth.get(2, 25), None);
}

#[test]
fn what_cannot_be_decomposed_is_refused_by_name_and_what_stands_still_has_no_components() {
    let still = |track: usize, _| Some([track as f64 + 0.1, 0.3]);
    let refusals = [
        (tracks(0, 9, still), "grouping needs at least 2 tracks, came 0"),
        (tracks(1, 9, still), "grouping needs at least 2 tracks, came 1"),
        (tracks(3, 1, still), "movement needs at least 2 frames, came 1"),
        (tracks(3, 9, |track, frame| (frame / 3 == track).then_some([1.0, 2.0])), "no two tracks are seen"),
        (tracks(3, 9, |_, _| Some([f64::NAN, 2.0])), "no two tracks are seen"),
    ];
    for (positions, wanted) in refusals {
        let error = Table::new(&positions, &mut |_| true).unwrap_err().to_string();
        assert!(error.starts_with(wanted), "{error}");
    }
    let stopped = Table::new(&tracks(3, 9, still), &mut |_| false);
    assert_eq!(stopped, Err(MotionError::Stopped));
    let bod = Bod::new(&table(&tracks(5, 40, still)));
    assert!(bod.is_empty() && bod.n_above() == 0 && bod.singular.iter().all(|s| *s == 0.0));
    let positions = tracks(5, 40, still);
    assert_eq!(denoised(&positions, 0, &mut |_| true).unwrap(), (positions, 0));
    // The same for all: one component. Two frames: one at most.
    let swing = |_, frame: usize| Some([(0.3 * frame as f64).sin(), 0.0]);
    assert_eq!(Bod::new(&table(&tracks(6, 50, swing))).len(), 1);
    let at = two_swings(5, 2, 0.0, 3);
    assert_eq!(Bod::new(&table(&tracks(5, 2, |track, frame| Some(at(track, frame))))).len(), 1);
}

/// Geometric over arithmetic mean: 1 of white noise.
fn flatness(power: &[f64]) -> f64 {
    let n = power.len() as f64;
    (power.iter().map(|p| p.ln()).sum::<f64>() / n).exp() / (power.iter().sum::<f64>() / n)
}

const LEAVES: usize = 80;
const CLIP: usize = 256;

/// Two swings of all leaves, little noise, and what is added to them, along an axis.
fn leaves(more: impl Fn(usize, usize, usize) -> f64) -> Table {
    let at = two_swings(LEAVES, CLIP, 0.1, 4);
    table(&tracks(LEAVES, CLIP, |track, frame| {
        let [x, y] = at(track, frame);
        Some([x + more(track, frame, 0), y + more(track, frame, 1)])
    }))
}

/// Every leaf at frequencies of its own, 30 to 60 cycles of the clip.
fn flutter(track: usize, frame: usize, axis: usize) -> f64 {
    let wave = |k: usize| {
        let cycles = 30.0 + ((track * 7 + (k + 2 * axis) * 11) % 31) as f64;
        let phase = (track * (3 + k) + 5 * axis) as f64;
        (std::f64::consts::TAU * cycles * frame as f64 / CLIP as f64 + phase).sin()
    };
    wave(0) + wave(1)
}

#[test]
fn flutter_is_what_is_left_and_whitening_makes_it_flat() {
    let table = leaves(flutter);
    let left = residual(&table, &Bod::new(&table)).unwrap();
    let mean =
        |range: std::ops::Range<usize>| left.power[range.clone()].iter().sum::<f64>() / range.len() as f64;
    assert!(mean(30..60) > 20.0 * mean(80..120), "{} {}", mean(30..60), mean(80..120));
    let white = whitened(&table, &left);
    let after = residual(&white, &Bod::new(&white)).unwrap();
    let [left, after] = [left, after].map(|residual| flatness(&residual.power[1..]));
    assert!(left < 0.5 && after > 0.8, "{left} {after}");
    let few = self::table(&tracks(15, CLIP, {
        let at = two_swings(15, CLIP, 0.3, 4);
        move |track, frame| Some(at(track, frame))
    }));
    assert_eq!(residual(&few, &Bod::new(&few)), None);
}

/// A wave of whole cycles in each of two runs, which jumps in phase from one to the other, loses the root of the power at its
/// frequency and nothing else; what is left after the strongest is that of the longer run alone. The power is that of what has
/// something of the frame before: what it comes to in fewer frames is known, of n frames n - 1 follow one another.
#[test]
fn over_a_seam_there_are_no_frequencies() {
    let runs = [0..128, 200..264];
    let wave = |track: usize, frame: usize| {
        let jump = if frame >= 200 { 2.0 } else { 0.0 };
        (std::f64::consts::TAU * frame as f64 / 8.0 + jump + track as f64).sin()
    };
    let is_seen = |frame: &usize| runs.iter().any(|run| run.contains(frame));
    let seen: Vec<usize> = (0..264).filter(is_seen).collect();
    let at = |track: usize, frame: usize| is_seen(&frame).then(|| [wave(track, frame), 0.0]);
    let table = table(&tracks(5, 264, at));
    assert_eq!((table.frames(), table.runs()), (&*seen, &[0..128, 128..192][..]));
    let power = (0..=64).map(|k| 10.0 + 6.0 * (std::f64::consts::TAU * f64::from(k) / 128.0).cos()).collect();
    let white = whitened(&table, &Residual { power, share: 0.5, own: None });
    for (track, row) in white.series().chunks(seen.len()).take(5).enumerate() {
        for (value, &frame) in row.iter().zip(&seen) {
            // Transforms there and back are as long as the longer run.
            let followed = if frame < 128 { 1.0 } else { 63.0 / 64.0 };
            let power = 10.0 + 6.0 * followed * 0.5_f64.sqrt();
            let wanted = 128.0 * wave(track, frame) / power.sqrt();
            assert!((value - wanted).abs() < 1e-3, "track {track} frame {frame}: {value}, wanted {wanted}");
        }
    }

    let own = two_swings(LEAVES, CLIP, 0.1, 4);
    let leaf = |track: usize, frame: usize| {
        let [x, y] = own(track, frame);
        let apart = if frame < 150 { 0.0 } else { 30.0 * (track % 7) as f64 };
        [x + flutter(track, frame, 0) + apart, y + flutter(track, frame, 1)]
    };
    let unseen = |frame: usize| (150..170).contains(&frame);
    let table =
        self::table(&tracks(LEAVES, CLIP, |track, frame| (!unseen(frame)).then(|| leaf(track, frame))));
    let bod = Bod::new(&table);
    let left = residual(&table, &bod).unwrap();
    let rest: Vec<Vec<f64>> = table
        .series()
        .chunks(CLIP - 20)
        .zip(bod.sum(15, |_| 1.0).chunks(CLIP - 20))
        .map(|(row, told)| (0..150).map(|k| row[k] - told[k]).collect())
        .collect();
    let [all, rest_2] =
        [table.series().chunks(CLIP - 20).flat_map(|row| &row[..150]).copied().collect(), rest.concat()]
            .map(|values: Vec<f64>| values.iter().map(|v| v * v).sum::<f64>());
    assert!((left.share - rest_2 / all).abs() < 1e-9 && left.power.len() == 76, "{}", left.share);
    // Parseval: power smoothed by Hann's weights has the same sum, but for its ends.
    let sum: f64 = left.power.iter().sum();
    let wanted = rest_2 * 150.0 / 2.0 / (2 * LEAVES) as f64;
    assert!((sum / wanted - 1.0).abs() < 0.05, "{sum} {wanted}");
}

/// Where every third frame is missing runs are of two frames, the last of one. What is left has next to nothing at 0 cycles, and
/// much above: a mean of two frames has much of that, and is divided by what it has.
#[test]
fn runs_of_one_and_two_frames_are_divided_by_what_is_in_so_few() {
    let is_seen = |frame: &usize| *frame < 64 || (*frame > 65 && frame % 3 != 2);
    let seen: Vec<usize> = (0..100).filter(is_seen).collect();
    let drawn = numbers(3 * 100, 9);
    let at = |track: usize, frame: usize| is_seen(&frame).then(|| [5.0 * drawn[100 * track + frame], 0.0]);
    let table = table(&tracks(3, 100, at));
    let short = &table.runs()[1..];
    assert_eq!((table.runs()[0].clone(), short.len()), (0..64, 12));
    assert!(short[..11].iter().all(|run| run.len() == 2) && short[11].len() == 1);
    // Of each less the one before: 2 - 2 cos; of two frames one follows another.
    let power = |k: i32| 2.001 - 2.0 * (std::f64::consts::TAU * f64::from(k) / 64.0).cos();
    let white = whitened(&table, &Residual { power: (0..=32).map(power).collect(), share: 0.5, own: None });
    let rows = table.series().chunks(seen.len()).zip(white.series().chunks(seen.len()));
    for (row, white) in rows.take(3) {
        for run in short {
            let (before, after) = (&row[run.clone()], &white[run.clone()]);
            let wanted = match before {
                [one] => vec![64.0 * one / 2.001_f64.sqrt()],
                [a, b] => {
                    let mean = 64.0 * (a + b) / 2.0 / 1.001_f64.sqrt();
                    let half = 64.0 * (a - b) / 2.0 / 3.001_f64.sqrt();
                    vec![mean + half, mean - half]
                }
                _ => unreachable!(),
            };
            let off = after.iter().zip(&wanted).map(|(got, wanted)| (got - wanted).abs()).fold(0.0, f64::max);
            assert!(off < 1e-9 * 64.0, "{run:?}: {after:?}, wanted {wanted:?}");
        }
    }
}

/// Modes that all leaves share, each at frequencies of its own among those of the flutter, are left as it is and are none.
#[test]
fn what_leaves_share_is_no_flutter_nor_is_white_noise() {
    let amounts = numbers(2 * LEAVES * 31, 12);
    let modes = |n: usize| {
        let amounts = &amounts;
        move |track: usize, frame: usize, axis: usize| -> f64 {
            let mode = |k: usize| {
                let cycles = 30.0 + (k as f64 + 0.37) * 30.0 / n as f64;
                let swing = (std::f64::consts::TAU * cycles * frame as f64 / CLIP as f64 + k as f64).sin();
                0.6 * amounts[2 * (track * 31 + k) + axis] * swing
            };
            (0..n).map(mode).sum()
        }
    };
    let of = |table: &Table| residual(table, &Bod::new(table)).unwrap();
    let chance = numbers(4 * LEAVES * 60, 13);
    let own = of(&leaves(|track, frame, axis| {
        let wave = |k: usize| {
            let angle = std::f64::consts::TAU * ((30 + k) * frame) as f64 / CLIP as f64;
            let amounts = &chance[2 * ((2 * track + axis) * 60 + k)..][..2];
            0.2 * (amounts[0] * angle.sin() + amounts[1] * angle.cos())
        };
        (0..60).map(wave).sum()
    }));
    assert!(own.is_flutter() && own.own.unwrap() > 0.85 && own.own.unwrap() < 1.05, "{own:?}");
    for n in [20, 31] {
        let shared = of(&leaves(modes(n)));
        assert!(shared.share > 0.04 && shared.own.unwrap() < 0.6 && !shared.is_flutter(), "{n}: {shared:?}");
    }
    let noise = numbers(2 * LEAVES * CLIP, 6);
    let white = of(&leaves(|track, frame, axis| noise[2 * (track * CLIP + frame) + axis]));
    assert!(white.own.is_none() && !white.is_flutter() && flatness(&white.power[1..]) > 0.9, "{white:?}");
}

/// What all share at the highest frequency makes its neighbours loud, in which there is noise alone: each track's own.
#[test]
fn what_is_shared_at_the_highest_frequency_is_no_flutter() {
    let amounts = numbers(2 * LEAVES * 14, 12);
    let table = leaves(|track, frame, axis| {
        let amount = |k: usize| amounts[2 * (track * 14 + k) + axis];
        let mode = |k: usize| {
            let cycles = 20.0 + 3.0 * k as f64;
            amount(k) * (std::f64::consts::TAU * cycles * frame as f64 / CLIP as f64).sin()
        };
        // These and the two swings are the 15 strongest.
        let strong: f64 = (0..13).map(mode).sum();
        strong + 0.25 * amount(13) * if frame % 2 == 0 { 1.0 } else { -1.0 }
    });
    let left = residual(&table, &Bod::new(&table)).unwrap();
    assert!(left.power.last() > Some(&(10.0 * left.power[left.power.len() - 10])), "{left:?}");
    assert!(left.own.unwrap() < 0.5, "{:?}", left.own);
}

#[test]
fn of_many_loud_frequencies_the_loudest_are_looked_at() {
    let power: Vec<f64> = (0..1001).map(|k| if k % 3 == 0 { 1.0 + f64::from(k) } else { 0.5 }).collect();
    let loud = whiten::loudest(&power, 2.0);
    let wanted: Vec<usize> = (0..256).map(|k| 999 - 3 * (255 - k)).collect();
    assert_eq!(loud, wanted);
    assert_eq!(whiten::loudest(&power[..10], 2.0), [3, 6, 9]);
}

/// Against the singular values themselves; noise comes to 1, one motion of all to 1 / n.
#[test]
fn how_much_is_each_tracks_own_is_what_the_formula_says() {
    let (n_series, loud) = (400, [2, 3, 5, 6, 9]);
    let n = loud.len() as f64;
    let power: Vec<f64> = (0..10).map(|k| 0.5 + k as f64).collect();
    let chance = numbers(20 * n_series, 21);
    let wave = |series: usize, k: usize| Complex::new(chance[20 * series + k], chance[20 * series + 10 + k]);
    for alone in [1.0, 0.3, 0.0] {
        let of = |series: usize, k: usize| {
            (wave(series, k) * alone + wave(series, 0) * (1.0 - alone)) * power[k].sqrt()
        };
        let waves: Vec<Vec<_>> =
            (0..n_series).map(|series| (0..10).map(|k| of(series, k)).collect()).collect();
        let table = DMatrix::from_fn(loud.len(), n_series, |row, series| {
            waves[series][loud[row]] / power[loud[row]].sqrt()
        });
        let s = table.singular_values();
        let [second, fourth] = [2, 4].map(|k| s.iter().map(|s| s.powi(k)).sum::<f64>());
        let wanted = second * second / (n * fourth) * (1.0 + n / n_series as f64);
        let own = whiten::own(&waves, &power, &loud).unwrap();
        assert!((own - wanted).abs() < 1e-9, "{alone}: {own}, wanted {wanted}");
        // What the covariance of these series, own^2 + common^2 between any two, comes to.
        let (own_2, common_2) = (alone * alone, (1.0 - alone).powi(2));
        let fourth = (n - 1.0) * own_2 * own_2 + (own_2 + n * common_2).powi(2);
        let known = n * (own_2 + common_2).powi(2) / fourth;
        assert!((own - known).abs() < 0.02, "{alone}: {own}, known {known}");
    }
    assert_eq!(whiten::own(&[], &power, &loud[..2]), None);
    let nothing = vec![vec![Complex::new(0.0, 0.0); 10]; 4];
    assert_eq!(whiten::own(&nothing, &power, &loud), None, "it would be 0 / 0");
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let at = two_swings(70, 90, 0.3, 1);
    let positions = tracks(70, 90, |track, frame| is_seen(track, frame).then(|| at(track, frame)));
    let of = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| (Bod::new(&table(&positions)), denoised(&positions, 0, &mut |_| true).unwrap()))
    };
    let one = of(1);
    assert!([2, 3, 5].iter().all(|&n| of(n) == one));
}
