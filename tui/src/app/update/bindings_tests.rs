//! Every binding of every place, pressed: it does what its row of `answers.txt` says, and Esc is the way back.

use std::fmt::Write as _;
use std::path::Path;

use super::tests::{line, start};
use super::*;
use crate::app::fixture::{self, press, send};
use crate::app::keymap::{Binding, KeyMap, shown};

/// How keys come to be read in a place. The start screen and forests have tests of their own.
const REACH: [(Context, &str); 14] = [
    (Context::Review, ""),
    (Context::Place, "a"),
    (Context::Shape, "grown G b"),
    (Context::Move, "m l"),
    (Context::Slide, "T"),
    (Context::Sketch, "s"),
    (Context::Paint, "e p"),
    (Context::Scale, "e b"),
    (Context::Form, "t r"),
    (Context::Menu, ":"),
    (Context::Prompt, "g f"),
    (Context::Dial, "v d"),
    (Context::Label, "C g l"),
    (Context::History, "U j"),
];

/// Presses keys; where the word is `grown`, a skeleton has.
fn reach(state: &mut State, way: &str) {
    match way.strip_prefix("grown") {
        Some(way) => {
            fixture::skeleton::show(state);
            press(state, way);
        }
        None => drop(press(state, way)),
    }
}

/// Keys that give an action something to do.
fn prepared(context: Context, action: Action) -> &'static str {
    match (context, action) {
        (Context::Form, Action::Up | Action::FineLeft | Action::FineRight) => "j j j",
        (Context::Menu, Action::Up) => "j Down",
        (Context::Dial, Action::Up) => "j",
        (Context::Menu, Action::Erase | Action::EraseLine) => "x",
        (Context::Prompt, Action::Erase | Action::EraseLine) => "1",
        (Context::Review, Action::Back) => "space",
        (Context::Move, Action::Pin) => ")",
        (Context::Sketch, Action::Erase) => ".",
        (Context::Paint, Action::Erase) => "D",
        (Context::Scale, Action::Erase) => "Enter",
        _ => "",
    }
}

fn bindings() -> impl Iterator<Item = (Binding, &'static str)> {
    let all = KeyMap::default().bindings().to_vec();
    let is_own = |context| matches!(context, Context::Start | Context::Forest);
    all.into_iter().filter(move |binding| !is_own(binding.context)).map(|binding| {
        let (_, way) = REACH.iter().find(|(context, _)| *context == binding.context).unwrap();
        (binding, *way)
    })
}

/// All that an action may change, apart from what every action leaves: its line in the log, and the lesson's note.
fn traces(state: &State) -> String {
    format!("{:?}", State { log: Default::default(), lesson: None, ..state.clone() })
}

/// What is looked at, in words.
fn looks(state: &State) -> Vec<String> {
    let on = |what: &str, is_on: bool| format!("{what} {}", if is_on { "on" } else { "off" });
    let [x, y] = state.centre;
    vec![
        format!("zoom {}", state.zoom),
        format!("middle {x:.0} {y:.0}"),
        on("follow", state.follow),
        on("marks", state.marks_all),
        on("motion", state.motion.is_on),
        on("skeleton", state.skeleton.is_on),
        format!("seen from {}°", state.skeleton.azimuth),
        format!("full colour at {:.0} px/s", state.motion.full_px_s()),
        format!("panel {:?}", state.panel),
        on("wide", state.panel_is_wide),
        on("group", state.plotted.of_group),
        format!("glyphs {}", state.glyphs),
        on("stills", state.stills),
        format!("theme {}", state.theme),
        on("mouse", state.mouse),
        on("by doubt", state.by_doubt),
        format!("range {:?}", state.range.map(|range| (range.from, range.to))),
        format!("picked {:?}", state.picked),
    ]
}

#[test]
fn every_binding_has_a_way_back() {
    for (binding, way) in bindings() {
        for from in ["frame=20", "frame=20 empty", "frame=20 job playing", "locked", "bare zoom=2"] {
            let mut state = start(from);
            reach(&mut state, way);
            binding.keys.iter().for_each(|key| drop(update(&mut state, Msg::Key(*key))));
            assert!(state.pending.is_empty(), "{binding:?} from {from}");
            press(&mut state, "Esc Esc Esc Esc");
            assert!(matches!(state.mode, Mode::Review), "{binding:?} from {from}: no way back");
        }
    }
}

/// Where nothing is in its way a binding changes something, asks for something, or says why not; and that is what its
/// row of `answers.txt` says. `REGENERATE=1` writes the rows anew.
#[test]
fn every_binding_answers() {
    let (mut rows, mut silent) = (String::new(), Vec::new());
    for (binding, way) in bindings() {
        let mut state = start("frame=20 zoom=2");
        reach(&mut state, way);
        assert_eq!(state.mode.context(), binding.context, "by `{way}`");
        press(&mut state, prepared(binding.context, binding.action));
        state.notice = None;
        let (before, saw) = (traces(&state), looks(&state));
        let keys = binding.keys.iter();
        let effects: Vec<Effect> = keys.flat_map(|key| send(&mut state, Msg::Key(*key))).collect();
        if effects.is_empty() && traces(&state) == before {
            silent.push(format!("{:?}: {}", binding.context, binding.action.info().name));
        }
        // The text of a log is long; that it is saved is enough.
        let short = |effect: &Effect| match effect {
            Effect::SaveLog(_) => Effect::SaveLog("…".to_owned()),
            other => other.clone(),
        };
        let effects: Vec<Effect> = effects.iter().map(short).collect();
        let seen: Vec<String> = looks(&state).into_iter().filter(|word| !saw.contains(word)).collect();
        let name = format!("{} {}", binding.context.name(), binding.action.info().name);
        let mut answer = line(&state, &effects);
        if let (Mode::Menu(menu), Some((what, rest))) = (&state.mode, answer.split_once(" of ")) {
            // How long a list is depends on all actions.
            answer = format!("{what}{}", rest.trim_start_matches(&menu.rows().len().to_string()));
        }
        write!(rows, "{name:32} {:10} {answer}", shown(&binding.keys)).unwrap();
        seen.iter().for_each(|word| write!(rows, " | {word}").unwrap());
        rows.push('\n');
    }
    assert_eq!(silent, Vec::<String>::new(), "these do nothing and say nothing");
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/app/update/answers.txt");
    if std::env::var_os("REGENERATE").is_some() {
        std::fs::write(&file, &rows).unwrap();
    }
    let wanted = std::fs::read_to_string(&file).unwrap();
    let other: Vec<_> = rows.lines().zip(wanted.lines()).filter(|(now, then)| now != then).collect();
    assert!(rows == wanted, "other answers (REGENERATE=1 accepts them): {other:#?}");
}
