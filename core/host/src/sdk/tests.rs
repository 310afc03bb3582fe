//! What a plugin is begun with is whole, and carries the name that was asked for.

use super::rust::SDK;
use super::{Language, adapt, begin};
use crate::manifest::Kind;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

#[test]
fn every_source_of_the_sdk_for_rust_is_handed_on() {
    for package in &SDK {
        let folder = package.name.strip_prefix("honami-").unwrap();
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder).join("src");
        let mut there = BTreeSet::new();
        let mut folders = vec![root.clone()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else {
                    there.insert(path.strip_prefix(&root).unwrap().to_string_lossy().into_owned());
                }
            }
        }
        let listed: BTreeSet<String> = package.sources.iter().map(|(file, _)| (*file).to_owned()).collect();
        assert_eq!(listed, there, "list them in sdk/rust.rs");
    }
}

#[test]
fn a_plugin_that_was_just_begun_has_its_own_id_and_nothing_of_the_template() {
    for (language, kind) in [
        (Language::Python, Kind::Tracker),
        (Language::Python, Kind::Clusterer),
        (Language::Python, Kind::Structure),
        (Language::Rust, Kind::Tracker),
        (Language::Rust, Kind::Clusterer),
        (Language::Rust, Kind::Structure),
        (Language::C, Kind::Tracker),
        (Language::C, Kind::Structure),
        (Language::Cpp, Kind::Tracker),
        (Language::Cpp, Kind::Structure),
    ] {
        let begun = begin("my-own", kind, language).unwrap();
        let (file, text) = &begun.files[0];
        assert!(text.contains("org.me.my-own") && !text.contains("org.honami."), "{file}: {text}");
        assert!(begun.build.contains("my-own"), "{}", begun.build);
    }
}

#[test]
fn the_adapter_of_a_trax_server_has_its_command_with_whole_paths_and_reads_its_folder() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let words =
        ["python3", here.join("src/sdk.rs").to_str().unwrap(), "--fast", "a \"b\""].map(str::to_owned);
    let (file, text) = adapt("kcf", &words).unwrap().files.swap_remove(0);
    let src = here.join("src");
    let wanted = [
        format!("COMMAND = [\"python3\",\"{}/sdk.rs\",\"--fast\",\"a \\\"b\\\"\"]", src.display()),
        format!("READS = [\"{}\"]", src.display()),
        "org.me.kcf".to_owned(),
    ];
    assert!(wanted.iter().all(|part| text.contains(part)), "{file}: {wanted:?}, {text}");
    assert!(adapt("kcf", &[]).unwrap_err().contains("-- python3 tracker.py"));
}

#[test]
fn names_that_would_not_work_are_refused() {
    for (name, language) in [
        ("", Language::C),
        ("a b", Language::C),
        ("../up", Language::C),
        ("1st", Language::Rust),
        ("-x", Language::Python),
        ("honami", Language::Rust),
        ("json", Language::Python),
        ("inspect", Language::Python),
        ("abc", Language::Python),
        ("zoneinfo", Language::Python),
    ] {
        let said = begin(name, Kind::Tracker, language).unwrap_err();
        assert!(said.contains(&format!("{name:?}")), "{said}");
    }
    assert!(begin("json", Kind::Tracker, Language::Rust).is_ok());
    assert!(begin("a", Kind::Clusterer, Language::C).unwrap_err().contains("in Python and in Rust"));
    assert!(begin("a", Kind::Clusterer, Language::Cpp).unwrap_err().contains("in Python and in Rust"));
    assert!(begin("a", Kind::Simulator, Language::Rust).unwrap_err().contains("no template of a simulator"));
}

/// Lines with code: neither empty nor a comment, nor the tests of the template itself.
fn n_code_lines(text: &str) -> usize {
    let is_code = |line: &&str| {
        let line = line.trim_start();
        let is_comment = ["//", "/*", "* ", "# ", "\"\"\""].iter().any(|mark| line.starts_with(mark));
        !line.is_empty() && !is_comment
    };
    text.lines().take_while(|line| *line != "#[cfg(test)]").filter(is_code).count()
}

#[test]
fn a_tracker_that_works_is_short_and_the_page_for_authors_says_how_short() {
    let n_lines = |language| {
        let begun = begin("mine", Kind::Tracker, language).unwrap();
        n_code_lines(&begun.files[0].1)
    };
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/plugins.md");
    let page = fs::read_to_string(page).unwrap();
    let all = [
        ("Python", Language::Python),
        ("Rust", Language::Rust),
        ("C++17", Language::Cpp),
        ("C99", Language::C),
    ];
    for (name, language) in all {
        let n = n_lines(language);
        let row = page.lines().find(|line| line.starts_with(&format!("| {name} | "))).unwrap();
        assert!(row.ends_with(&format!(" | {n} |")), "wanted {n} lines in: {row}");
    }
    assert!(n_lines(Language::Python) <= 25, "{}", n_lines(Language::Python));
}
