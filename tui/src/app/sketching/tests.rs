//! A simulated hand follows a feature over a simulated link, and what it draws is laid where the feature was.

#![expect(clippy::float_cmp, reason = "small whole numbers, and what must be the very same")]

use super::*;
use crate::app::fixture;
use crate::app::layout::{Layout, Lens};
use crate::app::state::{Mode, State};
use crate::app::update::{Effect, Fact, Msg, update};
use crate::term::input::{Mouse, MouseKind};
use honami_workbench::correct::Step;

/// Where the feature is at a time of the clip, image pixels.
fn feature(t_s: f64) -> [f64; 2] {
    [60.0 + 55.0 * t_s, 70.0 + 30.0 * t_s]
}

/// What leads the point.
#[derive(Clone, Copy, Debug, PartialEq)]
enum By {
    Mouse,
    Keys,
}

/// Draws after the feature from frame 10 on, seen over a link so late (milliseconds), at a rate in percent; returns the
/// state before the sketch is kept.
fn drawn(by: By, rate: u32, late_ms: u64) -> State {
    let mut state = fixture::state();
    let clip_fps = 25.0;
    let tick = Duration::from_millis(5);
    let clock = |state: &mut State, now| drop(update(state, Msg::Clock(now)));
    fixture::press(&mut state, "1 0 . z s");
    let start = feature(10.0 / clip_fps);
    if let Mode::Sketch(sketching) = &mut state.mode {
        sketching.point = start.map(|x| x as f32);
    }
    let lens = Lens::of(&state, Layout::of(&state).picture);
    let mouse = |state: &mut State, kind, at: [f64; 2]| {
        let (x, y) = lens.place_of(at.map(|x| x as f32), (1, 1)).unwrap();
        let (column, row) = (lens.area.x + x as u16, lens.area.y + y as u16);
        update(state, Msg::Mouse(Mouse { kind, column, row }));
        (column, row)
    };
    let mut now = Duration::from_secs(2);
    clock(&mut state, now);
    let mut cell = (0, 0);
    if by == By::Mouse {
        cell = mouse(&mut state, MouseKind::Press(0), start);
    }
    fixture::press(&mut state, &format!("{} ;", rate.to_string().split("").collect::<Vec<_>>().join(" ")));
    let since = now;
    let rate = f64::from(rate) / 100.0;
    let behind = Duration::from_millis(115 + late_ms);
    let mut n = 0;
    while state.frame < 60 {
        now += tick;
        clock(&mut state, now);
        // Every other picture is shown, and now and then one is held up.
        if n % 32 == 0 {
            let stall = if n % 320 == 0 { 700 } else { n % 5 };
            update(&mut state, Msg::Fact(Fact::Late(Duration::from_millis(late_ms + stall))));
        }
        n += 1;
        let seen_s = now.saturating_sub(since + behind).as_secs_f64() * rate;
        let at = feature(10.0 / clip_fps + seen_s);
        if by == By::Mouse {
            let (x, y) = lens.place_of(at.map(|x| x as f32), (1, 1)).unwrap();
            if (lens.area.x + x as u16, lens.area.y + y as u16) != cell {
                cell = mouse(&mut state, MouseKind::Drag(0), at);
            }
        } else {
            for (axis, key) in [(0, "l"), (1, "j")] {
                let Mode::Sketch(sketching) = &state.mode else { panic!("not drawing") };
                if at[axis] > f64::from(sketching.point[axis]) + 0.5 {
                    fixture::press(&mut state, key);
                }
            }
        }
    }
    state
}

#[test]
fn what_a_hand_draws_lies_where_the_feature_was_whatever_the_link() {
    for by in [By::Mouse, By::Keys] {
        for (rate, late_ms) in [(100, 5), (50, 5), (50, 90), (25, 250), (50, 400)] {
            let mut state = drawn(by, rate, late_ms);
            let Mode::Sketch(sketching) = &mut state.mode else { panic!("not drawing") };
            sketching.end(state.now);
            sketching.preview(&state.clip.times);
            let [hand, link] = sketching.late_ms().unwrap();
            assert!(hand == 115 && u64::from(link).abs_diff(late_ms) <= 4, "{link} ms of {late_ms}");
            let ghost = sketching.correction().unwrap();
            let shift_frames = 25.0 * (0.115 + late_ms as f64 / 1e3) * f64::from(rate) / 100.0;
            let last = 60 - shift_frames.ceil() as u32;
            assert!(
                ghost.affected.start == 11 && ghost.affected.end.abs_diff(last) <= 1,
                "{:?}",
                ghost.affected
            );
            // Frame 10 is a key-frame. Frames that the hand is early or late, by the way that the feature goes in one.
            let mut off: Vec<f64> = (10..last - 1)
                .filter_map(|frame| {
                    let sample = ghost.span.get(frame).filter(|s| s.source == Source::Sketch)?;
                    let wanted = feature(f64::from(frame) / 25.0);
                    Some((f64::from(sample.x) - wanted[0]) / (55.0 / 25.0))
                })
                .collect();
            off.sort_by(f64::total_cmp);
            let (median, worst) = (off[off.len() / 2], off[off.len() - 1].max(-off[0]));
            assert!(
                median.abs() <= 0.25 && worst <= 1.0,
                "{by:?} {rate} % {late_ms} ms: {median:.2}, {worst:.2}"
            );
        }
    }
}

#[test]
fn the_hand_is_followed_to_the_clips_end() {
    let mut state = fixture::state();
    fixture::press(&mut state, "9 0 . s");
    update(&mut state, Msg::Clock(Duration::from_secs(1)));
    fixture::press(&mut state, "; l");
    update(&mut state, Msg::Clock(Duration::from_secs(2)));
    assert_eq!((state.frame, state.play), (99, None));
    let Mode::Sketch(sketching) = &state.mode else { panic!("not drawing") };
    assert!(sketching.is_open(), "the hand is still on its way");
    fixture::press(&mut state, "l");
    let effects = fixture::press(&mut state, "Enter");
    let [Effect::Correct(Step::Sketch { strokes, .. }, _)] = &effects[..] else { panic!("{effects:?}") };
    assert_eq!(strokes[0].drawn.len(), 4, "where it began, two steps, and the end");
    assert_eq!(state.frame, 99);
}

#[test]
fn coordinates_that_have_not_changed_are_on_their_way() {
    let point = |elapsed_s: f64, x: f64, y: f64| Drawn { elapsed_s, at: [x, y] };
    let mut drawn = [
        point(0.0, 0.0, 0.0),
        point(1.0, 0.0, 4.0),
        point(2.0, 4.0, 4.0),
        point(3.0, 4.0, 8.0),
        point(4.0, 4.0, 8.0),
    ];
    straighten(&mut drawn);
    assert_eq!(drawn.map(|d| d.at[0]), [0.0, 2.0, 4.0, 4.0, 4.0]);
    assert_eq!(drawn.map(|d| d.at[1]), [0.0, 4.0, 6.0, 8.0, 8.0]);
    straighten(&mut []);
}
