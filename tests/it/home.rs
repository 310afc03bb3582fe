//! A fresh home: the program keeps to its own folders, and leaves clips and their folders alone.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use honami_tests::Bench;

/// Every file below a folder, relative to it.
fn files(folder: &Path) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(at) = folders.pop() {
        for entry in fs::read_dir(at).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                found.insert(path.strip_prefix(folder).unwrap().to_string_lossy().into_owned());
            }
        }
    }
    found
}

const JOB: &[&str] = &[
    "doctor",
    "synth clips/clip --size 160x120 --frames 12",
    "new p.honami clips/clip",
    "track p.honami",
    "cluster p.honami",
    "compare p.honami",
    "spectrum p.honami",
    "log p.honami",
    "plugin list",
    "export p.honami tracks out.csv",
];

/// Does the whole job and returns what has appeared outside the clip's folder.
fn appeared(bench: &Bench, variables: &[(&str, &str)]) -> BTreeSet<String> {
    for folder in ["clips", "home", "tmp"] {
        fs::create_dir(bench.path(folder)).unwrap();
    }
    for (k, line) in JOB.iter().enumerate() {
        let mut command = bench.command(line.split(' '));
        for name in ["XDG_CACHE_HOME", "XDG_DATA_HOME", "XDG_STATE_HOME", "XDG_CONFIG_HOME"] {
            command.env_remove(name);
        }
        command.env("HOME", bench.path("home")).env("TMPDIR", bench.path("tmp"));
        command.envs(variables.iter().map(|(name, folder)| (name, bench.path(folder))));
        assert!(command.output().unwrap().status.success(), "honami {line}");
        let clips = files(&bench.path("clips"));
        assert!(k == 0 || clips.len() == 13, "the clip's folder holds the clip and its truth: {clips:?}");
    }
    files(&bench.path("")).into_iter().filter(|file| !file.starts_with("clips/")).collect()
}

#[test]
fn the_whole_job_writes_what_was_asked_for_and_its_cache() {
    let own: BTreeSet<String> = ["p.honami", "out.csv"].map(str::to_owned).into();
    for (variables, cache) in [
        (&[][..], "home/.cache/honami/"),
        (&[("XDG_CACHE_HOME", "cache"), ("XDG_DATA_HOME", "share")][..], "cache/honami/"),
    ] {
        let bench = Bench::new();
        let rest: Vec<String> = appeared(&bench, variables).difference(&own).cloned().collect();
        assert!(rest.iter().all(|file| file.starts_with(cache)), "{rest:?}");
        for name in own.iter().map(String::as_str) {
            assert!(bench.path(name).exists(), "{name}");
        }
    }
}

#[test]
fn the_cache_can_be_deleted_at_any_time() {
    let bench = Bench::new();
    bench.synth("clip", 20, "");
    let tables = ["a.honami", "b.honami"].map(|project| {
        bench.json(&format!("new {project} clip"));
        bench.json(&format!("track {project}"));
        fs::remove_dir_all(bench.path("XDG_CACHE_HOME")).unwrap();
        bench.samples(project)
    });
    assert!(!tables[0].is_empty() && tables[0] == tables[1]);
}

#[test]
fn a_cache_that_cannot_be_written_costs_speed_only() {
    let bench = Bench::new();
    fs::write(bench.path("XDG_CACHE_HOME"), "a file where a folder should be").unwrap();
    bench.synth("clip", 10, "");
    assert!(bench.text("doctor").contains("cannot be made"));
    bench.json("new p.honami clip");
    assert!(bench.json("track p.honami")["tracks"].as_u64().unwrap() > 0);
}
