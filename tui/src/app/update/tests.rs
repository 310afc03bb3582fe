//! What keys do: `(state, keys, state)`, through one door.

use super::*;
use crate::app::action::TABLE;
use crate::app::clock::Play;
use crate::app::correcting::Tool;
use crate::app::fixture::{self, press};
use crate::app::layout::{Layout, Lens};
use crate::app::state::Job;
use crate::app::update::Fact;
use crate::term::input::MouseKind;
use honami_model::track::{TrackId, TrackSet};
use honami_workbench::track::PointSource;

/// The state that a line of words describes, from the fixture: `frame=10 track=2 zoom=1 playing job …`.
pub(super) fn start(words: &str) -> State {
    let mut state = fixture::state();
    for word in words.split_whitespace() {
        let (name, value) = word.split_once('=').unwrap_or((word, "0"));
        let n = value.parse::<u32>().unwrap();
        match name {
            "frame" => state.frame = n,
            "track" => state.selected = Some(TrackId(n)),
            "zoom" => state.zoom = n as u8,
            "empty" => {
                state.tracks.clear();
                state.selected = None;
                state.groups = None;
                state.review = Default::default();
            }
            "locked" => state.read_only = Some("ada on lab2".to_owned()),
            "playing" => {
                state.play = Some(Play { rate: 1.0, since: state.now, from: state.frame, around: None })
            }
            "job" => {
                let (what, plugin) = ("frame".to_owned(), "klt".to_owned());
                let since = Duration::ZERO;
                let done = (10, 100);
                state.job = Some(Job {
                    plugin,
                    what,
                    done,
                    first: 0,
                    since,
                    keeps_frames: true,
                    is_stopping: false,
                    frame: Some(10),
                    quiet: None,
                });
            }
            "bare" => state.plugins.clear(),
            "versus" => fixture::versus(&mut state),
            _ => panic!("{word}?"),
        }
    }
    state
}

/// The state and the effects in one line.
pub(super) fn line(state: &State, effects: &[Effect]) -> String {
    let mut words = vec![match &state.mode {
        Mode::Review => "review".to_owned(),
        Mode::Place([x, y]) => format!("place {x} {y}"),
        Mode::Shape(shaping) => format!("shape {} {}", shaping.bone.name, shaping.shape),
        Mode::Root([x, y]) => format!("root {x} {y}"),
        Mode::Move(moving) => {
            let (from, to) = (moving.from, moving.to());
            let mut words = format!("move {} {}", to[0] - from[0], to[1] - from[1]);
            if let Tool::Slide(frames) = moving.tool {
                words = format!("slide {frames:.2}");
            }
            words
        }
        Mode::Sketch(sketching) => format!("sketch {}", sketching.strokes.len()),
        Mode::Paint(painting) => {
            let [x, y] = painting.at;
            let n = painting.strokes.len();
            format!("paint {} {} at {x} {y} strokes {n}", painting.word(), painting.radius_px)
        }
        Mode::Scale(scaling) => super::scale_tests::told(scaling),
        Mode::Form(form) => format!("form {:?} row {} typed {:?}", form.task, form.at, form.typed),
        Mode::Menu(menu) => {
            format!("menu {:?} of {}", menu.chosen().map(|r| r.label.as_str()), menu.rows().len())
        }
        Mode::Dial(_) => {
            format!(
                "dial {} at {:.0}",
                state.motion.dial_words().unwrap_or_default(),
                state.motion.full_px_s()
            )
        }
        Mode::History { at, .. } => format!("history row {at}"),
        Mode::Label(typed) => format!("label {typed}"),
        Mode::Prompt(typed) => format!("prompt {typed:?}"),
        Mode::Name(typed) => format!("name {typed:?}"),
        Mode::GroupName(typed) => format!("name of the group {typed:?}"),
    }];
    words.push(format!(
        "frame {} track {}",
        state.frame,
        state.selected.map_or("-".to_owned(), |t| t.to_string())
    ));
    words.extend(state.count.map(|n| format!("count {n}")));
    words.extend(state.play.map(|play| format!("play {}", play.rate)));
    words.extend(state.play.and_then(|play| play.around).map(|around| format!("loop {around}")));
    words.extend(
        state.notice.as_ref().map(|n| format!("{} {}", if n.is_error { "error" } else { "said" }, n.text)),
    );
    words.extend(effects.iter().map(|effect| match effect {
        Effect::Commit(transaction, _) => format!("commit {}", transaction.label),
        Effect::Track(TrackRequest { plugin, params, points, every, frames, .. }) => {
            let params: Vec<String> = params.iter().map(|(id, value)| format!("{id}={value}")).collect();
            let points = match points {
                PointSource::Tracks(tracks) => tracks.to_string(),
                other => format!("{other:?}"),
            };
            format!("{plugin} follows {points} in {frames:?}, every {every:?} {}", params.join(" "))
        }
        Effect::Judge(Judge { track, frames, verdict, effort, .. }) => {
            let (word, n) = (verdict.word(), effort.keystrokes);
            format!("track {track} {}-{} {word} with {n} keys", frames.start, frames.end - 1)
        }
        Effect::Correct(step, _) => format!("{step:?}"),
        Effect::Cluster(ClusterRequest { plugin, .. }) => format!("{plugin} groups"),
        other => format!("{other:?}"),
    }));
    words.join(" | ")
}

