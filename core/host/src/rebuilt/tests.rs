//! A file that is built again: when it counts as another one.

use super::Watch;
use std::fs::{self, File};
use std::time::{Duration, Instant, SystemTime};

/// What happens to the file before a look.
#[derive(Clone, Copy)]
enum Done {
    Nothing,
    /// Written at once, and long ago by its own date.
    Old(&'static str),
    /// Another file in its place, dated in the future, as by a server whose clock is wrong.
    Fresh(&'static str),
    Removed,
}

/// What was done, at which millisecond it is looked, and whether there is another file.
type Step = (Done, u64, bool);

use Done::{Fresh, Nothing, Old, Removed};

#[test]
fn a_file_counts_once_when_it_is_another_and_whole() {
    let rows: [(&str, &[Step]); 7] = [
        ("as it was loaded", &[(Nothing, 0, true), (Nothing, 250, false), (Nothing, 5000, false)]),
        ("old by its date", &[(Nothing, 0, true), (Old("b"), 250, true), (Nothing, 500, false)]),
        (
            "still for 300 ms",
            &[(Nothing, 0, true), (Fresh("b"), 250, false), (Nothing, 549, false), (Nothing, 550, true)],
        ),
        (
            "written on and on",
            &[
                (Nothing, 0, true),
                (Fresh("b"), 250, false),
                (Fresh("bc"), 500, false),
                (Fresh("bcd"), 750, false),
                (Nothing, 1000, false),
                (Nothing, 1050, true),
            ],
        ),
        ("gone", &[(Nothing, 0, true), (Removed, 250, false), (Nothing, 5000, false)]),
        (
            "gone and there again",
            &[(Nothing, 0, true), (Removed, 250, false), (Fresh("b"), 500, false), (Nothing, 800, true)],
        ),
        (
            "twice",
            &[(Nothing, 0, true), (Old("b"), 250, true), (Old("cc"), 500, true), (Nothing, 750, false)],
        ),
    ];
    let folder = tempfile::tempdir().unwrap();
    let (file, new) = (folder.path().join("mine.so"), folder.path().join("new"));
    let dated = |text: &str, time| {
        fs::write(&new, text).unwrap();
        File::options().write(true).open(&new).unwrap().set_modified(time).unwrap();
        fs::rename(&new, &file).unwrap();
    };
    let hour = Duration::from_secs(3600);
    for (name, steps) in rows {
        dated("a", SystemTime::now() - hour);
        let mut watch = Watch { file: file.clone(), taken: None, seen: None };
        let begun = Instant::now();
        for (k, (done, ms, wanted)) in steps.iter().enumerate() {
            match *done {
                Nothing => {}
                Old(text) => dated(text, SystemTime::now() - hour),
                Fresh(text) => dated(text, SystemTime::now() + hour),
                Removed => fs::remove_file(&file).unwrap(),
            }
            assert_eq!(watch.look(begun + Duration::from_millis(*ms)), *wanted, "{name}, look {k}");
        }
    }
}
