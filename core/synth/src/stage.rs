//! Targets that are carried before two known cameras: what calibrating is tried on.

mod face;
#[cfg(test)]
mod tests;

use std::f64::consts::TAU;

use honami_cameras::camera::middle;
use honami_cameras::{Camera, Pair, Pixel, Place, Pose};
use nalgebra::{Rotation3, Vector2, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use crate::render::{Camera as Film, Picture};
use crate::settings::{Settings, SynthError};
use face::Face;

/// What is carried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carried {
    /// A chessboard of 9 by 6 inner corners, squares of 0.03 m.
    Board,
    /// Six targets on two bars that cross at a right angle, 5 m and 1 m long (thesis 2.3.2).
    Bars,
}

/// Two cameras that stand still, and a target that is carried about before them; lengths in metres.
#[derive(Clone, Debug)]
pub struct Stage {
    settings: Settings,
    face: Face,
    pair: Pair,
    films: [Film; 2],
    /// Directions of the light at the corners of pixels, (height + 1, width + 1), for each camera; none where its lens has no way back.
    rays: [Vec<Option<Vector2<f32>>>; 2],
}

/// Samples of a pixel along a side: edges are as smooth as a sensor has them.
const SAMPLES: usize = 4;

impl Stage {
    /// A stage of this size, number of frames and seed; of settings the plant's are not looked at, so frames may be as
    /// slow as one likes.
    ///
    /// # Errors
    /// [`SynthError`] for settings out of range.
    pub fn new(carried: Carried, settings: &Settings) -> Result<Self, SynthError> {
        settings.check_film()?;
        let width = f64::from(settings.width);
        let middle = middle([settings.width, settings.height]);
        let pair = match carried {
            // Lenses such as webcams have, a hand's breadth apart.
            Carried::Board => {
                let focal = 0.85 * width;
                let lens = |fx: f64, dx: f64, k1: f64| Camera {
                    fy: 0.997 * fx,
                    cx: middle.x + dx,
                    cy: middle.y - 0.6 * dx,
                    k1,
                    k2: 0.06,
                    p1: 0.0009,
                    p2: -0.0006,
                    ..Camera::pinhole(fx, middle)
                };
                let right_from_left =
                    Pose::new(Vector3::new(0.01, 0.06, -0.008), Vector3::new(-0.12, 0.003, 0.004));
                Pair {
                    cameras: [lens(focal, 0.011 * width, -0.22), lens(1.02 * focal, -0.008 * width, -0.2)],
                    right_from_left,
                }
            }
            // Eight metres apart, turned towards a tree 14 m away.
            Carried::Bars => {
                let lens = |focal: f64| Camera::pinhole(focal * width, middle);
                let right_from_left =
                    Pose::new(Vector3::new(0.02, 0.55, -0.01), Vector3::new(-8.0, 0.3, 2.5));
                Pair { cameras: [lens(1.0), lens(1.05)], right_from_left }
            }
        };
        let films = [0, 1].map(|side| {
            let settings =
                Settings { seed: settings.seed.wrapping_mul(2).wrapping_add(side), ..settings.clone() };
            let mut rng = Pcg64Mcg::seed_from_u64(settings.seed);
            Film::new(&settings, &mut rng)
        });
        let rays = pair.cameras.map(|camera| rays(&camera, settings.width, settings.height));
        Ok(Self { settings: settings.clone(), face: Face::of(carried), pair, films, rays })
    }

    /// Both cameras and how they stand.
    #[must_use]
    pub fn pair(&self) -> &Pair {
        &self.pair
    }

    /// Where the target's points are on its plane, metres: of a board its inner corners, row by row.
    #[must_use]
    pub fn points(&self) -> Vec<[f64; 2]> {
        self.face.points()
    }

    /// How wide the bars' targets are, metres.
    #[must_use]
    pub fn diameter(&self) -> f64 {
        2.0 * face::WHITE_M
    }

    /// How the target stands before the left camera in a frame.
    #[must_use]
    pub fn pose(&self, frame: u32) -> Pose {
        let t = f64::from(frame) / f64::from(self.settings.n_frames);
        self.face.pose(t)
    }

