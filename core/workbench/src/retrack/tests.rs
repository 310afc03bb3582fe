//! Crops, stretches and passes as plain data; the passes themselves are made by the real program in `tests/it`.

use honami_host::Values;
use honami_model::clip::{Clip, FrameTimes};
use honami_model::picture::{Chroma, Gray};
use honami_model::provenance::Value;
use proptest::prelude::*;

use super::Way;
use super::crop::{Bounds, Crop};
use super::direction::margin_px;
use super::plan::{Anchors, Limits, Pass, Stretch, around, stretches};

fn clip(width: u32, height: u32) -> Clip {
    Clip { width, height, times: FrameTimes::constant(10, 25.0).unwrap() }
}

proptest! {
    #[test]
    fn a_crop_holds_the_path_with_its_margin_and_lies_in_the_picture(
        (width, height) in (1_u32..900, 1_u32..900),
        margin_px in 1_u32..300,
        points in prop::collection::vec((-50.0_f32..950.0, -50.0_f32..950.0), 1..5),
    ) {
        let clip = clip(width, height);
        let mut bounds = Bounds::of(points[0].into());
        points.iter().for_each(|&point| bounds.add(point.into()));
        let crop = Crop::round(&bounds, margin_px, &clip);
        for (axis, size) in [width, height].into_iter().enumerate() {
            let (start, end) = (crop.origin[axis], crop.origin[axis] + crop.size[axis]);
            prop_assert!(start % 64 == 0 && start < end && end <= size);
            prop_assert!(end - start >= size.min(2 * margin_px), "levels of a pyramid need room");
        }
        // What is in the picture is nowhere near an edge at which the picture goes on.
        for (x, y) in points {
            if (0.0..width as f32).contains(&x) && (0.0..height as f32).contains(&y) {
                prop_assert!(!crop.is_cut_near([x, y], margin_px));
                let back = crop.outward(crop.inward([x, y]));
                prop_assert!((back[0] - x).abs() < 1e-3 && (back[1] - y).abs() < 1e-3);
            }
        }
    }
}

#[test]
fn a_crop_is_a_window_on_the_same_pixels() {
    let clip = clip(300, 200);
    let data: Vec<u8> = (0..300 * 200_u32).map(|k| (k % 251) as u8).collect();
    let crop = Crop::round(&Bounds::of([200.0, 190.0]), 20, &clip);
    assert_eq!((crop.origin, crop.size), ([128, 128], [93, 72]));
    let part = crop.of(Gray::packed(&data, 300, 200));
    assert!(part.is_whole() && !crop.is_whole());
    assert_eq!(part.row(7), &data[(135 * 300 + 128)..][..93]);
    let plane = Gray::packed(&data[..150 * 100], 150, 100);
    let chroma = crop.of_chroma(&Chroma { cb: plane, cr: plane });
    assert!(chroma.fits(93, 72));
    assert_eq!((chroma.cr.width, chroma.cr.height), (47, 36), "half the crop, rounded up");
    assert_eq!(chroma.cr.row(3), &data[(67 * 150 + 64)..][..47]);
    assert!(crop.is_cut_near([140.0, 190.0], 20) && crop.is_cut_near([215.0, 190.0], 20));
    assert!(!crop.is_cut_near([200.0, 195.0], 20), "below is the picture's own edge");
}

/// Stretches as `before frames after`, with a dot where nothing is said of the feature.
fn said(stretches: &[Stretch]) -> String {
    let word = |at: Option<[f32; 2]>| at.map_or(".".to_owned(), |at| at[0].to_string());
    let one =
        |s: &Stretch| format!("{} {}-{} {}", word(s.before), s.frames.start, s.frames.end - 1, word(s.after));
    stretches.iter().map(one).collect::<Vec<_>>().join(", ")
}

