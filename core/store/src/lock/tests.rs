//! One holder at a time, whoever comes, goes or dies.

use std::sync::atomic::{AtomicU32, Ordering};

use super::{Holder, Lock, holder_of, lock_path};
use crate::error::StoreError;

#[test]
fn the_second_learns_who_holds_it() {
    let folder = tempfile::tempdir().unwrap();
    let project = folder.path().join("plant.honami");
    assert_eq!(holder_of(&project), None);
    let lock = Lock::acquire(&project).unwrap();
    let me = Holder { pid: std::process::id(), ..lock.holder.clone() };
    assert_eq!(holder_of(&project), Some(me.clone()));
    let Err(error) = Lock::acquire(&project) else { panic!("two holders") };
    assert!(matches!(&error, StoreError::Locked { holder: Some(holder), .. } if *holder == me), "{error}");
    assert!(error.to_string().contains(&format!("(pid {}) since 20", me.pid)), "{error}");
    assert!(lock_path(&project).ends_with(".plant.honami.lock"));
    drop(lock);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing stays behind");
    assert!(Lock::acquire(&project).is_ok());
}

#[test]
fn what_a_killed_session_left_is_taken_over() {
    let folder = tempfile::tempdir().unwrap();
    let project = folder.path().join("plant.honami");
    let dead = r#"{"user":"ada","host":"lab3","pid":4242,"since":"2026-01-01T00:00:00Z"}"#;
    for left in [dead, "", "{half of a hol", &dead.repeat(9)] {
        std::fs::write(lock_path(&project), left).unwrap();
        assert_eq!(holder_of(&project), None, "the dead hold nothing");
        let lock = Lock::acquire(&project).unwrap();
        assert_eq!(holder_of(&project).unwrap().pid, std::process::id());
        drop(lock);
    }
}

/// Coming and going on the same name: the file is unlinked and made again under the others' hands.
#[test]
fn never_two_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let project = folder.path().join("plant.honami");
    let (inside, turns) = (AtomicU32::new(0), AtomicU32::new(0));
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                while turns.load(Ordering::SeqCst) < 400 {
                    match Lock::acquire(&project) {
                        Ok(_lock) => {
                            assert_eq!(inside.fetch_add(1, Ordering::SeqCst), 0);
                            turns.fetch_add(1, Ordering::SeqCst);
                            std::thread::yield_now();
                            inside.fetch_sub(1, Ordering::SeqCst);
                        }
                        Err(StoreError::Locked { .. }) => {}
                        Err(error) => panic!("{error}"),
                    }
                }
            });
        }
    });
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
