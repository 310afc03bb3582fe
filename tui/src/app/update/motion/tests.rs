//! Colours of motion: gain, dial, and what they are of.

use std::sync::Arc;

use honami_model::track::TrackId;
use honami_workbench::overlay::VelocityField;

use super::*;
use crate::app::fixture::press;
use crate::app::update::tests::{check, line, start};
use crate::app::update::{Fact, Msg, update};

#[test]
fn motion_in_colours() {
    for (keys, expect) in [
        ("v d", "dial  at 98"),
        ("v d l", "dial → 10° ± 45° at 98"),
        ("v d 3 h", "dial ↗ 330° ± 45° at 98"),
        ("v d 9 l k", "dial ↓ 90° ± 55° at 98"),
        ("v d 9 9 j", "dial → 0° ± 1° at 98"),
        ("v d l 9 9 k", "dial  at 98"),
        ("v d 2 +", "dial  at 49 | said full colour at 49 px/s"),
        ("v d - -", "dial  at 196 | said full colour at 196 px/s"),
    ] {
        let mut state = start("");
        let effects = press(&mut state, keys);
        let expect = expect.replace(" |", " | frame 0 track 1 |");
        let expect = if expect.contains("said") { expect } else { format!("{expect} | frame 0 track 1") };
        assert_eq!(line(&state, &effects), expect, "by `{keys}`");
    }
    let mut state = start("");
    press(&mut state, "v v");
    let before = state.motion;
    press(&mut state, "v d 5 l + Esc");
    assert_eq!(state.motion, before, "Esc sets it back");
    press(&mut state, "v d 5 l Enter");
    assert!(state.motion.is_on && state.motion.dial != before.dial, "Enter keeps it");
    press(&mut state, "v v");
    assert!(!state.motion.is_on);
    check(
        "empty",
        "v v",
        "review | frame 0 track - | error motion is shown of tracks, and there are none yet: t r follows features",
    );
}

#[test]
fn dense_motion_is_asked_for_measured_and_left_again() {
    let mut state = start("");
    let effects = press(&mut state, "v f");
    assert_eq!(effects, [Effect::Measure(Some(TrackId(1)))]);
    assert!(!state.motion.is_on && state.dense.is_none(), "not before a tracker says that it can");
    update(&mut state, Msg::Fact(Fact::Measures("klt".to_owned())));
    let said = "dense motion by klt: measured frame by frame (v f back to the tracks)";
    assert_eq!(line(&state, &[]), format!("review | frame 0 track 1 | said {said}"));
    assert!(state.motion.is_on && state.dense.as_ref().unwrap().field.is_none());
    let velocities = vec![Some([0.0, 200.0]); 4];
    let field = Arc::new(VelocityField { origin: [0.0; 2], step_px: 100.0, nx: 2, velocities });
    let full_px_s = state.motion.full_px_s;
    update(&mut state, Msg::Fact(Fact::Dense(Some((0, Arc::clone(&field))))));
    assert_eq!(state.motion.full_px_s, full_px_s, "the tracks have said which gain suits");
    press(&mut state, "v v");
    assert!(!state.motion.is_on && state.dense.is_some(), "off is not another source");
    press(&mut state, "v v");
    assert_eq!(
        line(&state, &[]),
        "review | frame 0 track 1 | said dense motion by klt: full colour at 98 px/s (v + v - gain, v d dial)"
    );
    assert_eq!(press(&mut state, "v f"), []);
    assert!(state.motion.is_on && state.dense.is_none());
    assert_eq!(
        line(&state, &[]),
        "review | frame 0 track 1 | said motion of the tracks: full colour at 98 px/s (v + v - gain, v d dial)"
    );

    // Where there are no tracks the field says which gain suits, and what fails ends it.
    let mut state = start("empty");
    press(&mut state, "v f");
    update(&mut state, Msg::Fact(Fact::Measures("klt".to_owned())));
    update(&mut state, Msg::Fact(Fact::Dense(Some((0, field)))));
    assert_eq!(state.motion.full_px_s, Some(200.0));
    update(&mut state, Msg::Fact(Fact::NotMeasured("klt fell over".to_owned())));
    assert_eq!(
        (line(&state, &[]), state.dense),
        ("review | frame 0 track - | error klt fell over".to_owned(), None)
    );
    let mut state = start("");
    state.mono = true;
    assert_eq!(press(&mut state, "v f"), [], "there are no colours");
}
