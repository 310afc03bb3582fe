//! What stands where a file is to be.

use std::fs;
use std::io::Write;

use super::{AtomicFile, is_begun_alike};
use crate::{PointRow, Writer};
use honami_model::unfinished::names;

#[cfg(unix)]
#[test]
fn a_link_is_followed_and_what_is_no_file_stays() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("elsewhere")).unwrap();
    fs::write(at("elsewhere/target"), "before").unwrap();
    symlink("elsewhere/target", at("link")).unwrap();
    let mut file = AtomicFile::create(&at("link"), |head| head == b"before").unwrap();
    file.write_all(b"after").unwrap();
    file.finish().unwrap();
    assert_eq!(fs::read(at("elsewhere/target")).unwrap(), b"after");
    assert!(fs::symlink_metadata(at("link")).unwrap().is_symlink());

    let _listens = std::os::unix::net::UnixListener::bind(at("socket")).unwrap();
    for (name, what) in [("elsewhere", "is a folder"), ("socket", "is a device or a pipe")] {
        let said = AtomicFile::create(&at(name), |_| true).unwrap_err().to_string();
        assert!(said.contains(what), "{said}");
    }
    assert!(fs::metadata(at("socket")).unwrap().file_type().is_socket());
}

#[test]
fn what_was_written_by_others_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    // What stands there, and whether a table of these columns may take its place.
    for (before, may) in [
        ("", true),
        ("id,x,y,frame\n1,2,3,4\n", true),
        ("id,x,y,frame\r\n", true),
        ("id,x,y,frame,mine\n", false),
        ("id,x\n", false),
        ("CODE:\tFORM-A\n", false),
        ("\n", false),
    ] {
        fs::write(&path, before).unwrap();
        let said = Writer::<PointRow>::create(&path).map(drop).map_err(|error| error.to_string());
        assert_eq!(said.is_ok(), may, "{before:?}");
        let wanted = "a.csv is there already and is another kind of file";
        assert!(may || said.is_err_and(|said| said.contains(wanted)), "{before:?}");
        assert_eq!(fs::read_to_string(&path).unwrap(), before);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
    for (head, text, wanted) in [
        ("HIERARCHY\nROOT a", "HIERARCHY\nROOT b", true),
        ("# 1 2 3", "# number type", false),
        ("series,hz\na,1", "series,hz\nb,2", true),
        ("series,hz,x\na,1", "series,hz\nb,2", false),
        ("\u{fffd}", "<svg a", false),
    ] {
        assert_eq!(is_begun_alike(head.as_bytes(), text), wanted);
    }
}

#[test]
fn a_file_is_listed_as_unfinished_until_it_has_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let n_listed = || names().iter().filter(|name| name.starts_with(folder.path())).count();
    let begin = |name: &str| AtomicFile::create(&folder.path().join(name), |_| true).unwrap();
    let (finished, left) = (begin("a"), begin("b"));
    assert_eq!(n_listed(), 2);
    finished.finish().unwrap();
    drop(left);
    assert_eq!((n_listed(), fs::read_dir(folder.path()).unwrap().count()), (0, 1));
}
