//! What the lines of the screen say while something is painted.

use honami_workbench::matting::Part;

use super::Context;
use crate::app::painting::Painting;
use crate::app::state::State;

/// What colours or letters mean, and keys, each with how soon it is left out.
pub(super) fn ways(state: &State, painting: &Painting) -> Vec<(u8, String)> {
    let marks = if state.mono { "P plant, - background" } else { "white plant, black background" };
    let mut ways: Vec<(u8, String)> = match &painting.found {
        None => vec![(0, marks.to_owned())],
        Some((_, parts)) => {
            let all = [
                (Part::Kept, ["cyan kept", "k kept"]),
                (Part::Boundary, ["red boundary", "b boundary"]),
                (Part::Trunk, ["brown trunk", "t trunk"]),
                (Part::Inner, ["yellow inner background", "i inner background"]),
            ];
            let there = all.into_iter().filter(|(part, _)| parts.n_pixels(*part) > 0);
            there.map(|(_, words)| (0, words[usize::from(state.mono)].to_owned())).collect()
        }
    };
    let hints = state.keys.hints(Context::Paint);
    let keys = |word: &str| Some(format!("{} {word}", hints.iter().find(|(_, other)| *other == word)?.0));
    ways.extend((1..).zip(["width", "take back", "1 px"]).filter_map(|(nth, word)| Some((nth, keys(word)?))));
    ways
}

/// The brush, and where it is.
pub(super) fn words(painting: &Painting) -> String {
    let [x, y] = painting.at;
    let pen = if painting.is_down { "  pen down" } else { "" };
    let width = 2 * painting.radius_px + 1;
    format!("{} {width} px{pen}  {x:.0}, {y:.0}", painting.word())
}
