//! The review of a project with one track that goes astray: found, judged, corrected, found again.

use std::sync::atomic::{AtomicU64, Ordering};

use honami_model::document::{ClusteringId, Key};
use honami_model::edit::{Edit, Transaction};
use honami_model::hierarchy::{Dendrogram, Merge};
use honami_model::judgement::{Effort, Verdict};
use honami_model::track::{Quality, Sample, Source, Status};
use honami_store::{Clustering, RunHead};
use honami_synth::Settings;
use tempfile::TempDir;

use super::crew::ANCHORED;
use super::*;
use crate::generate::{generate, truth_beside};
use crate::session::Session;
use crate::tried::provenance;

const N_FRAMES: u32 = 24;
/// From this frame on the straying track is where nothing is.
const ASTRAY: u32 = 9;

/// A project whose tracks follow the truth, but for one that strays from [`ASTRAY`] on; its number is the last.
fn project() -> (TempDir, Session, TrackId) {
    let folder = tempfile::tempdir().unwrap();
    let clip = folder.path().join("clip.y4m");
    let settings =
        Settings { width: 320, height: 240, n_frames: N_FRAMES, n_leaves: 40, ..Settings::default() };
    generate(&settings, &clip, &()).unwrap();
    let path = folder.path().join("clip.honami");
    let mut session = Session::create(&path, &clip, None, &Default::default()).unwrap();
    let truth = crate::compare::read_truth(&truth_beside(&clip), N_FRAMES).unwrap();
    let seen: Vec<_> = truth.into_iter().filter(|(_, path)| path.positions.iter().all(|at| at.2)).collect();
    let astray = seen.last().unwrap().0;
    let sample = |track, frame: u32, (x, y, _): (f64, f64, bool)| {
        let is_wrong = track == astray && frame >= ASTRAY;
        let off = if is_wrong { 6.0 * f64::from(frame - ASTRAY + 1) } else { 0.0 };
        let fb_px = (frame > 0).then_some(if is_wrong { 2.5 } else { 0.02 });
        let quality = Quality { fb_px, ncc: None };
        let (status, source) = (Status::Tracked, Source::Tracked);
        Sample { x: (x + off) as f32, y: y as f32, status, source, quality }
    };
    let rows: Vec<Vec<_>> = (0..N_FRAMES)
        .map(|frame| {
            seen.iter().map(|(id, path)| (*id, sample(*id, frame, path.positions[frame as usize]))).collect()
        })
        .collect();
    let tracks: honami_model::track::TrackSet = seen.iter().map(|(id, _)| *id).collect();
    session.project.claim_tracks(&tracks).unwrap();
    let head = RunHead { provenance: provenance("test"), tracks: tracks.clone(), frames: 0..N_FRAMES };
    let mut writer = session.project.begin_run(&head).unwrap();
    writer.append(0, &rows).unwrap();
    let run = writer.finish().unwrap();
    session.project.commit(Transaction::show_run(run, tracks)).unwrap();
    (folder, session, astray)
}

fn judged(session: &Session, item: &Item, verdict: Verdict) -> Transaction {
    let span = session.project.shown(item.track).unwrap().unwrap();
    let judgement = Judgement {
        end_frame: item.frames.end,
        verdict,
        reasons: item.reasons.codes().map(str::to_owned).collect(),
        reviewer: "ann".to_owned(),
        time: "2026-01-02T03:04:05Z".to_owned(),
        effort: Effort { keystrokes: 3, key_frames: 0, seconds: 1.5 },
        seal: Some(span.seal(item.frames.clone())),
    };
    Transaction::judge(item.track, item.frames.start, judgement)
}

#[test]
fn the_track_that_goes_astray_is_found_and_leaves_when_judged_until_it_changes() {
    let (folder, mut session, astray) = project();
    let found = review(&session.project, Arc::clone(&session.media), &()).unwrap();
    let first = found.queue.first().unwrap().clone();
    assert_eq!(first.track, astray, "{:?}", found.queue);
    assert!(first.frames.start.abs_diff(ASTRAY) <= 3 && first.frames.end == N_FRAMES, "{first:?}");
    assert!(["FB", "NCC", "NBR"].iter().all(|code| first.reasons.codes().any(|c| c == *code)), "{first:?}");
    assert!(first.suspicion > 0.8 && found.track(astray).unwrap().suspicion > 0.8, "{first:?}");

    assert!(tables::verdicts(&session.project, &folder.path().join("v.csv")).is_err());
    let label = session.project.commit(judged(&session, &first, Verdict::Accepted)).unwrap();
    let line = session.project.history().get(label).unwrap().label.clone();
    assert_eq!(line, format!("track {astray}: frames {}-23 accepted", first.frames.start));
    let after = review(&session.project, Arc::clone(&session.media), &()).unwrap();
    assert_eq!(after.queue.of_track(astray).count(), 0);
    let progress = after.progress();
    assert_eq!((progress.open + 1, progress.judged.done()), (found.queue.len(), 1));
    assert_eq!(tables::verdicts(&session.project, &folder.path().join("v.csv")).unwrap(), 1);
    assert_eq!(tables::efforts(&session.project, &folder.path().join("e.csv")).unwrap(), 1);

    let key = Edit::SetKey { track: astray, frame: 15, key: Key::set(3.0, 4.0) };
    session.project.commit(Transaction::new("moved", vec![key])).unwrap();
    let stands = || {
        let path = folder.path().join("v.csv");
        tables::verdicts(&session.project, &path).unwrap();
        let rows = honami_exchange::read::<honami_exchange::VerdictRow>(&path).unwrap();
        rows.map(|row| row.unwrap().stands).collect::<Vec<_>>()
    };
    assert_eq!(stands(), [Some(false)], "what was judged is no longer there");
    let again = review(&session.project, Arc::clone(&session.media), &()).unwrap();
    assert!(again.queue.of_track(astray).count() > 0 && again.progress().judged.done() == 0);
}

