//! Mattes come back as they were kept, in whichever frame they count.

use honami_model::document::MatteId;
use honami_model::edit::Transaction;
use rusqlite::Connection;

use super::KeptMatte;
use crate::testing::{Bench, provenance};
use crate::{Access, LogItem, Project, StoreError};

fn matte(frame: u32) -> KeptMatte {
    let plane = |most: u32, k: u32| (0..64 * 48).map(|pixel| (pixel / (k + frame) % most) as u8).collect();
    KeptMatte {
        provenance: provenance("matte", 0),
        frame,
        width: 64,
        height: 48,
        parts: plane(5, 300),
        opacity: plane(256, 1),
        marks: plane(3, 77),
    }
}

#[test]
fn a_matte_counts_from_its_frame_on_and_the_first_before_it() {
    let bench = Bench::new();
    let mut project = bench.create();
    let ids = project.save_mattes(&[matte(20), matte(50)]).unwrap();
    assert_eq!(project.document().matte_at(20), None, "what is found does not count yet");
    project.commit(Transaction::keep_mattes(&[(20, ids[0]), (50, ids[1])])).unwrap();
    let at = |project: &Project, frame| project.document().matte_at(frame).map(|(of, _)| of);
    let expected = [(0, 20), (20, 20), (49, 20), (50, 50), (199, 50)];
    for (frame, of) in expected {
        assert_eq!(at(&project, frame), Some(of), "{frame}");
    }
    project.commit(Transaction::remove_mattes(&[20])).unwrap();
    assert_eq!(at(&project, 0), Some(50));
    project.undo().unwrap();
    drop(project);

    let project = Project::open(&bench.path(), Access::Read).unwrap();
    assert_eq!(project.document().mattes().collect::<Vec<_>>(), [(20, ids[0]), (50, ids[1])]);
    assert_eq!(project.matte(ids[1]).unwrap(), matte(50));
    let log: Vec<String> = project
        .log()
        .unwrap()
        .into_iter()
        .map(|line| match line.item {
            LogItem::Edit(entry) => entry.label,
            LogItem::Matte(made) => format!("{} of {}", made.id, made.frame),
            other => format!("{other:?}"),
        })
        .collect();
    assert_eq!(
        log,
        ["project made", "1 of 20", "2 of 50", "mattes of 2 frames kept", "matte of frame 20 removed"]
    );
}

#[test]
fn what_is_no_matte_of_the_project_is_refused() {
    let bench = Bench::new();
    let mut project = bench.create();
    let short = KeptMatte { marks: vec![0; 7], ..matte(0) };
    let kept = project.save_mattes(&[matte(1), short]);
    assert!(matches!(kept, Err(StoreError::Planes { wanted: 3072, came: 7 })), "{kept:?}");
    assert_eq!(project.mattes().unwrap(), [], "all or none");
    let unknown = project.commit(Transaction::keep_mattes(&[(0, MatteId(9))]));
    assert!(matches!(unknown, Err(StoreError::NoSuchMatte(MatteId(9)))), "{unknown:?}");
    let id = project.save_mattes(&[matte(0)]).unwrap()[0];
    let beyond = project.commit(Transaction::keep_mattes(&[(200, id)])).unwrap_err();
    assert!(beyond.to_string().contains("beyond the clip"), "{beyond}");

    // Fewer pixels than the row says, and more.
    for height in [50, 40] {
        let conn = Connection::open(bench.path()).unwrap();
        conn.execute("UPDATE matte SET height = ?1", [height]).unwrap();
        let read = project.matte(id);
        assert!(matches!(read, Err(StoreError::Corrupt(_))), "{height}: {read:?}");
    }
}
