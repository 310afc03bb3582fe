//! Which key-frames are left out, and which model their errors choose. The models themselves are tried on a real clip by
//! the end-to-end tests.

use super::*;

#[test]
fn the_nearest_key_frames_are_left_out_with_their_neighbours() {
    let placed = |frames: &[u32]| -> Vec<Placed> { frames.iter().map(|&at| (at, [0.0; 2])).collect() };
    let many: Vec<u32> = (0..40).map(|k| 10 * k).collect();
    for (frames, frame, want) in [
        (&[][..], 5, None),
        (&[7], 5, Some((7, 7))),
        (&[0, 9, 20], 100, Some((0, 20))),
        (&many, 0, Some((0, 90))),
        (&many, 205, Some((160, 250))),
        (&many, 1000, Some((300, 390))),
    ] {
        let placed = placed(frames);
        let keys = nearest(&placed, frame);
        let ends = keys.first().zip(keys.last()).map(|(first, last)| (first.0, last.0));
        assert_eq!(ends, want, "{frames:?} {frame}");
    }
}

#[test]
fn a_model_that_missed_a_key_frame_is_not_offered_before_one_that_found_all() {
    let known = |px: &[(Model, usize, f64)]| {
        Errors::new(px.iter().map(|&(model, n, mean_px)| (model, LeftOut { n, mean_px })))
    };
    for (px, want) in [
        (&[][..], None),
        (&[(Model::Space, 2, 0.8), (Model::Both, 2, 0.3), (Model::Hermite, 2, 2.4)], Some(Model::Both)),
        (&[(Model::Space, 3, 0.8), (Model::Forward, 1, 0.1)], Some(Model::Space)),
        // Of equals the one that is offered before.
        (&[(Model::Both, 1, 0.5), (Model::Space, 1, 0.5)], Some(Model::Space)),
    ] {
        assert_eq!(known(px).best(), want, "{px:?}");
    }
}
