//! What stands where a file is to be.

use std::fs;
use std::io::Write;

use super::AtomicFile;

#[cfg(unix)]
#[test]
fn a_link_is_followed_and_what_is_no_file_stays() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("elsewhere")).unwrap();
    fs::write(at("elsewhere/target"), "before").unwrap();
    symlink("elsewhere/target", at("link")).unwrap();
    let mut file = AtomicFile::create(&at("link")).unwrap();
    file.write_all(b"after").unwrap();
    file.finish().unwrap();
    assert_eq!(fs::read(at("elsewhere/target")).unwrap(), b"after");
    assert!(fs::symlink_metadata(at("link")).unwrap().is_symlink());

    let _listens = std::os::unix::net::UnixListener::bind(at("socket")).unwrap();
    for (name, what) in [("elsewhere", "is a folder"), ("socket", "is a device or a pipe")] {
        let said = AtomicFile::create(&at(name)).unwrap_err().to_string();
        assert!(said.contains(what), "{said}");
    }
    assert!(fs::metadata(at("socket")).unwrap().file_type().is_socket());
}