/// The one door.
#[track_caller]
pub(super) fn check(from: &str, keys: &str, expect: &str) {
    let mut state = start(from);
    let effects = press(&mut state, keys);
    assert_eq!(line(&state, &effects), expect, "from `{from}` by `{keys}`");
}

#[test]
fn moving_in_time() {
    for (from, keys, expect) in [
        ("", ".", "review | frame 1 track 1"),
        ("", "1 2 .", "review | frame 12 track 1"),
        ("frame=5", "3 ,", "review | frame 2 track 1"),
        ("", ",", "review | frame 0 track 1"),
        ("frame=50", ">", "review | frame 60 track 1"),
        ("frame=50", "2 <", "review | frame 30 track 1"),
        ("frame=50", "l l h Right Left", "review | frame 51 track 1"),
        ("frame=50", "g e", "review | frame 99 track 1"),
        ("frame=50", "Home", "review | frame 0 track 1"),
        ("", "4 2 g f", "review | frame 42 track 1"),
        ("", "g f 4 2 Enter", "review | frame 42 track 1"),
        ("frame=5", "g f 4 x Backspace 7 Esc", "review | frame 5 track 1"),
        ("", "5 0 0 g f", "review | frame 99 track 1 | said there is no frame 500: this is the last one, 99"),
        ("frame=20", "]", "review | frame 50 track 1"),
        ("frame=99", "2 [", "review | frame 10 track 1"),
        ("frame=60", "]", "review | frame 60 track 1 | said track 1: no key-frame after this"),
        (
            "",
            "w",
            "review | frame 70 track 1 | said track 1: frames 70-79, LOST (0.85), item 1 of 2 of the track",
        ),
        (
            "",
            "w w",
            "review | frame 40 track 1 | said track 1: frames 40-49, FB (0.25), item 2 of 2 of the track",
        ),
        (
            "",
            "w w w",
            "review | frame 70 track 1 | said track 1: frames 70-79, LOST (0.85), item 1 of 2 of the track",
        ),
        ("", "1 2 Esc", "review | frame 0 track 1"),
        ("", "1 2 F9", "review | frame 0 track 1"),
        ("", "g x", "review | frame 0 track 1"),
    ] {
        check(from, keys, expect);
    }
}

#[test]
fn playing() {
    check("", "space", "review | frame 0 track 1 | play 1");
    check("playing frame=3", "space", "review | frame 3 track 1");
    check("frame=9", "B", "review | frame 9 track 1 | play -1");
    check("playing", "Esc", "review | frame 0 track 1");
    check("playing", ".", "review | frame 1 track 1");
    check("frame=99", "space", "review | frame 0 track 1 | play 1");
    for (keys, expect) in [
        (";", "play 0.5"),
        ("'", "play -0.5"),
        ("; ;", ""),
        ("; '", "play -0.5"),
        ("space B", "play -1"),
        ("B B", ""),
        ("2 5 ; ; ;", "play 0.25"),
        ("2 5 ; '", "play -0.25"),
        ("2 5 ; space", "play 1"),
        ("2 0 0 space", "play 2"),
        ("2 0 0 space space B", "play -2"),
        ("5 0 0 0 space", "play 16 | error a rate is 1 to 1600 %, got 5000"),
    ] {
        check("frame=9", keys, format!("review | frame 9 track 1 | {expect}").trim_end_matches(" | "));
    }
    let mut state = start("frame=10");
    press(&mut state, "space");
    for (ms, frame) in [(39, 10), (41, 11), (400, 20), (10_000, 99)] {
        update(&mut state, Msg::Clock(Duration::from_millis(ms)));
        assert_eq!(state.frame, frame, "after {ms} ms");
    }
    assert_eq!(state.play, None, "the end stops it");
    press(&mut state, "B");
    for (ms, frame) in [(10_039, 99), (10_041, 98), (10_400, 89), (90_000, 0)] {
        update(&mut state, Msg::Clock(Duration::from_millis(ms)));
        assert_eq!(state.frame, frame, "backwards after {ms} ms");
    }
}

