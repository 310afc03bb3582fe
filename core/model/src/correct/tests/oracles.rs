//! Formulas against what they were not derived from: the printed spline, quadratics, sigmoids by hand.

use super::*;
use crate::curve::{Knot, Segment};

/// The correction as the thesis prints it: the curve plus the difference of two virtual splines.
#[test]
fn space_is_the_displacement_of_the_virtual_spline() {
    let path = |t_s: f64| [50.0 + 20.0 * (9.0 * t_s).sin(), 40.0 + 30.0 * t_s];
    let given = Given::run(path);
    let at = |frame: u32| given.runs[0].1.samples[frame as usize];
    let given = given.clone().keyed(&[3, 20].map(|frame| (frame, at(frame).x, at(frame).y)));
    let (frame, to) = (9, [at(9).x + 6.0, at(9).y - 2.0]);
    let corrected = space(&given.shown(), frame, to).unwrap();
    let knot = |frame: u32, at: [f64; 2]| Knot { t_s: given.times.get(frame).unwrap(), at };
    let speed = |frame: u32| {
        [0, 1].map(|axis| {
            let (a, b) = (position(&at(frame - 1)), position(&at(frame + 1)));
            (b[axis] - a[axis]) / 0.08
        })
    };
    let spline = |from: Knot, to: Knot, ends: (u32, u32)| Segment {
        from,
        from_speed: speed(ends.0),
        to,
        to_speed: speed(ends.1),
    };
    for k in 3..=20 {
        let ends = if k < frame { (3, frame) } else { (frame, 20) };
        let place = |end: u32, moved: bool| {
            knot(end, if moved && end == frame { to.map(f64::from) } else { position(&at(end)) })
        };
        let s = spline(place(ends.0, false), place(ends.1, false), ends).at(given.times.get(k).unwrap());
        let s_star = spline(place(ends.0, true), place(ends.1, true), ends).at(given.times.get(k).unwrap());
        let got = position(corrected.span.get(k).unwrap());
        for axis in [0, 1] {
            let want = position(&at(k))[axis] + s_star[axis] - s[axis];
            assert!((got[axis] - want).abs() < 1e-4, "frame {k}: {} and not {want}", got[axis]);
        }
    }
    assert_eq!(corrected.affected, 4..20, "up to the key-frames and no further");
    assert!((corrected.largest_px - 40.0_f32.sqrt()).abs() < 1e-4);
}

#[test]
fn space_without_key_frames_starts_at_the_first_sample_and_holds_to_the_last() {
    let corrected = space(&Given::run(|_| [10.0, 10.0]).shown(), 10, [14.0, 10.0]).unwrap();
    let x: Vec<f32> = corrected.span.samples.iter().map(|sample| sample.x).collect();
    assert_eq!((x[0], x[5], x[10]), (10.0, 12.0, 14.0), "h01 is a half in the middle");
    assert_eq!(x[10..], [14.0; 14]);
    assert_eq!(corrected.affected, 1..N_FRAMES);
}

#[test]
fn space_keeps_status_source_and_run_and_leaves_the_lost() {
    let mut given = Given::run(|_| [10.0, 10.0]).unseen(15..N_FRAMES);
    given.runs[0].1.samples[12].status = Status::Occluded;
    let corrected = space(&given.shown(), 10, [14.0, 10.0]).unwrap();
    let at = |frame: u32| corrected.span.get(frame).unwrap();
    assert_eq!((at(12).status, at(12).source, at(12).x), (Status::Occluded, Source::Tracked, 14.0));
    assert_eq!(at(12).quality, Quality::default(), "it was measured elsewhere");
    assert_eq!((at(15).status, at(15).x), (Status::Lost, 10.0));
    assert!(!corrected.track.over.contains_key(&15), "a later key-frame is joined by a curve again");
    let Some(Over::Sample(laid)) = corrected.track.over.get(&12) else { panic!("not laid") };
    assert_eq!(laid.run, Some(RunId(1)));
}

#[test]
fn hermite_is_exact_for_quadratics_also_where_a_tracker_saw_something_else() {
    let path = |t_s: f64| [5.0 + 40.0 * t_s - 30.0 * t_s * t_s, 80.0 * t_s * t_s];
    let on = |frame: u32| {
        let [x, y] = path(f64::from(frame) / 25.0);
        (frame, x as f32, y as f32)
    };
    let given = Given::run(|_| [70.0, 70.0]).keyed(&[0, 4, 9, 20, 23].map(on));
    let (frame, x, y) = on(14);
    let corrected = hermite(&given.shown(), frame, [x, y]).unwrap();
    for k in 9..=20 {
        let (got, want) = (position(corrected.span.get(k).unwrap()), path(f64::from(k) / 25.0));
        assert!((got[0] - want[0]).hypot(got[1] - want[1]) < 1e-4, "frame {k}: {got:?}, not {want:?}");
    }
    assert_eq!(corrected.affected, 10..20, "beside them a tracker has seen the feature");
}

