//! The rules of the house that a machine can check.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use honami_tests::root;
use serde_json::Value;

/// What each package may use of the workspace (`*`: whatever ends its name); nothing else is allowed. ARCHITECTURE.md
/// says why.
const MAY_USE: &[(&str, &[&str])] = &[
    ("honami-abi", &[]),
    ("honami-plugin", &["honami-abi"]),
    ("honami-host", &["honami-abi", "honami-model"]),
    ("honami-plughost", &["honami-host"]),
    ("honami-check", &["honami-abi", "honami-host", "honami-model"]),
    ("honami-model", &[]),
    ("honami-media", &["honami-model"]),
    ("honami-store", &["honami-model"]),
    ("honami-exchange", &["honami-model"]),
    ("honami-vision", &["honami-model"]),
    ("honami-cameras", &[]),
    ("honami-matting", &[]),
    ("honami-motion", &["honami-model"]),
    ("honami-mechanics", &["honami-model"]),
    ("honami-structure", &["honami-model"]),
    ("honami-review", &["honami-model", "honami-vision"]),
    ("honami-synth", &["honami-model", "honami-cameras"]),
    ("honami-scene", &["honami-model", "honami-exchange", "honami-mechanics", "honami-structure"]),
    ("honami-follow", &["honami-plugin", "honami-vision"]),
    ("honami-tracker-*", &["honami-plugin", "honami-vision", "honami-follow"]),
    ("honami-grouping", &["honami-plugin", "honami-model", "honami-motion"]),
    ("honami-clusterer-*", &["honami-plugin", "honami-motion", "honami-grouping"]),
    ("honami-growing", &["honami-plugin", "honami-model", "honami-structure"]),
    ("honami-structure-*", &["honami-plugin", "honami-structure", "honami-growing"]),
    ("honami-simulator-*", &["honami-plugin", "honami-mechanics", "honami-model"]),
    (
        "honami-workbench",
        &[
            "honami-model",
            "honami-cameras",
            "honami-host",
            "honami-check",
            "honami-store",
            "honami-media",
            "honami-exchange",
            "honami-matting",
            "honami-motion",
            "honami-mechanics",
            "honami-review",
            "honami-scene",
            "honami-structure",
            "honami-synth",
            "honami-vision",
        ],
    ),
    ("honami", &["honami-workbench", "honami-model"]),
    ("honami-viewer", &["honami-scene", "honami-media", "honami-mechanics", "honami-model"]),
    ("honami-tests", &[]),
    ("xtask", &[]),
];

/// Libraries that one package alone may use.
const ONLY_USER: &[(&str, &str)] = &[
    ("libloading", "honami-host"),
    ("rusqlite", "honami-store"),
    ("ratatui", "honami"),
    ("wgpu", "honami-viewer"),
    ("eframe", "honami-viewer"),
];

/// Folders in which `unsafe` is allowed by name.
const UNSAFE_IN: &[&str] =
    &["core/abi", "core/plugin", "core/host", "core/check", "core/media", "core/vision"];

/// A file longer than this is split.
const MAX_LINES: usize = 800;

struct Package {
    folder: PathBuf,
    /// Names of what it depends on, tests aside.
    uses: BTreeSet<String>,
}

fn packages() -> BTreeMap<String, Package> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--format-version", "1", "--offline"])
        .current_dir(root())
        .output()
        .unwrap();
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let text = |v: &Value| v.as_str().unwrap().to_owned();
    let package = |p: &Value| {
        let uses = p["dependencies"].as_array().unwrap().iter();
        let uses = uses.filter(|d| d["kind"].is_null()).map(|d| text(&d["name"])).collect();
        let folder = Path::new(p["manifest_path"].as_str().unwrap()).parent().unwrap().to_owned();
        (text(&p["name"]), Package { folder, uses })
    };
    metadata["packages"].as_array().unwrap().iter().map(package).collect()
}