#[test]
fn looping() {
    for (keys, expect) in [
        ("b", "frame 20 track 1 | play 1 | loop 8"),
        ("b b", "frame 20 track 1"),
        ("b Esc", "frame 20 track 1"),
        ("1 2 b", "frame 20 track 1 | play 1 | loop 12"),
        ("1 2 b b b", "frame 20 track 1 | play 1 | loop 12"),
        ("b 3 b", "frame 20 track 1 | play 1 | loop 3"),
        ("b ;", "frame 20 track 1 | play 0.5 | loop 8"),
        ("; b", "frame 20 track 1 | play 0.5 | loop 8"),
        ("b . .", "frame 22 track 1 | play 1 | loop 8"),
        ("b g e", "frame 99 track 1 | play 1 | loop 8"),
    ] {
        check("frame=20", keys, &format!("review | {expect}"));
    }
    let mut state = start("frame=20");
    press(&mut state, "b");
    for (ms, shown) in [(0, 20), (41, 21), (321, 28), (361, 27), (950, 13), (990, 12), (1001, 13)] {
        update(&mut state, Msg::Clock(Duration::from_millis(ms)));
        assert_eq!((state.frame, state.shown_frame()), (20, shown), "after {ms} ms");
    }
    // Edits are of the frame round which it goes, and the work goes on there.
    let effects = press(&mut state, "*");
    assert!(line(&state, &effects).contains("commit track 1: key-frame at 20 (confirmed)"));
    press(&mut state, "m");
    assert_eq!((state.frame, state.shown_frame(), state.play), (20, 20, None));
}

#[test]
fn the_next_tick_shows_the_next_frame() {
    for keys in ["space", "B", "3 0 0 space", "3 3 B"] {
        let mut state = start("frame=50");
        press(&mut state, keys);
        let mut seen = vec![state.frame];
        while let Some(tick) = state.next_tick() {
            update(&mut state, Msg::Clock(tick));
            assert_ne!(seen.last(), Some(&state.frame), "{keys}: a tick without a frame");
            seen.push(state.frame);
        }
        assert_eq!(seen.len(), if keys.contains('B') { 51 } else { 50 }, "{keys}: every frame once");
    }
}

#[test]
fn selecting_tracks() {
    for (from, keys, expect) in [
        ("", "j", "review | frame 0 track 2"),
        ("", "k", "review | frame 0 track 7"),
        ("", "2 j", "review | frame 0 track 7"),
        ("", "S", "review | frame 0 track 1 | said tracks are listed by doubt, the worst first"),
        ("track=7", "S j", "review | frame 0 track 2"),
        ("track=1", "S j", "review | frame 0 track 7"),
        ("track=2", "S / Enter", "review | frame 0 track 1"),
        ("", "S S j", "review | frame 0 track 2"),
        ("", "j j k", "review | frame 0 track 2"),
        ("", "7 g t", "review | frame 0 track 7"),
        ("", "3 g t", "review | frame 0 track 1 | error there is no track 3"),
        ("", "/ 7 Enter", "review | frame 0 track 7"),
        ("track=7", "/ b u d Enter", "review | frame 0 track 1"),
        (
            "empty",
            "j",
            "review | frame 0 track - | error there are no tracks yet: t r follows features, a adds one by hand",
        ),
    ] {
        check(from, keys, expect);
    }
}

#[test]
fn the_queue() {
    let first = "review | frame 70 track 1";
    let second = "review | frame 70 track 7 | said track 7: frames 40-99, FB LOST (0.85)";
    for (from, keys, expect) in [
        ("", "n", &*format!("{first} | said track 1: frames 70-79, LOST (0.85)")),
        ("", "n n", second),
        ("", "2 n", second),
        ("", "n p", &format!("{first} | said this is the first item, the most doubtful")),
        ("", "9 n n", "review | frame 56 track 2 | said this was the last item; 4 are left, p goes back"),
        // A segment in which it is lost is accepted as lost.
        ("", "n Enter", &format!("{second} | track 1 70-79 lost with 1 keys")),
        ("", "n . , Enter", &format!("{second} | track 1 70-79 lost with 3 keys")),
        (
            "",
            "n n Enter",
            "review | frame 40 track 1 | said track 1: frames 40-49, FB (0.25) | track 7 40-99 accepted with 1 keys",
        ),
        ("", "n R", &format!("{second} | track 1 0-99 rejected with 1 keys")),
        ("", "n E", &format!("{second} | track 1 70-79 later with 1 keys")),
        // Another track is selected: the item is no longer the one that Enter speaks of.
        ("", "n j Enter", "review | frame 56 track 2 | said track 2: frames 40-59, FB (0.24)"),
        (
            "",
            "n . . w",
            &format!("{first} | said track 1: frames 70-79, LOST (0.85), item 1 of 2 of the track"),
        ),
        // The item that holds the frame is opened first, and then the track's others.
        (
            "frame=43",
            "w",
            "review | frame 40 track 1 | said track 1: frames 40-49, FB (0.25), item 2 of 2 of the track",
        ),
        (
            "frame=43",
            "w w",
            &format!("{first} | said track 1: frames 70-79, LOST (0.85), item 1 of 2 of the track"),
        ),
        // Enter opens what is doubtful and not open yet; `*` confirms, but nothing that is lost.
        (
            "frame=20",
            "Enter",
            &format!("{first} | said track 1: frames 70-79, LOST (0.85), item 1 of 2 of the track"),
        ),
        ("frame=75", "Enter Enter", &format!("{second} | track 1 70-79 lost with 1 keys")),
        (
            "frame=75",
            "*",
            "review | frame 75 track 1 | error track 1 is lost at frame 75: place it, or leave it so (m places it)",
        ),
        (
            "",
            "R",
            "review | frame 0 track 1 | error no item is open: w opens the selected track's, n the most doubtful",
        ),
        (
            "locked",
            "n Enter",
            &format!(
                "{first} | error read only: ada on lab2 holds this project; nothing can be changed here"
            ),
        ),
        ("frame=20", "|", "review | frame 30 track 1 | said half-way between 10 and 50"),
        ("frame=60", "|", "review | frame 74 track 1 | said half-way between 50 and 99"),
        (
            "empty",
            "n",
            "review | frame 0 track - | said there are no tracks yet: t r follows features, a adds one by hand",
        ),
        ("empty", "|", "review | frame 0 track - | error select a track first: j takes the next"),
    ] {
        check(from, keys, expect);
    }
}

