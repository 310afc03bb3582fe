//! Views that are known, for tests: cameras, poses and noise.

use nalgebra::{Vector2, Vector3};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;

use crate::{Camera, Pixel, Pose, Sighting, Target};

/// Size of pictures, pixels.
pub(crate) const SIZE: [u32; 2] = [640, 480];

/// A camera whose numbers are like those of a real one.
pub(crate) const LENS: Camera = Camera {
    fx: 536.0,
    fy: 533.0,
    cx: 330.0,
    cy: 232.0,
    k1: -0.26,
    k2: 0.08,
    p1: 0.0012,
    p2: -0.0007,
    k3: 0.0,
};

pub(crate) struct Noise {
    random: Pcg64Mcg,
    normal: Normal<f64>,
}

impl Noise {
    pub(crate) fn new(seed: u64, sigma: f64) -> Self {
        Self { random: Pcg64Mcg::seed_from_u64(seed), normal: Normal::new(0.0, sigma).unwrap() }
    }

    pub(crate) fn draw(&mut self) -> f64 {
        self.normal.sample(&mut self.random)
    }

    pub(crate) fn pixel(&mut self) -> Pixel {
        Vector2::new(self.draw(), self.draw())
    }
}

/// All points of a target as a camera sees them.
pub(crate) fn seen(camera: &Camera, pose: &Pose, target: &Target, noise: &mut Noise) -> Sighting {
    let at = |point: usize| camera.project(&pose.of(&target.place(point))).unwrap();
    (0..target.len()).map(|point| (point, at(point) + noise.pixel())).collect()
}

/// Poses of a target with this middle, before a camera, `depth` away: turned by up to 0.6 rad about several axes.
pub(crate) fn poses(n: usize, middle: [f64; 2], depth: f64, spread: f64) -> Vec<Pose> {
    (0..n)
        .map(|i| {
            let angle = i as f64 * 2.4;
            let turn = Vector3::new(angle.cos(), angle.sin(), 0.3 * (angle * 1.7).sin());
            let turned = Pose::new(turn * (0.25 + 0.35 * (i as f64 * 0.618).fract()), Vector3::zeros());
            let aside = Vector3::new((angle * 0.7).cos() * spread, (angle * 0.7).sin() * spread * 0.7, depth);
            let nearer = 1.0 - 0.25 * (i as f64 * 0.37).fract();
            let translation = aside * nearer - turned.of(&Vector3::new(middle[0], middle[1], 0.0));
            Pose { translation, ..turned }
        })
        .collect()
}

/// The board of OpenCV's pictures, of millimetres.
pub(crate) fn board() -> Target {
    Target::board(9, 6, 25.0).unwrap()
}

/// Views of the board by a camera.
pub(crate) fn board_views(camera: &Camera, n: usize, noise: &mut Noise) -> Vec<Sighting> {
    poses(n, [100.0, 62.5], 450.0, 60.0).iter().map(|pose| seen(camera, pose, &board(), noise)).collect()
}
