//! A forest that goes on: as the mechanics alone has it, as far as it is seen.

use super::{Live, LiveError};
use crate::ForestScene;
use crate::testing::forest;
use honami_mechanics::wind::Wind as _;
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
        alone.step(&|copy| grove.blowing(&wind, copy, time - scene.run_in), None, &threads).unwrap();
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

/// A squall that comes from 60 m away by 10 m/s is here after six seconds, whatever was before: of what is shown, and since
/// it was typed. One that is turned is where it would be.
#[test]
fn winds_that_travel_begin_with_what_is_shown_and_when_they_are_typed() {
    let scene = ForestScene { run_in: 20.0, ..forest(1, "squall") };
    let mut live = Live::new(Arc::new(scene.clone()), 1, 1 << 20).unwrap();
    let here = |seconds: f64| 15.0 * (-((60.0 - 10.0 * seconds) / 30.0).powi(2)).exp();
    let go_on = |live: &mut Live, seconds: f64| {
        (0..(seconds / scene.pace.step).round() as u32).for_each(|_| live.step().unwrap());
    };
    for _ in 0..2 {
        for seconds in [0.0, 2.0, 6.0] {
            go_on(&mut live, if seconds > 2.0 { 4.0 } else { seconds });
            let blowing = live.blowing(0).norm();
            assert!((blowing - here(seconds)).abs() < 1e-6, "{seconds} s: {blowing}");
        }
        go_on(&mut live, 30.0);
        assert!(live.blowing(0).norm() < 1e-9, "it has gone");
        live.blow("squall").unwrap();
    }
    go_on(&mut live, 6.0);
    live.turn(super::wind(&scene, "squall:speed=30", 1 << 20).unwrap());
    assert!((live.blowing(0).norm() - 30.0).abs() < 1e-6, "{}", live.blowing(0));
}

/// Air that is typed late flows from its beginning.
#[test]
fn a_wind_that_ends_is_whole_when_it_is_typed() {
    let scene = ForestScene { run_in: 0.0, ..forest(1, "still") };
    let mut live = Live::new(Arc::new(scene.clone()), 1, 1 << 24).unwrap();
    (0..3500).for_each(|_| live.step().unwrap());
    live.blow("air:cell=16").unwrap();
    let air = super::wind(&scene, "air:cell=16", 1 << 24).unwrap();
    let mut swung = 0.0_f64;
    for _ in 0..100 {
        let (time, grove) = (live.time() - 140.0, scene.grove());
        assert!((live.blowing(0) - grove.blowing(&air, 0, time)).norm() < 1e-6, "{time}");
        swung = swung.max((live.blowing(0) - air.sample(&grove.places[0], 0.0)).norm());
        live.step().unwrap();
    }
    assert!(swung > 0.1, "{swung}");
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