#[test]
fn what_an_item_takes_is_counted_without_pauses() {
    let mut state = start("");
    let at = |state: &mut State, secs: u64, keys: &str| {
        update(state, Msg::Clock(Duration::from_secs(secs)));
        press(state, keys)
    };
    at(&mut state, 10, "n");
    at(&mut state, 14, ".");
    // Two minutes at the coffee machine.
    at(&mut state, 134, ",");
    // The world answers the correction: frame 75 has become a key-frame.
    let row = &mut state.tracks[0];
    let mut span = (*row.span).clone();
    span.samples[75].source = honami_model::track::Source::Key;
    span.samples[75].status = honami_model::track::Status::Tracked;
    *row = crate::app::tracks::TrackRow::new(row.id, row.name.clone(), span.into());
    let effects = at(&mut state, 137, "Enter");
    let [Effect::Judge(found)] = &effects[..] else { panic!("{effects:?}") };
    assert_eq!((found.track, found.frames.clone(), found.verdict.word()), (TrackId(1), 70..80, "fixed"));
    assert_eq!((found.effort.keystrokes, found.effort.key_frames), (3, 1));
    assert!((found.effort.seconds - 7.0).abs() < 1e-3, "{:?}", found.effort);
    assert_eq!(found.reasons, ["LOST"]);
    // It has left at once.
    assert!(state.review.queue.of_track(TrackId(1)).all(|item| item.frames.start != 70));
}

#[test]
fn editing() {
    let sway = "review | frame 20 track 1";
    for (from, keys, expect) in [
        ("frame=20", "m", "move 0 0 | frame 20 track 1"),
        ("frame=20", "m l l k", "move 2 -1 | frame 20 track 1"),
        ("frame=20", "m 5 l H", "move 4.75 0 | frame 20 track 1"),
        ("frame=20", "m l Enter", &format!("{sway} | commit track 1: frames 11-49 corrected, up to 1.0 px")),
        ("frame=20", "m l Esc", sway),
        ("frame=20", "m l q", sway),
        (
            "frame=80 track=2",
            "m Enter",
            "review | frame 80 track 2 | commit track 2: key-frame at 80 (placed at 66.1, 120.0)",
        ),
        ("frame=20", "*", &format!("{sway} | commit track 1: key-frame at 20 (confirmed)")),
        ("frame=50", "*", "review | frame 50 track 1 | said track 1: frame 50 is a key-frame already"),
        ("frame=50", "X", "review | frame 50 track 1 | commit track 1: key-frame at 50 cleared"),
        (
            "frame=20",
            "X",
            &format!("{sway} | error no key-frame of the selected track is here; [ and ] go to them"),
        ),
        ("", "d d", "review | frame 0 track 2 | commit track 1 deleted"),
        ("track=7", "d d", "review | frame 0 track 2 | commit track 7 deleted"),
        ("", "a", "place 160 120 | frame 0 track 1"),
        ("", "a 1 0 h J Enter", "review | frame 0 track 1 | AddFeature { frame: 0, at: [150.0, 120.25] }"),
        ("", "a 9 9 9 h Enter", "review | frame 0 track 1 | AddFeature { frame: 0, at: [0.0, 120.0] }"),
        ("frame=50", "Backspace", "review | frame 50 track 1"),
        ("", "u", "review | frame 0 track 1 | Undo(1)"),
        ("", "2 Ctrl-r", "review | frame 0 track 1 | Redo(2)"),
        ("", "+", "review | frame 0 track 1 | commit cut into 3 groups"),
        ("", "9 +", "review | frame 0 track 1 | commit cut into 3 groups"),
        ("", "-", "review | frame 0 track 1 | commit cut into 1 group"),
        ("empty", "+", "review | frame 0 track - | error there is no hierarchy to cut; c groups the tracks"),
        (
            "empty",
            "m",
            "review | frame 0 track - | error select a track first: j takes the next, a click takes the nearest",
        ),
        (
            "locked",
            "d d",
            "review | frame 0 track 1 | error read only: ada on lab2 holds this project; nothing can be changed here",
        ),
    ] {
        check(from, keys, expect);
    }
}