    /// Where a camera, 0 or 1, sees a point of the target in a frame; none where it lies outside its picture.
    #[must_use]
    pub fn seen(&self, camera: usize, frame: u32, point: [f64; 2]) -> Option<Pixel> {
        let place = self.camera_from_target(camera, frame).of(&Place::new(point[0], point[1], 0.0));
        let at = self.pair.cameras[camera].project(&place)?;
        let [width, height] = [self.settings.width, self.settings.height].map(|side| f64::from(side) - 1.0);
        ((0.0..=width).contains(&at.x) && (0.0..=height).contains(&at.y)).then_some(at)
    }

    /// A frame as a camera, 0 or 1, films it.
    #[must_use]
    pub fn render(&self, camera: usize, frame: u32) -> Picture {
        let film = &self.films[camera];
        let mut canvas = film.background.clone();
        // From a ray of the camera to where it meets the target's plane.
        let pose = self.camera_from_target(camera, frame).inverse();
        let (origin, turn) = (pose.translation, pose.rotation);
        let lattice = &self.rays[camera];
        for row in 0..canvas.height {
            for column in 0..canvas.width {
                let near = row * (canvas.width + 1) + column;
                let far = near + canvas.width + 1;
                let corners = [lattice[near], lattice[near + 1], lattice[far], lattice[far + 1]];
                let [Some(a), Some(b), Some(c), Some(d)] = corners else { continue };
                if !self.face.may_lie(&origin, &turn, a) {
                    continue;
                }
                let mut light = [0.0_f32; 3];
                let mut n_on = 0;
                for k in 0..SAMPLES * SAMPLES {
                    // Rooks that do not see each other: an upright edge meets each at another place.
                    let (i, j) = (k % SAMPLES, k / SAMPLES);
                    let share = |coarse: usize, fine: usize| {
                        (coarse as f32 + (fine as f32 + 0.5) / SAMPLES as f32) / SAMPLES as f32
                    };
                    let (x, y) = (share(i, j), share(j, SAMPLES - 1 - i));
                    let ray = (a * (1.0 - x) + b * x) * (1.0 - y) + (c * (1.0 - x) + d * x) * y;
                    if let Some(colour) = self.face.light(&origin, &turn, ray) {
                        light.iter_mut().zip(colour).for_each(|(sum, c)| *sum += c);
                        n_on += 1;
                    }
                }
                let pixel = &mut canvas.pixels[row * canvas.width + column];
                let share = n_on as f32 / (SAMPLES * SAMPLES) as f32;
                for (value, sum) in pixel.iter_mut().zip(light) {
                    *value = *value * (1.0 - share) + sum / (SAMPLES * SAMPLES) as f32;
                }
            }
        }
        film.developed(&canvas, frame, f64::from(frame) / self.settings.fps)
    }

    fn camera_from_target(&self, camera: usize, frame: u32) -> Pose {
        let left = self.pose(frame);
        if camera == 0 { left } else { self.pair.right_from_left.after(&left) }
    }
}

/// Directions from which light falls on the corners of pixels.
fn rays(camera: &Camera, width: u32, height: u32) -> Vec<Option<Vector2<f32>>> {
    let corner = |i: u32| {
        let (column, row) = (i % (width + 1), i / (width + 1));
        let at = Pixel::new(f64::from(column) - 0.5, f64::from(row) - 0.5);
        camera.undistort(&at).ok().map(|ray| ray.cast())
    };
    (0..(width + 1) * (height + 1)).map(corner).collect()
}

/// A smooth way through turns and places, `t` from 0 to 1; a turn about an axis in the picture that goes round, and about the axis
/// of sight.
fn carried(t: f64, lean_rad: [f64; 2], roll_rad: f64, aside: [f64; 2], depth: [f64; 2]) -> Pose {
    let phase = TAU * t;
    let lean = lean_rad[0] + lean_rad[1] * (5.0 * phase).sin();
    let axis = 3.0 * phase;
    let turned = Rotation3::new(Vector3::new(axis.cos(), axis.sin(), 0.0) * lean)
        * Rotation3::new(Vector3::z() * roll_rad * (2.0 * phase + 0.4).sin());
    let place = Vector3::new(
        aside[0] * (2.0 * phase).cos(),
        aside[1] * (3.0 * phase + 0.9).sin(),
        depth[0] + depth[1] * (phase + 0.3).sin(),
    );
    Pose { rotation: turned, translation: place }
}
