//! Corrections that are worked out behind the screen: which is offered, what waits for them, and what is kept.

use std::sync::Arc;

use honami_model::track::Status;
use honami_workbench::offer::{Errors, LeftOut, Model, Wish};

use super::tests::start;
use super::*;
use crate::app::correcting::{Answer, Ask, Moving};
use crate::app::fixture::{self, press};

fn moving(state: &State) -> &Moving {
    match &state.mode {
        Mode::Move(moving) => moving,
        other => panic!("{other:?}"),
    }
}

fn tell_answer(state: &mut State, answer: Answer) -> Vec<Effect> {
    update(state, Msg::Fact(Fact::Offered(answer)))
}

fn errors(px: &[(Model, f64)]) -> Answer {
    let known = px.iter().map(|&(model, mean_px)| (model, LeftOut { n: 2, mean_px }));
    let models = px.iter().map(|(model, _)| *model).collect();
    Answer::Errors(TrackId(1), Ok(Errors::new(models, known)))
}

/// Presses keys without an answer to what is asked for behind the screen; returns the wishes.
fn press_alone(state: &mut State, keys: &str) -> Vec<Wish> {
    let mut wishes = Vec::new();
    for key in keys.split_whitespace() {
        for effect in update(state, Msg::Key(key.parse().unwrap())) {
            match effect {
                Effect::Offer(Ask::Ghost(Some(wish))) => wishes.push(wish),
                Effect::Offer(_) => {}
                other => panic!("{key}: {other:?}"),
            }
        }
    }
    wishes
}

#[test]
fn the_model_with_the_smallest_error_is_offered_first_unless_another_was_chosen() {
    let told = [(Model::Both, 0.31), (Model::Space, 0.82), (Model::Hermite, 2.4)];
    for (keys, told, want) in [
        ("m", &told[..], Model::Both),
        ("m l l", &told[..], Model::Both),
        ("m", &[], Model::Space),
        ("m", &told[1..], Model::Space),
        ("m", &told[2..], Model::Hermite),
        // What a person has chosen stays; Tab goes on from there.
        ("m Tab Tab", &told[..], Model::Hermite),
        ("m Tab Tab Tab Tab Tab", &told[..], Model::KeyOnly),
    ] {
        let mut state = start("frame=20");
        press(&mut state, keys);
        tell_answer(&mut state, errors(told));
        assert_eq!(moving(&state).model(), Some(want), "{keys} {told:?}");
    }
    // Where the track is not shown there is nothing that could be carried along.
    let mut state = start("frame=80 track=2");
    press(&mut state, "m");
    let known = Errors::new(vec![Model::Space], [(Model::Space, LeftOut { n: 1, mean_px: 0.1 })]);
    tell_answer(&mut state, Answer::Errors(TrackId(2), Ok(known)));
    assert_eq!(moving(&state).model(), Some(Model::KeyOnly));
}

#[test]
fn every_move_is_wished_for_anew_and_only_the_last_is_shown() {
    let mut state = start("frame=20");
    press(&mut state, "m");
    let wishes = press_alone(&mut state, "Tab l l 5 ) *");
    let keys: Vec<usize> = wishes.iter().map(|wish| wish.keys.len()).collect();
    assert_eq!(keys, [1, 1, 1, 2], "with the key-frame that was pinned");
    assert!(wishes.iter().all(|wish| wish.model == Model::Both && wish.frame == 20));
    // What comes late is for a wish that does not stand any more.
    let ghost = || Err("late".to_owned());
    tell_answer(&mut state, Answer::Ghost(wishes[2].clone(), ghost()));
    assert!(moving(&state).is_pending() && moving(&state).correction().is_none());
    fixture::answer(&mut state, Effect::Offer(Ask::Ghost(Some(wishes[3].clone()))));
    assert!(moving(&state).correction().is_some() && !moving(&state).is_pending());
    // Nothing is wanted any more once it is left.
    let left = press(&mut state, "Esc");
    assert!(left.is_empty(), "{left:?}");
    assert!(!state.is_asking);
}

