//! Two tracks written as strings: a digit is so many pixels from 0, `x` lost, a blank no sample.

use honami_model::track::{Quality, Source, Status};
use proptest::prelude::*;

use super::*;

/// A span of which each letter is a frame; blanks are at its ends.
fn span(letters: &str) -> Span {
    let sample = |letter: char| Sample {
        x: letter.to_digit(10).map_or(99.0, |px| px as f32),
        y: 5.0,
        status: if letter == 'x' { Status::Lost } else { Status::Tracked },
        source: Source::Tracked,
        quality: Quality { fb_px: letter.to_digit(10).map(|px| px as f32 / 10.0), ncc: None },
    };
    let first_frame = letters.chars().take_while(|letter| *letter == ' ').count() as u32;
    Span { first_frame, samples: letters.trim().chars().map(sample).collect() }
}

fn paired(track: u32, a: &str, b: &str) -> Paired {
    Paired { track: TrackId(track), spans: [span(a), span(b)] }
}

/// A row: track, frames, both see, far, farthest, unseen.
fn row_words(row: &Row) -> String {
    let farthest = row.farthest.map_or("never".to_owned(), |(px, frame)| format!("{px} at {frame}"));
    let Row { track, n_frames, n_both, n_far, n_unseen: [a, b], .. } = row;
    format!("{track}: {n_frames} frames, {n_both} both, {n_far} far, {farthest}, unseen {a} {b}")
}

fn place_words(place: &Place) -> String {
    let Place { track, frames, worst, sight } = place;
    format!("{track}: {}-{} {sight:?} at {worst}", frames.start, frames.end - 1)
}

#[test]
fn tracks_and_places() {
    for (what, a, b, row, places) in [
        ("the same", "0123", "0123", "1: 4 frames, 4 both, 0 far, 0 at 0, unseen 0 0", vec![]),
        (
            "apart at the end",
            "000000",
            "000135",
            "1: 6 frames, 6 both, 2 far, 5 at 5, unseen 0 0",
            vec!["1: 4-5 Both(5.0) at 5"],
        ),
        (
            "two waves near each other are one place, far ones two",
            "00000000000000000",
            "03000400000000200",
            "1: 17 frames, 17 both, 3 far, 4 at 5, unseen 0 0",
            vec!["1: 1-5 Both(4.0) at 5", "1: 14-14 Both(2.0) at 14"],
        ),
        (
            "each is left alone",
            "00xx00",
            "0000xx",
            "1: 6 frames, 2 both, 0 far, 0 at 0, unseen 2 2",
            vec!["1: 2-3 Alone(1) at 2", "1: 4-5 Alone(0) at 4"],
        ),
        ("both have lost it", "0x", "0x", "1: 2 frames, 1 both, 0 far, 0 at 0, unseen 1 1", vec![]),
        (
            "only common frames count",
            "  55",
            "9995  ",
            "1: 2 frames, 2 both, 1 far, 4 at 2, unseen 0 0",
            vec!["1: 2-2 Both(4.0) at 2"],
        ),
        ("never together", "11    ", "    11", "1: 0 frames, 0 both, 0 far, never, unseen 0 0", vec![]),
    ] {
        let found = disagreement(&[paired(1, a, b)]);
        assert_eq!(found.rows.iter().map(row_words).collect::<Vec<_>>(), [row], "{what}");
        assert_eq!(found.places.iter().map(place_words).collect::<Vec<_>>(), places, "{what}");
    }
}

#[test]
fn the_worst_is_first() {
    let found = disagreement(&[
        paired(1, "0000", "0000"),
        paired(2, "0000", "0900"),
        paired(3, "00xx", "0000"),
        paired(4, "000x", "5000"),
    ]);
    assert_eq!(found.rows.iter().map(|row| row.track.0).collect::<Vec<_>>(), [2, 4, 3, 1]);
    let places: Vec<String> = found.places.iter().map(place_words).collect();
    let want =
        ["2: 1-1 Both(9.0) at 1", "4: 0-0 Both(5.0) at 0", "3: 2-3 Alone(1) at 2", "4: 3-3 Alone(1) at 3"];
    assert_eq!(places, want);
}

