//! What is said of items, what that takes, and what becomes of it when it is undone or refused.

use std::sync::Arc;
use std::time::Duration;

use honami_model::history::{Entry, EntryId};
use honami_model::track::{Sample, Source, Status, TrackId};

use super::tests::{check, line, start};
use super::{Effect, Fact, Judge, Mode, Msg, State, queue, update};
use crate::app::fixture::press;
use crate::app::layout::Layout;
use crate::app::tracks::TrackRow;
use crate::term::input::{Mouse, MouseKind};

/// Changes samples of track 1, as a correction that the world has made.
fn change(state: &mut State, change: impl Fn(u32, &mut Sample)) {
    let row = &state.tracks[0];
    let mut span = (*row.span).clone();
    (0..).zip(&mut span.samples).for_each(|(frame, sample)| change(frame, sample));
    state.tracks[0] = TrackRow::new(row.id, row.name.clone(), Arc::new(span));
}

#[test]
fn a_verdict_says_what_has_become_of_the_samples() {
    let status = |frames: std::ops::Range<u32>, status: Status| {
        move |frame: u32, sample: &mut Sample| {
            if frames.contains(&frame) {
                sample.status = status;
            }
        }
    };
    let moved = |at: u32| {
        move |frame: u32, sample: &mut Sample| {
            if frame == at {
                (sample.x, sample.source) = (sample.x + 3.0, Source::Key);
            }
        }
    };
    type Change = Box<dyn Fn(u32, &mut Sample)>;
    let cases: [(&str, Vec<Change>); 10] = [
        ("accepted", vec![]),
        ("accepted", vec![Box::new(status(60..70, Status::Lost))]),
        ("fixed", vec![Box::new(moved(45))]),
        ("lost", vec![Box::new(status(40..50, Status::Lost))]),
        // Right up to 44: the usual case.
        ("lost", vec![Box::new(status(45..100, Status::Lost))]),
        ("lost", vec![Box::new(status(47..50, Status::Outside)), Box::new(moved(44))]),
        ("fixed", vec![Box::new(status(42..44, Status::Lost))]),
        ("occluded", vec![Box::new(status(42..44, Status::Occluded))]),
        ("occluded", vec![Box::new(status(40..50, Status::Occluded))]),
        ("fixed", vec![Box::new(status(42..44, Status::Occluded)), Box::new(moved(47))]),
    ];
    for (n, (verdict, changes)) in cases.into_iter().enumerate() {
        let mut state = start("");
        let rank =
            state.review.queue.of_track(TrackId(1)).find(|item| item.frames.start == 40).unwrap().rank();
        queue::open_rank(&mut state, rank);
        changes.iter().for_each(|by| change(&mut state, by));
        let effects = press(&mut state, "Enter");
        let [Effect::Judge(Judge { verdict: said, .. })] = &effects[..] else { panic!("{effects:?}") };
        assert_eq!(said.word(), verdict, "case {n}");
    }
}

#[test]
fn what_an_item_takes_is_kept_while_others_are_looked_at() {
    let at = |state: &mut State, secs: u64, keys: &str| {
        update(state, Msg::Clock(Duration::from_secs(secs)));
        press(state, keys)
    };
    // Left by n and come back to by p: one key and five seconds before, one key and a second after.
    let mut state = start("");
    for (secs, keys) in [(10, "n"), (14, "."), (15, "n"), (20, "p")] {
        at(&mut state, secs, keys);
    }
    let effects = at(&mut state, 21, "Enter");
    let [Effect::Judge(found)] = &effects[..] else { panic!("{effects:?}") };
    assert_eq!((found.track, found.effort.keystrokes), (TrackId(1), 3));
    assert!((found.effort.seconds - 6.0).abs() < 1e-3, "{:?}", found.effort);
    // Keys on another track are not its.
    let mut state = start("");
    for (secs, keys) in [(10, "n"), (11, "j"), (20, "."), (21, "."), (30, "k")] {
        at(&mut state, secs, keys);
    }
    let effects = at(&mut state, 32, "Enter");
    let [Effect::Judge(found)] = &effects[..] else { panic!("{effects:?}") };
    assert_eq!((found.track, found.effort.keystrokes), (TrackId(1), 2));
    assert!((found.effort.seconds - 3.0).abs() < 1e-3, "{:?}", found.effort);
}

