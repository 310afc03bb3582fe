//! A forest that goes on: as the mechanics alone has it, as far as it is seen.

use super::{Live, LiveError};
use crate::testing::forest;
use honami_mechanics::{Damping, Forest, Pose, Threads};
use std::sync::Arc;

#[test]
fn it_moves_as_the_mechanics_has_it() {
    let scene = forest(3, "storm");
    let mut live = Live::new(Arc::new(scene.clone()), 2, 1 << 20).unwrap();
    assert!(live.time().abs() < 1e-9, "{}", live.time());
    let threads = Threads::new(1).unwrap();
    let mut alone = Forest::new(&scene.stirring, &scene.body.order, &scene.stands, &scene.pace).unwrap();
    let n = scene.stirring.n_nodes();
    let mut motion = vec![[0.0; 3]; 3 * n];
    let (grove, wind) = (scene.grove(), super::wind(&scene, "storm", 1 << 20).unwrap());
    for _ in 0..60 {
        let time = alone.time();
        alone.step(&|copy| grove.blowing(&wind, copy, time), None, &threads).unwrap();
    }
    alone.pose(Pose { details: None, motion: &mut motion }, &threads);
    (0..10).for_each(|_| live.step().unwrap());
    assert!((live.time() - 0.4).abs() < 1e-9);
    // From as near as here all is seen whole.
    let camera = scene.orbit.camera();
    let seen = live.seen(&camera, [1280, 720]).unwrap();
    assert_eq!(seen.len(), 3);
    let farthest = motion.as_flattened().iter().fold(0.0, |most: f32, v| most.max(v.abs()));
    assert!(farthest > 0.01, "{farthest}");
    for seen in &seen {
        assert_eq!((seen.level, seen.motion), (0, &motion[seen.copy * n..][..n]));
    }
}

#[test]
fn less_is_seen_from_farther_and_nothing_from_behind() {
    let scene = forest(3, "wind");
    let mut live = Live::new(Arc::new(scene.clone()), 1, 1 << 20).unwrap();
    let mut orbit = scene.orbit;
    let mut levels = Vec::new();
    for times in [1.0, 3.0, 3.0, 4.0] {
        orbit.zoom(times);
        levels.push(live.seen(&orbit.camera(), [1280, 720]).unwrap()[0].level);
    }
    assert_eq!(levels, [0, 1, 2, 3]);
    // In a picture of a quarter of the height the same is seen from a quarter as far.
    let mut near = scene.orbit;
    near.zoom(9.0 / 4.0);
    assert_eq!(live.seen(&near.camera(), [320, 180]).unwrap()[0].level, 2);
    let mut camera = scene.orbit.camera();
    camera.target = std::array::from_fn(|axis| 2.0 * camera.eye[axis] - camera.target[axis]);
    assert!(live.seen(&camera, [1280, 720]).unwrap().is_empty());
}

#[test]
fn another_wind_blows_from_now_on_and_none_that_is_none() {
    let mut live = Live::new(Arc::new(forest(1, "still")), 1, 1 << 20).unwrap();
    assert!(live.blowing(0).norm() < 1e-12);
    live.blow("steady:speed=5,towards=90").unwrap();
    assert!((live.blowing(0).y - 5.0).abs() < 1e-9);
    let error = live.blow("breeze").unwrap_err();
    assert!(matches!(error, LiveError::Weather(_)) && live.blowing(0).y > 4.9, "{error}");
    let damping = Damping { mass: -1.0, ..Damping::default() };
    assert!(matches!(live.damp(damping), Err(LiveError::Forest(_))));
    live.damp(Damping { alpha: 2.0, ..Damping::default() }).unwrap();
}
