//! What keys, mouse and text do to a forest, and what its screen looks like.

use super::{Forest, Shot, Wish};
use crate::app::action::Context;
use crate::app::config::Config;
use crate::app::keymap::KeyMap;
use crate::app::view;
use crate::term::input::{Mouse, MouseKind};
use crate::term::key::Key;
use honami_workbench::plant::scene::{Shown, scene};
use honami_workbench::plant::sway::Motion;
use honami_workbench::plant::{Wish as Plant, vibrate};
use honami_workbench::scene::ForestScene;

/// So many copies of a small tree.
pub(super) fn copies(n_copies: usize, wind: &str) -> ForestScene {
    let plant = vibrate(&Plant::of("synth::tree:40,1", Some(4)), &()).unwrap();
    let shown = Shown { name: "tree".to_owned(), wind: wind.to_owned(), leaves: None, leaf_length: None };
    let motion = Motion { n_copies, ..Motion::default() };
    scene(&plant, &motion, &shown).unwrap()
}

fn forest() -> Forest {
    Forest::new(&copies(9, "wind"), &Config::default())
}

fn press(forest: &mut Forest, typed: &str) -> Option<Wish> {
    typed.split_whitespace().filter_map(|key| forest.on_key(key.parse::<Key>().unwrap())).last()
}

#[test]
fn keys_turn_the_eye_and_the_wind() {
    let begun = forest().orbit;
    type Then = fn(&Forest) -> bool;
    let cases: [(&str, Then); 22] = [
        ("l", |f| f.orbit.azimuth > 0.1 && f.orbit.azimuth < 0.2),
        ("h", |f| f.orbit.azimuth > 6.0),
        ("k", |f| f.orbit.elevation > f.begun.elevation),
        ("k k k k k k k k k k k k k k k k", |f| (f.orbit.elevation - 1.5).abs() < 1e-6),
        ("z", |f| f.orbit.distance < f.begun.distance),
        ("z Z l V", |f| f.orbit == f.begun),
        ("space", |f| !f.is_playing),
        (". .", |f| !f.is_playing && f.steps == 2),
        ("+", |f| f.wind == "wind:speed=10"),
        ("- -", |f| f.wind == "wind:speed=5.12"),
        ("H", |f| f.wind == "wind:towards=15"),
        ("L L", |f| f.wind == "wind:towards=330"),
        ("i s t o r m x Backspace Enter", |f| f.wind == "storm" && f.typed.is_none()),
        ("i x y Esc", |f| f.wind == "wind" && f.context() == Context::Forest),
        ("i Enter", |f| f.wind == "wind"),
        ("i x y Ctrl-u s t o r m Enter", |f| f.wind == "storm"),
        (": w i n d Enter", |f| f.menu.is_none() && f.typed.is_some()),
        (": x Ctrl-u Esc", |f| f.menu.is_none() && f.complaint.is_none()),
        ("? Down Down Up", |f| f.menu.as_ref().is_some_and(|menu| menu.at == 1)),
        ("? p l a y Enter", |f| f.menu.is_none() && !f.is_playing),
        ("v", |f| text(f).iter().any(|row| row.contains("sextants"))),
        ("Esc", |f| f.complaint.as_deref() == Some("q leaves")),
    ];
    for (typed, then) in cases {
        let mut forest = forest();
        assert_eq!(forest.orbit, begun);
        assert_eq!(press(&mut forest, typed), None);
        assert!(then(&forest), "{typed}: {} {:?}", forest.wind, forest.orbit);
    }
    for (typed, wish) in [
        ("q", Wish::Leave),
        ("Q", Wish::Leave),
        ("Ctrl-l", Wish::Redraw),
        (": l e a v e Enter", Wish::Leave),
        ("? Ctrl-l", Wish::Redraw),
    ] {
        assert_eq!(press(&mut forest(), typed), Some(wish), "{typed}");
    }
    // What blows, what is pressed, and what blows then: never weaker by +, the other way by neither, nor further round than
    // once.
    let winds = [
        ("wind:speed=80", "+", "wind:speed=80"),
        ("wind:speed=50", "+ +", "wind:speed=60"),
        ("steady:speed=-4", "+", "steady:speed=-5"),
        ("steady:speed=-4", "-", "steady:speed=-3.2"),
        ("steady:speed=0", "+", "steady:speed=0.5"),
        ("wind:towards=350", "H", "wind:towards=5"),
        ("wind:towards=-30", "H", "wind:towards=345"),
    ];
    for (wind, typed, then) in winds {
        let mut forest = Forest::new(&copies(1, wind), &Config::default());
        press(&mut forest, typed);
        assert_eq!(forest.wind, then, "{wind} {typed}");
    }
    // What has no speed says so.
    let mut still = forest();
    still.wind = "still".to_owned();
    press(&mut still, "+");
    assert_eq!(still.complaint.as_deref(), Some("still has no speed to change: choose another"));
}

