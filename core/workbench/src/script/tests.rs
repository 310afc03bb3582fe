//! The table of words.

use super::{WORDS, help, words};

#[test]
fn every_word_is_named_once_and_said_in_the_help() {
    let help = help();
    for (at, word) in WORDS.iter().enumerate() {
        assert!(!WORDS[..at].iter().any(|other| other.name == word.name), "{} twice", word.name);
        let said = format!("{} {}", word.name, word.takes);
        assert!(help.contains(said.trim_end()) && help.contains(word.does), "{} in {help}", word.name);
    }
    assert!(help.lines().skip(1).all(|line| line.starts_with("  ")));
}

#[test]
fn a_line_ends_at_its_remark() {
    assert_eq!(words(" key 1  2 # 3 4"), ["key", "1", "2"]);
    assert!(words("# nothing").is_empty() && words("  ").is_empty());
}
