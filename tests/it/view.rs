//! `honami view`: forests drawn by the real viewer, and what is said where they cannot be.

use std::fs;
use std::path::Path;

use honami_tests::{Bench, missing, program};

/// Whether the viewer was built and can draw; says what is skipped if not.
fn can_draw(bench: &Bench) -> bool {
    let viewer = program().with_file_name("honami-viewer");
    if !viewer.exists() {
        missing("viewer (cargo build -p honami-viewer)");
        return false;
    }
    let findings = bench.json("doctor")["findings"].clone();
    let there = findings.as_array().unwrap().iter().find(|finding| finding["what"] == "viewer").unwrap();
    if there["there"] != true {
        missing("driver to draw with (apt-get install mesa-vulkan-drivers)");
        return false;
    }
    assert!(there["found"].as_str().unwrap().starts_with("draws with "), "{there}");
    true
}

/// Width and height, from the head of a PNG.
fn size(png: &Path) -> [u32; 2] {
    let bytes = fs::read(png).unwrap();
    assert!(bytes.starts_with(b"\x89PNG"), "{}", png.display());
    [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()))
}

#[test]
fn a_forest_is_drawn_into_a_file_and_the_same_again() {
    let bench = Bench::new();
    if !can_draw(&bench) {
        return;
    }
    let line = "view synth::tree:60,1 --forest 4 --wind storm --frames 3 --size 160x90 --offscreen";
    let said = bench.json(&format!("{line} a.png"));
    assert_eq!((&said["out"], &said["size"]), (&"a.png".into(), &serde_json::json!([160, 90])));
    assert!(said["forest"].as_str().unwrap().starts_with("4 plants of 60 nodes with "), "{said}");
    assert_eq!(size(&bench.path("a.png")), [160, 90]);
    bench.text(&format!("{line} b.png"));
    assert!(fs::read(bench.path("a.png")).unwrap() == fs::read(bench.path("b.png")).unwrap());
    bench.text(&format!("{line} frames/"));
    assert_eq!(fs::read_dir(bench.path("frames")).unwrap().count(), 3);
    // Its last frame is that of the image; and what moved is elsewhere in the first.
    let frames: Vec<_> =
        fs::read_dir(bench.path("frames")).unwrap().map(|entry| entry.unwrap().path()).collect();
    let (first, last) = (frames.iter().min().unwrap(), frames.iter().max().unwrap());
    assert!(fs::read(first).unwrap() != fs::read(last).unwrap());
    // Nothing of the scene is left among the caches.
    let left = fs::read_dir(bench.path("XDG_CACHE_HOME/honami")).map_or(0, |left| {
        left.filter(|entry| entry.as_ref().unwrap().file_name().to_string_lossy().starts_with("scene-"))
            .count()
    });
    assert_eq!(left, 0);
}

#[test]
fn a_skeleton_is_drawn_over_its_clip_and_in_space() {
    let bench = Bench::tracked();
    if !can_draw(&bench) {
        return;
    }
    bench.json("cluster p.honami --groups 3");
    let drawn = |name: &str, words: &str| {
        let said = bench.json(&format!("view p.honami skeleton --size 320x240 {words} --offscreen {name}"));
        assert!(said["skeleton"].as_str().unwrap().contains("of 3 groups, frames 0-39"), "{said}");
        assert_eq!(size(&bench.path(name)), [320, 240], "{name}");
        fs::read(bench.path(name)).unwrap()
    };
    let first = drawn("first.png", "");
    assert!(first == drawn("again.png", ""), "the same again");
    // Bones that are off, the clip that goes on, and what is seen from elsewhere.
    for (name, words) in [
        ("clip.png", "--parts clip"),
        ("later.png", "--frames 30"),
        ("aside.png", "--azimuth 40 --elevation 15"),
    ] {
        assert!(first != drawn(name, words), "{name}");
    }
    let nothing = bench.line("view p.honami skeleton --parts copies --offscreen nothing.png");
    assert_eq!(nothing.code, Some(0), "{nothing:?}");
    assert!(
        nothing.stderr.contains("nothing is seen of the skeleton: it has no copies"),
        "{}",
        nothing.stderr
    );
}

/// Each: what is typed, what is said, and how it exits.
#[test]
fn what_cannot_be_shown_is_said() {
    let bench = Bench::new();
    fs::write(bench.path("notes.mtg"), "nothing").unwrap();
    let cases = [
        ("view synth::tree:60,1", "--offscreen OUT is wanted where there is no display", 2),
        ("view synth::tree:60,1 --terminal", "--offscreen OUT is wanted where there is no display", 2),
        ("view synth::tree:60,1 --leaf-length 0 --offscreen a.png", "a leaf is 0.0001 to 10.0 m long", 2),
        ("view synth::tree:60,1 --samples 3 --offscreen a.png", "wanted 1 or 4 samples, got 3", 2),
        ("view synth::tree:60,1 --distance 0 --offscreen a.png", "wanted a number above 0, got 0", 2),
        ("view synth::tree:60,1 --seconds -1 --offscreen a.mp4", "wanted a number above 0, got -1", 2),
        ("view synth::tree:60,1 --azimuth nan --offscreen a.png", "wanted a number, got nan", 2),
        ("view synth::tree:60,1 --offscreen notes.mtg", "notes.mtg is there already: choose another name", 1),
        ("view synth::tree:60,1 --spacing 3 --offscreen a.png", "--forest", 2),
        ("view synth::tree:60,1 --forest 0 --offscreen a.png", "wanted 1 to 10000000 copies, got 0", 2),
        (
            "view synth::tree:60,1 skeleton --offscreen a.png",
            "has no skeleton: a project (.honami) is wanted",
            2,
        ),
        ("view p.honami --terminal", "a skeleton is shown in the terminal by v k", 2),
    ];
    for (line, said, code) in cases {
        let ran = bench.line(line);
        assert_eq!(ran.code, Some(code), "{line}: {ran:?}");
        assert!(ran.stderr.contains(said), "{line}: {}", ran.stderr);
    }
    assert!(!bench.path("a.png").exists());
    if !can_draw(&bench) {
        return;
    }
    let cases = [
        ("view notes.mtg --offscreen a.png", "notes.mtg", 1),
        ("view away.mtg --offscreen a.png", "away.mtg", 1),
        ("view synth::tree:60,1 --wind breeze --offscreen a.png", "\"breeze\" is no wind and no file", 2),
        ("view synth::tree:60,1 --adapter Voodoo --offscreen a.png", "no adapter is called \"Voodoo\"", 2),
        ("view synth::tree:60,1 --offscreen a.gif", "honami: movies are written as", 2),
        (
            "view synth::tree:60,1 --offscreen a.y4m --fps 1e9",
            "0.001 to 100000 frames per second, got 1e9",
            2,
        ),
        ("view synth::tree:60,1 --offscreen a.y4m --seconds 1e9", "2.5e10 frames are too many", 2),
        ("view away.mtg --offscreen nowhere/a.png", "honami: nowhere is no folder: make it first", 1),
    ];
    for (line, said, code) in cases {
        let ran = bench.line(line);
        assert_eq!(ran.code, Some(code), "{line}: {ran:?}");
        assert!(ran.stderr.contains(said), "{line}: {}", ran.stderr);
    }
    assert!(!bench.path("a.png").exists() && !bench.path("a.gif").exists());
}
