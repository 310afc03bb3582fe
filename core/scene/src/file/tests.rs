//! Scene files whole, cut short, changed, and of others.

use super::{HEAD_BYTES, MAGIC, SceneFileError, read, write};
use crate::skeleton::{Film, Joint};
use crate::testing::forest;
use crate::{ForestScene, Scene, SkeletonScene};
use sha2::{Digest as _, Sha256};
use std::fs;

fn scene() -> Scene {
    let film = Film { width: 4, height: 3, n_frames: 1, ..Film::default() };
    let joints = vec![Joint::default(), Joint { parent: Some(0), ..Joint::default() }];
    let places = vec![[0.0, 0.0, 0.0], [1.0, 0.0, -2.5]];
    Scene::Skeleton(Box::new(SkeletonScene {
        clip: film,
        joints,
        places,
        times: vec![0.0],
        ..SkeletonScene::default()
    }))
}

#[test]
fn what_was_written_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.scene");
    // Twice: a scene takes the place of a scene.
    for _ in 0..2 {
        write(&path, &scene()).unwrap();
        assert_eq!(read(&path).unwrap(), scene());
    }
}

#[test]
fn nothing_else_is_a_scene() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.scene");
    write(&path, &scene()).unwrap();
    let whole = fs::read(&path).unwrap();
    let told = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        read(&path).unwrap_err()
    };
    for n in [1, 5, 8, HEAD_BYTES - 1, HEAD_BYTES, whole.len() - 1] {
        let error = told(&whole[..n]);
        assert!(matches!(error, SceneFileError::Short { came, .. } if came == n as u64), "{n}: {error}");
    }
    let changed = |at: usize| {
        let mut bytes = whole.clone();
        bytes[at] ^= 1;
        told(&bytes)
    };
    assert!(matches!(changed(7), SceneFileError::Version(_)));
    assert!(matches!(changed(0), SceneFileError::Other(_)));
    for at in [16, HEAD_BYTES, whole.len() - 1] {
        assert!(matches!(changed(at), SceneFileError::Changed(_)), "byte {at}");
    }
    assert!(matches!(told(&[whole.as_slice(), b"x"].concat()), SceneFileError::Changed(_)));
    assert!(matches!(told(b""), SceneFileError::Other(_)));
    assert!(matches!(told(b"track,frame\n"), SceneFileError::Other(_)));
    fs::remove_file(&path).unwrap();
    assert!(matches!(read(&path), Err(SceneFileError::Io { .. })));
}

#[test]
fn it_takes_the_place_of_nothing_but_a_scene() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("notes.txt");
    fs::write(&path, "mine").unwrap();
    assert!(matches!(write(&path, &scene()), Err(SceneFileError::Table(_))));
    assert_eq!(fs::read(&path).unwrap(), b"mine");
}

#[test]
fn a_scene_whose_parts_do_not_go_together_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.scene");
    let Scene::Skeleton(whole) = scene() else { unreachable!() };
    type Spoil = fn(&mut SkeletonScene);
    let cases: [(&str, Spoil); 5] = [
        ("1 places of 2 joints in 1 frames", |scene| scene.places.truncate(1)),
        ("a root alone", |scene| {
            scene.joints.truncate(1);
            scene.places.truncate(1);
        }),
        ("it names", |scene| scene.joints[1].parent = Some(1)),
        ("it names", |scene| scene.joints[1].group = Some(0)),
        ("0 places of 2 joints in 0 frames", |scene| (scene.times, scene.places) = Default::default()),
    ];
    for (wanted, spoil) in cases {
        let mut scene = whole.clone();
        spoil(&mut scene);
        write(&path, &Scene::Skeleton(scene)).unwrap();
        let error = read(&path).unwrap_err().to_string();
        assert!(error.contains(wanted), "{error}");
    }
}

#[test]
fn a_forest_whose_parts_do_not_go_together_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.scene");
    type Spoil = fn(&mut ForestScene);
    let cases: [(&str, Spoil); 5] = [
        ("1 places and 2 copies", |scene| scene.places.truncate(1)),
        ("no number", |scene| scene.stands[1].scale = f32::NAN),
        ("in steps of 0 s", |scene| scene.pace.step = 0.0),
        ("NaN s of wind", |scene| scene.run_in = f64::NAN),
        ("an order of 41 of 41 nodes", |scene| scene.body.order.swap(0, 1)),
    ];
    for (wanted, spoil) in cases {
        let mut scene = forest(2, "calm");
        spoil(&mut scene);
        write(&path, &Scene::Forest(Box::new(scene))).unwrap();
        let error = read(&path).unwrap_err().to_string();
        assert!(error.contains(wanted), "{error}");
    }
}

/// The viewer is built apart: one of yesterday must not take the scenes of today for its own. Whoever changes what a scene
/// consists of gives [`MAGIC`] another number, and these the numbers that come.
#[test]
fn scenes_of_another_shape_are_of_another_version() {
    let bytes = postcard::to_allocvec(&scene()).unwrap();
    let print: String = Sha256::digest(&bytes)[..4].iter().map(|byte| format!("{byte:02x}")).collect();
    // What a forest weighs depends on rounding, how long it is written does not.
    let n_forest = postcard::to_allocvec(&Scene::Forest(Box::new(forest(2, "calm")))).unwrap().len();
    assert_eq!((&MAGIC, print.as_str(), n_forest), (b"HONAMI01", "05427f1e", 36_475));
}