#[test]
fn stretches_lie_between_what_a_person_has_said() {
    // The feature is said to be at x = frame; at 30 it is lost.
    let anchors: Anchors = [0, 10, 11, 20, 30].map(|at| (at, (at != 30).then_some([at as f32, 0.0]))).into();
    let (forward, backward, both) = (Way::Forward, Way::Backward, Way::Both);
    for (frames, way, want) in [
        (0..=39, both, "0 1-9 10, 11 12-19 20, 20 21-29 ."),
        (0..=39, forward, "0 1-9 ., 11 12-19 ., 20 21-29 ."),
        (0..=39, backward, ". 1-9 10, . 12-19 20"),
        (5..=15, both, ". 5-9 10, 11 12-15 ."),
        (5..=15, forward, "11 12-15 ."),
        (10..=20, both, "11 12-19 20"),
        (12..=19, both, ""),
        (31..=39, both, ""),
        (10..=10, both, ""),
    ] {
        assert_eq!(said(&stretches(&anchors, &frames, way)), want, "{frames:?} {way:?}");
    }
}

#[test]
fn a_word_at_the_cursor_means_up_to_the_neighbouring_key_frames() {
    let anchors: Anchors = [5, 10, 20].map(|at| (at, Some([0.0, 0.0]))).into();
    let (forward, backward, both) = (Way::Forward, Way::Backward, Way::Both);
    for (frame, way, want) in [
        (12, both, 10..=20),
        (10, both, 5..=20),
        (20, both, 10..=39),
        (3, both, 0..=5),
        (30, both, 20..=39),
        (12, forward, 10..=20),
        (10, forward, 10..=20),
        (25, forward, 20..=39),
        (2, forward, 0..=5),
        (12, backward, 10..=20),
        (20, backward, 10..=20),
        (5, backward, 0..=5),
        (30, backward, 20..=39),
    ] {
        let limits = Limits { marked: None, followed: 0..0, n_frames: 40 };
        assert_eq!(around(&anchors, frame, way, &limits), want, "{frame} {way:?}");
    }
}

#[test]
fn what_no_key_frame_ends_goes_no_further_than_the_track_did_or_the_range() {
    let anchors: Anchors = [(10, Some([1.0; 2])), (20, Some([2.0; 2]))].into();
    let (forward, backward, both) = (Way::Forward, Way::Backward, Way::Both);
    for (frame, way, marked, followed, want) in [
        (25, forward, None, 5..30, 20..=29),
        (25, both, None, 5..30, 20..=29),
        (20, both, None, 5..30, 10..=29),
        (7, backward, None, 5..30, 5..=10),
        (15, both, None, 5..12, 10..=20),
        // Key-frames beyond what was followed: as far as the clip.
        (25, forward, None, 5..15, 20..=39),
        (7, backward, None, 12..30, 0..=10),
        // As far as it was followed.
        (25, forward, None, 5..21, 20..=20),
        // A marked range holds everything, and may go further.
        (25, forward, Some(15..35), 5..30, 20..=34),
        (15, both, Some(12..19), 5..30, 12..=18),
        (15, both, Some(11..20), 5..30, 10..=20),
        (25, both, Some(21..99), 5..30, 20..=39),
        (7, backward, Some(8..30), 5..30, 8..=10),
        // A cursor outside it.
        (25, forward, Some(2..8), 5..30, 2..=7),
        (7, backward, Some(22..30), 5..30, 22..=29),
    ] {
        let limits = Limits { marked: marked.clone(), followed: followed.clone(), n_frames: 40 };
        let came = around(&anchors, frame, way, &limits);
        assert_eq!(came, want, "{frame} {way:?} marked {marked:?} followed {followed:?}");
    }
}

#[test]
fn a_pass_leaves_its_key_frame_in_its_own_direction() {
    let pass = |from, frames, backward| Pass { from, at: [0.0; 2], frames, backward };
    assert_eq!(pass(3, 4..7, false).order().collect::<Vec<_>>(), [3, 4, 5, 6]);
    assert_eq!(pass(7, 4..7, true).order().collect::<Vec<_>>(), [7, 6, 5, 4]);
}

#[test]
fn the_margin_is_as_wide_as_the_tracker_looks() {
    for (radius, levels, want) in
        [(10, 4, 128), (15, 4, 180), (31, 5, 744), (10, 1, 128), (100, 40, u32::MAX / 2)]
    {
        let values = [("radius", radius), ("levels", levels)];
        let values: Values = values.into_iter().map(|(id, n)| (id.to_owned(), Value::Int(n))).collect();
        assert_eq!(margin_px(&values), want, "{radius} {levels}");
    }
    assert_eq!(margin_px(&Values::default()), 128);
}
