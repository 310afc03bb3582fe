//! Copies come, are used, and are forgotten.

use super::{AGE_MAX, keep_bytes, make_room};
use std::fs::{self, File};
use std::path::Path;
use std::time::{Duration, SystemTime};

fn grow_old(path: &Path) {
    let long_ago = SystemTime::now() - AGE_MAX - Duration::from_secs(60);
    File::open(path).unwrap().set_modified(long_ago).unwrap();
}

#[test]
fn what_nobody_has_loaded_for_long_goes_when_another_copy_comes() {
    let folder = tempfile::tempdir().unwrap();
    let store = folder.path();
    let at = |name: &str| store.join(name);
    for name in ["old.so", "young.so", "used.so", "half-1-2"] {
        keep_bytes(store, &at(name), b"a library").unwrap();
    }
    for name in ["old.program", "young.program"] {
        keep_bytes(&at(name), &at(name).join("mine.py"), b"a program").unwrap();
    }
    fs::create_dir(at("another")).unwrap();
    for name in ["old.so", "used.so", "half-1-2", "old.program", "another"] {
        grow_old(&at(name));
    }
    // Loaded again: it is kept.
    keep_bytes(store, &at("used.so"), b"a library").unwrap();
    make_room(store, &at("young.so"));
    assert!(at("old.so").exists(), "nothing comes, nothing goes");
    make_room(store, &at("new.so"));
    let mut left: Vec<_> = fs::read_dir(store).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, ["another", "used.so", "young.program", "young.so"]);
    assert!(at("young.program").join("mine.py").exists());
}
