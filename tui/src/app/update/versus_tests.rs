//! Two runs beside each other: what keys do, through the one door.

use honami_model::document::RunId;

use super::tests::{check, line, start};
use super::*;
use crate::app::fixture::{self, press};
use crate::app::panel::Panel;
use crate::app::versus::{Sides, Versus};

#[test]
fn two_runs_beside_each_other() {
    let here = "review | frame 20 track 1";
    let worst = "review | frame 40 track 1 | said track 1: 9.5 px apart at 40 (31-49), place 1 of 4";
    let second = "review | frame 20 track 7 | said track 7: 3.0 px apart at 20 (20-69), place 2 of 4";
    let last = "review | frame 30 track 2 | said track 2: only A sees it from 30 on (30-59), place 4 of 4";
    for (keys, expect) in [
        ("n", worst.to_owned()),
        ("n n", second.to_owned()),
        ("4 n", last.to_owned()),
        (
            "9 n n",
            "review | frame 30 track 2 | said this was the last place of disagreement; p goes back"
                .to_owned(),
        ),
        ("2 n p", worst.to_owned()),
        ("n p", "review | frame 40 track 1 | said this is the worst disagreement".to_owned()),
        ("F", format!("{here} | said only A: run 1 klt radius=5")),
        ("F F", format!("{here} | said only B: run 2 klt radius=15")),
        ("F F F", format!("{here} | said A and B")),
        ("A", format!("{here} | said the tracks as they are shown")),
        ("v a", format!("{here} | Entrants(None)")),
        ("e A", format!("{here} | Take {{ tracks: TrackSet([1..=1]), frames: 0..100, run: RunId(1) }}")),
        // The place that is open, and the second time all of the track.
        (
            "n e A",
            "review | frame 40 track 1 | Take { tracks: TrackSet([1..=1]), frames: 31..50, run: RunId(1) }"
                .to_owned(),
        ),
        (
            "n e A e A",
            "review | frame 40 track 1 | Take { tracks: TrackSet([1..=1]), frames: 31..50, run: RunId(1) } | \
             Take { tracks: TrackSet([1..=1]), frames: 0..100, run: RunId(1) }"
                .to_owned(),
        ),
        (
            "n e A e B",
            "review | frame 40 track 1 | Take { tracks: TrackSet([1..=1]), frames: 31..50, run: RunId(1) } | \
             Take { tracks: TrackSet([1..=1]), frames: 31..50, run: RunId(2) }"
                .to_owned(),
        ),
        (
            "r 9 l e B",
            "review | frame 29 track 1 | Take { tracks: TrackSet([1..=1]), frames: 20..30, run: RunId(2) }"
                .to_owned(),
        ),
        (
            "y j y e B",
            "review | frame 20 track 2 | Take { tracks: TrackSet([1..=2]), frames: 0..100, run: RunId(2) }"
                .to_owned(),
        ),
    ] {
        check("frame=20 versus", keys, &expect);
    }
    check("frame=20", "A", &format!("{here} | Versus(None)"));
    for keys in ["F", "e A", "e B"] {
        check("frame=20", keys, &format!("{here} | error no two runs are beside each other: A shows them"));
    }
    check(
        "frame=20 versus locked",
        "e A",
        &format!("{here} | error read only: ada on lab2 holds this project; nothing can be changed here"),
    );
}

#[test]
fn esc_leaves_the_range_then_the_picks_then_the_two_runs() {
    let mut state = start("versus");
    press(&mut state, "y r Esc Esc");
    assert!(state.range.is_none() && state.picked.is_empty() && state.versus.is_some());
    press(&mut state, "Esc");
    assert!(state.versus.is_none() && state.panel.is_none());
}

#[test]
fn without_two_runs_the_form_of_another_tracker_opens() {
    let mut state = start("");
    update(&mut state, Msg::Fact(Fact::Versus(None)));
    let Mode::Form(form) = &state.mode else { panic!("no form") };
    assert_eq!((form.plugin().name.as_str(), form.features().word()), ("flow", "the tracks here"));
    let said = state.notice.clone().unwrap();
    assert!(said.is_error && said.text.starts_with("no two runs of the same tracks"), "{said:?}");
    // Beside one that does not drift the one that does.
    for (on_top, wanted) in [("anchored 0.1.0", "klt"), ("klt 0.1.0", "anchored")] {
        let mut state = start("");
        state.plugins.iter_mut().filter(|plugin| plugin.name == "flow").for_each(|plugin| {
            wanted.clone_into(&mut plugin.name);
        });
        state.tracker = Some(on_top.to_owned());
        update(&mut state, Msg::Fact(Fact::Versus(None)));
        let Mode::Form(form) = &state.mode else { panic!("no form") };
        assert_eq!(form.plugin().name, wanted);
    }
    let effects = press(&mut state, "Enter");
    assert_eq!(
        line(&state, &effects),
        "review | frame 0 track 1 | flow follows Existing in 0..100, every None "
    );
}

