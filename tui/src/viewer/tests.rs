//! Where the viewer is looked for, and how its end is told.

use super::*;

#[test]
fn the_viewer_is_beside_this_program_or_is_missed_with_what_builds_it() {
    let folder = tempfile::tempdir().unwrap();
    for (place, how) in [("debug", "cargo build -p"), ("bin", "cargo build --release -p")] {
        let own = folder.path().join(place).join("honami");
        std::fs::create_dir(folder.path().join(place)).unwrap();
        let missed = beside(&own).unwrap_err().to_string();
        assert!(missed.contains(how) && missed.contains(place), "{missed}");
        std::fs::write(own.with_file_name(NAME), "").unwrap();
        assert_eq!(beside(&own).unwrap(), own.with_file_name(NAME));
    }
}

#[test]
fn ends_are_told_in_words() {
    for (raw, told) in [
        (0, None),
        (1 << 8, Some("the viewer failed, with status 1")),
        (11, Some("the viewer crashed, by signal 11")),
    ] {
        assert_eq!(ending(ExitStatus::from_raw(raw)).as_deref(), told);
    }
}

#[test]
fn two_scenes_are_there_and_none_in_the_end() {
    let mut scenes = Scenes::new().unwrap();
    let folder = scenes.folder.path().to_owned();
    let there = || std::fs::read_dir(&folder).unwrap().count();
    let scene = Scene::Skeleton(Box::default());
    for wanted in [1, 2, 2, 2] {
        let path = scenes.write(&scene).unwrap();
        assert!(path.exists());
        assert_eq!(there(), wanted);
    }
    drop(scenes);
    assert!(!folder.exists());
}
