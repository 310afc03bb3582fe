//! The terminal and the viewer's window in step: who tells what, and never back what was said.

use honami_workbench::scene::control::{self, Command, Event, Garbled};

use super::tests::{line, start};
use super::{Effect, Fact, Msg, State, update};
use crate::app::command_log::What;
use crate::app::fixture;
use crate::app::tracks::TrackRow;
use crate::viewer::Heard;

const READY: &str = r#"<{"ready":{"protocol":1,"adapter":"lavapipe"}}"#;

fn hear(state: &mut State, heard: Heard) -> Vec<Effect> {
    update(state, Msg::Fact(Fact::Window(heard)))
}

/// Does word after word: keys, `at:SECONDS` of the clock, and `<EVENT` of the window. Returns what is asked for, a word each:
/// `>COMMAND` to the window.
fn script(state: &mut State, words: &str) -> Vec<String> {
    let word = |effect: Effect| match effect {
        Effect::Tell(command) => format!(">{}", control::line(&command).trim_end()),
        Effect::Edit(asked, hint) => format!("edit {} ({hint})", control::line(&asked).trim_end()),
        other => format!("{other:?}"),
    };
    let mut asked = Vec::new();
    for said in words.split_whitespace() {
        let effects = match said.strip_prefix('<') {
            Some(event) => hear(state, Heard::Said(control::event(event).unwrap())),
            None => fixture::send(state, fixture::msg(said)),
        };
        asked.extend(effects.into_iter().map(word));
    }
    asked
}

/// A state with an open window.
fn opened(from: &str) -> State {
    let mut state = start(from);
    assert_eq!(script(&mut state, "v w"), ["OpenWindow"], "from {from}");
    script(&mut state, READY);
    state.notice = None;
    state
}