#[test]
fn every_edit_is_refused_in_a_locked_project() {
    for keys in ["m", "a", "d d", "Enter", "X", "u", "Ctrl-r", "+", "-", "t t", "t f", "t b", "t r", "c"] {
        let mut state = start("locked frame=50");
        let effects = press(&mut state, keys);
        assert!(effects.is_empty() && matches!(state.mode, Mode::Review), "{keys}: {effects:?}");
        assert!(state.notice.is_some_and(|n| n.is_error && n.text.contains("ada on lab2")), "{keys}");
    }
}

#[test]
fn tracking_again() {
    let within = |frame: u32, track: u32, way: &str, within: &str| {
        format!(
            "review | frame {frame} track {track} | Retrack {{ track: TrackId({track}), way: {way}, frame: {frame}, within: {within} }}"
        )
    };
    let retrack = |frame, track, way| within(frame, track, way, "None");
    for (from, keys, expect) in [
        ("frame=20", "r 3 . r 2 , t t", within(21, 1, "Both", "Some(20..24)")),
        ("frame=20", "r 3 . t b", within(23, 1, "Backward", "Some(20..24)")),
        ("frame=20", "t t", retrack(20, 1, "Both")),
        ("frame=20", "t f", retrack(20, 1, "Forward")),
        ("frame=20", "t b", retrack(20, 1, "Backward")),
        (
            "empty",
            "t t",
            "review | frame 0 track - | error select a track first: j takes the next, a click takes the nearest".to_owned(),
        ),
        (
            "job",
            "t f",
            "review | frame 0 track 1 | error klt is still running: wait for it, or stop it with Esc"
                .to_owned(),
        ),
    ] {
        check(from, keys, &expect);
    }
}

#[test]
fn forms() {
    let klt = |points: &str, every: &str, params: &str| {
        format!("review | frame 0 track 1 | klt follows {points} in 0..100, every {every} {params}")
    };
    let params = "check=true expire=0.55 label=none motion=translation radius=10";
    let with_radius = |px: u32| params.replace("radius=10", &format!("radius={px}"));
    let unchecked = params.replace("check=true", "check=false");
    for (from, keys, expect) in [
        ("", "t r", "form Track row 0 typed None | frame 0 track 1"),
        ("", "t r Esc", "review | frame 0 track 1"),
        ("", "t r Enter", &klt("Existing", "None", params)),
        ("", "t r j l Enter", &klt("track 1", "None", params)),
        ("", "t r j l l Enter", &klt("Detect", "None", params)),
        ("", "t r j h j l l Enter", &klt("Detect", "Some(10)", params)),
        ("empty", "t r Enter", &klt("Detect", "None", params).replace("track 1", "track -")),
        ("", "t r j j j l l Enter", &klt("Existing", "None", &with_radius(12))),
        ("", "t r j j j 2 5 Enter Enter", &klt("Existing", "None", &with_radius(25))),
        ("", "t r j j j j j l k l l Enter", &klt("Existing", "None", &unchecked)),
        ("", "t r j j j j j j j j j k", "form Track row 6 typed None | frame 0 track 1"),
        (
            "",
            "t r j j j 9 9 Enter",
            "form Track row 3 typed Some(\"99\") | frame 0 track 1 | error radius: wanted a whole number, 2 to 50 (px), got \"99\"",
        ),
        ("", "t r j j j 9 9 Esc Esc", "review | frame 0 track 1"),
        ("", "t r l Enter", "review | frame 0 track 1 | flow follows Existing in 0..100, every None "),
        (
            "",
            "t r j j 3 0 - 1 2 0 Enter",
            "form Track row 2 typed Some(\"30-120\") | frame 0 track 1 | error frames: wanted the first and the last, of 0-99, got \"30-120\"",
        ),
        ("", "t r j j 3 0 - 4 0 Enter Enter", &klt("Existing", "None", params).replace("0..100", "30..41")),
        (
            "frame=8",
            "r 9 . r t r Enter",
            &klt("Existing", "None", params).replace("0..100", "8..18").replace("frame 0", "frame 17"),
        ),
        ("", "c Enter", "review | frame 0 track 1 | movement groups"),
        (
            "job",
            "t r Enter",
            "form Track row 0 typed None | frame 0 track 1 | error klt is still running: wait for it, or stop it with Esc while reviewing",
        ),
        (
            "bare",
            "t r",
            "review | frame 0 track 1 | error no tracker was found; `honami doctor` says where tracker-anchored is looked for",
        ),
        (
            "empty",
            "c",
            "review | frame 0 track - | error two tracks or more can be grouped; t r follows features first",
        ),
    ] {
        check(from, keys, expect);
    }
}

