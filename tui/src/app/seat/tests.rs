//! A seat is found again, and one that is out of date does no harm.

use super::*;
use crate::app::fixture;
use crate::app::update::{Msg, update};

#[test]
fn what_is_left_is_found_again() {
    let mut state = fixture::state();
    for key in "4 2 g f j z f S M Tab 1 2 b b v q v s v v v + v d 3 h Enter".split(' ') {
        update(&mut state, Msg::Key(key.parse().unwrap()));
    }
    let seat = Seat::of(&state);
    let json = serde_json::to_string(&seat).unwrap();
    let mut again = fixture::state();
    serde_json::from_str::<Seat>(&json).unwrap().take(&mut again);
    assert_eq!(Seat::of(&again), seat);
    assert_eq!((again.glyphs, again.stills, again.loop_frames), (Glyphs::Quadrants, false, 12));
    assert_eq!(again.motion, state.motion);
    assert_ne!(again.motion, fixture::state().motion);
    assert_eq!((again.frame, again.selected, again.follow), (42, Some(TrackId(2)), true));
}

#[test]
fn a_seat_that_is_out_of_date_does_no_harm() {
    for json in [
        r#"{}"#,
        r#"{"frame":4000000000,"selected":99,"zoom":200,"follow":true,"centre":[1e30,5.0],"hat":"blue"}"#,
        r#"{"centre":null}"#,
        r#"{"glyphs":"runes","loop-frames":0,"full-px-s":-1.0,"dial-rad":[0.0,99.0],"motion":true}"#,
    ] {
        let mut state = fixture::state();
        serde_json::from_str::<Seat>(json).unwrap().take(&mut state);
        assert!(state.frame <= state.last_frame() && state.zoom <= ZOOM_MAX, "{json}");
        assert_eq!((state.selected, state.follow), (None, false), "{json}");
        assert!(state.loop_frames > 0 && state.motion.full_px_s.is_none(), "{json}");
    }
}