#[test]
fn a_key_frame_is_confirmed_while_an_item_is_open() {
    let commit = "review | frame 90 track 1 | commit track 1: key-frame at 90 (confirmed)";
    check("frame=90", "*", commit);
    check("", "n 9 0 g f *", commit);
    let mut state = start("");
    press(&mut state, "n 9 0 g f *");
    assert_eq!(state.opened().map(|opened| opened.item.frames.clone()), Some(70..80), "it is open still");
}

#[test]
fn undoing_a_verdict_goes_back_to_its_item() {
    let mut state = start("");
    press(&mut state, "n Enter");
    assert_eq!(state.selected, Some(TrackId(7)), "on to the next");
    let entry = Entry {
        id: EntryId(5),
        parent: Some(EntryId(3)),
        next: None,
        label: "track 1: frames 70-79 lost".to_owned(),
        author: "ana".to_owned(),
        time: String::new(),
    };
    update(&mut state, Msg::Fact(Fact::History(vec![entry], EntryId(5))));
    assert_eq!(state.selected, Some(TrackId(7)));
    press(&mut state, "g s");
    // To another branch, and back: nothing is judged or undone by that.
    for head in [4, 5] {
        update(&mut state, Msg::Fact(Fact::History(Vec::new(), EntryId(head))));
        assert_eq!((state.selected, state.frame), (Some(TrackId(7)), 0));
    }
    update(&mut state, Msg::Fact(Fact::History(Vec::new(), EntryId(2))));
    assert_eq!((state.selected, state.frame), (Some(TrackId(1)), 70), "undone, and the edit before it too");
    assert_eq!(state.opened().map(|opened| opened.item.frames.clone()), Some(70..80));
}

#[test]
fn a_deleted_track_that_is_there_again_is_the_selected_one() {
    let mut state = start("track=7");
    press(&mut state, "d d");
    assert_eq!(state.selected, Some(TrackId(2)));
    update(&mut state, Msg::Fact(Fact::ThereAgain(TrackId(7))));
    assert_eq!(state.selected, Some(TrackId(7)));
}

#[test]
fn what_is_done_to_a_doubtful_track_counts_for_its_item_also_where_nobody_has_opened_it() {
    let at = |state: &mut State, secs: u64, keys: &str| {
        update(state, Msg::Clock(Duration::from_secs(secs)));
        press(state, keys)
    };
    let judged = |state: &mut State, secs: u64, keys: &str| -> Judge {
        let effects = at(state, secs, keys);
        let [Effect::Judge(found)] = &effects[..] else { panic!("{effects:?}") };
        found.clone()
    };
    let mark = |frame: u32, sample: &mut Sample| {
        if frame == 72 {
            (sample.x, sample.source, sample.status) = (3.0, Source::Key, Status::Tracked);
        }
    };
    // Corrected first, and then opened by Enter and accepted: four keys and seven seconds.
    let mut state = start("frame=72");
    at(&mut state, 10, ".");
    at(&mut state, 13, ",");
    change(&mut state, mark);
    at(&mut state, 15, "Enter");
    assert_eq!(state.opened().map(|opened| opened.item.frames.clone()), Some(70..80));
    let found = judged(&mut state, 17, "Enter");
    assert_eq!((found.effort.keystrokes, found.effort.key_frames, found.verdict.word()), (4, 1, "fixed"));
    assert!((found.effort.seconds - 7.0).abs() < 1e-3, "{:?}", found.effort);
    // Corrected, left for another, and come back to: the keys on the other are not its.
    let mut state = start("frame=72");
    at(&mut state, 10, ".");
    change(&mut state, mark);
    at(&mut state, 11, "j");
    at(&mut state, 12, ". ,");
    at(&mut state, 20, "k");
    at(&mut state, 21, "w");
    let found = judged(&mut state, 23, "Enter");
    assert_eq!((found.effort.keystrokes, found.effort.key_frames), (3, 1));
    assert!((found.effort.seconds - 3.0).abs() < 1e-3, "{:?}", found.effort);
    // Passing by is no work.
    let mut state = start("frame=72");
    at(&mut state, 10, "j");
    at(&mut state, 11, "k");
    at(&mut state, 12, "j");
    at(&mut state, 13, "w");
    let found = judged(&mut state, 14, "Enter");
    assert_eq!((found.track, found.effort.keystrokes), (TrackId(2), 1));
}

