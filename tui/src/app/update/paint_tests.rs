//! Painting by keys and by mouse: strokes, the matte that is found of them, and what is kept.

use std::sync::Arc;

use honami_workbench::matting::{Mark, Part, Parts};

use super::*;
use crate::app::fixture::{self, msg, press};
use crate::app::state::Job;

fn told(state: &State) -> String {
    let Mode::Paint(painting) = &state.mode else { return "not painting".to_owned() };
    let count = |mark| painting.marks.marks.iter().filter(|of| **of == mark).count();
    format!("{} strokes {} {}", painting.strokes.len(), count(Mark::Foreground), count(Mark::Background))
}

fn all_kept(state: &State) -> Arc<Parts> {
    let (width, height) = (state.clip.width, state.clip.height);
    Arc::new(Parts { width, height, parts: vec![Part::Kept; (width * height) as usize] })
}

#[test]
fn keys_alone_paint_find_and_keep() {
    let mut state = fixture::state();
    assert_eq!(press(&mut state, "e p"), [Effect::LookAtMatte(0)]);
    press(&mut state, "9 - l l");
    assert_eq!(told(&state), "0 strokes 0 0", "the pen is up");
    let effects = press(&mut state, "Enter");
    assert_eq!(effects, []);
    assert!(state.notice.as_ref().is_some_and(|notice| notice.is_error), "nothing is painted");
    press(&mut state, "D 4 l D");
    assert_eq!(told(&state), "1 strokes 5 0");
    press(&mut state, "Tab 9 j 2 + D 1 0 l");
    assert_eq!(told(&state), "2 strokes 5 121", "21 pixels and 5 of a brush of 5, each 20 on");
}

/// The matte is found while the terminal waits, as a job.
fn job(state: &mut State) {
    let (plugin, what) = ("the matte".to_owned(), "per cent".to_owned());
    let (done, since) = ((0, 100), Duration::ZERO);
    let (first, keeps_frames, is_stopping, frame, quiet) = (0, false, false, None, None);
    let job = Job { plugin, what, done, first, since, keeps_frames, is_stopping, frame, quiet };
    update(state, Msg::Fact(Fact::Job(Some(job))));
}

#[test]
fn a_matte_is_found_of_what_was_painted_and_kept() {
    let mut state = fixture::state();
    press(&mut state, "2 0 g f e p");
    for word in ["press:20,10", "drag:30,10", "release:30,10"] {
        update(&mut state, msg(word));
    }
    press(&mut state, "Tab");
    update(&mut state, msg("press:20,16"));
    let effects = press(&mut state, "Enter");
    let [Effect::FindMatte(20, 2, plane)] = &effects[..] else { panic!("{effects:?}") };
    let there_is = |mark| plane.marks.contains(&mark);
    assert!(there_is(Mark::Foreground) && there_is(Mark::Background));
    job(&mut state);
    assert_eq!(press(&mut state, "Enter"), [], "one at a time");
    assert!(state.notice.as_ref().is_some_and(|notice| notice.is_error));

    // A stroke that was painted meanwhile is not in it.
    update(&mut state, msg("press:24,18"));
    let found = |of| Fact::Matted((20, of), all_kept(&fixture::state()), "80 % kept".to_owned());
    update(&mut state, Msg::Fact(Fact::Job(None)));
    update(&mut state, Msg::Fact(found(2)));
    assert!(matches!(press(&mut state, "Enter")[..], [Effect::FindMatte(20, 3, _)]));
    update(&mut state, Msg::Fact(found(3)));
    let line = state.notice.as_ref().map(|notice| notice.text.clone());
    assert_eq!(line.as_deref(), Some("80 % kept; Enter keeps it, more strokes refine it"));
    assert_eq!(press(&mut state, "Enter"), [Effect::KeepMatte(20, UNDO)]);
    assert!(matches!(state.mode, Mode::Review));
}

#[test]
fn esc_stops_what_is_found_and_then_leaves_without_a_trace() {
    let mut state = fixture::state();
    press(&mut state, "e p D l Tab D l");
    assert_eq!(press(&mut state, "Q"), [], "it is asked first");
    assert!(matches!(press(&mut state, "Enter")[..], [Effect::FindMatte(0, 2, _)]));
    job(&mut state);
    assert_eq!(press(&mut state, "Esc"), [Effect::StopJob]);
    assert_eq!(press(&mut state, "Esc"), []);
    assert!(matches!(state.mode, Mode::Review));
    update(&mut state, Msg::Fact(Fact::Job(None)));
    update(&mut state, Msg::Fact(Fact::Matted((0, 2), all_kept(&fixture::state()), String::new())));
    let line = state.notice.as_ref().map(|notice| notice.text.clone());
    assert_eq!(line.as_deref(), Some("painting is over: the matte that was found is not kept"));
    assert_eq!(told(&state), "not painting");

    let mut locked = fixture::state();
    locked.read_only = Some("ada on lab2".to_owned());
    assert_eq!(press(&mut locked, "e p"), []);
    assert_eq!(told(&locked), "not painting");
}

#[test]
fn the_kept_matte_of_the_frame_is_gone_on_from() {
    let mut state = fixture::state();
    press(&mut state, "e p");
    let marks = Arc::new(vec![Mark::Background; 320 * 240]);
    update(&mut state, Msg::Fact(Fact::Matte(0, marks, all_kept(&fixture::state()))));
    assert_eq!(told(&state), "0 strokes 0 76800");
    press(&mut state, "9 - D");
    assert_eq!(told(&state), "1 strokes 1 76799");
    assert!(matches!(press(&mut state, "Enter")[..], [Effect::FindMatte(0, 1, _)]));
    press(&mut state, "Backspace");
    assert_eq!(told(&state), "0 strokes 0 76800");
    update(&mut state, Msg::Fact(Fact::Matted((0, 1), all_kept(&fixture::state()), "found".to_owned())));
    let line = state.notice.as_ref().map(|notice| notice.text.clone());
    assert_eq!(line.as_deref(), Some("found; Enter finds it anew, with the strokes since"));
}
