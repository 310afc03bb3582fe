//! Runs: what was appended is what is read, whoever died in between.

use std::collections::BTreeMap;
use std::ops::Range;

use honami_model::edit::Transaction;
use honami_model::history::EntryId;
use honami_model::track::{Sample, TrackId, TrackSet};
use proptest::prelude::*;
use rusqlite::Connection;

use super::{Build, RunInfo, RunState, Seam};
use crate::testing::{Bench, N_FRAMES, head, rows, sample, tracks};
use crate::{Access, Project, StoreError};

/// All samples of a run by track and frame, as the project gives them track by track and all together.
fn samples_of(project: &Project, run: &RunInfo) -> BTreeMap<(u32, u32), Sample> {
    let all = project.run_tracks(run.id).expect("readable");
    let mut one_by_one = Vec::new();
    for track in (0..20).map(TrackId) {
        one_by_one
            .extend(project.run_spans(run.id, track).expect("readable").into_iter().map(|s| (track, s)));
    }
    assert_eq!(one_by_one, all);
    all.iter()
        .flat_map(|(track, span)| span.frames().map(|frame| (track.0, frame)).zip(span.samples.clone()))
        .collect()
}

type Extent = (TrackSet, Range<u32>);

/// What a run says it has.
fn extent(run: &RunInfo) -> Extent {
    (run.tracks.clone(), run.found.clone())
}

/// What a run with these samples must say.
fn extent_of(samples: &BTreeMap<(u32, u32), Sample>) -> Extent {
    let frames = || samples.keys().map(|key| key.1);
    let found = frames().min().unwrap_or(0)..frames().max().map_or(0, |last| last + 1);
    (samples.keys().map(|key| TrackId(key.0)).collect(), found)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// Chunks in any order, with gaps and repetitions, read while the run works, after it was interrupted
    /// or ended, and after reopening; in several passes, for tests hold few samples at once.
    #[test]
    fn reads_what_was_written_last(
        pieces in prop::collection::vec((0_u32..20, 1_u32..6, 0_u32..120, 0_u32..80), 0..12),
        end in 0..3,
    ) {
        let bench = Bench::new();
        let mut project = bench.create();
        let mut writer = project.begin_run(&head(0..20)).unwrap();
        let id = writer.run();
        let mut want = BTreeMap::new();
        for (k, (track, n_tracks, frame, n_frames)) in (0_u8..).zip(pieces) {
            let (numbers, frames) = (track..(track + n_tracks).min(20), frame..frame + n_frames);
            let mut frames_of_samples = rows(numbers, frames);
            for (frame, row) in (frame..).zip(&mut frames_of_samples) {
                for (track, sample) in row {
                    sample.x = f32::from(k);
                    want.insert((track.0, frame), *sample);
                }
            }
            writer.append(frame, &frames_of_samples).unwrap();
        }
        let working = project.run(id).unwrap();
        prop_assert_eq!(&working.state, &RunState::Running);
        prop_assert_eq!(&samples_of(&project, &working), &want);
        prop_assert_eq!(extent(&working), extent_of(&want), "told while it works");
        let state = match end {
            0 => { writer.finish().unwrap(); RunState::Complete }
            1 => { writer.abandon("by hand").unwrap(); RunState::Stopped { reason: "by hand".to_owned() } }
            _ => { drop(writer); RunState::Interrupted }
        };
        drop(project);
        for access in [Access::Read, Access::Write, Access::Read] {
            let project = Project::open(&bench.path(), access).unwrap();
            let ended = project.run(id).unwrap();
            prop_assert_eq!((&ended.state, &ended.head), (&state, &head(0..20)));
            prop_assert_eq!(&samples_of(&project, &ended), &want);
            prop_assert_eq!(extent(&ended), extent_of(&want));
        }
    }
}