#[test]
fn an_item_that_has_changed_shows_what_it_is_now() {
    let mut state = start("");
    press(&mut state, "n");
    assert_eq!(state.doubt().map(|item| item.worst), Some(70));
    let wrong: Vec<_> = state.review.queue.of_track(TrackId(1)).cloned().collect();
    let half = wrong.iter().filter(|item| item.frames.start == 70).cloned();
    let half = half.map(|item| honami_workbench::review::Item { frames: 75..80, worst: 75, ..item });
    state.review.queue.set(TrackId(1), half);
    assert_eq!(state.doubt().map(|item| item.worst), Some(75));
    state.review.queue.set(TrackId(1), []);
    assert_eq!(state.doubt(), None, "it has no numbers any more");
    assert_eq!(state.current_item().map(|item| item.worst), Some(70), "it is open still");
}

/// Whatever was placed, typed or opened is there again.
#[test]
fn what_the_project_refuses_is_not_lost() {
    for (from, keys, left) in [
        ("frame=20", "m l l Enter", "move 2 0 | frame 20 track 1"),
        ("frame=20", "m l Tab Enter", "move 1 0 | frame 20 track 1"),
        ("frame=20", "m l 5 . Enter", "move 1 0 | frame 25 track 1"),
        ("frame=20", "T l Enter", "slide 1.00 | frame 20 track 1"),
        ("", "a 1 0 h Enter", "place 150 120 | frame 0 track 1"),
        ("", "e n x Enter", "name \"bud-leftx\" | frame 0 track 1"),
        ("frame=20", "e x 7 Enter", "review | frame 20 track 1"),
        ("", "t r j j j 2 5 Enter Enter", "form Track row 3 typed None | frame 0 track 1"),
        ("", "d d", "review | frame 0 track 1"),
        ("", "n Enter", "review | frame 70 track 1"),
        ("", "n R", "review | frame 70 track 1"),
        // Nothing was given up for these.
        ("frame=20", "m l Esc u", "review | frame 20 track 1"),
        ("frame=20", "m l Enter u", "review | frame 20 track 1"),
    ] {
        let mut state = start(from);
        assert!(!press(&mut state, keys).is_empty(), "`{keys}` asks for nothing");
        update(&mut state, Msg::Fact(Fact::Refused));
        state.notice = None;
        assert_eq!(line(&state, &[]), left, "by `{keys}`");
    }
    let mut state = start("");
    press(&mut state, "n Enter");
    assert!(state.review.queue.of_track(TrackId(1)).all(|item| item.frames.start != 70));
    update(&mut state, Msg::Fact(Fact::Refused));
    assert!(
        state.review.queue.of_track(TrackId(1)).any(|item| item.frames.start == 70),
        "it is in the queue"
    );
    assert_eq!(state.opened().map(|opened| opened.item.frames.clone()), Some(70..80), "and open");
}

#[test]
fn what_is_not_known_yet_is_not_kept_as_something_else() {
    let mut state = start("frame=20");
    for key in ["m", "l", "Enter"] {
        let effects = update(&mut state, Msg::Key(key.parse().unwrap()));
        assert!(effects.iter().all(|effect| matches!(effect, Effect::Study(_))), "{effects:?}");
    }
    let seen = line(&state, &[]);
    assert_eq!(seen, "move 1 0 | frame 20 track 1 | error track 1 could not be read: Esc, and then again");
}