#[test]
fn a_window_is_opened_and_closed() {
    for (from, words, asked, said) in [
        ("", "v w", "OpenWindow", "said opening the viewer's window …"),
        // It is told where the terminal is once it is there, and nothing before.
        ("frame=5", "v w . j", "OpenWindow", ""),
        (
            "frame=5",
            &format!("v w . j {READY}"),
            r#"OpenWindow >{"frame":6} >{"select":{"track":2}}"#,
            "said the viewer's window is open, drawn by lavapipe",
        ),
        ("", "v w v w", "OpenWindow CloseWindow", "said the viewer's window is closed"),
        ("", &format!("v w v w {READY}"), "OpenWindow CloseWindow", "said the viewer's window is closed"),
        (
            "",
            &format!("v w {READY} v w v w"),
            "OpenWindow >{\"frame\":0} >{\"select\":{\"track\":1}} CloseWindow OpenWindow",
            "said opening the viewer's window …",
        ),
        (
            "empty",
            "v w",
            "",
            "error the window shows a skeleton, which grows from groups: c groups the tracks",
        ),
        ("", r#"v w <{"ready":{"protocol":7,"adapter":"x"}} ."#, "OpenWindow CloseWindow", ""),
        ("locked", "v w", "OpenWindow", "said opening the viewer's window …"),
        // Without one nothing is told, shown or heard.
        ("", ". j -", "", ""),
        ("", r#"<{"frame":9} <"undo""#, "", ""),
    ] {
        let mut state = start(from);
        let got = script(&mut state, words).into_iter().filter(|word| !word.starts_with("Commit"));
        assert_eq!(got.collect::<Vec<_>>().join(" "), asked, "from `{from}` by `{words}`");
        let is = line(&state, &[]);
        assert!(said.is_empty() || is.ends_with(said), "from `{from}` by `{words}`: {is}");
    }
}

/// How it ends is said, the terminal goes on, and the next one is another.
#[test]
fn ends_are_said() {
    for (heard, said) in [
        (Heard::Ended(None), "said the viewer's window was closed"),
        (
            Heard::Ended(Some("the viewer crashed, by signal 9".to_owned())),
            "error the viewer crashed, by signal 9",
        ),
        (
            Heard::Said(Event::Ready { protocol: 2, adapter: String::new() }),
            "error the viewer is of another version of honami: build both anew",
        ),
    ] {
        let mut state = opened("");
        let asked = hear(&mut state, heard.clone());
        assert_eq!(asked, [Effect::CloseWindow], "{heard:?}");
        assert_eq!(line(&state, &[]), format!("review | frame 0 track 1 | {said}"));
        assert_eq!(script(&mut state, ". j"), [""; 0], "nobody is told");
        assert_eq!(script(&mut state, "v w"), ["OpenWindow"]);
    }
    // What is wrong and no end is said, too.
    for (heard, said) in [
        (Heard::Said(Event::Failed("no room".to_owned())), "error the viewer: no room"),
        (
            Heard::Garbled(Garbled { why: "cut".to_owned(), line: "{".to_owned() }),
            "error the viewer: a line of the control pipe says nothing: cut: {",
        ),
    ] {
        let mut state = opened("");
        assert_eq!(hear(&mut state, heard), []);
        assert_eq!(line(&state, &[]), format!("review | frame 0 track 1 | {said}"));
        assert_eq!(script(&mut state, "."), [r#">{"frame":1}"#]);
    }
}

/// Each: what is done in the terminal and (`<`) in the window, what the window is told, and where the terminal is then.
#[test]
fn time_goes_both_ways_and_no_word_comes_back() {
    for (words, told, at) in [
        (".", r#">{"frame":1}"#, "frame 1"),
        ("g e", r#">{"frame":99}"#, "frame 99"),
        ("z M", "", "frame 0"),
        // The window goes somewhere: the terminal follows and says nothing; then it goes on from there.
        (r#"<{"frame":40}"#, "", "frame 40"),
        (r#"<{"frame":40} <{"frame":41} ."#, r#">{"frame":42}"#, "frame 42"),
        (r#"<{"frame":40} at:1 at:2"#, "", "frame 40"),
        // The terminal plays: the window follows frame by frame, and a frame that is the same is told once.
        ("space at:0.04 at:0.05 at:0.08", r#">{"frame":1} >{"frame":2}"#, "frame 2"),
        // The window plays: the terminal follows; where it was stopped it stays.
        (
            r#"<{"playing":true} <{"passing":3} at:1 <{"passing":7} <{"playing":false} <{"frame":7}"#,
            "",
            "frame 7",
        ),
        // What was on its way before it was stopped from here is not followed.
        (r#"<{"playing":true} <{"passing":3} . <{"passing":4}"#, r#">"pause" >{"frame":4}"#, "frame 4"),
        (r#"<{"playing":true} <{"passing":3} , <{"passing":4}"#, r#">"pause" >{"frame":2}"#, "frame 2"),
        (r#"<{"passing":4}"#, "", "frame 0"),
        // Whoever began last leads.
        (r#"space at:0.04 <{"playing":true} <{"passing":9} at:0.4"#, r#">{"frame":1}"#, "frame 9"),
        (r#"space at:0.04 <{"frame":9} at:0.4"#, r#">{"frame":1}"#, "frame 9"),
        (
            r#"<{"playing":true} <{"passing":3} space <{"passing":4} at:0.04"#,
            r#">"pause" >{"frame":4}"#,
            "frame 4 track 1 | play 1",
        ),
        // A loop goes on round where the window went.
        (r#"2 0 . 1 b <{"frame":50}"#, r#">{"frame":20}"#, "frame 50 track 1 | play 1 | loop 1"),
        // What is open in a frame stays in it.
        (r#"a <{"frame":40}"#, "", "frame 0"),
        (r#"s <{"playing":true} <{"passing":4}"#, "", "frame 0"),
        (r#"<{"frame":4000}"#, "", "frame 99"),
    ] {
        let mut state = opened("");
        assert_eq!(script(&mut state, words).join(" "), told, "by `{words}`");
        let is = line(&state, &[]);
        assert!(format!("{is} | ").contains(&format!("{at} ")), "by `{words}`: {is}");
        // Whatever it was, both are in step now.
        let now = state.now;
        assert_eq!(update(&mut state, Msg::Clock(now)), [], "by `{words}`");
    }
}

#[test]
fn what_is_chosen_goes_both_ways_and_no_word_comes_back() {
    for (words, told, track, bone) in [
        ("j", r#">{"select":{"track":2}}"#, "2", None),
        ("j k", r#">{"select":{"track":2}} >{"select":{"track":1}}"#, "1", None),
        // Where bones are listed it is a bone.
        ("P s j", r#">{"select":{"bone":2}}"#, "1", Some(2)),
        ("P s j P s", r#">{"select":{"bone":2}} >{"select":{"track":1}}"#, "1", Some(2)),
        // A bone that is chosen in the window is chosen here, by a track of its group where bones are not listed.
        (r#"<{"selected":{"bone":3}}"#, "", "1", Some(3)),
        (r#"<{"selected":{"bone":2}}"#, "", "7", Some(2)),
        (r#"<{"selected":{"bone":4}}"#, "", "1", Some(4)),
        (r#"P s <{"selected":{"bone":2}}"#, "", "1", Some(2)),
        (r#"P s <{"selected":{"bone":2}} k"#, r#">{"select":{"bone":3}}"#, "1", Some(3)),
        (r#"<{"selected":{"bone":2}} j"#, r#">{"select":{"track":1}}"#, "1", Some(2)),
        (r#"<{"selected":{"track":2}}"#, "", "2", None),
        (r#"<{"selected":{"track":5}}"#, "", "1", None),
        (r#"<{"selected":{"bone":2}} <{"selected":null}"#, "", "7", None),
        (r#"m <{"selected":{"bone":2}}"#, "", "1", None),
    ] {
        let mut state = opened("");
        fixture::skeleton::show(&mut state);
        assert_eq!(script(&mut state, words).join(" "), told, "by `{words}`");
        assert_eq!(state.selected.unwrap().to_string(), track, "by `{words}`");
        assert_eq!(state.skeleton.chosen, bone, "by `{words}`");
    }
    // Shaped in the terminal, the bone that `G b` took is the window's, too.
    let mut state = opened("");
    fixture::skeleton::show(&mut state);
    assert_eq!(script(&mut state, "G b"), [r#">{"select":{"bone":3}}"#]);
    assert_eq!(script(&mut state, "Esc"), [r#">{"select":{"track":1}}"#]);
}

#[test]
fn what_the_window_asks_for_is_an_edit() {
    let shape = r#"{"shape":{"node":3,"plane_deg":30.0,"lean_deg":0.0,"gain":1.0}}"#;
    for (from, open, event, asked, is) in [
        ("", "", shape, "ShowWindow|edit EVENT (u undoes)", ""),
        ("", "", r#"{"root":[12.5,3.0]}"#, "edit EVENT (u undoes)|ShowWindow", ""),
        ("", "", r#"{"root":null}"#, "edit EVENT (u undoes)|ShowWindow", ""),
        ("", "", r#"{"cut":3}"#, "edit EVENT (u undoes)|ShowWindow", ""),
        ("", "", r#""undo""#, "edit EVENT (u undoes)|ShowWindow", ""),
        // A count that is being typed is the terminal's.
        ("", "3", r#""redo""#, "edit EVENT (u undoes)|ShowWindow", " | count 3"),
        (
            "locked",
            "",
            r#"{"cut":3}"#,
            r#">{"say":"read only: ada on lab2 holds this project; nothing can be changed here"}"#,
            " | error read only: ada on lab2 holds this project; nothing can be changed here",
        ),
        (
            "",
            "g f",
            r#""undo""#,
            r#">{"say":"something is open in the terminal: Enter keeps it, Esc drops it, then the window goes on"}"#,
            " | error something is open in the terminal: Enter keeps it, Esc drops it, then the window goes on",
        ),
    ] {
        let mut state = opened(from);
        script(&mut state, open);
        let got = script(&mut state, &format!("<{event}"));
        let mut wanted: Vec<String> = asked.split('|').map(|word| word.replace("EVENT", event)).collect();
        let mut sorted = got.clone();
        sorted.sort();
        wanted.sort();
        assert_eq!(sorted, wanted, "{event} from `{from}`");
        // It is committed before it is shown.
        assert!(got[0].starts_with("edit") || got.len() == 1, "{got:?}");
        assert!(line(&state, &[]).ends_with(&format!("frame 0 track 1{is}")), "{}", line(&state, &[]));
        // The log can do it again, without a window.
        let logged = state.log.lines().iter().rev().find(|line| matches!(line.what, What::Window(_)));
        let logged = logged.expect("it is in the log").clone();
        if open.is_empty() {
            let mut anew = start(from);
            let effects = super::again(&mut anew, &logged).unwrap();
            let edit = |effect: &Effect| matches!(effect, Effect::Edit(..));
            assert_eq!(effects.iter().filter(|effect| edit(effect)).count(), effects.len(), "no window");
            assert_eq!(effects.len(), usize::from(from.is_empty()));
        }
    }
    // What is refused puts nothing back that was given up for something else before.
    let mut state = opened("");
    script(&mut state, "d d");
    script(&mut state, r#". . <"undo""#);
    drop(update(&mut state, Msg::Fact(Fact::Refused)));
    assert_eq!(state.frame, 2);
}

/// What the skeleton grows from and how it is shaped is shown once; what is none of this is not.
#[test]
fn the_window_is_shown_what_changes() {
    let mut state = opened("");
    let (tracks, groups) = (state.tracks.clone(), state.groups.clone());
    let moved = |row: &TrackRow| TrackRow::new(row.id, None, std::sync::Arc::new((*row.span).clone()));
    let hand = crate::app::skeleton::Hand { root: Some([1.0, 2.0]), ..Default::default() };
    for (fact, is_shown) in [
        (Fact::Tracks(tracks.clone()), false),
        (Fact::Groups(groups.map(Box::new)), false),
        (Fact::Groups(Some(Box::new(fixture::groups(3)))), true),
        (Fact::Tracks(tracks.iter().map(moved).collect()), true),
        (Fact::Hand(hand.clone()), true),
        (Fact::Hand(hand), false),
        (Fact::Ready(3), false),
        (Fact::Groups(None), false),
    ] {
        let told = format!("{fact:?}");
        let asked = update(&mut state, Msg::Fact(fact));
        assert_eq!(asked.contains(&Effect::ShowWindow), is_shown, "{told}");
    }
    drop(update(&mut state, Msg::Fact(Fact::Groups(Some(Box::new(fixture::groups(2)))))));
    // Without groups there is nothing else to show, which is said there.
    let [Effect::Tell(Command::Say(line))] = &update(&mut state, Msg::Fact(Fact::Groups(None)))[..] else {
        panic!("nothing is said")
    };
    assert!(line.starts_with("there are no groups"), "{line}");
    drop(update(&mut state, Msg::Fact(Fact::Groups(Some(Box::new(fixture::groups(2)))))));
    // Hidden and shown in the terminal it is the same.
    assert_eq!(script(&mut state, "v k v k"), [""; 0]);
    script(&mut state, "v w");
    let asked = update(&mut state, Msg::Fact(Fact::Groups(Some(Box::new(fixture::groups(2))))));
    assert_eq!(asked, [], "nobody looks");
}