#[test]
fn a_run_that_sees_the_feature_elsewhere_is_named() {
    let (folder, mut session, astray) = project();
    let truth = truth_beside(&folder.path().join("clip.y4m"));
    let path = crate::compare::read_truth(&truth, N_FRAMES).unwrap().remove(&astray).unwrap();
    let sample = |&(x, y, _): &(f64, f64, bool)| {
        let (status, source, quality) = (Status::Tracked, Source::Tracked, Quality::default());
        Sample { x: x as f32, y: y as f32, status, source, quality }
    };
    let span = Span { first_frame: 0, samples: path.positions.iter().map(sample).collect() };
    let provenance = provenance(ANCHORED[0]);
    let head = RunHead { provenance, tracks: astray.into(), frames: 0..N_FRAMES };
    let project = &mut session.project;
    let shown = project.document().runs()[0].clone();
    let alone = Changes::since(&mut Known::default(), project).unwrap().subjects;
    assert!(alone.iter().all(|subject| subject.rivals.is_empty() && subject.kind == Kind::Stepwise));
    let right = project.keep_runs(&[(head, vec![(astray, span)])]).unwrap()[0];
    project.commit(Transaction::show_run(right, astray.into())).unwrap();
    let with = Changes::since(&mut Known::default(), project).unwrap().subjects;
    let kind = |track: TrackId| with.iter().find(|subject| subject.track == track).unwrap().kind;
    assert_eq!((kind(astray), kind(with[0].track)), (Kind::Anchored, Kind::Stepwise));
    // The run that strays lies over it again.
    project.commit(Transaction::hide_run(shown.run)).unwrap();
    project.commit(Transaction::show_run(shown.run, shown.tracks)).unwrap();
    let found = review(&session.project, Arc::clone(&session.media), &()).unwrap();
    let first = found.queue.first().unwrap();
    let far = (f64::from(first.measured - ASTRAY + 1) * 6.0).round();
    assert_eq!(first.disagreement(), Some(format!("disagrees with anchored by {far} px")), "{first:?}");
    assert!(first.reasons.codes().any(|code| code == "DIS"), "{first:?}");
}

#[test]
fn what_a_person_calls_lost_is_not_doubtful_until_that_is_undone() {
    use crate::correct::{Step, prepare};
    let (_folder, mut session, astray) = project();
    let n_found = |session: &Session| {
        let review = review(&session.project, Arc::clone(&session.media), &()).unwrap();
        review.queue.of_track(astray).count()
    };
    assert!(n_found(&session) > 0);
    let n_doubtful = |session: &Session| super::n_doubtful(&session.project).unwrap();
    let before = n_doubtful(&session);
    for status in [Status::Lost, Status::Occluded, Status::Outside] {
        let frames = ASTRAY - 3..N_FRAMES;
        let mark = Step::Mark { tracks: astray.into(), frames, status };
        let (edit, _) = prepare(&mut session.project, &mark).unwrap();
        session.project.commit(edit).unwrap();
        assert_eq!(n_found(&session), 0, "{status:?}");
        assert_eq!(n_doubtful(&session) + 1, before, "{status:?}");
        session.project.undo().unwrap();
        assert!(n_found(&session) > 0, "{status:?}");
    }
}

/// Everything that a reviewer tells, after it was told of a project and has looked at all pictures.
fn all(reviewer: &mut Reviewer, known: &mut Known, project: &Project, review: &mut Review) {
    let mut told = reviewer.tell(Changes::since(known, project).unwrap());
    while !told.is_empty() || reviewer.is_pending() {
        told.into_iter().for_each(|(track, segments)| review.set(track, segments));
        told = if reviewer.is_pending() { reviewer.look(&()).unwrap() } else { Vec::new() };
    }
}