/// Every file of the project with one of these endings, build results aside, sorted.
fn files(endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root().to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() && name != "target" && name != ".git" {
                folders.push(path);
            } else if path.extension().is_some_and(|e| endings.iter().any(|want| e == *want)) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

#[track_caller]
fn assert_none(complaints: &[String]) {
    assert!(complaints.is_empty(), "\n{}\n", complaints.join("\n"));
}

#[test]
fn packages_use_only_what_lies_below_them() {
    let packages = packages();
    let mut complaints = Vec::new();
    for (name, package) in &packages {
        // A fixture is a plugin or program of one test; it stands under nothing.
        if package.folder.components().any(|c| c.as_os_str() == "fixtures") {
            continue;
        }
        let is_it = |known: &str| match known.strip_suffix('*') {
            Some(start) => name.starts_with(start),
            None => name == known,
        };
        let Some((_, allowed)) = MAY_USE.iter().find(|(known, _)| is_it(known)) else {
            complaints.push(format!("{name} is not in the list of tests/it/tidy.rs"));
            continue;
        };
        for used in package.uses.iter().filter(|used| packages.contains_key(*used)) {
            if !allowed.contains(&used.as_str()) {
                complaints.push(format!("{name} must know nothing of {used}"));
            }
        }
        for (library, user) in ONLY_USER {
            if package.uses.contains(*library) && name != user {
                complaints.push(format!("{library} belongs to {user}, but {name} uses it"));
            }
        }
    }
    assert_none(&complaints);
}

#[test]
fn every_source_file_says_what_it_is_and_is_short() {
    let mut complaints = Vec::new();
    for path in files(&["rs"]) {
        let text = fs::read_to_string(&path).unwrap();
        if !text.starts_with("//! ") {
            complaints.push(format!("{}: its first line does not say what it is", shown(&path)));
        }
        let n_lines = text.lines().count();
        if n_lines > MAX_LINES {
            complaints.push(format!("{}: {n_lines} lines, more than {MAX_LINES}", shown(&path)));
        }
        if path.file_name().unwrap() == "mod.rs" {
            complaints.push(format!("{}: use foo.rs beside foo/", shown(&path)));
        }
    }
    assert_none(&complaints);
}

#[test]
fn unsafe_is_allowed_only_where_it_must_be() {
    let allows = ["allow(unsafe_code", "expect(unsafe_code"].map(|lint| format!("{lint},"));
    let mut complaints = Vec::new();
    for path in files(&["rs"]) {
        let text = fs::read_to_string(&path).unwrap();
        let at = shown(&path);
        if allows.iter().any(|allow| text.contains(allow.as_str()))
            && !UNSAFE_IN.iter().any(|folder| at.starts_with(folder))
            && at != "tests/it/tidy.rs"
        {
            complaints.push(format!("{at}: unsafe code does not belong here"));
        }
    }
    assert_none(&complaints);
}

#[test]
fn no_test_is_ignored_and_none_sleeps() {
    let forbidden = [["#[ign", "ore"], ["thread::sl", "eep"]].map(|halves| halves.concat());
    let mut complaints = Vec::new();
    let is_test = |path: &PathBuf| shown(path).split('/').any(|part| part == "tests" || part == "tests.rs");
    for path in files(&["rs"]).into_iter().filter(is_test) {
        let text = fs::read_to_string(&path).unwrap();
        for (k, line) in text.lines().enumerate() {
            if forbidden.iter().any(|word| line.contains(word.as_str())) {
                complaints.push(format!("{}:{}: {}", shown(&path), k + 1, line.trim()));
            }
        }
    }
    assert_none(&complaints);
}

#[test]
fn every_misprint_that_is_cited_has_its_row() {
    let errata = fs::read_to_string(root().join("docs/errata.md")).unwrap();
    let mut complaints = Vec::new();
    for path in files(&["rs", "md"]) {
        let text = fs::read_to_string(&path).unwrap();
        for line in text.lines().filter(|line| line.contains("rrata ")) {
            let words = line.split(|c: char| !c.is_ascii_alphanumeric());
            let numbers = words.filter(|word| {
                let digits = word.strip_prefix(['E', 'Z']).unwrap_or_default();
                !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
            });
            let without = numbers.filter(|number| !errata.contains(&format!("| {number} |")));
            complaints.extend(
                without.map(|number| format!("{}: {number} has no row in docs/errata.md", shown(&path))),
            );
        }
    }
    assert_none(&complaints);
}

#[test]
fn documents_name_what_exists() {
    let architecture = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let mut complaints = Vec::new();
    let packages = packages();
    for (name, package) in &packages {
        let folder = shown(&package.folder);
        if !folder.contains("fixtures") && !architecture.contains(&format!("`{folder}`")) {
            complaints.push(format!("ARCHITECTURE.md has no row for `{folder}` ({name})"));
        }
    }
    let first_columns = architecture.lines().filter_map(|line| line.strip_prefix("| ")?.split(" | ").next());
    let words: BTreeSet<&str> = first_columns.flat_map(|column| column.split([' ', ','])).collect();
    let libraries: BTreeSet<&String> = packages.values().flat_map(|package| &package.uses).collect();
    let others = libraries.into_iter().filter(|library| !packages.contains_key(*library));
    let without = others.filter(|library| !words.contains(library.as_str()));
    complaints.extend(without.map(|library| format!("ARCHITECTURE.md does not say why {library} is used")));
    assert_none(&complaints);
}

#[test]
fn links_of_documents_lead_somewhere() {
    let mut complaints = Vec::new();
    for path in files(&["md"]) {
        let text = fs::read_to_string(&path).unwrap();
        let links = text.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next());
        let inside = links.filter(|link| !link.is_empty() && !link.contains("://"));
        let lost = inside.filter(|link| !path.with_file_name(link).exists());
        complaints.extend(lost.map(|link| format!("{}: {link} is not there", shown(&path))));
    }
    assert_none(&complaints);
}