#[test]
fn edits_go_on_while_a_run_writes() {
    let bench = Bench::new();
    let mut project = bench.create();
    let numbers = project.reserve_tracks(10).unwrap();
    let mut writer = project.begin_run(&head(numbers.clone())).unwrap();
    let run = writer.run();
    let work = std::thread::Builder::new().name("run".to_owned()).spawn(move || {
        for frame in (0..N_FRAMES).step_by(4) {
            writer.append(frame, &rows(0..10, frame..frame + 4))?;
        }
        writer.finish()
    });
    let mine = project.reserve_tracks(1).unwrap().start;
    project.commit(Transaction::add_track(TrackId(mine), 0, 1.0, 1.0)).unwrap();
    for frame in 1..60 {
        project.commit(Transaction::set_key(TrackId(mine), frame, [2.0, 2.0], None)).unwrap();
        assert!(project.shown(TrackId(mine)).unwrap().is_some());
    }
    assert_eq!(work.unwrap().join().unwrap().unwrap(), run);
    project.commit(Transaction::show_run(run, project.run(run).unwrap().tracks)).unwrap();
    assert_eq!(project.shown_all().unwrap().len(), 11);
    assert_eq!(project.history().entries().len(), 62);
    assert_eq!(project.integrity().unwrap(), Vec::<String>::new());
}

#[test]
fn a_working_run_keeps_the_lock() {
    let bench = Bench::new();
    let mut project = bench.create();
    let mut writer = project.begin_run(&head(0..2)).unwrap();
    drop(project);
    let refused = Project::open(&bench.path(), Access::Write);
    assert!(matches!(refused, Err(StoreError::Locked { .. })));
    writer.append(0, &rows(0..2, 0..3)).unwrap();
    let reader = Project::open(&bench.path(), Access::Read).unwrap();
    assert_eq!(reader.run(writer.run()).unwrap().state, RunState::Running);
    let run = writer.finish().unwrap();
    assert_eq!(reader.run(run).unwrap().state, RunState::Complete, "a reader sees results that end");
    assert!(Project::open(&bench.path(), Access::Write).is_ok());
}

#[test]
fn only_what_exists_and_has_ended_is_shown() {
    let bench = Bench::new();
    let mut project = bench.create();
    let mut writer = project.begin_run(&head(0..2)).unwrap();
    let run = writer.run();
    let show = |numbers| Transaction::show_run(run, tracks(numbers));
    assert!(matches!(project.commit(show(0..2)), Err(StoreError::RunWorks(_))));
    let nan = vec![vec![(TrackId(1), Sample { x: f32::NAN, ..sample(1, 5) })]];
    assert_eq!(
        writer.append(5, &nan).unwrap_err().to_string(),
        "track 1: the position at frame 5 is not finite; the tracker must not return it"
    );
    writer.append(0, &rows(0..2, 0..9)).unwrap();
    writer.finish().unwrap();
    assert!(matches!(project.commit(show(0..3)), Err(StoreError::NotInRun { track: TrackId(2), .. })));
    let other = honami_model::document::RunId(9);
    assert!(matches!(
        project.commit(Transaction::show_run(other, tracks(0..1))),
        Err(StoreError::NoSuchRun(_))
    ));
    assert_eq!(project.revision().0, 0, "nothing happened");
    project.commit(show(0..2)).unwrap();
    assert_eq!(project.sample_runs(TrackId(1)).unwrap(), [Some(run); 9]);
    assert_eq!([3, 9].map(|frame| project.run_at(TrackId(1), frame).unwrap()), [Some(run), None]);
}

#[test]
fn a_run_that_is_taken_back_leaves_nothing() {
    let bench = Bench::new();
    let mut project = bench.create();
    let mut writer = project.begin_run(&head(0..2)).unwrap();
    writer.append(0, &rows(0..2, 0..9)).unwrap();
    writer.discard().unwrap();
    assert!(project.runs().unwrap().is_empty());
    let mut writer = project.begin_run(&head(0..2)).unwrap();
    writer.append(0, &rows(0..1, 0..3)).unwrap();
    let run = writer.finish().unwrap();
    assert_eq!(project.run_tracks(run).unwrap().len(), 1, "nothing of the other's");
}

