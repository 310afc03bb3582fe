//! Tables read back to the same bits, say where they are wrong, and are never half there.

use std::path::PathBuf;

use honami_model::track::{Quality, Sample, Source, Status, TrackId};
use proptest::prelude::*;

use super::*;
use crate::{PointRow, TrackRow, TruthRow, spans, trust};

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn written<R: Row>(rows: &[R]) -> (tempfile::TempDir, PathBuf) {
    let folder = folder();
    let path = folder.path().join("table.csv");
    let mut table = Writer::create(&path).expect("a new table");
    rows.iter().for_each(|row| table.write(row).expect("a row"));
    table.finish().expect("a whole table");
    (folder, path)
}

fn error_of<R: Row + std::fmt::Debug>(text: &str) -> String {
    let folder = folder();
    let path = folder.path().join("t.csv");
    std::fs::write(&path, text).expect("written");
    let error = match read::<R>(&path) {
        Err(error) => error,
        Ok(rows) => rows.collect::<Result<Vec<R>, _>>().expect_err("a wrong table"),
    };
    error.to_string().replace(&path.display().to_string(), "t.csv")
}

fn row(track: u32, frame: u32, x: f32) -> TrackRow {
    let quality = Quality { fb_px: Some(0.1), ncc: None };
    let sample = Sample { x, y: -0.5, status: Status::Tracked, source: Source::Tracked, quality };
    TrackRow { track: TrackId(track), frame, time_s: Some(f64::from(frame) / 29.97), sample, run: Some(3) }
}

proptest! {
    #[test]
    fn tracks_read_back_to_the_same_bits(
        track: u32, frame: u32, time_s in proptest::option::of(-1e9_f64..1e9), x in -1e6_f32..1e6, y: f32,
        status in 0_u8..6, fb_px in proptest::option::of(0.0_f32..1e6), ncc in proptest::option::of(-1.0_f32..=1.0),
        run: Option<u64>,
    ) {
        prop_assume!(y.is_finite());
        let status = Status::from_u8(status).expect("a status");
        let sample = Sample { x, y, status, source: Source::Sketch, quality: Quality { fb_px, ncc } };
        let row = TrackRow { track: TrackId(track), frame, time_s, sample, run };
        let (_folder, path) = written(&[row]);
        let back = read::<TrackRow>(&path).expect("opens").collect::<Result<Vec<_>, _>>().expect("reads");
        prop_assert_eq!(back, vec![row]);
    }
}

#[test]
fn the_headers_are_those_of_the_manual() {
    let header = |path: PathBuf| std::fs::read_to_string(path).unwrap().lines().next().unwrap().to_owned();
    let (_a, tracks) = written::<TrackRow>(&[]);
    let (_b, points) = written::<PointRow>(&[]);
    let (_c, truth) = written::<TruthRow>(&[]);
    assert_eq!(header(tracks), "track,frame,time_s,x,y,status,source,quality,fb,ncc,run");
    assert_eq!(header(points), "id,x,y,frame");
    assert_eq!(header(truth), "track,frame,x,y,visible,branch");
}

#[test]
fn a_row_is_as_short_as_it_can_be() {
    let (_folder, path) = written(&[row(4, 0, 0.1)]);
    let text = std::fs::read_to_string(path).unwrap();
    assert_eq!(text.lines().nth(1).unwrap(), "4,0,0,0.1,-0.5,1,tracked,0.9090909,0.1,,3");
    let (_folder, path) =
        written(&[TruthRow { track: 1, frame: 2, x: 3.5, y: 4.0, visible: true, branch: 9 }]);
    assert_eq!(std::fs::read_to_string(path).unwrap().lines().nth(1).unwrap(), "1,2,3.5,4,1,9");
}

#[test]
fn names_of_any_kind_read_back() {
    for name in ["", "the \"old\" oak, left", "two\nlines", "葉"] {
        let row = crate::GroupRow { track: TrackId(1), group: 2, name: name.to_owned() };
        let (_folder, path) = written(std::slice::from_ref(&row));
        assert_eq!(read::<crate::GroupRow>(&path).unwrap().map(Result::unwrap).collect::<Vec<_>>(), [row]);
    }
}

