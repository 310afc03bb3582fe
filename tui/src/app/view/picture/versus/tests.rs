//! The colours of disagreement can be told apart on every terminal.

use std::collections::BTreeSet;

use super::*;
use crate::term::colour::Depth;

#[test]
fn every_class_has_a_colour_and_a_letter_of_its_own() {
    for depth in [Depth::Ansi16, Depth::Ansi256, Depth::True] {
        let all = COLOURS.iter().chain(&ENDS).chain([&UNSEEN]);
        let seen: BTreeSet<String> = all.map(|colour| depth.nearest(rgb(*colour)).to_string()).collect();
        assert_eq!(seen.len(), COLOURS.len() + ENDS.len() + 1, "{depth:?}: {seen:?}");
    }
    assert_eq!(GLYPHS.into_iter().collect::<BTreeSet<char>>().len(), GLYPHS.len());
}
