//! What keys do to ranges, picks and whole tracks. The fixture: track 1 in frames 0-99 with key-frames at 10 and 50,
//! track 2 in 0-59, track 7 in 20-99 with one at 30; 1 and 2 are a group.

use super::tests::{check, line, start};
use crate::app::fixture::press;
use crate::app::update::{Fact, Msg, update};
use honami_model::track::TrackId;

#[test]
fn ranges_are_marked_and_taken_away() {
    let mark = |tracks: &str, frames: &str, status: &str| {
        format!("Mark {{ tracks: TrackSet([{tracks}]), frames: {frames}, status: {status} }}")
    };
    for (from, keys, frame, expect) in [
        // Without a range: to the next key-frame, to the end, or this frame.
        ("frame=20", "x", 20, mark("1..=1", "20..50", "Lost")),
        ("frame=60", "x", 60, mark("1..=1", "60..100", "Lost")),
        ("frame=20", "o", 20, mark("1..=1", "20..21", "Occluded")),
        ("frame=20", "O", 20, mark("1..=1", "20..21", "Outside")),
        // With one, to both sides of where it began; ended, it stays where it is.
        ("frame=20", "r 9 l x", 29, mark("1..=1", "20..30", "Lost")),
        ("frame=20", "r 9 h o", 11, mark("1..=1", "11..21", "Occluded")),
        ("frame=20", "r 9 l r 3 0 l O", 59, mark("1..=1", "20..30", "Outside")),
        ("frame=20", "r 9 l r l r 2 l x", 32, mark("1..=1", "30..33", "Lost")),
        ("frame=20", "r 9 l Esc o", 29, mark("1..=1", "29..30", "Occluded")),
        ("frame=20", "r 9 l d r", 29, "DeleteRange { tracks: TrackSet([1..=1]), frames: 20..30 }".to_owned()),
        // On all that are picked.
        ("frame=20", "y j y r 9 l x", 29, mark("1..=2", "20..30", "Lost")),
        ("frame=20", "Y o", 20, mark("1..=2", "20..21", "Occluded")),
    ] {
        let mut state = start(from);
        let effects = press(&mut state, keys);
        let seen = line(&state, &effects);
        assert!(seen.ends_with(&format!(" | {expect}")), "{seen} by `{keys}`, not {expect}");
        assert_eq!(state.frame, frame, "by `{keys}`");
    }
    check("frame=20", "d r", "review | frame 20 track 1 | error no range to take away: r begins one here");
    check(
        "frame=20",
        "r 9 l r",
        "review | frame 29 track 1 | said range 20-29: x lost, o occluded, O outside, d r takes it away, Esc gives it up",
    );
}

#[test]
fn a_range_stays_until_it_is_used_or_given_up() {
    let mut state = start("frame=20");
    press(&mut state, "y r 9 l x");
    assert!(state.range.is_some(), "it may be refused");
    update(&mut state, Msg::Fact(Fact::Corrected(None)));
    assert_eq!((state.range, state.selected, state.picked.len()), (None, Some(TrackId(1)), 1));
    update(&mut state, Msg::Fact(Fact::Corrected(Some(TrackId(7)))));
    assert_eq!(state.selected, Some(TrackId(7)), "a new track is looked at");
    press(&mut state, "r Esc");
    assert_eq!((state.range, state.picked.len()), (None, 1), "the range goes before the picks");
    press(&mut state, "Esc");
    assert!(state.picked.is_empty());
}

#[test]
fn tracks_are_picked_by_one_and_by_groups() {
    for (from, keys, picked) in [
        ("", "y", "1"),
        ("", "y y", ""),
        ("", "y j j y", "1 7"),
        ("", "Y", "1 2"),
        ("", "y Y", "1 2"),
        ("", "Y Y", ""),
        ("", "j j y k Y Y", "7"),
        ("", "Y Esc", ""),
        ("empty", "y Y", ""),
    ] {
        let mut state = start(from);
        press(&mut state, keys);
        let seen: Vec<String> = state.picked.iter().map(ToString::to_string).collect();
        assert_eq!(seen.join(" "), picked, "by `{keys}`");
    }
    check("", "Y d d", "review | frame 0 track 7 | commit 2 tracks deleted");
    let mut state = start("");
    press(&mut state, "Y");
    let left = state.tracks[1..].to_vec();
    update(&mut state, Msg::Fact(Fact::Tracks(left)));
    assert_eq!(
        state.picked.iter().map(|track| track.0).collect::<Vec<_>>(),
        [2],
        "what is gone is not picked"
    );
}

#[test]
fn whole_tracks() {
    for (from, keys, expect) in [
        ("frame=20", "e s", "Split { track: TrackId(1), frame: 20 }"),
        ("", "e s", "error track 1 is in frames 0-99: go to where the second part begins"),
        ("frame=20", "e x Enter", "Swap { tracks: [TrackId(1), TrackId(2)], frames: 20..100 }"),
        ("frame=20", "e x 7 Enter", "Swap { tracks: [TrackId(1), TrackId(7)], frames: 20..100 }"),
        ("frame=20", "r 9 l e x 7 Enter", "Swap { tracks: [TrackId(1), TrackId(7)], frames: 20..30 }"),
        ("", "e j 7 Enter", "Join { track: TrackId(1), with: TrackId(7) }"),
        ("", "e d", "Duplicate(TrackId(1))"),
        ("", "Y e a", "Average(TrackSet([1..=2]))"),
        (
            "",
            "y e a",
            "error two tracks or more have an average, 1 picked: y picks the selected one, Y its group",
        ),
        ("", "e n", "name \"bud-left\""),
        ("", "j e n a space b Enter", "commit track 2 named a b"),
        ("", "e n Backspace Backspace Backspace Backspace Backspace Enter", "commit track 1 named bud"),
        ("", "e n Enter", "review"),
        ("", "e n x Esc", "review"),
        ("locked", "e j", "error read only: ada on lab2 holds this project; nothing can be changed here"),
        ("locked", "Y o", "error read only: ada on lab2 holds this project; nothing can be changed here"),
    ] {
        let mut state = start(from);
        let effects = press(&mut state, keys);
        let seen = line(&state, &effects);
        assert!(seen.split(" | ").any(|part| part == expect), "{seen} by `{keys}`, not {expect}");
    }
}
