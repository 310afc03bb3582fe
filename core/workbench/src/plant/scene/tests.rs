//! Scenes of a generated tree: what is shown of it, and what is refused.

use super::{Shown, scene};
use crate::plant::sway::Motion;
use crate::plant::{Wish, vibrate};

fn shown(wind: &str) -> Shown {
    Shown { name: "tree".to_owned(), wind: wind.to_owned(), leaves: None, leaf_length: None }
}

#[test]
fn a_forest_is_seen_from_outside_of_it() {
    let plant = vibrate(&Wish::of("synth::tree:200,1", Some(6)), &()).unwrap();
    for n_copies in [1, 9, 100] {
        let motion = Motion { n_copies, size_spread: 0.2, ..Motion::default() };
        let made = scene(&plant, &motion, &shown("wind")).unwrap();
        assert_eq!((made.places.len(), made.stands.len()), (n_copies, n_copies));
        let eye = made.orbit.camera().eye;
        let nearest =
            made.places.iter().map(|[x, y]| (eye[0] - x).hypot(eye[1] - y)).fold(f32::MAX, f32::min);
        assert!(nearest > plant.height as f32 && eye[2] > 0.0, "{n_copies}: {nearest} m off at {} m", eye[2]);
        assert!(!made.body.levels[0].leaves.is_empty());
    }
    let bare = Shown { leaves: Some(0), ..shown("wind") };
    assert!(scene(&plant, &Motion::default(), &bare).unwrap().body.levels[0].leaves.is_empty());
    let error = scene(&plant, &Motion::default(), &shown("breeze")).unwrap_err();
    assert!(error.is_as_typed() && error.to_string().contains("is no wind and no file"), "{error}");
}