#[test]
fn a_run_after_work_by_hand_is_for_that_track() {
    let followed = |state: &mut State| match &press(state, "t r Enter")[..] {
        [Effect::Track(request)] => request.points.clone(),
        other => panic!("{other:?}"),
    };
    let only = |track| PointSource::Tracks(TrackSet::from(TrackId(track)));
    let mut state = start("frame=20");
    press(&mut state, "m l Enter");
    assert_eq!(followed(&mut state), only(1));
    assert_eq!(followed(&mut state), PointSource::Existing, "the run was for it; the next is not");
    press(&mut state, "m l Enter u");
    assert_eq!(followed(&mut state), PointSource::Existing, "it was undone");
    press(&mut state, "m l Enter j");
    assert_eq!(followed(&mut state), PointSource::Existing, "another is selected");
    update(&mut state, Msg::Fact(Fact::Placed(TrackId(7))));
    assert_eq!(followed(&mut state), only(7));
}

#[test]
fn a_text_is_typed_with_every_letter() {
    let mut state = start("");
    press(&mut state, "t r j j j j j j");
    press(&mut state, "l Backspace Backspace Backspace Backspace q h j k l Enter");
    let effects = press(&mut state, "Enter");
    assert!(line(&state, &effects).contains("label=qhjkl"), "{}", line(&state, &effects));
}

#[test]
fn menus_do_what_they_say() {
    let n_review = TABLE.iter().filter(|i| i.action.word_in(Context::Review).is_some()).count();
    check("", ":", &format!("menu Some(\"left\") of {n_review} | frame 0 track 1"));
    check("", ": u n d o Enter", "review | frame 0 track 1 | Undo(1)");
    check("", ": q q", "menu None of 0 | frame 0 track 1");
    check("", ": q q Enter", "review | frame 0 track 1");
    check(
        "frame=20",
        "m l : z o o m Enter Enter",
        "review | frame 20 track 1 | commit track 1: frames 11-49 corrected, up to 1.0 px",
    );
    check("frame=20", "m ? Esc", "move 0 0 | frame 20 track 1");
    check("", "? Down Down Up Enter", "review | frame 0 track 2");
}

/// The fixture's track 1 has key-frames at 10 and 50 and a run below; 40 ms a frame.
#[test]
fn a_correction_is_seen_before_it_is_kept() {
    let kept = |frames: &str| format!("review | frame 20 track 1 | commit track 1: frames {frames}");
    for (from, keys, expect) in [
        // What becomes of the samples beside it: Tab offers the next model.
        ("frame=20", "m l Tab Tab Enter", kept("11-49 drawn through key-frames, up to 38.8 px")),
        (
            "frame=20",
            "m l Tab Tab Tab Tab Tab Enter",
            kept("20").replace("frames 20", "key-frame at 20 (moved 1.0 px)"),
        ),
        ("frame=20", "m l Tab Tab Tab Tab Tab Tab Enter", kept("11-49 corrected, up to 1.0 px")),
        // Nudges are smaller the closer one looks.
        ("frame=20 zoom=2", "m 2 l H", "move 0.4375 0 | frame 20 track 1".to_owned()),
        ("frame=20", "m Ctrl-Right 5 Ctrl-Up", "move 0.10000038 -0.5 | frame 20 track 1".to_owned()),
        // Other frames are looked at meanwhile; it is kept where it was begun.
        ("frame=20", "m l 5 .", "move 1 0 | frame 25 track 1".to_owned()),
        ("frame=20", "m l ] Enter", kept("11-49 corrected, up to 1.0 px")),
        // A sample of the path becomes a key-frame without leaving the frame.
        (
            "frame=20",
            "m l 5 ) *",
            "move 1 0 | frame 20 track 1 | said frame 25 becomes a key-frame as it is: the correction ends there"
                .to_owned(),
        ),
        ("frame=20", "m l 5 ) * 9 ( * Enter", kept("16-25 corrected, up to 1.0 px")),
        ("frame=20", "m l 5 ) * * Enter", kept("11-49 corrected, up to 1.0 px")),
        ("frame=20", "m l 5 . * Enter", kept("11-25 corrected, up to 1.0 px")),
        (
            "frame=20",
            "m l 3 0 ) *",
            "move 1 0 | frame 20 track 1 | said frame 50 is a key-frame already: corrections end there"
                .to_owned(),
        ),
        // Along the path: h and l by frames, H and L by quarters; never so far that samples change their order.
        ("frame=20", "T 2 l H", "slide 1.75 | frame 20 track 1".to_owned()),
        ("frame=20", "T 9 9 h", "slide -9.50 | frame 20 track 1".to_owned()),
        ("frame=20", "T 2 l H Enter", kept("11-49 shifted in time, up to 4.6 px")),
        ("frame=20", "T l Esc", "review | frame 20 track 1".to_owned()),
        (
            "frame=80 track=2",
            "T",
            "review | frame 80 track 2 | error track 2 has no sample at 80: there is nothing to slide".to_owned(),
        ),
    ] {
        check(from, keys, &expect);
    }
}

