//! The camera: paints a pose over the background, then light, sensor noise and 4:2:0 coding.

mod background;
mod paint;

use std::f64::consts::TAU;

use honami_model::picture::{Gray, Planes, Range};
use rand::{Rng, RngExt};
use rand_pcg::{Pcg32, Pcg64Mcg};

use crate::plant::Plant;
use crate::pose::Pose;
use crate::settings::Settings;
use paint::Canvas;

/// A rendered frame: full range, BT.601, chroma at half size (rounded up), rows packed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Luma, (height, width).
    pub y: Vec<u8>,
    /// Blue difference, (ceil(height/2), ceil(width/2)).
    pub u: Vec<u8>,
    /// Red difference, (ceil(height/2), ceil(width/2)).
    pub v: Vec<u8>,
}

impl Picture {
    /// The planes as trackers and writers take them.
    #[must_use]
    pub fn planes(&self) -> Planes<'_> {
        Planes {
            y: Gray::packed(&self.y, self.width, self.height),
            uv: Some((&self.u, &self.v)),
            range: Range::Full,
        }
    }
}

/// A fixed camera before a fixed background.
#[derive(Clone, Debug)]
pub(crate) struct Camera {
    pub(crate) background: Canvas,
    seed: u64,
    noise: f64,
    lighting: f64,
    /// Phases of the slow and the quick swing of the light.
    light_phase_rad: [f64; 2],
}

impl Camera {
    pub(crate) fn new(settings: &Settings, rng: &mut Pcg64Mcg) -> Self {
        Self {
            background: background::paint(settings, rng),
            seed: settings.seed,
            noise: settings.noise,
            lighting: settings.lighting,
            light_phase_rad: [rng.random_range(0.0..TAU), rng.random_range(0.0..TAU)],
        }
    }

    /// The frame with this number of a pose.
    pub(crate) fn picture(&self, plant: &Plant, pose: &Pose, frame: u32, t_secs: f64) -> Picture {
        let mut canvas = self.background.clone();
        canvas.plant(plant, pose);
        self.developed(&canvas, frame, t_secs)
    }

    /// What the sensor makes of a painted frame.
    pub(crate) fn developed(&self, canvas: &Canvas, frame: u32, t_secs: f64) -> Picture {
        let mut sensor = Sensor::new(self.seed, frame, self.light(t_secs), self.noise);
        sensor.picture(canvas)
    }

    /// Strength of the light: swings of 9 s and 3.7 s, clouds and thin clouds.
    fn light(&self, t_secs: f64) -> f64 {
        let swing = |hz: f64, phase: f64| (TAU * hz * t_secs + phase).sin();
        let [slow, quick] = self.light_phase_rad;
        1.0 + self.lighting * (0.75 * swing(0.11, slow) + 0.25 * swing(0.27, quick))
    }
}

/// Turns light into bytes.
struct Sensor {
    rng: Pcg32,
    light: f32,
    /// Noise per unit of the sum of four bytes.
    noise: f32,
}

/// Standard deviation of the sum of four uniform bytes.
const FOUR_BYTES_SD: f64 = 147.799;

impl Sensor {
    fn new(seed: u64, frame: u32, light: f64, noise: f64) -> Self {
        let rng = Pcg32::new(seed, u64::from(frame));
        Self { rng, light: light as f32, noise: (noise / FOUR_BYTES_SD) as f32 }
    }

    fn picture(&mut self, canvas: &Canvas) -> Picture {
        let (width, height) = (canvas.width, canvas.height);
        let mut y = Vec::with_capacity(width * height);
        for pixel in &canvas.pixels {
            let luma = 0.299 * pixel[0] + 0.587 * pixel[1] + 0.114 * pixel[2];
            y.push(self.byte(luma * self.light, 1.0));
        }
        let n_chroma = width.div_ceil(2) * height.div_ceil(2);
        let (mut u, mut v) = (Vec::with_capacity(n_chroma), Vec::with_capacity(n_chroma));
        for row in (0..height).step_by(2) {
            for column in (0..width).step_by(2) {
                let [r, g, b] = canvas.mean_of_four(row, column).map(|c| c * self.light);
                u.push(self.byte(128.0 - 0.168_736 * r - 0.331_264 * g + 0.5 * b, 0.5));
                v.push(self.byte(128.0 + 0.5 * r - 0.418_688 * g - 0.081_312 * b, 0.5));
            }
        }
        Picture { width: width as u32, height: height as u32, y, u, v }
    }

    /// A value with noise, all but normal: the sum of four uniform bytes. The mean of four pixels has half.
    #[inline]
    fn byte(&mut self, value: f32, share: f32) -> u8 {
        let sum: u32 = self.rng.next_u32().to_le_bytes().into_iter().map(u32::from).sum();
        (value + share * self.noise * (sum as f32 - 510.0) + 0.5) as u8
    }
}
