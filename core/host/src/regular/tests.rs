//! What is no file is told at once.

use super::*;
use crate::error::HostError;
use crate::{note, script, store};
use rustix::fs::{CWD, FileType, Mode, mknodat};
use std::fs;
use std::os::unix::fs::symlink;

#[test]
fn pipes_devices_folders_and_endless_files_are_refused_without_a_wait() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for ending in ["so", "honami.json"] {
        let named = |name: &str| at(&format!("{name}.{ending}"));
        mknodat(CWD, named("pipe"), FileType::Fifo, Mode::RUSR | Mode::WUSR, 0).unwrap();
        symlink("/dev/zero", named("endless")).unwrap();
        fs::create_dir(named("folder")).unwrap();
        File::create(named("huge")).unwrap().set_len(LIBRARY_BYTES_MAX + 1).unwrap();
        for (name, wanted) in [
            ("pipe", "wanted a file"),
            ("endless", "wanted a file"),
            ("folder", "wanted a file"),
            ("huge", "bytes, it has more"),
        ] {
            let path = named(name);
            let scanned =
                if ending == "so" { note::read(&path).map(drop) } else { script::read(&path).map(drop) };
            let hashed = store::sha256_of(&path).map(drop);
            for got in [scanned, hashed] {
                let why = match got {
                    Err(HostError::File { why, .. }) => why,
                    other => format!("{other:?}"),
                };
                assert!(why.contains(wanted), "{name}.{ending}: {why}");
            }
        }
    }
}

#[test]
fn a_file_of_as_many_bytes_as_it_may_have_is_read_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("it");
    fs::write(&path, b"1234").unwrap();
    assert_eq!(read(&path, 4).unwrap(), b"1234");
    assert!(read(&path, 3).is_err());
}
