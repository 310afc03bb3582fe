//! Frames of the clock, for even and uneven times.

use super::*;
use proptest::prelude::*;

fn play(rate: f64, from: u32, around: Option<u32>) -> Play {
    Play { rate, since: Duration::from_secs(3), from, around }
}

/// The frames that ticks bring, from the first on.
fn ticked(play: &Play, times_s: &[f64], n: usize) -> Vec<u32> {
    let mut now = play.since;
    let mut frames = vec![play.frame(times_s, now)];
    for _ in 0..n {
        match play.next(times_s, now) {
            Some(next) => now = next,
            None => break,
        }
        frames.push(play.frame(times_s, now));
    }
    frames
}

const UNEVEN: [f64; 6] = [0.5, 0.54, 0.70, 0.71, 1.5, 1.6];

#[test]
fn uneven_frames_last_as_long_as_they_do() {
    // Milliseconds since the start, forward from 0, backward from 5, and there and back within 1..=3 round 2.
    for (ms, forward, backward, looped) in [
        (0, 0, 5, 2),
        (9, 0, 5, 2),
        (11, 0, 5, 3),
        (19, 0, 5, 3),
        (21, 0, 5, 2),
        (41, 1, 5, 2),
        (99, 1, 5, 2),
        (101, 1, 4, 2),
        (179, 1, 4, 2),
        (181, 1, 4, 1),
        (201, 2, 4, 1),
        (339, 3, 4, 1),
        (341, 3, 4, 2),
        (899, 3, 3, 1),
        (901, 3, 2, 1),
        (1_101, 5, 0, 2),
        (90_000, 5, 0, 1),
    ] {
        let at = |p: Play| p.frame(&UNEVEN, p.since + Duration::from_millis(ms));
        let seen = [play(1.0, 0, None), play(-1.0, 5, None), play(1.0, 2, Some(1))].map(at);
        assert_eq!(seen, [forward, backward, looped], "after {ms} ms");
    }
}

#[test]
fn a_frame_is_due_when_the_clock_comes_to_it() {
    for (play, frame, ms) in [
        (play(1.0, 0, None), 4, 1000),
        (play(0.5, 1, None), 2, 320),
        (play(-0.5, 5, None), 4, 200),
        (play(1.0, 3, None), 2, 0),
    ] {
        assert_eq!(play.due(&UNEVEN, frame), Some(play.since + Duration::from_millis(ms)));
    }
    assert_eq!(play(1.0, 0, Some(2)).due(&UNEVEN, 1), None, "in a loop it is due again and again");
    assert_eq!(play(1.0, 0, None).due(&UNEVEN, 6), None);
}

#[test]
fn a_loop_goes_there_and_back() {
    let even: Vec<f64> = (0..20).map(|k| f64::from(k) / 25.0).collect();
    assert_eq!(ticked(&play(1.0, 10, Some(2)), &even, 9), [10, 11, 12, 11, 10, 9, 8, 9, 10, 11]);
    assert_eq!(ticked(&play(-0.5, 10, Some(2)), &even, 9), [10, 9, 8, 9, 10, 11, 12, 11, 10, 9]);
    assert_eq!(ticked(&play(1.0, 0, Some(2)), &even, 5), [0, 1, 2, 1, 0, 1]);
    assert_eq!(ticked(&play(1.0, 19, Some(1)), &even, 3), [19, 18, 19, 18]);
    assert_eq!(ticked(&play(1.0, 7, Some(0)), &even, 5), [7]);
    assert_eq!(ticked(&play(1.0, 0, Some(8)), &[0.0], 5), [0]);
}

#[test]
fn rates_in_words() {
    for (percent, words) in [(100, ""), (50, "½x"), (25, "¼x"), (200, "2x"), (33, "33 %"), (150, "150 %")] {
        assert_eq!(rate_words(percent), words);
    }
}

fn times() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(0.001..0.3_f64, 0..30).prop_map(|steps| {
        let mut t = 0.25;
        std::iter::once(t)
            .chain(steps.into_iter().map(move |step| {
                t += step;
                t
            }))
            .collect()
    })
}

proptest! {
    #[test]
    fn a_loop_never_leaves_its_frames(
        times in times(), from in 0_u32..30, around in 0_u32..12, rate in -8.0..8.0_f64, ms in 0_u64..100_000,
    ) {
        let from = from.min(times.len() as u32 - 1);
        let play = play(rate, from, Some(around));
        let frame = play.frame(&times, play.since + Duration::from_millis(ms));
        prop_assert!(frame.abs_diff(from) <= around && (frame as usize) < times.len());
        prop_assert!(play.loop_frames(times.len() as u32).unwrap().contains(&frame));
        prop_assert_eq!(play.frame(&times, play.since), from);
    }

    #[test]
    fn every_tick_brings_the_neighbour(
        times in times(), from in 0_u32..30, around in prop::option::of(0_u32..12),
        rate in prop_oneof![0.01..8.0_f64, -8.0..-0.01_f64],
    ) {
        let from = from.min(times.len() as u32 - 1);
        let play = play(rate, from, around);
        let frames = ticked(&play, &times, 60);
        for pair in frames.windows(2) {
            prop_assert_eq!(pair[0].abs_diff(pair[1]), 1, "{:?}", frames);
        }
    }

    #[test]
    fn what_is_due_is_what_ticks_bring(
        times in times(), from in 0_u32..30, around in prop::option::of(0_u32..6), rate in -4.0..4.0_f64, n in 1_usize..60,
    ) {
        let from = from.min(times.len() as u32 - 1);
        let play = play(if rate.abs() < 0.01 { 1.0 } else { rate }, from, around);
        let (mut now, mut n_ticks) = (play.since, 0);
        for _ in 0..n {
            let Some(next) = play.next(&times, now) else { break };
            (now, n_ticks) = (next, n_ticks + 1);
        }
        prop_assert_eq!(play.n_due(&times, now), n_ticks);
    }
}