#[test]
fn a_click_in_the_column_takes_nothing_away_that_is_open() {
    let click = |keys: &str, y: u16| {
        let mut state = start("frame=20");
        press(&mut state, "P t");
        press(&mut state, keys);
        let column = Layout::of(&state).column.x + 2;
        let press = Mouse { kind: MouseKind::Press(0), column, row: y };
        update(&mut state, Msg::Mouse(press));
        state
    };
    let row = (0..24).find(|y| click("", *y).selected == Some(TrackId(7))).expect("a row of track 7");
    for keys in ["a", "m l", "T", "t r", "e n x", "v d", "g l"] {
        let state = click(keys, row);
        assert_eq!(state.selected, Some(TrackId(1)), "after `{keys}`");
        assert!(!matches!(state.mode, Mode::Review | Mode::History { .. }), "after `{keys}`");
    }
}

#[test]
fn a_click_in_a_loop_selects_what_is_seen() {
    let mut state = start("frame=8");
    press(&mut state, "b");
    update(&mut state, Msg::Clock(Duration::from_millis(321)));
    assert_eq!((state.frame, state.shown_frame()), (8, 16));
    // Track 2 is at 79 px there, and at 100 px in the frame round which it goes.
    update(&mut state, Msg::Mouse(Mouse { kind: MouseKind::Press(0), column: 26, row: 10 }));
    assert_eq!(state.selected, Some(TrackId(2)));
}

/// Up and down in the queue go to its items, and Enter accepts what they open; it makes no key-frame there.
#[test]
fn the_rows_of_the_queue_are_its_items() {
    let rank = |state: &State| state.opened().map(|opened| opened.item.rank());
    let ranks: Vec<_> = start("").review.queue.iter().map(|item| item.rank()).collect();
    for (keys, at) in
        [("P q n j", 1), ("P q n j j", 2), ("P q n 2 j k", 1), ("P q n j n", 2), ("P q n 9 j", 3)]
    {
        let mut state = start("");
        press(&mut state, keys);
        assert_eq!(rank(&state), Some(ranks[at]), "by `{keys}`");
        let effects = press(&mut state, "Enter");
        assert!(matches!(effects[..], [Effect::Judge(_)]), "by `{keys}`: {effects:?}");
    }
    // A track without doubt: Enter goes to the first item.
    let mut state = start("track=2 frame=5");
    state.review.queue.set(TrackId(2), Vec::new());
    let effects = press(&mut state, "P q Enter");
    assert_eq!((rank(&state), effects), (state.review.queue.first().map(|item| item.rank()), Vec::new()));
}

#[test]
fn the_last_line_says_what_enter_does() {
    for (from, keys, word) in [
        ("frame=20", "", "open"),
        ("frame=20", "n", "accept"),
        ("frame=20", "P q", "open"),
        ("frame=20", "P q j", "accept"),
        ("frame=20 bare", "v k", "open"),
        ("frame=20 locked", "", ""),
        ("frame=20 locked", "n", ""),
        ("frame=20 empty", "", ""),
    ] {
        let mut state = start(from);
        press(&mut state, keys);
        assert_eq!(enter(&state), word, "from `{from}` by `{keys}`");
    }
    let mut state = start("frame=20");
    state.review = Default::default();
    assert_eq!(enter(&state), "key-frame");
    state.frame = 10;
    assert_eq!(enter(&state), "", "it is one already");
    state.frame = 75;
    assert_eq!(enter(&state), "", "it is lost there");
    crate::app::fixture::skeleton::show(&mut state);
    press(&mut state, "P s");
    assert_eq!(enter(&state), "shape");
}

/// The word beside Enter in the last line.
fn enter(state: &State) -> String {
    let frame = crate::app::view::draw(&State { size: (300, 24), ..state.clone() }, None);
    let row: String = (0..300).map(|x| frame.cells[(x, 23)].symbol().to_owned()).collect();
    row.split_once('⏎')
        .map_or_else(String::new, |(_, rest)| rest.split("  ").next().unwrap().trim().to_owned())
}
