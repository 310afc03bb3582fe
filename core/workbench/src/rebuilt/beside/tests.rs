//! How the difference of two builds is told.

use honami_model::track::{Quality, Sample, Source, Span, Status, TrackId};

use super::Difference;
use crate::versus::Paired;

/// Five frames from 10 on, seen where there is a distance.
fn pair(track: u32, px: [Option<f32>; 5]) -> Paired {
    let sample =
        |x: f32, status| Sample { x, y: 0.0, status, source: Source::Tracked, quality: Quality::default() };
    let new = |px: Option<f32>| sample(px.unwrap_or(0.0), px.map_or(Status::Lost, |_| Status::Tracked));
    let before = vec![sample(0.0, Status::Tracked); 5];
    let span = |samples| Span { first_frame: 10, samples };
    Paired { track: TrackId(track), spans: [span(before), span(px.map(new).to_vec())] }
}

#[test]
fn it_is_told_in_one_line() {
    let same = pair(1, [Some(0.0); 5]);
    let apart = pair(2, [Some(0.25), Some(0.5), Some(1.0), Some(2.0), Some(4.0)]);
    let blind = pair(3, [None; 5]);
    let median = "it differs from the build before by";
    for (tracks, wanted) in [
        (vec![same.clone()], format!("{median} 0.00 px in the median, 0 of 1 features by 1 px or more")),
        (vec![apart.clone()], format!("{median} 1.00 px in the median, 1 of 1 features by 1 px or more")),
        (
            vec![same, apart, blind.clone()],
            format!(
                "{median} 0.12 px in the median, 1 of 3 features by 1 px or more, and sees 5 samples fewer"
            ),
        ),
        (vec![blind], "it sees nothing that the build before sees, and sees 5 samples fewer".to_owned()),
    ] {
        assert_eq!(Difference::of(9..15, &tracks).to_string(), format!("on frames 9-14 {wanted}"));
    }
}
