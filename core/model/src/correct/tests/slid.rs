//! Correction in time, and sketching: samples slide along the curve, strokes are shifted by the delays.

use super::*;

proptest! {
    /// On a curve that runs along x = t, positions tell the time map: it keeps its order and its bounds.
    #[test]
    fn time_never_turns_round(
        frame in 0..N_FRAMES, shift_s in -3.0_f64..3.0, keys in prop::collection::btree_set(0..N_FRAMES, 0..4),
    ) {
        let given = Given::run(|t_s| [t_s, 0.0]);
        let keys: Vec<_> = keys.into_iter().map(|at| (at, given.times.get(at).unwrap() as f32, 0.0)).collect();
        let given = given.keyed(&keys);
        let slid = time(&given.shown(), frame, shift_s).unwrap();
        let t: Vec<f32> = slid.correction.span.samples.iter().map(|sample| sample.x).collect();
        prop_assert!(t.windows(2).all(|pair| pair[0] < pair[1]), "{:?}", t);
        prop_assert!(slid.shift_s.abs() <= shift_s.abs() && slid.shift_s * shift_s >= 0.0);
        let moved = f64::from(t[frame as usize]) - given.times.get(frame).unwrap();
        prop_assert!((moved - slid.shift_s).abs() < 1e-5);
        prop_assert!(slid.correction.span.samples.iter().all(|sample| sample.y == 0.0 && (0.0..=0.92).contains(&sample.x)));
    }

    /// No sample leaves the curve, and nothing outside the bounds changes, live interpolation included.
    #[test]
    fn time_stays_within_its_key_frames(given in any_given(), frame in 0..N_FRAMES, shift_s in -0.2_f64..0.2) {
        let shown = given.shown();
        let Ok(slid) = time(&shown, frame, shift_s) else { return Ok(()) };
        let (before, after) = shown.keys_around(frame);
        let inside = before.map_or(0, |before| before + 1)..after.unwrap_or(N_FRAMES);
        for at in (0..N_FRAMES).filter(|at| !inside.contains(at)) {
            prop_assert_eq!(shown.span().get(at), slid.correction.span.get(at), "frame {}", at);
        }
    }
}

#[test]
fn the_shift_is_linear_between_the_key_frames() {
    let at = |frame: u32| (frame, f32::from(u8::try_from(frame).unwrap()) * 4.0, 0.0);
    let given = Given::run(|t_s| [100.0 * t_s, 0.0]).keyed(&[at(4), at(16)]);
    let slid = time(&given.shown(), 8, 0.08).unwrap();
    let frames: Vec<f32> = (4..=16).map(|k| slid.correction.span.get(k).unwrap().x / 4.0).collect();
    let want = [4.0, 5.5, 7.0, 8.5, 10.0, 10.75, 11.5, 12.25, 13.0, 13.75, 14.5, 15.25, 16.0];
    assert!(frames.iter().zip(want).all(|(a, b): (&f32, f32)| (a - b).abs() < 1e-4), "{frames:?}");
    let cut = time(&given.shown(), 8, 1.0).unwrap();
    assert!((cut.shift_s - 0.95 * 8.0 / 25.0).abs() < 1e-9, "{}", cut.shift_s);
    assert!((time(&given.shown(), 8, f64::NAN).unwrap().shift_s).abs() < 1e-12);
}

#[test]
fn a_shift_of_a_whole_frame_takes_the_samples_themselves() {
    let given = Given::run(|t_s| [50.0 + 9.0 * (40.0 * t_s).sin(), 20.0 * t_s]);
    let slid = time(&given.shown(), 12, 0.04).unwrap();
    let (was, is) = (given.runs[0].1.samples[13], slid.correction.span.get(12).unwrap());
    assert!((was.x - is.x).abs() < 1e-4 && (was.y - is.y).abs() < 1e-4, "{was:?} {is:?}");
}

