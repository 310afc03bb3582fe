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
fn the_first_model_is_the_best_one_as_far_as_that_is_known() {
    let alone = || Model::ALL.into_iter().filter(|model| *model != Model::Fused);
    let known = |models: Vec<Model>, px: &[(Model, usize, f64)]| {
        Errors::new(models, px.iter().map(|&(model, n, mean_px)| (model, LeftOut { n, mean_px })))
    };
    assert_eq!(known(Vec::new(), &[]).first(), None);
    assert_eq!(known(Model::ALL.to_vec(), &[]).first(), Some(Model::Fused));
    assert_eq!(known(alone().collect(), &[]).first(), None);
    for (px, want) in [
        // One key-frame left out says little: it has to be clearly better.
        (&[(Model::Space, 1, 0.8), (Model::Both, 1, 1.0), (Model::Hermite, 1, 0.9)][..], Model::Both),
        (&[(Model::Space, 1, 0.2), (Model::Both, 1, 12.0)], Model::Space),
        (&[(Model::Space, 8, 0.8), (Model::Both, 8, 1.6), (Model::Hermite, 8, 0.7)], Model::Space),
        (&[(Model::Space, 3, 9.0), (Model::Both, 3, 30.0), (Model::Hermite, 3, 2.0)], Model::Hermite),
        // What missed a key-frame that another found is not offered before it.
        (&[(Model::Space, 3, 0.8), (Model::Both, 1, 0.1)], Model::Space),
        (&[(Model::KeyOnly, 3, 0.0), (Model::Space, 3, 0.8)], Model::Space),
    ] {
        assert_eq!(known(alone().collect(), px).first(), Some(want), "{px:?}");
    }
}