#[test]
fn columns_are_found_by_name() {
    let folder = folder();
    let path = folder.path().join("foreign.csv");
    std::fs::write(&path, "\u{feff}y,species, x ,frame,track\r\n2.5,\"oak, old\",1.5,7,3\r\n").unwrap();
    let rows: Vec<TrackRow> = read(&path).unwrap().map(Result::unwrap).collect();
    let sample = rows[0].sample;
    assert_eq!((rows[0].track, rows[0].frame, sample.x, sample.y), (TrackId(3), 7, 1.5, 2.5));
    assert_eq!((sample.status, sample.source, rows[0].time_s), (Status::Tracked, Source::Imported, None));
}

#[test]
fn an_error_names_line_column_wanted_and_came() {
    let cases = [
        (
            "track,frame,x\n",
            "t.csv line 1: wanted the columns track,frame,x,y; `y` is missing from `track,frame,x`",
        ),
        (
            "track,frame,x,y\n1,0,1,1\n1,1,NaN,1\n",
            "t.csv line 3, column `x`: wanted a finite number, came `NaN`",
        ),
        (
            "track,frame,x,y\n1,-1,2,1\n",
            "t.csv line 2, column `frame`: wanted a whole number of 0 or more, came `-1`",
        ),
        ("track,frame,x,y\n1,0,,1\n", "t.csv line 2, column `x`: wanted a finite number, came ``"),
        (
            "track,frame,x,y,status\n1,0,1,1,9\n",
            "t.csv line 2, column `status`: wanted 0 to 5, or lost, tracked, …, newborn, came `9`",
        ),
    ];
    for (text, wanted) in cases {
        assert_eq!(error_of::<TrackRow>(text), wanted);
    }
    assert!(error_of::<PointRow>("id,x,y\n1,2\n").contains("line: 2"), "uneven rows");
    assert!(error_of::<TruthRow>("").contains("`track` is missing"));
}

#[test]
fn what_is_not_finished_leaves_the_old_table_and_nothing_else() {
    let (folder, path) = written(&[row(1, 0, 1.0)]);
    let before = std::fs::read(&path).unwrap();
    let mut table = Writer::create(&path).unwrap();
    table.write(&row(2, 0, 2.0)).unwrap();
    let error = table.write(&row(3, 0, f32::NAN)).unwrap_err();
    assert!(error.to_string().ends_with("line 3: column `x` would be NaN; only finite numbers are written"));
    drop(table);
    assert_eq!(std::fs::read(&path).unwrap(), before);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    assert!(matches!(
        Writer::<TrackRow>::create(&folder.path().join("no/t.csv")),
        Err(TableError::File { .. })
    ));
}

#[test]
fn spans_fill_gaps_with_lost_samples() {
    let rows = [row(2, 9, 1.0), row(1, 5, 5.0), row(2, 6, 6.0), row(2, 9, 9.0)];
    let gathered = spans(rows.map(Ok), 10).unwrap();
    let span = &gathered[&TrackId(2)];
    assert_eq!(span.frames(), 6..10);
    let seen: Vec<_> = span.samples.iter().map(|s| (s.x, s.status.is_seen())).collect();
    assert_eq!(seen, [(6.0, true), (6.0, false), (6.0, false), (9.0, true)]);
    assert_eq!(gathered[&TrackId(1)].frames(), 5..6);
    let beyond = spans(rows.map(Ok), 9).unwrap_err();
    assert_eq!(beyond.to_string(), "track 2 has a row for frame 9, but the clip has 9 frames (0 the first)");
}

#[test]
fn the_worst_part_decides_the_trust() {
    let quality = |fb_px, ncc| trust(Quality { fb_px, ncc });
    assert_eq!(quality(None, None), None);
    assert_eq!(quality(Some(1.0), None), Some(0.5));
    assert_eq!(quality(Some(0.0), Some(0.8)), Some(0.8));
    assert_eq!(quality(Some(3.0), Some(0.8)), Some(0.25));
    assert_eq!(quality(None, Some(-0.4)), Some(0.0));
}
