//! Where the copies of a forest stand, and which wind they feel there.

use honami_mechanics::wind::Wind;
use honami_mechanics::{Stand, Vector};
use rand::{RngExt as _, SeedableRng as _};

/// Metres between copies of a plant of height 1, unless others are wanted; each stands up to a quarter of that off.
const APART: f64 = 0.8;
/// Sizes, and masses, are so many larger ones and so many smaller: copies of one size and mass go on by the same numbers,
/// which are few.
const STEPS: i32 = 8;
/// Where on a copy's height its wind is measured, from the ground.
const CROWN: f64 = 2.0 / 3.0;

/// How many copies of a plant are wanted, and how unlike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planting {
    /// Copies of the plant.
    pub n_copies: usize,
    /// Copies are up to 1 + so much times larger or smaller than the plant; the first is as it was measured.
    pub size_spread: f64,
    /// And heavier or lighter than one of their size.
    pub mass_spread: f64,
    /// Metres between copies; `None`: 0.8 times the plant's height.
    pub spacing: Option<f64>,
    /// Of where copies stand, how they are turned, and their sizes and masses.
    pub seed: u64,
}

/// Where copies stand, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Grove {
    /// Of their roots, metres.
    pub places: Vec<Vector>,
    /// How: one a place.
    pub stands: Vec<Stand>,
    /// Of the plant, metres.
    pub height: f64,
}

impl Grove {
    /// In rows, each a little off, turned, larger or smaller and heavier or lighter by chance; the first as it was measured.
    #[must_use]
    pub fn new(height: f64, planting: &Planting) -> Self {
        // Apart from the other: copies stand where they do whatever their sizes.
        let mut sizes = rand_pcg::Pcg64Mcg::seed_from_u64(!planting.seed);
        let mut chance = rand_pcg::Pcg64Mcg::seed_from_u64(planting.seed);
        let (side, apart) =
            ((planting.n_copies as f64).sqrt().ceil() as usize, planting.spacing.unwrap_or(APART * height));
        let mut stand = |k: usize| {
            let mut off = || chance.random_range(-0.25..0.25);
            let (row, column) = (k / side, k % side);
            let place = Vector::new((column as f64 + off()) * apart, (row as f64 + off()) * apart, 0.0);
            let turn = chance.random_range(0.0..std::f32::consts::TAU);
            let [scale, mass] = [planting.size_spread, planting.mass_spread].map(|spread| {
                let step = sizes.random_range(-STEPS..=STEPS);
                (1.0 + spread).powf(f64::from(step) / f64::from(STEPS)) as f32
            });
            let first = (Vector::zeros(), Stand::default());
            if k == 0 { first } else { (place, Stand { turn, scale, mass }) }
        };
        let (places, stands) = (0..planting.n_copies).map(&mut stand).unzip();
        Self { places, stands, height }
    }

    /// The wind at a copy's crown.
    #[must_use]
    pub fn blowing(&self, wind: &dyn Wind, copy: usize, time: f64) -> Vector {
        let up = Vector::z() * (CROWN * f64::from(self.stands[copy].scale) * self.height);
        wind.sample(&(self.places[copy] + up), time)
    }

    /// From the axes of the plant to where a copy stands.
    #[must_use]
    pub fn shown(&self, copy: usize, own: &Vector) -> Vector {
        let Stand { turn, scale, .. } = self.stands[copy];
        let (sin, cos) = f64::from(turn).sin_cos();
        let turned = Vector::new(cos * own.x - sin * own.y, sin * own.x + cos * own.y, own.z);
        self.places[copy] + turned * f64::from(scale)
    }
}
