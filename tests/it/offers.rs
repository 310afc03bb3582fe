//! Corrections that are offered, on a generated clip with the real tracker: what is previewed is what is kept, and what is
//! not kept leaves nothing behind.

use std::sync::Arc;

use honami_model::document::Key;
use honami_model::edit::Transaction;
use honami_model::track::TrackId;
use honami_tests::{Bench, program};
use honami_workbench::offer::{Granted, Model, Wish, errors, grant};
use honami_workbench::plugins::Values;
use honami_workbench::retrack;
use honami_workbench::session::{Session, SessionOptions};
use honami_workbench::track::{self, Area, PointSource, TrackRequest};

const N_FRAMES: u32 = 25;
const TRACK: TrackId = TrackId(3);

/// A project in which a tracker has run with two windows.
fn session(bench: &Bench) -> Session {
    bench.json(&format!("synth clip.y4m --size 320x240 --frames {N_FRAMES} --leaves 60"));
    bench.json("new p.honami clip.y4m");
    bench.json("track p.honami --with klt --set max_features=20");
    let plugin_paths = vec![program().parent().unwrap().to_owned()];
    let options = SessionOptions { plugin_paths, ..SessionOptions::default() };
    let mut session = Session::open(&bench.path("p.honami"), &options).unwrap();
    let mut params = Values::default();
    let klt = session.registry.find(honami_workbench::plugins::Kind::Tracker, "klt").unwrap();
    params.set_text(&klt.params, "radius=7").unwrap();
    let (plugin, frames, every, area) = ("klt".to_owned(), 0..N_FRAMES, None, Area::Whole);
    let request = TrackRequest { plugin, params, points: PointSource::Existing, frames, every, area };
    let done = track::prepare(&mut session, &request).unwrap().run(&()).unwrap();
    track::finish(&mut session, done).unwrap();
    session
}

fn shown(session: &Session, frame: u32) -> [f32; 2] {
    let span = session.project.shown(TRACK).unwrap().unwrap();
    let sample = span.get(frame).unwrap();
    [sample.x, sample.y]
}

/// The sample there becomes a key-frame as it is.
fn confirm(session: &mut Session, frame: u32) {
    let span = session.project.shown(TRACK).unwrap().unwrap();
    let step = Transaction::confirm_key(TRACK, frame, span.get(frame).unwrap()).unwrap();
    session.project.commit(step).unwrap();
}

#[test]
fn what_is_previewed_is_what_is_kept() {
    let bench = Bench::new();
    let mut session = session(&bench);
    confirm(&mut session, N_FRAMES - 1);
    for model in Model::ALL.into_iter().filter(|model| model.at_once().is_none()) {
        let n_runs = session.project.runs().unwrap().len();
        let study = Arc::new(retrack::study(&session, TRACK).unwrap());
        assert!(study.has_rivals());
        let ([x, y], [px, py]) = (shown(&session, 12), shown(&session, 6));
        let keys = vec![(6, Key::confirmed(px, py)), (12, Key::set(x + 0.5, y))];
        let granted = grant(&study, &Wish { track: TRACK, frame: 12, model, keys }, &()).unwrap();
        let ghost = granted.correction().clone();
        assert!(!ghost.affected.is_empty() && ghost.affected.start > 5, "{model:?}: {:?}", ghost.affected);
        assert_eq!(session.project.runs().unwrap().len(), n_runs, "{model:?}: nothing is kept of a preview");
        match granted {
            Granted::Ready(correction) => drop(session.project.commit(correction.transaction).unwrap()),
            Granted::Retracked(retracked) => drop(retrack::finish(&mut session, *retracked).unwrap()),
        }
        assert_eq!(*session.project.shown(TRACK).unwrap().unwrap(), ghost.span, "{model:?}");
        assert_eq!(session.project.runs().unwrap().len() > n_runs, model != Model::Fused, "a pass is a run");
        session.project.undo().unwrap();
        assert_eq!(shown(&session, 12).map(f32::to_bits), [x, y].map(f32::to_bits), "{model:?}");
    }
}

#[test]
fn errors_are_those_at_key_frames_that_were_left_out() {
    let bench = Bench::new();
    let mut session = session(&bench);
    let none = errors(&retrack::study(&session, TRACK).unwrap(), 12, &()).unwrap();
    assert_eq!(Model::ALL.map(|model| none.px(model)), [None; 7], "nothing to leave out");
    for frame in [8, 16, 24] {
        confirm(&mut session, frame);
    }
    let told = errors(&retrack::study(&session, TRACK).unwrap(), 12, &()).unwrap();
    // The runs were right: carried along they stay, and the tracker finds them again.
    assert!(told.px(Model::Space).unwrap() < 1e-3, "{told:?}");
    for model in [Model::Both, Model::Forward, Model::Backward, Model::Fused] {
        assert!(told.px(model).unwrap() < 1.0, "{model:?}: {told:?}");
    }
    assert!(told.px(Model::Hermite).unwrap() > told.px(Model::Both).unwrap(), "leaves sway: {told:?}");
    assert_eq!(told.px(Model::KeyOnly), None);
}
