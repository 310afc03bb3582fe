//! Projects: made, found damaged, edited, undone, closed and opened again.

use honami_model::document::ClusteringId;
use honami_model::edit::Transaction;
use honami_model::hierarchy::{Dendrogram, Merge};
use honami_model::history::EntryId;
use honami_model::provenance::Provenance;
use honami_model::track::{Source, TrackId};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use rusqlite::Connection;

use super::{Access, Project};
use crate::testing::{Bench, N_FRAMES, head, provenance, rows, tracked, tracks};
use crate::{Clustering, LogItem, RunHead, StoreError};

#[test]
fn a_new_project_is_one_file_and_is_never_made_over_another() {
    let bench = Bench::new();
    let project = bench.create();
    assert_eq!(bench.names(), [".plant.honami.lock", "plant.honami"]);
    assert_eq!(project.clip().path.to_str(), Some("clip.mp4"), "relative to the project");
    assert_eq!(project.clip().clip, bench.record().clip);
    drop(project);
    assert_eq!(bench.names(), ["plant.honami"]);
    let open = Project::open(&bench.path(), Access::Write).unwrap();
    assert!(matches!(Project::create(&bench.path(), &bench.record()), Err(StoreError::Exists(_))));
    drop(open);
    for _ in 0..2 {
        let refused = Project::create(&bench.path(), &bench.record());
        assert!(matches!(refused, Err(StoreError::Exists(_))));
        assert_eq!(bench.names(), ["plant.honami"], "nothing half-made");
        // A link to nowhere is not overwritten either.
        std::fs::remove_file(bench.path()).unwrap();
        std::os::unix::fs::symlink("nowhere", bench.path()).unwrap();
    }
    let nowhere = bench.folder.path().join("no/such/folder.honami");
    assert!(matches!(Project::create(&nowhere, &bench.record()), Err(StoreError::Io { .. })));
}

