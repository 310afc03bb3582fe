//! Ends of tracks, told apart.

use honami_model::track::{Quality, Sample, Source};

use super::*;

fn span(track: u32, first_frame: u32, statuses: &[Status]) -> (TrackId, Span) {
    let sample =
        |&status| Sample { x: 1.0, y: 2.0, status, source: Source::Tracked, quality: Quality::default() };
    (TrackId(track), Span { first_frame, samples: statuses.iter().map(sample).collect() })
}

#[test]
fn what_is_lost_hidden_outside_and_born_is_told_apart() {
    use Status::{Lost, Newborn, Occluded, Outside, Rejected, Tracked};
    let spans = [
        span(0, 0, &[Tracked, Tracked, Tracked]),
        span(1, 0, &[Tracked, Lost, Lost]),
        span(2, 1, &[Tracked, Outside]),
        span(3, 0, &[Tracked, Occluded, Occluded]),
        // Left out of the last frame by the tracker: seen before, or outside before.
        span(4, 0, &[Tracked, Tracked]),
        span(5, 0, &[Tracked, Outside]),
        // Lost, then seeded again.
        span(6, 0, &[Tracked]),
        span(6, 2, &[Tracked]),
        // Born by the tracker, one of them ended.
        span(7, 0, &[Newborn, Tracked]),
        span(8, 2, &[Newborn]),
        span(9, 0, &[Tracked, Tracked, Rejected]),
    ];
    let ends = Ends::of(&spans, 2);
    assert_eq!(ends, Ends { n_lost: 3, n_hidden: 1, n_outside: 2, n_born: 2, n_seen: 13, n_frames: 23 });
    assert_eq!(
        ends.to_string(),
        "56.5 % of samples seen; at the end 3 lost, 1 occluded, 2 outside, 2 born on the way"
    );
    assert_eq!(Ends::of(&[], 0).to_string(), "0 lost");
}
