//! Where the viewer is looked for, and how its end is told.

use honami_workbench::scene::Scene;

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

/// Variables that are set, and whether they name a display.
#[test]
fn a_window_wants_a_display() {
    for (set, there) in [
        (&[][..], false),
        (&[("DISPLAY", ""), ("WAYLAND_DISPLAY", "")], false),
        (&[("DISPLAY", ":0")], true),
        (&[("WAYLAND_DISPLAY", "wayland-1")], true),
    ] {
        let variable =
            |name: &str| set.iter().find(|(known, _)| *known == name).map(|(_, value)| value.into());
        assert_eq!(has_display(variable), there, "{set:?}");
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

/// What was printed by one that has ended so, and what is said of it.
#[test]
fn last_words_are_in_the_line_about_an_end() {
    let panicked =
        "thread 'main' panicked at src/app.rs:3:5:\nno room\nnote: run with `RUST_BACKTRACE=1`\n\n";
    for (raw, printed, told) in [
        (1 << 8, "libEGL: no\nhonami-viewer: there is no display\n", "the viewer: there is no display"),
        (2 << 8, "honami-viewer: no adapter is called so\n", "the viewer: no adapter is called so"),
        (1 << 8, "", "the viewer failed, with status 1"),
        (101 << 8, panicked, "the viewer failed, with status 101; it last said: no room"),
        (9, "", "the viewer crashed, by signal 9"),
        (6, "\x1b[31mlost\x1b[0m\n", "the viewer crashed, by signal 6; it last said: lost"),
    ] {
        let status = ExitStatus::from_raw(raw);
        let words = last_words(printed.as_bytes());
        assert_eq!(with_words(status, ending(status).unwrap(), &words), told, "{printed:?}");
    }
}

#[test]
fn few_scenes_are_there_and_none_in_the_end() {
    let mut scenes = Scenes::new().unwrap();
    let folder = scenes.folder.path().to_owned();
    let there = || std::fs::read_dir(&folder).unwrap().count();
    let scene = Scene::Skeleton(Box::default());
    for wanted in (1..=scenes::KEPT as usize).chain([scenes::KEPT as usize; 2]) {
        let path = scenes.write(&scene).unwrap();
        assert!(path.exists());
        assert_eq!(there(), wanted);
    }
    drop(scenes);
    assert!(!folder.exists());
}
