//! Runs of a project side by side: which are offered, how they disagree, and what is taken of one.

use honami_model::edit::Transaction;
use honami_model::track::Source;
use honami_store::RunHead;

use super::*;
use crate::correct::{Step, prepare};
use crate::session::Session;
use crate::tried::{project, provenance};

const N_FRAMES: u32 = 12;

/// A run of some tracks by a plugin, or a build of it (`klt@4d5e`), each `off` pixels below where it is without; every
/// third sample of the last track is lost.
fn run(session: &mut Session, plugin: &str, radius: i64, tracks: Range<u32>, off: f32) -> RunId {
    let (plugin, build) = plugin.split_once('@').unwrap_or((plugin, "test"));
    let what = match plugin {
        "pass" => "retrack",
        "mine" => REBUILT,
        _ => "track",
    };
    let id = if plugin.contains('.') { plugin.to_owned() } else { format!("org.honami.{plugin}") };
    let provenance = Provenance {
        what: what.to_owned(),
        plugin_sha256: build.to_owned(),
        params: [("radius", radius), ("levels", 4)].map(|(id, n)| (id.to_owned(), Value::Int(n))).into(),
        ..provenance(&id)
    };
    let last = tracks.end - 1;
    let sample = |track: u32, frame: u32| Sample {
        x: 5.0 * track as f32,
        y: frame as f32 + off,
        status: if track == last && frame % 3 == 2 { Status::Lost } else { Status::Tracked },
        source: Source::Tracked,
        quality: Quality { fb_px: Some(0.1), ncc: None },
    };
    let set: TrackSet = tracks.clone().map(TrackId).collect();
    let is_new = |track: &TrackId| session.project.document().track(*track).is_none();
    let new: TrackSet = set.iter().filter(is_new).collect();
    session.project.claim_tracks(&new).unwrap();
    let head = RunHead { provenance, tracks: set.clone(), frames: 0..N_FRAMES };
    let mut writer = session.project.begin_run(&head).unwrap();
    let row = |frame| tracks.clone().map(|track| (TrackId(track), sample(track, frame))).collect();
    writer.append(0, &(0..N_FRAMES).map(row).collect::<Vec<Vec<_>>>()).unwrap();
    let run = writer.finish().unwrap();
    if !matches!(plugin, "pass" | "mine") {
        session.project.commit(Transaction::show_run(run, set)).unwrap();
    }
    run
}

/// The names of the two that are compared unless others are wished for.
fn usual_of(session: &Session) -> Option<[String; 2]> {
    usual(&entrants(&session.project).unwrap()).map(|two| two.map(|one| one.name()))
}

#[test]
fn the_newest_runs_of_different_trackers_are_compared() {
    let (_folder, mut session) = project(N_FRAMES);
    let named = |a: &str, b: &str| Some([a.to_owned(), b.to_owned()]);
    assert_eq!(usual_of(&session), None, "no run");
    run(&mut session, "klt", 10, 1..4, 0.0);
    assert_eq!(usual_of(&session), None, "one run");
    run(&mut session, "klt", 10, 1..4, 0.0);
    assert_eq!(usual_of(&session), named("run 1 klt", "run 2 klt"), "the same twice");
    run(&mut session, "klt", 5, 1..4, 0.0);
    assert_eq!(usual_of(&session), named("run 2 klt radius=10", "run 3 klt radius=5"));
    run(&mut session, "pass", 5, 1..2, 0.0);
    run(&mut session, "flow", 5, 1..4, 0.0);
    run(&mut session, "flow", 5, 7..9, 0.0);
    assert_eq!(usual_of(&session), named("run 3 klt radius=5", "run 5 flow"), "run 6 shares no track");
    session.project.commit(Transaction::hide_run(RunId(5))).unwrap();
    assert_eq!(
        usual_of(&session),
        named("run 2 klt radius=10", "run 3 klt radius=5"),
        "hidden ones are last"
    );
    run(&mut session, "mine", 5, 1..3, 0.0);
    assert_eq!(
        usual_of(&session),
        named("run 3 klt radius=5", "run 7 mine rebuilt"),
        "beside the run before it"
    );
    run(&mut session, "klt", 7, 1..4, 0.0);
    assert_eq!(usual_of(&session), named("run 3 klt radius=5", "run 8 klt radius=7"), "something newer");
    let all: Vec<RunId> = entrants(&session.project).unwrap().into_iter().map(|one| one.run).collect();
    assert_eq!(all, [8, 7, 6, 5, 3, 2, 1].map(RunId), "the newest first, without the pass");
}