#[test]
fn what_is_no_project_is_told_apart() {
    let bench = Bench::new();
    drop(bench.create());
    let bytes = std::fs::read(bench.path()).unwrap();
    let put = |name: &str, bytes: &[u8]| {
        let path = bench.folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let other = bench.folder.path().join("other.db");
    Connection::open(&other).unwrap().execute_batch("CREATE TABLE t (x)").unwrap();
    let newer = put("newer.honami", &bytes);
    Connection::open(&newer).unwrap().pragma_update(None, "user_version", 9).unwrap();
    let rootless = put("rootless.honami", &bytes);
    let conn = Connection::open(&rootless).unwrap();
    conn.execute_batch("PRAGMA foreign_keys = off; DELETE FROM clip").unwrap();
    let damaged = put("damaged.honami", &[&bytes[..4096], &vec![0xA5; bytes.len() - 4096]].concat());
    let cases = [
        (
            put("text.honami", &b"not a database at all, but long enough to be one".repeat(99)),
            "not a honami project",
        ),
        (put("empty.honami", b""), "not a honami project"),
        (put("short.honami", &bytes[..50]), "damaged"),
        (put("half.honami", &bytes[..bytes.len() / 2]), "damaged"),
        (other, "not a honami project"),
        (bench.folder.path().to_owned(), "not a honami project"),
        (bench.folder.path().join("gone.honami"), "cannot open the project"),
        (newer, "schema 9, this honami knows up to 8; update honami"),
        (damaged, "damaged"),
        (rootless, "damaged"),
    ];
    for (path, want) in cases {
        for access in [Access::Write, Access::Read] {
            let Err(error) = Project::open(&path, access) else { panic!("{} opened", path.display()) };
            assert!(error.to_string().contains(want), "{}: {error}", path.display());
        }
    }
    assert!(bench.names().iter().all(|name| !name.ends_with(".lock")), "{:?}", bench.names());
}

#[test]
fn a_second_session_reads_and_learns_who_writes() {
    let bench = Bench::new();
    let mut project = tracked(&bench, 0..3);
    let Err(StoreError::Locked { holder, .. }) = Project::open(&bench.path(), Access::Write) else {
        panic!("two writers")
    };
    assert_eq!(holder.as_ref(), project.holder());
    let mut reader = Project::open(&bench.path(), Access::Read).unwrap();
    assert_eq!((reader.access(), reader.holder()), (Access::Read, project.holder()));
    assert_eq!(reader.shown_all().unwrap(), project.shown_all().unwrap());
    let key = Transaction::set_key(TrackId(1), 7, [1.0, 2.0], None);
    assert!(matches!(reader.commit(key.clone()), Err(StoreError::ReadOnly)));
    assert!(matches!(reader.undo(), Err(StoreError::ReadOnly)));
    assert!(matches!(reader.reserve_tracks(1), Err(StoreError::ReadOnly)));
    assert!(matches!(reader.begin_run(&head(0..1)), Err(StoreError::ReadOnly)));
    project.commit(key).unwrap();
    assert_eq!(reader.document().track(TrackId(1)).unwrap().keys.len(), 0, "a reader stands still");
    let reader = Project::open(&bench.path(), Access::Read).unwrap();
    assert_eq!(reader.document(), project.document());
}

#[test]
fn undo_is_a_tree_that_survives_closing() {
    let bench = Bench::new();
    let mut project = tracked(&bench, 0..6);
    let mut rng = Pcg32::seed_from_u64(5);
    let mut documents = std::collections::BTreeMap::from([(project.revision(), project.document().clone())]);
    for step in 0..240 {
        match rng.random_range(0..10) {
            0..5 => {
                let (track, frame) = (TrackId(rng.random_range(0..6)), rng.random_range(0..N_FRAMES));
                let id =
                    project.commit(Transaction::set_key(track, frame, [step as f32, 0.5], None)).unwrap();
                documents.insert(id, project.document().clone());
            }
            5..7 => drop(project.undo().unwrap()),
            7 => drop(project.redo().unwrap()),
            8 => {
                let n = project.history().next_id().0;
                project.jump(EntryId(rng.random_range(1..n))).unwrap();
            }
            _ => {
                let (shown, history) = (project.shown_all().unwrap(), project.history().clone());
                drop(project);
                project = Project::open(&bench.path(), Access::Write).unwrap();
                assert_eq!(project.history(), &history);
                assert_eq!(project.shown_all().unwrap(), shown, "cached or read, the same");
            }
        }
        if let Some(want) = documents.get(&project.revision()) {
            assert_eq!(project.document(), want, "at entry {}", project.revision());
        }
    }
    assert!(matches!(project.jump(EntryId(9999)), Err(StoreError::NoSuchEntry(_))));
    project.jump(EntryId::ROOT).unwrap();
    assert!(project.undo().unwrap().is_none());
    assert_eq!(project.document().tracks().count(), 0, "undoing a run takes its tracks away");
    let again = project.redo().unwrap().unwrap();
    assert_eq!(again.label, "run 1 shown: 6 tracks");
    assert_eq!(project.shown_all().unwrap().len(), 6);
}

#[test]
fn hand_work_lies_over_runs_and_stays() {
    let bench = Bench::new();
    let mut project = tracked(&bench, 0..2);
    let track = TrackId(1);
    let before = project.shown(track).unwrap().unwrap();
    project.commit(Transaction::set_key(track, 50, [9.0, 9.0], None)).unwrap();
    // A later run over some frames of the same track.
    let mut writer = project.begin_run(&head(1..2)).unwrap();
    let mut later = rows(1..2, 40..60);
    later.iter_mut().for_each(|row| row[0].1.y = 77.0);
    writer.append(40, &later).unwrap();
    let run = writer.finish().unwrap();
    project.commit(Transaction::show_run(run, tracks(1..2))).unwrap();
    let shown = project.shown(track).unwrap().unwrap();
    let at = |frame: u32| *shown.get(frame).unwrap();
    assert_eq!((at(39), at(60)), (*before.get(39).unwrap(), *before.get(60).unwrap()));
    assert_eq!((at(45).y, at(50).y, at(50).source), (77.0, 9.0, Source::Key));
    let runs = project.sample_runs(track).unwrap();
    assert_eq!([39, 45, 50].map(|frame| runs[frame].map(|run| run.0)), [Some(1), Some(2), None]);
    let layers = project.layers(track).unwrap().unwrap();
    assert_eq!(layers.shown(&project.clip().clip.times).span(), &*shown, "the layers make what is shown");
    project.commit(Transaction::hide_run(run)).unwrap();
    assert_eq!(project.shown(track).unwrap().unwrap().get(50).unwrap().source, Source::Key);
    project.commit(Transaction::delete_tracks(tracks(1..2))).unwrap();
    assert_eq!((project.shown(track).unwrap(), project.shown_all().unwrap().len()), (None, 1));
    assert!(project.layers(track).unwrap().is_none());
}

#[test]
fn track_numbers_are_used_once() {
    let bench = Bench::new();
    let mut project = bench.create();
    project.claim_tracks(&tracks(0..4)).unwrap();
    assert_eq!(project.reserve_tracks(3).unwrap(), 4..7);
    drop(project);
    let mut project = Project::open(&bench.path(), Access::Write).unwrap();
    assert_eq!(project.reserve_tracks(1).unwrap(), 7..8);
    assert!(matches!(project.claim_tracks(&tracks(6..9)), Err(StoreError::TrackTaken(TrackId(6), 8))));
    project.claim_tracks(&tracks(20..22)).unwrap();
    assert_eq!(project.reserve_tracks(1).unwrap(), 22..23);
}

#[test]
fn a_full_disk_changes_nothing() {
    let bench = Bench::new();
    let mut project = tracked(&bench, 0..2);
    let pages: u32 = project.conn.pragma_query_value(None, "page_count", |row| row.get(0)).unwrap();
    project.conn.pragma_update_and_check(None, "max_page_count", pages, |_| Ok(())).unwrap();
    let document = project.document().clone();
    let label = "x".repeat(1 << 20);
    let mut transaction = Transaction::set_key(TrackId(0), 3, [1.0, 1.0], None);
    transaction.label = label;
    let error = project.commit(transaction.clone()).unwrap_err();
    assert!(matches!(error, StoreError::DiskFull), "{error}");
    assert_eq!((project.document(), project.revision()), (&document, EntryId(1)));
    project.conn.pragma_update_and_check(None, "max_page_count", 1 << 20, |_| Ok(())).unwrap();
    assert_eq!(project.commit(transaction).unwrap(), EntryId(2), "repeated when there is room");
}

#[test]
fn a_clip_that_moved_is_found_again_or_asked_for() {
    let bench = Bench::new();
    let project = bench.create();
    let hash = |path: &std::path::Path| std::fs::read_to_string(path).ok();
    assert!(matches!(project.find_media(hash), Err(StoreError::MediaMissing { .. })));
    let right = project.clip().sha256.clone();
    let sub = bench.folder.path().join("videos");
    std::fs::create_dir(&sub).unwrap();
    std::fs::write(project.media_path(), "another clip").unwrap();
    let error = project.find_media(hash).unwrap_err();
    assert!(error.to_string().contains("wanted SHA-256 0123456789ab…, came another clip…"), "{error}");
    std::fs::write(sub.join("clip.mp4"), &right).unwrap();
    let real_sub = sub.canonicalize().unwrap();
    assert_eq!(project.find_media(hash).unwrap(), real_sub.join("clip.mp4"));
    drop(project);
    let mut project = Project::open(&bench.path(), Access::Write).unwrap();
    assert!(project.relink(&sub.join("clip.mp4"), "other").is_err());
    project.relink(&sub.join("clip.mp4"), &right).unwrap();
    drop(project);
    // Moved together, project and clip still know each other.
    let away = tempfile::tempdir().unwrap();
    let home = away.path().join("home");
    std::fs::rename(bench.folder.path(), &home).unwrap();
    let project = Project::open(&home.join("plant.honami"), Access::Read).unwrap();
    assert_eq!(project.clip().path.to_str(), Some("videos/clip.mp4"));
    assert_eq!(project.find_media(hash).unwrap(), home.canonicalize().unwrap().join("videos/clip.mp4"));
}

fn three_tracks(input_revision: u32) -> Clustering {
    let merges = vec![Merge { a: 0, b: 2, height: 0.1, size: 2 }, Merge { a: 3, b: 1, height: 0.7, size: 3 }];
    Clustering {
        provenance: provenance("cluster", input_revision),
        tracks: vec![TrackId(0), TrackId(1), TrackId(2)],
        dendrogram: Dendrogram::new(3, merges).expect("a tree"),
        cut: 2,
        outlier_frames: vec![4, 9],
        notes: vec!["two groups".to_owned()],
    }
}

#[test]
fn groups_are_kept_named_and_told_when_stale() {
    let bench = Bench::new();
    let mut project = tracked(&bench, 0..5);
    let made = three_tracks(project.revision().0);
    let id = project.save_clustering(&made).unwrap();
    assert_eq!(project.clustering(id).unwrap(), made);
    assert_eq!(project.grouping().unwrap(), None);
    project.commit(Transaction::show_clustering(id, made.cut)).unwrap();
    let groups = project.grouping().unwrap().unwrap();
    assert_eq!(groups.group_of.values().copied().collect::<Vec<_>>(), [0, 1, 0]);
    assert_eq!(groups.nodes, [3, 1]);
    project.commit(Transaction::name_group(id, 3, Some("left branch".to_owned()))).unwrap();
    assert_eq!(project.document().group_name(id, groups.nodes[0]), Some("left branch"));
    project.commit(Transaction::set_key(TrackId(4), 3, [0.0, 0.0], None)).unwrap();
    assert_eq!(project.is_stale(id).unwrap(), None, "a track it never used");
    project.commit(Transaction::set_key(TrackId(2), 3, [0.0, 0.0], None)).unwrap();
    let stale = project.is_stale(id).unwrap().unwrap();
    assert_eq!(stale.to_string(), "stale: 1 of its 3 tracks changed since revision 1");
    project.undo().unwrap();
    assert_eq!(project.is_stale(id).unwrap(), None, "undone is as if never done");
    project.commit(Transaction::hide_run(honami_model::document::RunId(1))).unwrap();
    assert_eq!(project.is_stale(id).unwrap().unwrap().changed, tracks(0..3));
    assert!(matches!(
        project.commit(Transaction::show_clustering(ClusteringId(7), 2)),
        Err(StoreError::NoSuchClustering(_))
    ));
    let short = Clustering { tracks: vec![TrackId(0)], ..made };
    assert!(matches!(project.save_clustering(&short), Err(StoreError::Clustering { .. })));
}

#[test]
fn the_log_tells_everything_with_its_provenance() {
    let bench = Bench::new();
    let mut project = tracked(&bench, 0..3);
    project.set_author("grace");
    project.save_clustering(&three_tracks(1)).unwrap();
    project.commit(Transaction::name_track(TrackId(1), Some("bud".to_owned()))).unwrap();
    let log = project.log().unwrap();
    let lines: Vec<String> = log
        .iter()
        .map(|line| match &line.item {
            LogItem::Edit(entry) => format!("{} {}", entry.id, entry.label),
            LogItem::Run(run) => format!("run {} {} {}", run.id, run.state, run.head.provenance.plugin_id),
            LogItem::Clustering(made) => format!("clustering {} of {}", made.id, made.n_tracks),
            LogItem::Matte(made) => format!("matte {} of {}", made.id, made.frame),
            LogItem::Space(made) => format!("space {} of {}", made.id, made.n_tracks),
        })
        .collect();
    assert_eq!(
        lines,
        [
            "0 project made",
            "run 1 complete org.honami.klt",
            "1 run 1 shown: 3 tracks",
            "clustering 1 of 3",
            "2 track 1 named bud"
        ]
    );
    assert!(matches!(&log[4].item, LogItem::Edit(entry) if entry.author == "grace"));
}

/// Edits 0 project made, 1 track added, 2 run 1 shown, 3 clustering 1 shown, 4 track named; run 2 and
/// clustering 2 were made from 2 and never shown.
#[test]
fn the_log_tells_causes_before_effects() {
    // Second of each edit; of runs 1 and 2; of clusterings 1 and 2.
    let cases = [
        ("all in one second", [5; 5], [5; 2], [5; 2], "e0 e1 r1 e2 r2 c1 c2 e3 e4"),
        ("one after the other", [0, 1, 3, 6, 8], [2, 5], [4, 7], "e0 e1 r1 e2 c1 r2 e3 c2 e4"),
        ("results as they ended", [1, 1, 1, 2, 2], [1, 2], [2, 3], "e0 e1 r1 e2 r2 c1 e3 e4 c2"),
        ("results by a slow clock", [5, 6, 7, 8, 9], [0, 0], [0, 1], "e0 e1 r1 e2 r2 c1 c2 e3 e4"),
        ("results by a fast clock", [1, 2, 3, 4, 5], [9, 9], [9, 8], "e0 e1 r1 e2 c1 e3 e4 c2 r2"),
        ("a clock set back", [9, 9, 1, 2, 3], [1, 1], [2, 2], "e0 e1 r1 e2 r2 c1 c2 e3 e4"),
    ];
    for (name, edits, runs, clusterings, want) in cases {
        let bench = Bench::new();
        let mut project = bench.create();
        let date = |second: u32| format!("2026-01-02T03:04:{second:02}Z");
        let dated = |second, revision| Provenance { date: date(second), ..provenance("made", revision) };
        let run = |project: &mut Project, revision, second| {
            let head = RunHead { provenance: dated(second, revision), ..head(0..3) };
            let mut writer = project.begin_run(&head).unwrap();
            writer.append(0, &rows(0..3, 0..1)).unwrap();
            writer.finish().unwrap()
        };
        project.commit(Transaction::add_track(TrackId(9), 0, 1.0, 1.0)).unwrap();
        let shown = run(&mut project, 1, runs[0]);
        project.commit(Transaction::show_run(shown, tracks(0..3))).unwrap();
        run(&mut project, 2, runs[1]);
        let saved = clusterings.map(|second| {
            let made = Clustering { provenance: dated(second, 2), ..three_tracks(2) };
            project.save_clustering(&made).unwrap()
        });
        project.commit(Transaction::show_clustering(saved[0], 2)).unwrap();
        project.commit(Transaction::name_track(TrackId(1), Some("bud".to_owned()))).unwrap();
        for (id, second) in (0_u32..).zip(edits) {
            let values = rusqlite::params![date(second), id];
            project.conn.execute("UPDATE entry SET time = ?1 WHERE id = ?2", values).unwrap();
        }
        drop(project);
        let log = Project::open(&bench.path(), Access::Read).unwrap().log().unwrap();
        let words = log.iter().map(|line| match &line.item {
            LogItem::Edit(entry) => format!("e{}", entry.id),
            LogItem::Run(run) => format!("r{}", run.id),
            LogItem::Clustering(made) => format!("c{}", made.id),
            LogItem::Matte(made) => format!("m{}", made.id),
            LogItem::Space(made) => format!("s{}", made.id),
        });
        assert_eq!(words.collect::<Vec<_>>().join(" "), want, "{name}");
    }
}

#[test]
fn a_seat_is_kept_without_an_edit_and_a_project_of_before_gets_one() {
    let bench = Bench::new();
    drop(bench.create());
    // As the first schema was.
    let conn = Connection::open(bench.path()).unwrap();
    conn.execute_batch(
        "DROP TABLE step; DROP TABLE space; DROP TABLE matte; DROP TABLE seam; DROP TABLE seat; ALTER TABLE run DROP COLUMN request; PRAGMA user_version = 1",
    )
    .unwrap();
    drop(conn);
    let mut project = Project::open(&bench.path(), Access::Write).unwrap();
    assert_eq!(project.seat().unwrap(), None);
    for state in ["{}", r#"{"frame":12}"#] {
        project.set_seat(state).unwrap();
        assert_eq!(project.seat().unwrap().as_deref(), Some(state));
    }
    assert_eq!(project.history().entries().len(), 1, "being somewhere is no edit");
    let mut reader = Project::open(&bench.path(), Access::Read).unwrap();
    assert!(matches!(reader.set_seat("{}"), Err(StoreError::ReadOnly)));
    drop(project);
    let project = Project::open(&bench.path(), Access::Write).unwrap();
    assert_eq!(project.seat().unwrap().as_deref(), Some(r#"{"frame":12}"#));
}
