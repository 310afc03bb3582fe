//! What keys and the mouse do while a track is drawn. The fixture: track 1 in frames 0-99, key-frames at 10 and 50.

#![expect(clippy::float_cmp, reason = "what must be the very same")]

use super::tests::{check, line, start};
use super::*;
use crate::app::fixture::{self, press, send};
use honami_model::correct::{Played, Stroke};

/// Sends what words stand for.
fn play(state: &mut State, words: &str) -> Vec<Effect> {
    words.split_whitespace().flat_map(|word| send(state, fixture::msg(word))).collect()
}

/// The strokes that words leave: frames at their ends and number of points, and the delay in milliseconds.
fn strokes(state: &State) -> String {
    let Mode::Sketch(sketching) = &state.mode else { return "not drawing".to_owned() };
    let word = |stroke: &Stroke| match stroke.played {
        Played::STEPWISE => format!("{} put", stroke.drawn.len()),
        Played { rate, delay_s, .. } => {
            format!("{} at {rate} late {:.0}", stroke.drawn.len(), delay_s * 1e3)
        }
    };
    let affected =
        sketching.correction().map_or_else(String::new, |ghost| format!(" | {:?}", ghost.affected));
    let words: Vec<String> = sketching.strokes.iter().map(word).collect();
    words.join(", ") + &affected
}

#[test]
fn strokes_are_drawn_by_the_mouse_and_by_keys() {
    for (words, expect, frame) in [
        // Held down before the clip plays, or while it does; let go, the clip stops.
        (
            "press:40,10 ; at:1 late:85 late:95 late:85 drag:41,10 at:2 release:41,10",
            "3 at 0.5 late 200 | 20..43",
            45,
        ),
        ("; at:1 press:40,10 at:1.5 drag:41,10 at:2 release:41,10", "3 at 0.5 late 115 | 32..44", 45),
        ("press:40,10 2 5 ; at:1 drag:41,10 at:2 release:41,10", "3 at 0.25 late 115 | 20..32", 32),
        ("press:40,10 ' at:1 drag:41,10 at:1.6 release:41,10", "3 at -0.5 late 115 | 2..21", 0),
        // A button that is not held draws nothing, nor does looking on.
        ("press:40,10 release:40,10 ; at:1 drag:41,10 ;", "", 32),
        ("; at:1 ;", "", 32),
        // Held arrows lead the point, from where it was when the clip began to play.
        ("; at:0.5 l at:1 l l at:1.5 ;", "5 at 0.5 late 115 | 20..38", 38),
        ("; at:1 l space at:1.5 j ;", "3 at 0.5 late 115, 3 at 1 late 115 | 20..42", 44),
        // A second stroke, and taking strokes back: first the one that is being drawn.
        ("; at:1 l ; ; at:2 j ;", "3 at 0.5 late 115, 3 at 0.5 late 115 | 20..44", 44),
        ("; at:1 l ; ; at:2 j Backspace", "3 at 0.5 late 115 | 20..32", 44),
        ("; at:1 l ; Backspace", "", 32),
        // Frame by frame: put down, next; the same stroke as long as one steps on.
        (". . .", "3 put | 20..23", 23),
        ("5 . .", "2 put | 20..26", 26),
        (". . , .", "2 put, 1 put | 20..22", 22),
        (". . Backspace Backspace", "", 22),
        (". ; at:0.5 l ; .", "1 put, 3 at 0.5 late 115, 1 put | 20..28", 28),
    ] {
        let mut state = start("frame=20");
        press(&mut state, "s");
        let effects = play(&mut state, words);
        assert_eq!(
            (strokes(&state).as_str(), effects, state.frame),
            (expect, Vec::new(), frame),
            "by `{words}`"
        );
    }
}

