//! Scale bars by keys and by mouse: both ends, a length, what they say, and what is kept.

use super::*;
use crate::app::fixture::{self, msg, press};
use crate::app::layout::Lens;
use crate::app::scaling::{End, Scaling};

/// What is set, in a line.
pub(super) fn told(scaling: &Scaling) -> String {
    let [x, y] = scaling.at;
    let Scaling { ends, typed, bar, .. } = scaling;
    let kept = bar.as_ref().map_or_else(String::new, |bar| format!(" makes {} m", bar.length_m));
    format!("scale at {x} {y} ends {} typed {typed:?}{kept}", ends.len())
}

fn line(state: &State) -> String {
    match &state.mode {
        Mode::Scale(scaling) => told(scaling),
        mode => format!("{:?}", mode.context()),
    }
}

/// What went wrong last.
fn wrong(state: &State) -> Option<&str> {
    state.notice.as_ref().filter(|notice| notice.is_error).map(|notice| notice.text.as_str())
}

/// Types a text, whatever keys its letters are elsewhere.
fn type_in(state: &mut State, text: &str) {
    update(state, Msg::Paste(text.to_owned()));
}

#[test]
fn keys_alone_set_a_bar_and_keep_it() {
    for (keys, expect) in [
        ("e b", "scale at 160 120 ends 0 typed \"\""),
        ("e b 4 0 h", "scale at 120 120 ends 0 typed \"\""),
        ("e b 4 0 h Enter", "scale at 120 120 ends 1 typed \"\""),
        ("e b 4 0 h Enter 8 0 l 2 L", "scale at 200.5 120 ends 1 typed \"\""),
        ("e b 4 0 h Enter 8 0 l Enter", "scale at 200 120 ends 2 typed \"\""),
        ("e b 4 0 h Enter 8 0 l Enter 2 0 0 m m", "scale at 200 120 ends 2 typed \"200mm\""),
        (
            "e b 4 0 h Enter 8 0 l Enter 2 0 0 m m Enter",
            "scale at 200 120 ends 2 typed \"200mm\" makes 0.2 m",
        ),
        ("e b 9 9 9 h 9 9 9 k", "scale at 0 0 ends 0 typed \"\""),
        // A mistake is taken back, the last one first.
        ("e b Enter 8 0 l Enter 2 m Enter Backspace", "scale at 240 120 ends 2 typed \"2m\""),
        ("e b Enter 8 0 l Enter 2 m Enter Backspace Backspace", "scale at 240 120 ends 2 typed \"2\""),
        ("e b Enter 8 0 l Enter 2 m Ctrl-u", "scale at 240 120 ends 2 typed \"\""),
        ("e b Enter 8 0 l Enter Backspace", "scale at 240 120 ends 1 typed \"\""),
        ("e b Enter 8 0 l Enter Backspace Backspace", "scale at 240 120 ends 0 typed \"\""),
        // When both ends are set nothing moves them.
        ("e b Enter 8 0 l Enter 2 m Enter l", "scale at 240 120 ends 2 typed \"2m\" makes 2 m"),
    ] {
        let mut state = fixture::state();
        assert_eq!(press(&mut state, keys), [], "{keys}");
        assert_eq!(line(&state), expect, "{keys}");
        assert_eq!(wrong(&state), None, "{keys}");
    }
    let mut state = fixture::state();
    state.frame = 20;
    press(&mut state, "e b 4 0 h Enter 8 0 l Enter 2 0 0 m m Enter");
    let effects = press(&mut state, "Enter");
    let [Effect::Scale(Some(bar), UNDO)] = effects[..] else { panic!("{effects:?}") };
    assert_eq!((bar.frame, bar.ends, bar.length_m), (20, [[120.0, 120.0], [200.0, 120.0]], 0.2));
    assert!(matches!(state.mode, Mode::Review));
    // The project refuses it: nothing that was set is lost.
    update(&mut state, Msg::Fact(Fact::Refused));
    assert_eq!(line(&state), "scale at 200 120 ends 2 typed \"200mm\" makes 0.2 m");
}