#[test]
fn while_a_tracker_runs_no_form_opens() {
    let mut state = start("job");
    update(&mut state, Msg::Fact(Fact::Versus(None)));
    assert!(matches!(state.mode, Mode::Review));
    let said = state.notice.clone().unwrap();
    assert!(!said.is_error && said.text.contains("is still running; when it is done, A shows"), "{said:?}");
}

#[test]
fn until_the_runs_are_compared_none_is_taken() {
    let mut state = start("versus");
    state.versus.as_mut().unwrap().compared = None;
    assert_eq!(press(&mut state, "e A"), []);
    assert_eq!(state.notice.clone().unwrap().text, "the two runs are still being compared");
}

#[test]
fn two_runs_are_chosen_one_after_the_other() {
    let mut state = start("versus");
    update(&mut state, Msg::Fact(Fact::Entrants(None, fixture::entrants())));
    assert_eq!(press(&mut state, "Down Enter"), [Effect::Entrants(Some(RunId(2)))]);
    update(&mut state, Msg::Fact(Fact::Entrants(Some(RunId(2)), fixture::entrants())));
    let Mode::Menu(menu) = &state.mode else { panic!("no menu") };
    let labels: Vec<&str> = menu.rows().map(|row| row.label.as_str()).collect();
    assert_eq!(labels, ["run 4 klt radius=20", "run 1 klt radius=5"], "not with itself");
    assert_eq!(press(&mut state, "Enter"), [Effect::Versus(Some([RunId(2), RunId(4)]))]);
    let mut state = start("");
    let one = fixture::entrants().split_off(2);
    update(&mut state, Msg::Fact(Fact::Entrants(None, one)));
    assert!(matches!(state.mode, Mode::Form(_)), "there is nothing to choose from");
}

#[test]
fn they_are_compared_once_and_again_when_other_tracks_are_shown() {
    let mut state = start("versus");
    let n_tracks = |state: &mut State| Versus::request(state).map(|request| request.tracks.len());
    assert_eq!((n_tracks(&mut state), n_tracks(&mut state)), (Some(3), None));
    let rows = state.tracks.clone();
    update(&mut state, Msg::Fact(Fact::Tracks(rows[1..].to_vec())));
    assert_eq!((n_tracks(&mut state), n_tracks(&mut state)), (Some(2), None));
    update(&mut state, Msg::Fact(Fact::Tracks(rows[1..].to_vec())));
    assert_eq!(n_tracks(&mut state), None, "samples of hand work are not of the runs");
}

#[test]
fn what_is_told_of_other_runs_is_not_taken() {
    let mut state = start("versus");
    let failed = Err("disk".to_owned());
    update(&mut state, Msg::Fact(Fact::Compared([RunId(1), RunId(4)], failed.clone())));
    assert!(state.versus.as_ref().is_some_and(|versus| versus.compared.is_some()));
    update(&mut state, Msg::Fact(Fact::Compared([RunId(1), RunId(2)], failed)));
    assert!(state.versus.is_none() && state.panel != Some(Panel::Versus));
}

#[test]
fn a_click_selects_the_run_that_is_drawn() {
    let mut state = start("frame=40 versus");
    let points = |sides: Sides, state: &mut State| {
        let versus = state.versus.as_mut().unwrap();
        versus.sides = sides;
        versus
            .points(40)
            .into_iter()
            .filter(|(track, _)| track.0 == 1)
            .map(|(_, at)| (2.0 * at[1]) as u32)
            .collect::<Vec<_>>()
    };
    assert_eq!(points(Sides::Both, &mut state), [240, 259]);
    assert_eq!(points(Sides::One(0), &mut state), [240]);
    assert_eq!(points(Sides::One(1), &mut state), [259]);
}