#[test]
fn builds_of_a_plugin_are_told_apart_and_the_last_two_are_offered() {
    let (_folder, mut session) = project(N_FRAMES);
    let last_two = |session: &Session| {
        last_builds(&entrants(&session.project).unwrap()).map(|two| two.map(|one| one.name()))
    };
    let named = |a: &str, b: &str| Some([a.to_owned(), b.to_owned()]);
    run(&mut session, "flow@aa", 5, 1..4, 0.0);
    run(&mut session, "flow@aa", 5, 1..4, 0.0);
    assert_eq!(last_two(&session), None, "one build");
    run(&mut session, "flow@0123456789abcdef", 5, 1..4, 0.0);
    run(&mut session, "klt", 5, 1..4, 0.0);
    let [a, b] = ["run 2 flow (aa, 2026-11-22 18:20)", "run 3 flow (01234567, 2026-11-22 18:20)"];
    assert_eq!(last_two(&session), named(a, b));
    assert_eq!(usual_of(&session), named(b, "run 4 klt"), "only where there are several");
    run(&mut session, "flow@cc", 5, 7..9, 0.0);
    assert_eq!(last_two(&session), named(a, b), "the newest has no track that another has");
    run(&mut session, "org.other.klt@dd", 5, 1..4, 0.0);
    assert_eq!(last_two(&session), named(a, b), "a namesake is no build of it");
}

#[test]
fn two_runs_are_compared_where_both_have_tracks_that_are_asked_for() {
    let (_folder, mut session) = project(N_FRAMES);
    let [a, b] = [run(&mut session, "klt", 10, 1..4, 0.0), run(&mut session, "flow", 1, 2..6, 3.0)];
    let path = session.project.path();
    let all: TrackSet = (1..6).map(TrackId).collect();
    let versus = compare(path, [a, b], &all).unwrap();
    assert_eq!(versus.tracks.iter().map(|paired| paired.track.0).collect::<Vec<_>>(), [2, 3]);
    let Summary { n_tracks, n_both, median_px, n_unseen, .. } = versus.found.summary;
    assert_eq!((n_tracks, n_both, median_px, n_unseen), (2, 20, Some(3.0), [4, 0]));
    let two = TrackSet::from(TrackId(2));
    assert_eq!(compare(path, [a, b], &two).unwrap().tracks.len(), 1);
    let keys = [(TrackId(2), 4, [10.0, 4.0]), (TrackId(2), 5, [10.0, 6.0]), (TrackId(5), 5, [0.0, 0.0])];
    let AtKeys { n_new, median_px, n_given } = versus.at_keys(keys);
    assert_eq!((n_new, median_px, n_given), (1, [Some(1.0), Some(2.0)], [1, 0]));
    assert!(compare(path, [a, RunId(99)], &all).is_err());
}

#[test]
fn what_a_hidden_run_found_is_taken_and_given_back() {
    let (_folder, mut session) = project(N_FRAMES);
    let [a, _] = [run(&mut session, "klt", 10, 1..4, 0.0), run(&mut session, "flow", 1, 1..4, 3.0)];
    session.project.commit(Transaction::hide_run(a)).unwrap();
    let y = |session: &Session| session.project.shown(TrackId(2)).unwrap().unwrap().get(5).unwrap().y as u32;
    assert_eq!(y(&session), 8);
    let step = |frames, run| Step::Take { tracks: TrackId(2).into(), frames, run };
    let (edit, _) = prepare(&mut session.project, &step(4..7, a)).unwrap();
    assert_eq!(edit.label, "track 2: frames 4-6 taken from run 1, up to 3.0 px");
    session.project.commit(edit).unwrap();
    assert_eq!((y(&session), session.project.run_at(TrackId(2), 5).unwrap()), (5, Some(a)));
    session.project.undo().unwrap();
    assert_eq!(y(&session), 8);
    assert!(prepare(&mut session.project, &step(0..12, RunId(9))).is_err(), "there is no such run");
}

#[test]
fn what_a_tracker_left_out_is_lost() {
    let sample =
        |x: f32, status| Sample { x, y: 0.0, status, source: Source::Tracked, quality: Quality::default() };
    let piece = |first_frame, xs: &[f32]| Span {
        first_frame,
        samples: xs.iter().map(|x| sample(*x, Status::Tracked)).collect(),
    };
    let words = |span: &Span| {
        let word = |s: &Sample| format!("{}{}", s.x, if s.status.is_seen() { "" } else { "x" });
        format!("{}: {}", span.first_frame, span.samples.iter().map(word).collect::<Vec<_>>().join(" "))
    };
    for (pieces, end, want) in [
        (vec![], 5, "0: "),
        (vec![piece(2, &[1.0, 2.0])], 0, "2: 1 2"),
        (vec![piece(2, &[1.0, 2.0])], 6, "2: 1 2 2x 2x"),
        (vec![piece(6, &[5.0]), piece(2, &[1.0, 2.0])], 8, "2: 1 2 2x 2x 5 5x"),
        (vec![piece(0, &[1.0, 2.0, 3.0]), piece(2, &[9.0])], 3, "0: 1 2 9"),
    ] {
        assert_eq!(words(&whole(pieces, end)), want);
    }
}
