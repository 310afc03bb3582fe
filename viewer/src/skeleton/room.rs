//! How much room a skeleton takes. From the front it is seen where it was filmed; from elsewhere all of it fits into the
//! picture, in every frame and from every side, so that nothing leaves it and nothing breathes while it turns.

use std::f32::consts::PI;

use honami_scene::{Camera, SkeletonScene};

use super::{front, lens};

/// So much of a picture is left free at its edges.
const MARGIN: f32 = 0.06;
/// Sides from which it is tried, and ways in which the farthest place is looked for; of half a circle.
const SIDES: u32 = 18;
const WAYS: u32 = 24;
/// No nearer than this, of how far the front is.
const NEAREST: f32 = 0.2;

/// Where a skeleton is, all frames together. Lengths are pixels of the clip.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Room {
    /// From the middle of the clip to that of the skeleton.
    off: [f32; 3],
    /// Of the places farthest out: how far from the upright through its middle, and how high above that.
    farthest: Vec<[f32; 2]>,
    /// From where the front is seen.
    front: f32,
}

impl Room {
    /// What joints take, and what they carry.
    pub(super) fn of(scene: &SkeletonScene) -> Self {
        let places = || scene.places.iter().chain(scene.leaves.iter().flat_map(|leaf| &leaf.places));
        let middle: [f32; 3] = std::array::from_fn(|axis| {
            let along = || places().map(|place| place[axis]);
            along().fold(f32::INFINITY, f32::min).midpoint(along().fold(f32::NEG_INFINITY, f32::max))
        });
        let outline: Vec<[f32; 2]> =
            places().map(|[x, y, z]| [(x - middle[0]).hypot(y - middle[1]), z - middle[2]]).collect();
        let ways = (0..=WAYS).map(|k| (PI * (k as f32 / WAYS as f32 - 0.5)).sin_cos());
        let farthest = ways.filter_map(|(up, out)| {
            let far = |[wide, high]: &[f32; 2]| out * wide + up * high;
            outline.iter().copied().max_by(|a, b| far(a).total_cmp(&far(b)))
        });
        let orbit = front(scene);
        Self {
            off: std::array::from_fn(|axis| middle[axis] - orbit.target[axis]),
            farthest: farthest.collect(),
            front: orbit.distance,
        }
    }

    /// A camera as it is told, from where it sees all of it as far as it is not at the front, in a picture so many times as
    /// wide as high, of a clip so many times as wide as high.
    pub(super) fn fit(&self, camera: &Camera, aspect: f32, clip_aspect: f32) -> Camera {
        let forward = camera.axes()[2];
        let depth = lens::depth(forward);
        let farther = 1.0 + depth * (self.farther(forward, lens::edges(camera, aspect, clip_aspect)) - 1.0);
        let target: [f32; 3] = std::array::from_fn(|axis| camera.target[axis] + depth * self.off[axis]);
        let away = |axis: usize| farther * (camera.eye[axis] - camera.target[axis]);
        Camera { eye: std::array::from_fn(|axis| target[axis] + away(axis)), target, angle: camera.angle }
    }