#[test]
fn an_interrupted_run_waits_until_it_was_shown() {
    let bench = Bench::new();
    let mut project = bench.create();
    let mut runs = Vec::new();
    for numbers in [0..2, 2..5] {
        let mut writer = project.begin_run(&head(numbers.clone())).unwrap();
        writer.append(0, &rows(numbers, 0..9)).unwrap();
        runs.push(writer.run());
    }
    // Stopped and ended runs are no business of the next session.
    project.begin_run(&head(5..6)).unwrap().abandon("by hand").unwrap();
    project.begin_run(&head(5..6)).unwrap().finish().unwrap();
    drop(project);
    let [first, second] = runs[..] else { panic!("two runs") };
    let show = |run, numbers| Some(Transaction::show_run(run, tracks(numbers)));
    // What a session does before it dies, and the runs left to show then and when the next one opens.
    let sessions = [
        (None, vec![first, second]),
        (None, vec![first, second]),
        (Some(Transaction::add_track(TrackId(7), 0, 1.0, 1.0)), vec![first, second]),
        (show(second, 2..5), vec![first]),
        (None, vec![first]),
        (show(first, 0..2), vec![]),
        (None, vec![]),
    ];
    for (step, (edit, left)) in sessions.into_iter().enumerate() {
        let mut project = Project::open(&bench.path(), Access::Write).unwrap();
        if let Some(edit) = edit {
            project.commit(edit).unwrap();
        }
        assert_eq!(project.interrupted(), left, "step {step}");
        drop(project);
        for (access, left) in [(Access::Read, vec![]), (Access::Write, left)] {
            let project = Project::open(&bench.path(), access).unwrap();
            assert_eq!(project.interrupted(), left, "after step {step}");
        }
    }
    // What was undone is not forced on anybody again, also where another edit was made instead.
    let mut project = Project::open(&bench.path(), Access::Write).unwrap();
    project.jump(EntryId::ROOT).unwrap();
    project.commit(Transaction::add_track(TrackId(8), 0, 1.0, 1.0)).unwrap();
    drop(project);
    let project = Project::open(&bench.path(), Access::Write).unwrap();
    assert_eq!((project.interrupted(), project.document().runs().len()), (&[][..], 0));
}

#[test]
fn every_frame_can_be_told_the_build_that_tracked_it_and_seams_of_before_have_none() {
    let bench = Bench::new();
    let mut project = bench.create();
    let mut writer = project.begin_run(&head(0..2)).unwrap();
    let id = writer.run();
    let build = |name: &str| Build { version: name.to_owned(), sha256: format!("{name}-of-64-digits") };
    let seam = |frame, build| Seam { frame, why: "was rebuilt".to_owned(), build };
    // The second is given up at its third frame: what it had tracked is tracked anew by the first.
    let first = Build {
        version: project.run(id).unwrap().head.provenance.plugin_version,
        sha256: project.run(id).unwrap().head.provenance.plugin_sha256,
    };
    let seams = [
        seam(10, Some(build("second"))),
        seam(10, Some(first.clone())),
        seam(15, None),
        seam(20, Some(build("third"))),
    ];
    for seam in &seams {
        writer.seam(seam).unwrap();
    }
    writer.append(0, &rows(0..2, 0..30)).unwrap();
    writer.finish().unwrap();
    let run = project.run(id).unwrap();
    assert_eq!(run.seams, seams);
    assert_eq!(
        seams[0].to_string(),
        "started again at frame 10: it was rebuilt, and goes on as second (second-o…)"
    );
    let builds = [0, 9, 10, 19, 20, 29].map(|frame| run.build_of(frame));
    let third = build("third");
    assert_eq!(builds.each_ref(), [&first, &first, &first, &first, &third, &third]);
    drop(project);
    // As the schema before was.
    let conn = Connection::open(bench.path()).unwrap();
    conn.execute_batch(
        "DROP TABLE step; DROP TABLE space; DROP TABLE matte; ALTER TABLE seam DROP COLUMN plugin_version; ALTER TABLE seam DROP COLUMN plugin_sha256;
         ALTER TABLE run DROP COLUMN request;
         PRAGMA user_version = 3",
    )
    .unwrap();
    drop(conn);
    let run = Project::open(&bench.path(), Access::Write).unwrap().run(id).unwrap();
    assert_eq!(run.seams.iter().map(|seam| seam.frame).collect::<Vec<_>>(), [10, 10, 15, 20]);
    assert_eq!(run.build_of(29), first);
}