#[test]
fn told_of_edits_it_knows_what_one_that_begins_anew_finds_with_any_number_of_threads() {
    let (_folder, mut session, astray) = project();
    let (mut known, mut kept) = (Known::default(), Review::default());
    let mut reviewer = Reviewer::new(Arc::clone(&session.media), 2);
    all(&mut reviewer, &mut known, &session.project, &mut kept);
    let key = Edit::SetKey { track: astray, frame: 15, key: Key::set(30.0, 40.0) };
    let tracks = session.project.document().tracks().map(|(id, _)| id).take(2).collect();
    let id = in_one_chain(&mut session.project);
    let steps = [
        Transaction::show_clustering(id, 1),
        Transaction::new("moved", vec![key]),
        Transaction::show_clustering(id, 6),
        Transaction::new("deleted", vec![Edit::DeleteTracks { tracks }]),
    ];
    for step in steps {
        session.project.commit(step).unwrap();
        all(&mut reviewer, &mut known, &session.project, &mut kept);
        for threads in [1, 3] {
            let (mut fresh, mut anew) =
                (Reviewer::new(Arc::clone(&session.media), threads), Review::default());
            all(&mut fresh, &mut Known::default(), &session.project, &mut anew);
            assert_eq!(anew, kept);
        }
    }
    assert!(Changes::since(&mut known, &session.project).unwrap().is_empty());
}

/// Keeps a clustering in which every track joins those before it.
fn in_one_chain(project: &mut Project) -> ClusteringId {
    let tracks: Vec<TrackId> = project.document().tracks().map(|(id, _)| id).collect();
    let n = u32::try_from(tracks.len()).unwrap();
    let merge =
        |k: u32| Merge { a: if k == 0 { 0 } else { n + k - 1 }, b: k + 1, height: k.into(), size: k + 2 };
    let dendrogram = Dendrogram::new(n, (0..n - 1).map(merge).collect()).unwrap();
    let (outlier_frames, notes, provenance) = (Vec::new(), Vec::new(), provenance("chain"));
    project
        .save_clustering(&Clustering { provenance, tracks, dendrogram, cut: 1, outlier_frames, notes })
        .unwrap()
}

#[test]
fn once_tracks_are_grouped_the_one_that_leaves_its_groups_way_is_known_by_it() {
    let (_folder, mut session, astray) = project();
    let far = |session: &Session| {
        let found = review(&session.project, Arc::clone(&session.media), &()).unwrap();
        found.queue.first().map(|item| (item.track, item.parts.group_px)).unwrap()
    };
    assert_eq!(far(&session), (astray, None));
    let id = in_one_chain(&mut session.project);
    session.project.commit(Transaction::show_clustering(id, 1)).unwrap();
    let (track, px) = far(&session);
    // It is as far off as it strays, but for how the leaves about it sway.
    assert!(track == astray && px.is_some_and(|px| px > 40.0 && px < 110.0), "{px:?}");
    session.project.undo().unwrap();
    assert_eq!(far(&session), (astray, None));
}

/// Stops after so many reports.
struct StopAfter(AtomicU64);

impl Progress for StopAfter {
    fn report(&self, _: u64, _: u64, _: &str) -> Flow {
        let left = self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1));
        if left.is_ok() { Flow::Continue } else { Flow::Stop }
    }
}

#[test]
fn stopped_it_says_so() {
    let (_folder, session, _) = project();
    let stopped = review(&session.project, Arc::clone(&session.media), &StopAfter(AtomicU64::new(5)));
    assert!(matches!(stopped, Err(WorkbenchError::Stopped)), "{stopped:?}");
}

/// Fails as a fault of the program would.
struct Faulty;

impl Progress for Faulty {
    fn report(&self, _: u64, _: u64, _: &str) -> Flow {
        panic!("a fault, for the test's sake")
    }
}

#[test]
fn a_fault_is_said_and_not_taken_for_a_stop() {
    let (_folder, session, _) = project();
    let mut reviewer = Reviewer::new(Arc::clone(&session.media), 2);
    reviewer.tell(Changes::since(&mut Known::default(), &session.project).unwrap());
    assert!(reviewer.is_pending());
    assert!(matches!(reviewer.look(&Faulty), Err(WorkbenchError::Fault)));
}

#[test]
fn a_refused_step_uses_no_number_up() {
    use crate::correct::{Step, prepare};
    let (_folder, mut session, track) = project();
    let project = &mut session.project;
    let refused = prepare(project, &Step::Split { track, frame: 0 });
    assert!(refused.is_err());
    let (_, new) = prepare(project, &Step::Split { track, frame: 9 }).unwrap();
    assert_eq!(new, Some(TrackId(track.0 + 1)));
}