#[test]
fn finding_by_letters_and_in_lists() {
    for (keys, expect) in [
        ("g l", "label  | frame 20 track 1"),
        ("g l j", "review | frame 20 track 7 | said track 7 is selected"),
        ("g l z", "review | frame 20 track 1 | error no track here has the letters z"),
        ("g l Esc", "review | frame 20 track 1"),
        ("g k Down Enter", "review | frame 50 track 1"),
        ("g p m o v Enter", "form Cluster row 0 typed None | frame 20 track 1"),
        ("g p f l o Enter", "form Track row 0 typed None | frame 20 track 1"),
        ("v m", "review | frame 20 track 1 | said the mouse is the terminal's | Mouse(false)"),
    ] {
        check("frame=20", keys, expect);
    }
}

#[test]
fn going_about_in_the_undo_tree() {
    for (keys, expect) in [
        ("U", "history row 1 | frame 0 track 1"),
        ("U k Enter", "history row 0 | frame 0 track 1 | Jump(EntryId(4))"),
        ("U 9 j Enter", "history row 4 | frame 0 track 1 | Jump(EntryId(0))"),
        ("U j Esc", "review | frame 0 track 1"),
        ("U U", "review | frame 0 track 1"),
    ] {
        check("", keys, expect);
    }
}

#[test]
fn leaving_and_stopping() {
    check("", "q", "review | frame 0 track 1 | Leave");
    check("", "Q", "review | frame 0 track 1 | Leave");
    for (keys, place, asks) in [
        ("m l", "move 1 0", "a move is not kept: Enter keeps, Esc drops, Q again leaves"),
        ("s .", "sketch 1", "a sketch is not kept: Enter keeps, Esc drops, Q again leaves"),
        (
            "t r",
            "form Track row 0 typed None",
            "a form has not been run: Enter runs, Esc drops, Q again leaves",
        ),
    ] {
        let press = |more: &str| {
            let mut state = start("");
            let effects = press(&mut state, &format!("{keys} {more}"));
            let [place, said] = [line(&state, &[]), state.notice.map_or_else(String::new, |n| n.text)];
            (place.split(" | ").next().unwrap().to_owned(), said, effects == [Effect::Leave])
        };
        let asked = (place.to_owned(), asks.to_owned(), false);
        assert_eq!(press("Q"), asked, "{keys}");
        assert_eq!(press("Q Q"), (place.to_owned(), String::new(), true), "{keys}");
        assert_eq!(press("Q Ctrl-l Q"), asked, "{keys}: something else was done between");
    }
    check("", "m Q", "move 0 0 | frame 0 track 1 | Leave");
    check("", "t r q", "review | frame 0 track 1");
    check("job", "Esc Esc", "review | frame 0 track 1 | StopJob");
    check("", "Ctrl-l Ctrl-z", "review | frame 0 track 1 | Redraw | Suspend");
}

#[test]
fn the_mouse() {
    // In 80x24 the picture of 320x240 is 54 cells wide from column 13, 6 px a cell; rows 1 to 20, 12 px each.
    let mut state = start("");
    let mut mouse = |kind, column, row| update(&mut state, Msg::Mouse(Mouse { kind, column, row }));
    mouse(MouseKind::Press(0), 26, 10);
    mouse(MouseKind::WheelDown, 26, 22);
    assert_eq!((state.selected, state.frame), (Some(TrackId(2)), 1));
    let mut state = start("");
    update(&mut state, Msg::Mouse(Mouse { kind: MouseKind::Press(0), column: 77, row: 22 }));
    assert_eq!(state.frame, 99, "the end of the time line");
    press(&mut state, "a");
    update(&mut state, Msg::Mouse(Mouse { kind: MouseKind::Press(0), column: 40, row: 11 }));
    let Mode::Place(at) = state.mode else { panic!("not placing") };
    assert!((at[0] - 162.0).abs() < 6.0 && (at[1] - 126.0).abs() < 12.0, "{at:?}");
}

