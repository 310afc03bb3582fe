//! Whose samples a track shows.

use honami_model::track::{Quality, Sample, Source, Span, Status, TrackId};
use honami_workbench::versus::Paired;

use super::{Follows, follows};

/// A span from frame 3 on, whose samples are told apart by their digits.
fn span(digits: &str) -> Span {
    let sample = |x: char| Sample {
        x: x.to_digit(10).map_or(0.0, |x| x as f32),
        y: 1.0,
        status: Status::Tracked,
        source: Source::Tracked,
        quality: Quality::default(),
    };
    Span { first_frame: 3, samples: digits.chars().map(sample).collect() }
}

#[test]
fn frames_in_which_both_are_the_same_go_with_those_beside_them() {
    let [a, b, neither] = [Follows::One(0), Follows::One(1), Follows::Neither];
    for (shown, wanted) in [
        ("0222", vec![(b, 3..7)]),
        ("0111", vec![(a, 3..7)]),
        ("0211", vec![(b, 3..5), (a, 5..7)]),
        ("0912", vec![(neither, 3..5), (a, 5..6), (b, 6..7)]),
        ("0", vec![]),
    ] {
        let paired = Paired { track: TrackId(0), spans: [span("0111"), span("0222")] };
        let found = follows(&span(shown), &paired);
        assert!(found == wanted, "{shown}");
    }
}
