//! Mean movements, and light.

use honami_model::picture::Gray;
use honami_model::track::{Quality, Sample, Source, Status};

use super::*;

/// A track that begins in a frame; `None` where it is lost.
fn span(first_frame: u32, places: &[Option<[f32; 2]>]) -> Arc<Span> {
    let sample = |place: &Option<[f32; 2]>| {
        let status = if place.is_some() { Status::Tracked } else { Status::Lost };
        let [x, y] = place.unwrap_or_default();
        Sample { x, y, status, source: Source::Tracked, quality: Quality::default() }
    };
    Arc::new(Span { first_frame, samples: places.iter().map(sample).collect() })
}

#[test]
fn a_track_that_comes_or_goes_is_no_movement_and_a_gap_ends_it() {
    // A sway of both, an offset of 100 px between them, and a creep that is no sway.
    let sway = |frame: usize| (frame as f32 * 0.7).sin();
    let at = |frame: usize, x: f32| Some([x + sway(frame) + 0.5 * frame as f32, -sway(frame)]);
    let early: Vec<_> = (0..12).map(|frame| at(frame, 0.0)).collect();
    let mut late: Vec<_> = (4..30).map(|frame| at(frame, 100.0)).collect();
    let times = FrameTimes::constant(30, 25.0).unwrap();
    let course = Course::of(&times, &[span(0, &early), span(4, &late)]);
    assert_eq!(course.times_s, times.as_slice());
    let wanted: Vec<f64> = (0..30).map(|frame| f64::from(sway(frame))).collect();
    let wanted = detrended(times.as_slice(), wanted);
    for (k, want) in wanted.iter().enumerate() {
        assert!((course.right[k] - want).abs() < 1e-4 && (course.down[k] + want).abs() < 1e-4, "frame {k}");
    }
    // Nobody is seen in frame 14: what comes after is longer.
    late[10] = None;
    let course = Course::of(&times, &[span(0, &early), span(4, &late)]);
    assert_eq!(course.times_s, times.as_slice()[15..]);
}

#[test]
fn light_is_the_mean_of_the_pixels_whose_centres_lie_in_the_region() {
    let data: Vec<u8> = (0..12).map(|k| if k == 5 { 255 } else { 0 }).collect();
    let planes = |range| Planes { y: Gray::packed(&data, 4, 3), uv: None, range };
    let linear = Light::new(1.0);
    for (region, wanted) in [
        ([0.0, 0.0, 4.0, 3.0], Some(255.0 / 12.0)),
        ([1.0, 1.0, 1.0, 1.0], Some(255.0)),
        ([0.5, 0.5, 1.0, 1.0], Some(255.0)),
        ([0.5, 0.5, 2.0, 1.0], Some(127.5)),
        ([2.0, 0.0, 9.0, 9.0], Some(0.0)),
        ([4.0, 0.0, 2.0, 2.0], None),
        ([0.0, -3.0, 2.0, 3.0], None),
        ([0.2, 0.2, 0.3, 0.3], None),
    ] {
        assert_eq!(linear.mean(&planes(Range::Full), region), wanted, "{region:?}");
    }
    // Half the light is 0.5^(1 / 2.2) = 0.73 of the values of video.
    let half = [(16.0 + 219.0 * 0.5_f64.powf(1.0 / 2.2)).round() as u8; 1];
    let planes = Planes { y: Gray::packed(&half, 1, 1), uv: None, range: Range::Limited };
    let light = Light::new(2.2).mean(&planes, [0.0, 0.0, 1.0, 1.0]).unwrap();
    assert!((light - 127.5).abs() < 0.7, "{light}");
}