#[test]
fn clicks_set_ends() {
    let mut state = fixture::state();
    let lens = Lens::shown(&state);
    press(&mut state, "e b");
    for (word, n_ends) in [("press:20,10", 1), ("drag:30,10", 1), ("release:30,10", 1), ("press:60,14", 2)] {
        assert_eq!(update(&mut state, msg(word)), []);
        let Mode::Scale(scaling) = &state.mode else { panic!("{word}: {:?}", state.mode) };
        assert_eq!(scaling.ends.len(), n_ends, "{word}");
    }
    type_in(&mut state, "0.5m");
    press(&mut state, "Enter");
    let Mode::Scale(scaling) = &state.mode else { panic!("{:?}", state.mode) };
    let bar = scaling.bar.expect("a bar");
    let seen = [(20, 10), (60, 14)].map(|(column, row)| lens.point_of(column, row).expect("in the picture"));
    assert_eq!(bar.ends, seen.map(|at| at.map(f64::from)));
    // The next click belongs to no end, nor does one on the time line, beside the picture, or while typing.
    update(&mut state, msg("press:30,12"));
    assert_eq!(state.notice.as_ref().map(|notice| notice.is_error), Some(false));
    press(&mut state, "Backspace");
    let before = line(&state);
    for word in ["press:30,12", "press:0,10", "press:30,22"] {
        update(&mut state, msg(word));
        assert_eq!((line(&state), state.frame), (before.clone(), 0), "{word}");
    }
}