#[test]
fn all_in_all() {
    let found = disagreement(&[paired(1, "00000", "01237"), paired(2, "999x", "9xxx")]).summary;
    let Summary { n_tracks, n_both, median_px, within, n_unseen, fb_px } = found;
    assert_eq!((n_tracks, n_both, n_unseen), (2, 6, [1, 3]));
    // 0, 0, 1, 2, 3, 7.
    assert_eq!(median_px, Some(1.5));
    assert_eq!(within.map(|share| (share * 6.0).round() as u32), [2, 3, 5, 6], "sixths");
    let rounded = fb_px.map(|px| px.map(|px| (px * 1e3).round()));
    assert_eq!(rounded, [Some(0.0), Some(250.0)], "medians of 0 0 0 0 0 .9 .9 .9 and of 0 .1 .2 .3 .7 .9");
    assert_eq!(disagreement(&[]), Disagreement::default());
}

#[test]
fn classes() {
    for (px, want) in [(0.0, 0), (0.99, 0), (1.0, 1), (2.0, 2), (3.9, 2), (4.0, 3), (8.0, 4), (1e9, 4)] {
        assert_eq!(class(px), want, "{px} px");
    }
}

#[test]
fn key_frames_that_were_given_are_no_test() {
    let at = |x: u32| [x as f32, 5.0];
    for (what, a, b, keys, want) in [
        ("none", "0000", "0000", vec![], (0, [None, None], [0, 0])),
        ("B was given both", "0000", "0330", vec![(1, 3), (2, 3)], (0, [None, None], [0, 2])),
        ("one is new to both", "0000", "0310", vec![(1, 3), (2, 3)], (1, [Some(3.0), Some(2.0)], [0, 1])),
        ("A has lost it", "00x0", "0010", vec![(2, 3)], (1, [None, Some(2.0)], [0, 0])),
    ] {
        let paired = paired(1, a, b);
        let [a, b] = &paired.spans;
        let found = at_keys(keys.iter().map(|(frame, x)| ([&a.samples[*frame], &b.samples[*frame]], at(*x))));
        assert_eq!((found.n_new, found.median_px, found.n_given), want, "{what}");
    }
}

proptest! {
    /// Counted another way: frame by frame over all tracks; and A with B is B with A.
    #[test]
    fn counts_add_up(tracks in proptest::collection::vec(("[0-9x]{1,30}", "[0-9x]{1,30}"), 0..8)) {
        let pairs: Vec<Paired> = (0..).zip(&tracks).map(|(id, (a, b))| paired(id, a, b)).collect();
        let found = disagreement(&pairs);
        let sights: Vec<Sight> =
            pairs.iter().flat_map(|p| (0..30).filter_map(|frame| p.sight(frame))).collect();
        let n = |is: fn(&Sight) -> bool| sights.iter().filter(|sight| is(sight)).count();
        let rows = &found.rows;
        prop_assert_eq!(rows.iter().map(|row| row.n_frames as usize).sum::<usize>(), sights.len());
        prop_assert_eq!(found.summary.n_both as usize, n(|sight| matches!(sight, Sight::Both(_))));
        let n_far = n(|sight| matches!(sight, Sight::Both(px) if *px >= FAR_PX));
        prop_assert_eq!(rows.iter().map(|row| row.n_far as usize).sum::<usize>(), n_far);
        let in_places = |is_far: bool| {
            let is_meant = |p: &&Place| matches!(p.sight, Sight::Both(_)) == is_far;
            found.places.iter().filter(is_meant).map(|p| p.frames.len()).sum::<usize>()
        };
        prop_assert!(in_places(true) >= n_far && in_places(false) >= n(|sight| matches!(sight, Sight::Alone(_))));
        let swapped = pairs.into_iter().map(|p| { let [a, b] = p.spans; Paired { spans: [b, a], ..p } });
        let other = disagreement(&swapped.collect::<Vec<_>>());
        prop_assert_eq!(other.summary.median_px, found.summary.median_px);
        prop_assert_eq!(other.summary.n_unseen, { let [a, b] = found.summary.n_unseen; [b, a] });
    }
}
