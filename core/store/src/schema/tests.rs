//! Projects of every schema there ever was, kept in `core/store/tests/schemas`: today's program opens them all.
//!
//! Each was made by the steps of the schema up to its own, with the rows of a project of the day that it was made in, as
//! far as that schema has their tables and columns. One that is there is never made again; `REGENERATE=1` makes the newest.

use std::fs;
use std::path::{Path, PathBuf};

use honami_model::edit::Transaction;
use honami_model::hierarchy::{Dendrogram, Merge};
use honami_model::history::EntryId;
use honami_model::track::TrackId;
use rusqlite::Connection;

use super::{APPLICATION_ID, MIGRATIONS, SCHEMA};
use crate::testing::{Bench, N_FRAMES, provenance, sample, tracked};
use crate::{Access, Clustering, Project, RunState, StoreError};

fn kept(schema: u32) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/schemas/{schema}.honami"))
}

/// Two tracks, a key-frame, a name that was undone, and groups.
fn fill(bench: &Bench) {
    let mut project = tracked(bench, 0..2);
    project.set_author("ada");
    project.commit(Transaction::set_key(TrackId(1), 50, [9.0, 8.5], None)).unwrap();
    let merges = vec![Merge { a: 0, b: 1, height: 0.5, size: 2 }];
    let made = Clustering {
        provenance: provenance("cluster", project.revision().0),
        tracks: vec![TrackId(0), TrackId(1)],
        dendrogram: Dendrogram::new(2, merges).unwrap(),
        cut: 2,
        outlier_frames: vec![4],
        notes: vec!["two groups".to_owned()],
    };
    let id = project.save_clustering(&made).unwrap();
    project.commit(Transaction::show_clustering(id, made.cut)).unwrap();
    project.commit(Transaction::name_track(TrackId(0), Some("bud".to_owned()))).unwrap();
    project.undo().unwrap();
}

/// The columns of every table, as this database has them.
fn tables(conn: &Connection) -> Vec<(String, Vec<String>)> {
    let names = |sql: &str| {
        let mut statement = conn.prepare(sql).unwrap();
        let names = statement.query_map([], |row| row.get(0)).unwrap();
        names.collect::<Result<Vec<String>, _>>().unwrap()
    };
    let columns = |table: &str| names(&format!("SELECT name FROM pragma_table_info('{table}')"));
    let all = names("SELECT name FROM main.sqlite_schema WHERE type = 'table'");
    all.into_iter().map(|table| (table.clone(), columns(&table))).collect()
}

/// Makes the project of a schema out of one of today.
fn make(schema: u32, from: &Path, to: &Path) {
    let conn = Connection::open(to).unwrap();
    conn.pragma_update(None, "application_id", APPLICATION_ID).unwrap();
    MIGRATIONS[..schema as usize].iter().for_each(|step| conn.execute_batch(step).unwrap());
    conn.pragma_update(None, "user_version", schema).unwrap();
    let tables = tables(&conn);
    conn.pragma_update(None, "foreign_keys", false).unwrap();
    conn.execute("ATTACH ?1 AS today", [from.to_str().unwrap()]).unwrap();
    for (table, columns) in tables {
        let columns = columns.join(", ");
        let sql = format!("INSERT INTO main.{table} ({columns}) SELECT {columns} FROM today.{table}");
        conn.execute(&sql, []).unwrap();
    }
}

/// What [`fill`] has done is there, and goes on.
fn assert_filled(project: &mut Project, schema: u32) {
    assert_eq!(project.integrity().unwrap(), Vec::<String>::new(), "schema {schema}");
    let labels: Vec<_> = project.history().entries().iter().map(|entry| entry.label.as_str()).collect();
    assert_eq!((labels.len(), labels[4]), (5, "track 0 named bud"), "schema {schema}: {labels:?}");
    assert_eq!(project.history().entries()[2].author, "ada");
    let [key, other] = [1, 0].map(|track| project.shown(TrackId(track)).unwrap().unwrap());
    let at = |frame: u32| *key.get(frame).unwrap();
    assert_eq!((at(50).x, at(50).y), (9.0, 8.5), "schema {schema}");
    for frame in 0..N_FRAMES {
        assert_eq!(other.get(frame).copied(), Some(sample(0, frame)), "schema {schema}, frame {frame}");
    }
    let run = project.run(honami_model::document::RunId(1)).unwrap();
    assert_eq!((run.state, run.head.frames.end), (RunState::Complete, N_FRAMES));
    assert_eq!(run.head.provenance, provenance("track", 0));
    let groups = project.grouping().unwrap().unwrap();
    assert_eq!(groups.group_of.values().copied().collect::<Vec<_>>(), [0, 1]);
    assert_eq!(project.redo().unwrap().unwrap().label, "track 0 named bud");
    assert_eq!(project.document().track(TrackId(0)).unwrap().name.as_deref(), Some("bud"));
    let edit = Transaction::set_key(TrackId(0), 7, [1.0, 2.0], None);
    assert_eq!(project.commit(edit).unwrap(), EntryId(5));
}

#[test]
fn projects_of_every_schema_open_here() {
    for schema in 1..=SCHEMA {
        let bench = Bench::new();
        if std::env::var_os("REGENERATE").is_some() && !kept(schema).exists() {
            fill(&bench);
            make(schema, &bench.path(), &kept(schema));
            fs::remove_file(bench.path()).unwrap();
        }
        fs::copy(kept(schema), bench.path())
            .unwrap_or_else(|error| panic!("{error}: {}; REGENERATE=1 makes it", kept(schema).display()));
        let reader = Project::open(&bench.path(), Access::Read);
        let is_older = matches!(&reader, Err(StoreError::Older { came, .. }) if *came == schema);
        assert_eq!((is_older, reader.is_ok()), (schema < SCHEMA, schema == SCHEMA), "schema {schema}");
        assert!(fs::read(kept(schema)).unwrap() == fs::read(bench.path()).unwrap(), "a look changes nothing");
        assert_filled(&mut Project::open(&bench.path(), Access::Write).unwrap(), schema);
        let reader = Project::open(&bench.path(), Access::Read).unwrap();
        assert_eq!(super::version(&reader.conn, &bench.path()).unwrap(), SCHEMA);
        assert_eq!(reader.revision(), EntryId(5));
    }
}

#[test]
fn a_project_of_a_newer_program_is_refused_by_name_and_left_as_it_is() {
    let bench = Bench::new();
    fs::copy(kept(SCHEMA), bench.path()).unwrap();
    Connection::open(bench.path()).unwrap().pragma_update(None, "user_version", SCHEMA + 1).unwrap();
    let before = fs::read(bench.path()).unwrap();
    for access in [Access::Read, Access::Write] {
        let error = Project::open(&bench.path(), access).unwrap_err();
        assert!(matches!(error, StoreError::Newer { came, .. } if came == SCHEMA + 1), "{error}");
        let said = error.to_string();
        assert!(said.contains("plant.honami") && said.contains("update honami"), "{said}");
        assert!(fs::read(bench.path()).unwrap() == before, "byte for byte");
        assert_eq!(bench.names(), ["plant.honami"], "nothing beside it");
    }
}