#[test]
fn hermite_redraws_the_next_segments_where_they_are_interpolated() {
    let given =
        Given::run(|_| [50.0, 50.0]).keyed(&[(2, 0.0, 0.0), (8, 6.0, 0.0), (14, 12.0, 0.0), (20, 18.0, 0.0)]);
    let first = hermite(&given.shown(), 8, [6.0, 0.0]).unwrap();
    assert_eq!(first.affected, 3..14);
    let given = Given { track: first.track, ..given };
    let second = hermite(&given.shown(), 14, [12.0, 6.0]).unwrap();
    assert_eq!(second.affected, 3..20, "the speed at 8 is another, and the curve before it with it");
    let straight = linear(&given.shown(), 14, [12.0, 6.0]).unwrap();
    let y: Vec<f32> = (8..=14).map(|frame| straight.span.get(frame).unwrap().y).collect();
    assert_eq!(y, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(straight.affected, 9..20, "lines do not bend their neighbours");
}

#[test]
fn hermite_leaves_to_the_composition_what_no_run_has_seen() {
    let given = Given::run(|_| [50.0, 50.0]).unseen(0..12).keyed(&[(2, 0.0, 0.0), (20, 18.0, 0.0)]);
    let corrected = hermite(&given.shown(), 11, [9.0, 4.0]).unwrap();
    let laid: Vec<u32> = corrected.track.over.keys().copied().collect();
    assert_eq!(laid, (12..20).collect::<Vec<_>>(), "before, the live curve goes through the key-frames");
    assert!((3..20).all(|k| corrected.span.get(k).unwrap().x < 20.0));
}

#[test]
fn sigmoids_sum_to_one_and_end_on_the_key_frames() {
    // By hand: s(x) = 1/(1+e^-x), rising(tau) = (s(10 tau - 5) - s(-5)) / (s(5) - s(-5)).
    for (tau, want) in [(0.0, 0.0), (0.25, 0.070_104), (0.5, 0.5), (0.75, 0.929_896), (1.0, 1.0)] {
        assert!(
            (super::super::blend::rising(tau) - want).abs() < 1e-6,
            "{tau}: {}",
            super::super::blend::rising(tau)
        );
    }
    let at_x = |x: f64| Span {
        first_frame: 0,
        samples: vec![sample([x, 0.0], Status::Tracked, Source::Tracked); 24],
    };
    let times = FrameTimes::constant(24, 25.0).unwrap();
    let blended = blended(&at_x(10.0), &at_x(20.0), [(2, [10.0, 0.0]), (22, [20.0, 0.0])], &times);
    let x: Vec<f32> = blended.iter().map(|at| at.sample.x).collect();
    assert_eq!((blended[0].frame, x.len(), x[9]), (3, 19, 15.0));
    assert!(x[0] > 10.0 && x[18] < 20.0 && x.windows(2).all(|pair| pair[0] < pair[1]));
    assert!((x[4] - 10.701_04).abs() < 1e-4, "{}", x[4]);
    for k in 0..=9 {
        assert!((x[k] + x[18 - k] - 30.0).abs() < 1e-5, "the weights sum to one");
    }
    assert_eq!((blended[0].side, blended[18].side), (Some(Side::Forward), Some(Side::Backward)));
}

/// f followed, - lost: forwards and backwards, and what the blend makes of them (a ahead, b back, m both, i bridged).
#[test]
fn a_blend_follows_the_one_that_has_not_lost_it() {
    let found = |letters: &str, x: f64| {
        let status = |letter| if letter == 'f' { Status::Tracked } else { Status::Lost };
        let samples =
            letters.chars().map(|letter| sample([x, 0.0], status(letter), Source::Tracked)).collect();
        Span { first_frame: 1, samples }
    };
    let times = FrameTimes::constant(11, 25.0).unwrap();
    let keys = [(0, [10.0, 0.0]), (10, [20.0, 0.0])];
    for (ahead, back, want) in [
        ("fffffffff", "fffffffff", "mmmmmmmmm"),
        ("fffffffff", "----fffff", "aaaaammmm"),
        ("fffff----", "---------", "aaaaaiiii"),
        ("fff------", "------fff", "aaaiiibbb"),
        ("fffff----", "fffffffff", "mmmmbbbbb"),
        ("---------", "---------", "iiiiiiiii"),
        ("ffffff---", "---ffffff", "aaaambbbb"),
    ] {
        let blended = blended(&found(ahead, 10.0), &found(back, 20.0), keys, &times);
        let letter = |sample: &Sample| match (sample.source, sample.x) {
            (Source::Interpolated, _) => 'i',
            (_, 10.0) => 'a',
            (_, 20.0) => 'b',
            _ => 'm',
        };
        let letters: String = blended.iter().map(|at| letter(&at.sample)).collect();
        let x: Vec<f32> = blended.iter().map(|at| at.sample.x).collect();
        assert!(x.windows(2).all(|pair| pair[0] <= pair[1]), "{ahead} {back}: {x:?}");
        assert_eq!(letters, want, "{ahead} {back}");
    }
}