#[test]
fn the_point_is_led_by_steps_of_a_settable_size() {
    for (from, keys, expect) in [
        ("frame=20", "s 3 l k", "sketch 3 -1 | frame 20 track 1"),
        ("frame=20 zoom=1", "s l L", "sketch 0.625 0 | frame 20 track 1"),
        ("frame=20", "s + + l J", "sketch 4 1 | frame 20 track 1"),
        ("frame=20", "s 9 + l - - l", "sketch 80 0 | frame 20 track 1"),
        ("frame=20", "s 9 - l", "sketch 0.25 0 | frame 20 track 1"),
        // It goes on as it went, unless a frame is a key-frame or drawn already.
        ("frame=20", "s . 2 l k . .", "sketch 6 -3 | frame 23 track 1"),
        ("frame=20", "s . 2 l . l . , ,", "sketch 2 0 | frame 21 track 1"),
        ("frame=20", "s 2 . 2 l 2 .", "sketch 4 0 | frame 24 track 1"),
    ] {
        let mut state = start(from);
        let row = state.selected_row().unwrap().clone();
        let effects = press(&mut state, keys);
        let here = row.at(20).unwrap();
        let Mode::Sketch(sketching) = &state.mode else { panic!("not drawing") };
        let by = [0, 1].map(|axis| sketching.point[axis] - here[axis]);
        let seen = line(&state, &effects);
        let rest = seen.split_once(" | ").unwrap().1;
        assert_eq!(format!("sketch {} {} | {rest}", by[0], by[1]), expect, "by `{keys}`");
    }
    let mut state = start("frame=20");
    press(&mut state, "s ] .");
    let Mode::Sketch(sketching) = &state.mode else { panic!("not drawing") };
    assert_eq!(
        sketching.strokes[0].drawn[0].at.map(|x| x as f32),
        state.selected_row().unwrap().at(50).unwrap()
    );
}

#[test]
fn a_sketch_is_kept_or_left() {
    let mut state = start("frame=20");
    let effects = play(&mut state, "s ; at:1 l Enter");
    let [Effect::Correct(Step::Sketch { track: TrackId(1), strokes }, hint)] = &effects[..] else {
        panic!("{effects:?}")
    };
    assert_eq!((strokes.len(), strokes[0].drawn.len(), *hint), (1, 3, "T slides a sample in time, u undoes"));
    assert!(matches!(state.mode, Mode::Review) && state.play.is_none());
    assert_eq!(state.frame, 31, "the last frame that was drawn");
    for (from, keys, expect) in [
        ("frame=20", "s Esc", "review | frame 20 track 1"),
        ("frame=20", "s l . . q", "review | frame 22 track 1"),
        ("playing", "s", "sketch 0 | frame 0 track 1"),
        ("frame=20", "s ; Esc", "sketch 0 | frame 20 track 1"),
        ("frame=20", "s ; l Esc Esc", "review | frame 20 track 1"),
        (
            "frame=20",
            "s Enter",
            "sketch 0 | frame 20 track 1 | error nothing is drawn yet: hold the mouse's button down, or steer, while the clip plays; or step",
        ),
        (
            "frame=20",
            "s ; l Enter",
            "sketch 1 | frame 20 track 1 | error the stroke covers no frame; draw while the clip plays, for longer than its delay",
        ),
        (
            "frame=99",
            "s .",
            "sketch 0 | frame 99 track 1 | error this is the last frame: there is none to step to; Enter keeps what is drawn",
        ),
        (
            "locked",
            "s",
            "review | frame 0 track 1 | error read only: ada on lab2 holds this project; nothing can be changed here",
        ),
        (
            "empty",
            "s",
            "review | frame 0 track - | error select a track first: j takes the next, a click takes the nearest",
        ),
    ] {
        check(from, keys, expect);
    }
    let mut state = start("frame=20");
    press(&mut state, "s . .");
    state.tracks.clear();
    update(&mut state, Msg::Fact(Fact::Tracks(Vec::new())));
    assert!(matches!(state.mode, Mode::Review), "its track is gone");
}

#[test]
fn the_view_stands_still_under_the_hand() {
    let mut state = start("frame=20 zoom=3");
    press(&mut state, "f s");
    let centre = state.centre;
    play(&mut state, "; at:1 l at:2");
    assert!(state.frame > 40 && state.centre == centre);
    press(&mut state, "; Esc .");
    assert_ne!(state.centre, centre, "it is followed again");
}
