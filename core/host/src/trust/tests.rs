//! What the lab says counts whole, or is told to be broken.

use super::{Lab, TrustBook};
use crate::registry::{Registry, SearchPath};
use std::fs;

#[test]
fn a_file_of_the_lab_that_says_something_else_is_no_file_that_says_nothing() {
    for (text, wanted) in [
        ("sha256 = [\"ab\"]\nfolders = [\"/opt/lab\"]\n", None),
        ("", None),
        ("sha256 = [", Some("is broken")),
        ("sha265 = [\"ab\"]\n", Some("unknown field `sha265`")),
    ] {
        let said = toml::from_str::<Lab>(text).map_err(|error| format!("is broken: {error}"));
        match wanted {
            None => drop(said.unwrap()),
            Some(wanted) => assert!(said.as_ref().is_err_and(|why| why.contains(wanted)), "{said:?}"),
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("trust.toml");
    assert!(Lab::read(&file).unwrap().sha256.is_empty(), "there is none");
    fs::write(&file, "sha256 = 3\n").unwrap();
    assert!(Lab::read(&file).is_err());
    fs::write(&file, [0xff, 0xfe]).unwrap();
    assert!(Lab::read(&file).is_err_and(|why| why.contains("cannot be read")));
}

#[test]
fn that_it_is_broken_is_a_problem_of_the_registry() {
    let book = TrustBook { broken: Some("is broken: here".into()), ..TrustBook::default() };
    let registry = Registry::scan_path(&SearchPath { book, ..SearchPath::default() });
    let told: Vec<String> = registry.problems().iter().map(ToString::to_string).collect();
    assert_eq!(
        told,
        [
            "/etc/honami/trust.toml: is broken: here; until that is mended nothing is trusted for the lab's sake"
        ]
    );
}
