//! Where the copies of a forest stand, which wind they feel there, and where their nodes are.

use honami_mechanics::wind::Wind;
use honami_mechanics::{Stand, Vector};
use rand::{RngExt as _, SeedableRng as _};

use super::Vibrating;
use super::sway::Motion;

/// Metres between copies of a plant of height 1, unless others are wanted; each stands up to a quarter of that off.
const APART: f64 = 0.8;
/// Sizes, and masses, are so many larger ones and so many smaller: copies of one size and mass go on by the same numbers,
/// which are few.
const STEPS: i32 = 8;
/// Where on a copy's height its wind is measured, from the ground.
const CROWN: f64 = 2.0 / 3.0;

/// Of all copies, the least and the most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spans {
    /// Of the slowest mode, hertz.
    pub hz: [f64; 2],
    /// Metres.
    pub height: [f64; 2],
    /// Wood and leaves, kilograms.
    pub kilograms: [f64; 2],
}

impl Spans {
    /// Of the copies of a plant as they move.
    #[must_use]
    pub fn of(plant: &Vibrating, motion: &Motion) -> Self {
        let stands = Grove::new(plant.height, motion).stands;
        let (heavier, kilograms, hz) = (motion.damping.mass, plant.beams.kilograms(), plant.modes.hz(0));
        let span = |of: &dyn Fn(f64, f64) -> f64| {
            let values = stands.iter().map(|stand| of(f64::from(stand.scale), f64::from(stand.mass)));
            values.fold([f64::INFINITY, 0.0], |[least, most], value| [value.min(least), value.max(most)])
        };
        Self {
            // A copy that is s times as large swings s times as slowly.
            hz: span(&|scale, mass| hz / (scale * (mass * heavier).sqrt())),
            height: span(&|scale, _| plant.height * scale),
            kilograms: span(&|scale, mass| kilograms * heavier * scale.powi(3) * mass),
        }
    }
}

/// Where copies stand, and how.
pub(super) struct Grove {
    /// Of their roots, metres.
    pub(super) places: Vec<Vector>,
    pub(super) stands: Vec<Stand>,
    /// Of the plant, metres.
    pub(super) height: f64,
}

impl Grove {
    /// In rows, each a little off, turned, larger or smaller and heavier or lighter by chance; the first as it was measured.
    pub(super) fn new(height: f64, motion: &Motion) -> Self {
        // Apart from the other: copies stand where they do whatever their sizes.
        let mut sizes = rand_pcg::Pcg64Mcg::seed_from_u64(!motion.seed);
        let mut chance = rand_pcg::Pcg64Mcg::seed_from_u64(motion.seed);
        let (side, apart) =
            ((motion.n_copies as f64).sqrt().ceil() as usize, motion.spacing.unwrap_or(APART * height));
        let mut stand = |k: usize| {
            let mut off = || chance.random_range(-0.25..0.25);
            let (row, column) = (k / side, k % side);
            let place = Vector::new((column as f64 + off()) * apart, (row as f64 + off()) * apart, 0.0);
            let turn = chance.random_range(0.0..std::f32::consts::TAU);
            let [scale, mass] = [motion.size_spread, motion.mass_spread].map(|spread| {
                let step = sizes.random_range(-STEPS..=STEPS);
                (1.0 + spread).powf(f64::from(step) / f64::from(STEPS)) as f32
            });
            let first = (Vector::zeros(), Stand::default());
            if k == 0 { first } else { (place, Stand { turn, scale, mass }) }
        };
        let (places, stands) = (0..motion.n_copies).map(&mut stand).unzip();
        Self { places, stands, height }
    }

    /// The wind at a copy's crown.
    pub(super) fn blowing(&self, wind: &dyn Wind, copy: usize, time: f64) -> Vector {
        let up = Vector::z() * (CROWN * f64::from(self.stands[copy].scale) * self.height);
        wind.sample(&(self.places[copy] + up), time)
    }

    /// From the axes of the plant to where a copy stands.
    pub(super) fn shown(&self, copy: usize, own: &Vector) -> Vector {
        let Stand { turn, scale, .. } = self.stands[copy];
        let (sin, cos) = f64::from(turn).sin_cos();
        let turned = Vector::new(cos * own.x - sin * own.y, sin * own.x + cos * own.y, own.z);
        self.places[copy] + turned * f64::from(scale)
    }
}