/// Looking elsewhere: what is seen after keys, as magnification and the image point in the middle.
#[test]
fn looking() {
    // 320x240 in 80x24: 6 px a cell; 3, 1.5, then whole cells for each pixel: 1, 2, 4 and 8.
    for (keys, times, middle) in [
        ("", 0.17, [159.5, 119.5]),
        ("z", 0.33, [119.5, 119.5]),
        ("z z z", 1.0, [40.5, 120.5]),
        ("5 z", 4.0, [40.0, 120.0]),
        ("9 z", 8.0, [40.0, 120.0]),
        ("9 z Z", 4.0, [40.0, 120.0]),
        ("9 z 9 Z", 0.17, [159.5, 119.5]),
        ("5 z Ctrl-Right", 4.0, [45.0, 120.0]),
        ("5 z 4 Ctrl-Right Ctrl-Down", 4.0, [60.0, 122.5]),
        ("5 z 4 Ctrl-Right C", 4.0, [40.0, 120.0]),
        ("5 z 9 9 9 Ctrl-Left 9 9 9 Ctrl-Up", 4.0, [9.5, 4.5]),
        ("5 z 9 9 9 Ctrl-Left 9 9 9 Ctrl-Up Ctrl-Right", 4.0, [14.5, 4.5]),
        ("C", 0.33, [119.5, 119.5]),
        ("Ctrl-Right", 0.17, [159.5, 119.5]),
    ] {
        let mut state = start("");
        press(&mut state, keys);
        let lens = Lens::of(&state, Layout::of(&state).picture);
        let seen = (format!("{:.2}", lens.magnification()), lens.middle());
        assert_eq!(seen, (format!("{times:.2}"), middle), "by `{keys}`");
    }
    check("", "Ctrl-Right", "review | frame 0 track 1 | said all of the picture is seen: z looks closer");
    check("", "9 z z", "review | frame 0 track 1 | said as close as it gets: 8 cells a pixel");
}

#[test]
fn the_wheel_and_dragging_keep_the_point_under_the_mouse() {
    let mut state = start("");
    let under = |state: &State, column, row| {
        Lens::of(state, Layout::of(state).picture).point_of(column, row).unwrap()
    };
    let event = |state: &mut State, kind, column, row| {
        update(state, Msg::Mouse(Mouse { kind, column, row }));
    };
    let point = under(&state, 40, 10);
    for n in 1..=6 {
        event(&mut state, MouseKind::WheelUp, 40, 10);
        let now = under(&state, 40, 10);
        let far = (now[0] - point[0]).hypot(now[1] - point[1]);
        assert!(far <= 6.0, "{now:?} after {n} steps");
    }
    press(&mut state, "f");
    let before = under(&state, 40, 10);
    event(&mut state, MouseKind::Press(1), 40, 10);
    event(&mut state, MouseKind::Drag(1), 36, 12);
    let far = (0..2).map(|axis| (under(&state, 36, 12)[axis] - before[axis]).abs()).fold(0.0, f32::max);
    assert!(far < 1e-3, "moved {far} px");
    assert!(!state.follow, "dragging ends it");
}

#[test]
fn deleting_what_was_selected_selects_another() {
    let mut state = start("");
    let rows = state.tracks[1..].to_vec();
    update(&mut state, Msg::Fact(Fact::Tracks(rows)));
    assert_eq!(state.selected, Some(TrackId(2)));
    update(&mut state, Msg::Fact(Fact::Tracks(Vec::new())));
    assert_eq!(state.selected, None);
}

#[test]
fn a_paste_is_typed_at_once_as_far_as_there_is_room() {
    let long = "un\tdo ".repeat(1000);
    for (keys, text, expect) in [
        (":", " undo\n", "menu Some(\"undo\") of 4 | frame 0 track 1"),
        (":", &long, "menu None of 0 | frame 0 track 1"),
        ("g f", "frame 42", "prompt \"42\" | frame 0 track 1"),
        ("g f", "12345678901234", "prompt \"123456789\" | frame 0 track 1"),
        ("", "4 2", "review | frame 0 track 1 | count 2"),
    ] {
        let mut state = start("");
        press(&mut state, keys);
        let effects = update(&mut state, Msg::Paste(text.to_owned()));
        assert_eq!(line(&state, &effects), expect, "{keys} and {text:.20}");
        if let Mode::Menu(menu) = &state.mode {
            assert!(menu.typed.chars().count() <= TYPED_MAX && !menu.typed.contains(char::is_control));
        }
    }
}