#[test]
fn what_is_kept_is_what_was_shown_and_keys_wait_for_it() {
    let mut state = start("frame=20");
    let kept = press(&mut state, "m l Tab Enter");
    let wish = match &kept[..] {
        [Effect::Keep(wish, _)] => wish.clone(),
        other => panic!("{other:?}"),
    };
    assert!(matches!(state.mode, Mode::Review));
    // Not there yet: Enter and what follows it wait.
    let mut state = start("frame=20");
    press(&mut state, "m");
    let wishes = press_alone(&mut state, "l Tab Enter Tab");
    assert_eq!(wishes, std::slice::from_ref(&wish));
    assert_eq!(state.held.len(), 2);
    assert!(state.notice.as_ref().is_some_and(|notice| notice.text.starts_with("both ways …")));
    assert_eq!(moving(&state).model(), Some(Model::Both), "no other model is offered meanwhile");
    tell_answer(&mut state, errors(&[(Model::Hermite, 0.1)]));
    assert_eq!(moving(&state).model(), Some(Model::Both));
    let found = press_and_find(&state, &wish);
    let effects = tell_answer(&mut state, Answer::Ghost(wish.clone(), Ok(found)));
    assert_eq!(effects.first(), Some(&Effect::Keep(wish.clone(), UNDO)));
    update(&mut state, Msg::Clock(Duration::from_millis(5)));
    assert!(state.held.is_empty() && state.panel.is_some(), "then the rest of the keys, where they belong");
    // Esc gives up what waits, and nothing is kept where nothing is found.
    for (key, why, said) in
        [("Esc", None, "not kept: it can be moved on"), ("l", Some("lost at once"), "lost at once")]
    {
        let mut state = start("frame=20");
        press(&mut state, "m");
        press_alone(&mut state, "l Tab Enter");
        press_alone(&mut state, key);
        if let Some(why) = why {
            let effects = tell_answer(&mut state, Answer::Ghost(wish.clone(), Err(why.to_owned())));
            assert!(effects.is_empty(), "{effects:?}");
        }
        assert_eq!(state.notice.as_ref().map(|notice| notice.text.as_str()), Some(said));
        assert!(state.held.is_empty() && matches!(state.mode, Mode::Move(_)));
    }
}

#[test]
fn what_the_project_refuses_is_worked_out_again() {
    let mut state = start("frame=20");
    let kept = press(&mut state, "m l Tab Enter");
    let [Effect::Keep(wish, _)] = &kept[..] else { panic!("{kept:?}") };
    let asked = update(&mut state, Msg::Fact(Fact::Refused));
    assert_eq!(asked, [Effect::Offer(Ask::Ghost(Some(wish.clone())))]);
    assert!(moving(&state).is_pending(), "what was found is handed over once");
    asked.into_iter().for_each(|effect| fixture::answer(&mut state, effect));
    assert_eq!(press(&mut state, "Enter"), kept);
}

#[test]
fn what_cannot_be_worked_out_is_said_and_waited_for_no_more() {
    let mut state = start("frame=20");
    press(&mut state, "m");
    let wishes = press_alone(&mut state, "Tab l");
    let fault = |n: usize| Answer::Ghost(wishes[n].clone(), Err("a fault".to_owned()));
    tell_answer(&mut state, fault(0));
    assert!(moving(&state).is_pending() && state.notice.is_none(), "nobody waits for it any more");
    tell_answer(&mut state, fault(1));
    let said = |state: &State| state.notice.as_ref().map(|notice| (notice.text.clone(), notice.is_error));
    assert_eq!(said(&state), Some(("a fault".to_owned(), true)));
    assert!(!moving(&state).is_pending());
    tell_answer(&mut state, Answer::Errors(TrackId(1), Err("a fault".to_owned())));
    let why = "how far off each model is could not be measured: a fault";
    assert_eq!(said(&state), Some((why.to_owned(), true)));
    assert!(moving(&state).offer.errors.is_some(), "they are not awaited");
}

/// What the fixture finds for a wish.
fn press_and_find(state: &State, wish: &Wish) -> Arc<honami_model::correct::Correction> {
    let mut other = state.clone();
    other.held.clear();
    fixture::answer(&mut other, Effect::Offer(Ask::Ghost(Some(wish.clone()))));
    Arc::new(moving(&other).correction().unwrap().clone())
}

#[test]
fn a_pinned_sample_stays_as_it_is_seen_and_one_that_is_not_seen_is_none() {
    for (status, pinned) in [
        (Status::Tracked, Some(Status::Tracked)),
        (Status::Occluded, Some(Status::Occluded)),
        (Status::Lost, None),
    ] {
        // Beyond the last key-frame: between two, the curve would be seen.
        let mut state = start("frame=50");
        press(&mut state, "m");
        let Mode::Move(moving) = &mut state.mode else { panic!("{:?}", state.mode) };
        let mut layers = moving.layers.as_deref().unwrap().clone();
        for (_, span) in &mut layers.runs {
            span.samples.iter_mut().for_each(|sample| sample.status = status);
        }
        moving.layers = Some(Arc::new(layers));
        press(&mut state, "5 ) *");
        let Mode::Move(moving) = &state.mode else { panic!("{:?}", state.mode) };
        assert_eq!(moving.pins.values().map(|key| key.status).next(), pinned, "{status:?}");
    }
}