/// The length of a bar whose ends lie anywhere in the cells that were clicked scatters by as much as is said.
#[test]
fn the_error_is_that_of_what_was_pointed_at() {
    const N: u32 = 12;
    let sides_px = [6.0, 12.0];
    let offsets = || (0..N).map(|i| (f64::from(i) + 0.5) / f64::from(N) - 0.5);
    let places = |at: [f32; 2]| {
        offsets().flat_map(move |x| {
            offsets().map(move |y| [f64::from(at[0]) + x * sides_px[0], f64::from(at[1]) + y * sides_px[1]])
        })
    };
    for (a, b) in
        [([10.0, 20.0], [310.0, 20.0]), ([10.0, 20.0], [10.0, 230.0]), ([10.0, 230.0], [250.0, 20.0])]
    {
        let mut scaling = Scaling::new(0, a);
        for at in [a, b] {
            scaling.set(End { at, sides_px }).expect("far apart");
        }
        scaling.typed = "1m".to_owned();
        scaling.measure().expect("a length");
        let said = scaling.bar.expect("a bar").relative_error();
        let (mut n, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for from in places(a) {
            for to in places(b) {
                let far = (to[0] - from[0]).hypot(to[1] - from[1]);
                (n, sum, squares) = (n + 1.0, sum + far, squares + far * far);
            }
        }
        let mean: f64 = sum / n;
        let scatter = (squares / n - mean * mean).sqrt() / mean;
        assert!((said / scatter - 1.0).abs() < 0.01, "{a:?} {b:?}: said {said}, is {scatter}");
    }
    // Closer than half a pixel nobody points, however near one looks; and from far away nearly nobody measures.
    let error_px = |zoom: &str, way: &str| {
        let mut state = fixture::state();
        press(&mut state, &format!("e b {zoom} Enter {way} Enter 1 m Enter"));
        let Mode::Scale(scaling) = &state.mode else { panic!("{:?}", state.mode) };
        scaling.bar.map(|bar| bar.end_error_px)
    };
    assert_eq!(error_px("z z z z z z", "9 9 9 l"), Some(0.5));
    let cell_px: f64 = 320.0 / 53.0;
    assert!(error_px("", "8 0 l").is_some_and(|px| (px - cell_px / 12.0_f64.sqrt()).abs() < 1e-9));
}

#[test]
fn what_measures_nothing_is_refused() {
    let set = "e b Enter 8 0 l Enter";
    let unit = "wanted a unit (mm, cm, m) after 25";
    let wanted = |text: &str| format!("wanted a length above 0 such as 25mm or 0.5m, got {text}");
    for (text, expect) in [
        ("25", unit.to_owned()),
        ("", wanted("")),
        ("0m", wanted("0m")),
        ("-3cm", wanted("-3cm")),
        ("2 ft", wanted("2 ft")),
        ("NaN m", wanted("NaN m")),
        ("infm", wanted("infm")),
        ("half a metre", wanted("half a metre")),
    ] {
        let mut state = fixture::state();
        press(&mut state, set);
        type_in(&mut state, text);
        assert_eq!(press(&mut state, "Enter"), [], "{text}");
        assert_eq!(wrong(&state), Some(expect.as_str()), "{text}");
        assert_eq!(line(&state), format!("scale at 240 120 ends 2 typed {text:?}"));
    }
    // So small that in metres it is nothing.
    let mut state = fixture::state();
    press(&mut state, set);
    type_in(&mut state, "4e-324mm");
    assert_eq!(press(&mut state, "Enter"), []);
    assert!(wrong(&state).is_some_and(|line| line.contains("a length above 0")), "{:?}", state.notice);

    for (keys, expect) in [
        ("e b Enter Enter", "at least 2 px apart, came 0.00 px (z looks closer)"),
        ("e b Enter l Enter", "at least 2 px apart, came 1.00 px (z looks closer)"),
        ("e b Enter 4 l Enter", "measures nothing: a longer one, or smaller errors (z looks closer)"),
    ] {
        let mut state = fixture::state();
        press(&mut state, keys);
        assert!(wrong(&state).is_some_and(|line| line.ends_with(expect)), "{keys}: {:?}", state.notice);
        assert!(line(&state).contains("ends 1"), "{keys}");
    }
}

#[test]
fn esc_leaves_with_nothing_changed() {
    let whole = "Enter 8 0 l Enter 2 m Enter";
    for n in 0..=whole.split(' ').count() {
        let mut state = fixture::state();
        let keys: Vec<&str> = whole.split(' ').take(n).collect();
        press(&mut state, &format!("e b {}", keys.join(" ")));
        assert!(matches!(state.mode, Mode::Scale(_)), "{keys:?}");
        assert_eq!(press(&mut state, "Esc"), [], "{keys:?}");
        assert!(matches!(state.mode, Mode::Review) && state.scale.is_none(), "{keys:?}");
    }
    let mut state = fixture::state();
    press(&mut state, "e b Enter");
    assert_eq!(press(&mut state, "Q"), []);
    assert!(wrong(&state).is_some_and(|line| line.starts_with("a scale bar is not kept")));
    assert_eq!(press(&mut state, "Q"), [Effect::Leave]);
}

#[test]
fn the_view_goes_with_the_cursor() {
    let mut state = fixture::state();
    press(&mut state, "e b z z z z Enter");
    for _ in 0..200 {
        press(&mut state, "l");
        let Mode::Scale(scaling) = &state.mode else { panic!("{:?}", state.mode) };
        assert!(Lens::shown(&state).pixel_of(scaling.at).is_some(), "{:?} is not seen", scaling.at);
    }
}

#[test]
fn a_kept_bar_is_removed() {
    let mut state = fixture::state();
    assert_eq!(press(&mut state, "d b"), []);
    assert_eq!(wrong(&state), Some("the project has no scale bar: e b sets one"));
    let ends = [[100.0, 100.0], [200.0, 100.0]];
    let bar = ScaleBar { frame: 0, ends, length_m: 0.5, length_error_m: 0.0, end_error_px: 0.5 };
    update(&mut state, Msg::Fact(Fact::Scale(Some(bar))));
    assert_eq!(press(&mut state, "d b"), [Effect::Scale(None, UNDO)]);
    // Another is set in its place.
    assert_eq!(press(&mut state, "e b Enter 8 0 l Enter 2 m Enter Enter").len(), 1);
    state.read_only = Some("ada on lab2".to_owned());
    for keys in ["d b", "e b"] {
        assert_eq!(press(&mut state, keys), []);
        assert!(wrong(&state).is_some_and(|line| line.starts_with("read only")), "{keys}");
        assert!(matches!(state.mode, Mode::Review), "{keys}");
    }
}