#[test]
fn every_binding_answers() {
    let mut begun = forest();
    press(&mut begun, "l");
    for binding in KeyMap::default().bindings().iter().filter(|binding| binding.context == Context::Forest) {
        let mut forest = begun.clone();
        let wish = binding.keys.iter().filter_map(|key| forest.on_key(*key)).last();
        let is_silent = wish.is_none() && format!("{forest:?}") == format!("{begun:?}");
        assert!(forest.pending.is_empty() && !is_silent, "{binding:?} is silent");
    }
}

#[test]
fn the_help_is_seen_and_clicked() {
    let mut forest = forest();
    press(&mut forest, "?");
    let rows = text(&forest);
    assert!(rows.iter().any(|row| row.contains("what works here")), "{rows:?}");
    forest.on_mouse(Mouse { kind: MouseKind::WheelDown, column: 9, row: 9 });
    assert_eq!(forest.menu.as_ref().map(|menu| menu.at), Some(1), "the wheel goes on in the list");
    press(&mut forest, "Ctrl-u z o o m");
    let row = text(&forest).iter().position(|row| row.trim_start().starts_with("zoom in")).unwrap();
    let wish = forest.on_mouse(Mouse { kind: MouseKind::Press(0), column: 9, row: row as u16 });
    assert!(wish.is_none() && forest.menu.is_none() && forest.orbit.distance < forest.begun.distance);
}

#[test]
fn the_mouse_goes_round_and_nearer() {
    let mut forest = forest();
    let at = |kind, column, row| Mouse { kind, column, row };
    forest.on_mouse(at(MouseKind::Drag(0), 10, 10));
    assert_eq!(forest.orbit, forest.begun, "what was not taken hold of is not dragged");
    forest.on_mouse(at(MouseKind::Press(0), 10, 10));
    forest.on_mouse(at(MouseKind::Drag(0), 5, 12));
    assert!(forest.orbit.azimuth > 0.1 && forest.orbit.elevation > forest.begun.elevation);
    forest.on_mouse(at(MouseKind::WheelUp, 5, 12));
    assert!(forest.orbit.distance < forest.begun.distance);
}

fn text(forest: &Forest) -> Vec<String> {
    let frame = view::forest::draw(forest, false);
    let (columns, _) = forest.size;
    let rows = frame.cells.content.chunks(usize::from(columns));
    rows.map(|row| row.iter().map(ratatui::buffer::Cell::symbol).collect::<String>().trim_end().to_owned())
        .collect()
}

#[test]
fn its_screen_says_what_there_is_and_what_blows() {
    let mut forest = forest();
    let rows = text(&forest);
    assert_eq!(rows[0], "tree  9 plants, 4 modes");
    assert!(rows[11].contains("going on for a while"), "{rows:?}");
    assert_eq!(rows[22], "wind");
    assert!(rows[23].contains("hl round") && rows[23].ends_with("? help  q leave"), "{}", rows[23]);
    forest.size.0 = 120;
    assert!([". step", "V front", "v q finer"].iter().all(|hint| text(&forest)[23].contains(hint)));
    forest.size.0 = 80;
    let area = view::forest::picture(&forest);
    let size = [u32::from(area.width), 2 * u32::from(area.height)];
    let pixels = vec![[10, 200, 30]; (size[0] * size[1]) as usize];
    forest.shot = Some(Shot { size, pixels, time: 1.25, wind: [0.0, 7.0, 0.0] });
    let rows = text(&forest);
    assert!(rows[0].ends_with("1.2 s") && rows[22] == "wind  ↑  7.0 m/s, seen from 0°", "{rows:?}");
    let frame = view::forest::draw(&forest, false);
    let middle = frame.cells.index_of(40, 11);
    assert!(frame.softness[middle] > 0, "the picture is painted as far as the link carries it");
    forest.is_playing = false;
    forest.orbit.azimuth = std::f32::consts::FRAC_PI_2;
    assert!(text(&forest)[22].contains("→") && text(&forest)[0].ends_with("paused at 1.25 s"));
    forest.size = (20, 2);
    assert_eq!(text(&forest).len(), 2);
    forest.typed = Some("storm".to_owned());
    forest.size = (80, 24);
    assert_eq!(text(&forest)[22], "other wind: storm▏  now wind");
}
