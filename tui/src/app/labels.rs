//! Letters on the tracks in the picture: typing them selects one.

use std::collections::BTreeSet;

use honami_model::track::TrackId;

use super::layout::Lens;
use super::state::State;

/// Letters of labels, those under the fingers first.
const LETTERS: &[u8; 26] = b"fjdkslaghrueiwoqptyvmcnbxz";

/// A label: its letters, its track, and where that is, image pixels.
pub(super) type Label = (String, TrackId, [f32; 2]);

/// The labels of the tracks that are seen and have room, from the middle of the picture outwards: the nearest have one letter, the
/// others two, and no label begins another.
#[must_use]
pub(super) fn labels(state: &State) -> Vec<Label> {
    let lens = Lens::shown(state);
    let (x, y) = (lens.x + lens.width / 2.0, lens.y + lens.height / 2.0);
    let far = |at: [f32; 2]| (f64::from(at[0]) - x).hypot(f64::from(at[1]) - y);
    let seen = state.tracks.iter().filter_map(|row| Some((row.id, row.at(state.frame)?)));
    let mut seen: Vec<(TrackId, [f32; 2])> = seen.collect();
    seen.sort_by(|a, b| far(a.1).total_cmp(&far(b.1)).then(a.0.cmp(&b.0)));
    // Letters that touch cannot be read: where tracks crowd, those nearer to the middle have them.
    let mut taken = BTreeSet::new();
    seen.retain(|(_, at)| {
        let Some((x, y)) = lens.pixel_of(*at) else { return false };
        let row = y / 2;
        let is_free = taken.range((row, x.saturating_sub(2))..=(row, x + 2)).next().is_none();
        is_free && taken.insert((row, x))
    });
    let words = words(seen.len());
    words.into_iter().zip(seen).map(|(word, (track, at))| (word, track, at)).collect()
}

/// So many words of one or two letters, none the beginning of another; as many as there are.
fn words(n: usize) -> Vec<String> {
    let all = LETTERS.len();
    // Every first letter given up as a word of its own begins as many words as there are letters.
    let n_first = n.saturating_sub(all).div_ceil(all - 1).min(all);
    let letter = |&c: &u8| char::from(c).to_string();
    let (short, first) = LETTERS.split_at(all - n_first);
    let long = first.iter().rev().flat_map(|a| LETTERS.iter().map(move |b| letter(a) + &letter(b)));
    short.iter().map(letter).chain(long).take(n).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_short_and_none_begins_another() {
        for n in [0, 1, 3, 26, 27, 51, 52, 300, 676, 10_000] {
            let words = words(n);
            assert_eq!(words.len(), n.min(676), "{n}");
            assert!(words.iter().all(|word| n > 26 || word.len() == 1), "{n}: {words:?}");
            for (i, a) in words.iter().enumerate() {
                assert!(words[i + 1..].iter().all(|b| !b.starts_with(a.as_str())), "{n}: {a}");
            }
        }
    }
}