    /// How many times as far as the front it is to be seen from, looking this way (length 1) or so from any other side; the
    /// picture's edges are so far right and up of its middle, of the distance.
    fn farther(&self, forward: [f32; 3], edges: [f32; 2]) -> f32 {
        let (level, steep) = (forward[0].hypot(forward[1]), forward[2]);
        let [right, up] = edges.map(|edge| edge * (1.0 - MARGIN));
        let sides = (0..=SIDES).map(|k| (PI * k as f32 / SIDES as f32).sin_cos());
        let needed = sides.flat_map(|(sin, cos)| {
            self.farthest.iter().map(move |[wide, high]| {
                let aside = wide * sin / right;
                let above = (level * high - steep * wide * cos).abs() / up;
                aside.max(above) - level * wide * cos - steep * high
            })
        });
        needed.fold(NEAREST * self.front, f32::max) / self.front
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::lens::Lens;
    use honami_scene::Orbit;
    use honami_scene::skeleton::{Carried, Film};

    /// Of a clip of 320x180: a plant at its right, which sways out of it, with leaves before and behind.
    fn scene() -> SkeletonScene {
        let leaf = |depth: f32, high: f32| Carried {
            places: (0..9).map(|k| [240.0 + 12.0 * k as f32, depth, -high]).collect(),
            ..Carried::default()
        };
        SkeletonScene {
            clip: Film { width: 320, height: 180, ..Film::default() },
            places: (0..9)
                .flat_map(|k| [[230.0, 0.0, -179.0], [230.0 + 10.0 * k as f32, 0.0, -4.0]])
                .collect(),
            leaves: vec![leaf(-120.0, 8.0), leaf(140.0, 90.0), leaf(30.0, 2.0)],
            ..SkeletonScene::default()
        }
    }

    /// How far out all places are seen, the farthest frame of each: 1 at the edge.
    fn seen(scene: &SkeletonScene, camera: &Camera, aspect: f32) -> Vec<[f32; 2]> {
        let lens = Lens::new(camera, aspect, 320.0 / 180.0);
        let places = scene.places.iter().chain(scene.leaves.iter().flat_map(|leaf| &leaf.places));
        places.map(|place| lens.seen(*place).unwrap_or([9.0; 2])).collect()
    }

    fn farthest(seen: &[[f32; 2]]) -> f32 {
        seen.as_flattened().iter().fold(0.0, |far, v| far.max(v.abs()))
    }

    #[test]
    fn from_elsewhere_all_frames_fit_into_the_picture_with_little_to_spare() {
        let scene = scene();
        let room = Room::of(&scene);
        for (elevation, aspect) in [(0.0, 16.0 / 9.0), (0.3, 16.0 / 9.0), (-0.8, 1.0), (1.4, 0.6), (0.2, 3.0)]
        {
            let cameras: Vec<Camera> = (0..40)
                .map(|k| Orbit { azimuth: 0.5 + 0.133 * k as f32, elevation, ..front(&scene) }.camera())
                .collect();
            let fitted = |camera: &Camera| room.fit(camera, aspect, 320.0 / 180.0);
            let most = |all: &dyn Fn(&Camera) -> Camera| {
                cameras.iter().map(|camera| farthest(&seen(&scene, &all(camera), aspect))).fold(0.0, f32::max)
            };
            let (before, after) = (most(&|camera| *camera), most(&fitted));
            assert!(before > 1.1, "it would be cut: {before}");
            assert!((0.8..0.97).contains(&after), "up {elevation}, {aspect} wide: {after}");
            // As far away from every side: nothing breathes.
            let away =
                |camera: &Camera| (0..3).map(|k| (camera.eye[k] - camera.target[k]).powi(2)).sum::<f32>();
            let all: Vec<f32> = cameras.iter().map(|camera| away(&fitted(camera)).sqrt()).collect();
            assert!(all.iter().all(|at| (at / all[0] - 1.0).abs() < 1e-3), "{all:?}");
        }
    }

    #[test]
    fn the_front_is_left_without_a_jump() {
        let scene = scene();
        let room = Room::of(&scene);
        let at = |azimuth: f32| {
            let camera = Orbit { azimuth, ..front(&scene) }.camera();
            seen(&scene, &room.fit(&camera, 16.0 / 9.0, 320.0 / 180.0), 16.0 / 9.0)
        };
        let plain = seen(&scene, &front(&scene).camera(), 16.0 / 9.0);
        assert!(at(0.0) == plain, "where it was filmed");
        let mut last = at(0.0);
        for k in 1..=140 {
            let now = at(0.005 * k as f32);
            let moved = now.iter().flatten().zip(last.iter().flatten()).map(|(a, b)| (a - b).abs());
            let most = moved.fold(0.0, f32::max);
            assert!(most < 0.03, "{most} at {} rad", 0.005 * k as f32);
            last = now;
        }
    }
}