#[test]
fn a_stroke_is_shifted_by_hand_and_link() {
    // E10: the hand's 115 ms are 57.5 ms of the clip at half speed; the link's 80 ms are 40.
    for (rate, link_s, want_s) in
        [(1.0, 0.0, 0.115), (0.5, 0.0, 0.0575), (0.5, 0.08, 0.0975), (-0.5, 0.0, -0.0575)]
    {
        let played = Played::under_hand(0.0, rate, link_s);
        assert!((played.shift_s() - want_s).abs() < 1e-12);
    }
    // The pointer moves 100 px a second of the clip, late by the delays: laid down where the feature was.
    let given = Given::run(|_| [0.0, 0.0]).keyed(&[(10, 7.0, 7.0)]);
    let played = Played::under_hand(0.2, 0.5, 0.08);
    let drawn: Vec<Drawn> = (0..=10)
        .map(|k| Drawn { elapsed_s: 0.195 + 0.1 * f64::from(k), at: [20.0 + 5.0 * f64::from(k), 0.0] })
        .collect();
    let sketched = sketch(&given.shown(), &[Stroke { played, drawn: drawn.clone() }]).unwrap();
    assert_eq!(sketched.affected, 5..18, "0.2 s to 0.7 s of the clip");
    for frame in (5..18).filter(|frame| *frame != 10) {
        let sample = sketched.span.get(frame).unwrap();
        assert!((sample.x - 4.0 * frame as f32).abs() < 1e-3, "frame {frame}: {}", sample.x);
        assert_eq!((sample.source, sample.status), (Source::Sketch, Status::Tracked));
    }
    assert_eq!(sketched.span.get(10), given.shown().span().get(10), "a key-frame stands");
    let backwards = Played { rate: -0.5, from_s: 0.7, ..played };
    let stroke = Stroke { played: backwards, drawn };
    assert_eq!(sketch(&given.shown(), &[stroke]).unwrap().affected, 5..18);
}

#[test]
fn what_nobody_can_have_seen_is_not_drawn() {
    // The hand waits where the feature is until the first picture moves, and goes on until the clip has stood for its
    // delay: nothing before the frame from which it played is covered.
    let given = Given::run(|_| [0.0, 0.0]);
    let point = |elapsed_s: f64, x: f64| Drawn { elapsed_s, at: [x, 0.0] };
    for (from_s, rate, affected) in [(0.2, 0.5, 5..8), (0.2, -0.5, 3..6)] {
        let played = Played { from_s, rate, delay_s: 0.2 };
        // The shift is 0.1 s: what is drawn until 0.2 s of the wall's clock is the hand at rest.
        let drawn = vec![point(0.0, 50.0), point(0.2, 50.0), point(0.36, 66.0)];
        let sketched = sketch(&given.shown(), &[Stroke { played, drawn }]).unwrap();
        assert_eq!(sketched.affected, affected, "at {rate}");
        for frame in affected {
            let wanted = 50.0 + 8.0 * f64::from(frame.abs_diff(5));
            let x = sketched.span.get(frame).unwrap().x;
            assert!((f64::from(x) - wanted).abs() < 1e-3, "frame {frame} at {rate}: {x}, not {wanted}");
        }
    }
}

#[test]
fn strokes_do_not_run_into_each_other_and_the_last_one_counts() {
    let given = Given::run(|_| [0.0, 0.0]);
    let step = |frame: u32, x: f64| Drawn { elapsed_s: f64::from(frame) / 25.0, at: [x, 1.0] };
    let stroke = |drawn: &[Drawn]| Stroke { played: Played::STEPWISE, drawn: drawn.to_vec() };
    let strokes = [
        stroke(&[step(2, 10.0), step(4, 20.0), step(5, 30.0)]),
        stroke(&[step(9, 7.0)]),
        stroke(&[step(4, 8.0)]),
    ];
    let sketched = sketch(&given.shown(), &strokes).unwrap();
    let x: Vec<f32> = (1..=10).map(|frame| sketched.span.get(frame).unwrap().x).collect();
    assert_eq!(x, [0.0, 10.0, 15.0, 8.0, 30.0, 0.0, 0.0, 0.0, 7.0, 0.0]);
    let text = serde_json::to_string(&strokes[1]).unwrap();
    assert_eq!(text, r#"{"from_s":0.0,"rate":1.0,"delay_s":0.0,"drawn":[[0.36,7.0,1.0]]}"#);
    assert_eq!(serde_json::from_str::<Stroke>(&text).unwrap(), strokes[1]);
}
