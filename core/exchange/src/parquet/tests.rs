//! What the Parquet table refuses.

use std::path::Path;

use honami_model::track::{Quality, Sample, Source, Status, TrackId};

use super::*;

fn row(x: f32) -> TrackRow {
    let quality = Quality::default();
    let sample = Sample { x, y: 1.0, status: Status::Tracked, source: Source::Tracked, quality };
    TrackRow { track: TrackId(u32::MAX), frame: 7, time_s: None, sample, run: None }
}

#[test]
fn what_is_not_finished_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("t.parquet");
    let mut table = ParquetWriter::create(&path).expect("a new table");
    table.write(&row(1.0)).expect("a row");
    let error = table.write(&row(f32::NAN)).expect_err("no number").to_string();
    assert!(error.ends_with("line 2: column `x` would be NaN; only finite numbers are written"), "{error}");
    drop(table);
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
    assert!(matches!(ParquetWriter::create(Path::new("no/such/t.parquet")), Err(TableError::File { .. })));
}

#[test]
fn large_numbers_and_several_groups_come_back() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("t.parquet");
    let mut table = ParquetWriter::create(&path).expect("a new table");
    let n = GROUP_ROWS as u32 + 10;
    for frame in 0..n {
        table.write(&TrackRow { frame, ..row(frame as f32) }).expect("a row");
    }
    table.finish().expect("a whole table");
    let read = parse(std::fs::File::open(&path).expect("a file")).expect("a table");
    assert_eq!((read.tracks.len(), read.tracks[0].number), (1, Some(u32::MAX)));
    assert_eq!(read.tracks[0].spans[0].frames(), 0..n);
    assert!(read.tracks[0].samples().all(|(frame, sample)| sample.x.to_bits() == (frame as f32).to_bits()));
}
