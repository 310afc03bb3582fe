//! The face of a leaf: midrib, side veins, blotches and spots, drawn once per leaf from its own seed.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Brightness of a leaf relative to its colour, on a grid over its length (-1..1) and width (-1..1).
#[derive(Clone, Debug)]
pub(crate) struct Texture {
    /// Texels, (n_across, n_along), row-major.
    texels: Vec<f32>,
    n_along: usize,
    n_across: usize,
}

/// Texels per pixel: fine enough for bilinear sampling to be smooth, coarse enough not to alias.
const DENSITY: f64 = 1.6;

impl Texture {
    /// Draws the face of a leaf of the given half sizes.
    pub(crate) fn new(seed: u64, half_length_px: f64, half_width_px: f64) -> Self {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let size = |half_px: f64| ((2.0 * half_px * DENSITY).ceil() as usize).max(4);
        let (n_along, n_across) = (size(half_length_px), size(half_width_px));
        let veins = Veins::new(&mut rng, half_length_px);
        let marks = marks(&mut rng, half_length_px, half_width_px);
        let centred = |i: usize, n: usize| (2.0 * i as f64 + 1.0) / n as f64 - 1.0;
        let texels = (0..n_across * n_along)
            .map(|i| {
                let x = centred(i % n_along, n_along) * half_length_px;
                let y = centred(i / n_along, n_across) * half_width_px;
                let marked: f64 = marks.iter().map(|mark| mark.at(x, y)).sum();
                (1.0 + veins.at(x, y) + marked).clamp(0.35, 1.75) as f32
            })
            .collect();
        Self { texels, n_along, n_across }
    }

    /// Brightness at a place of the leaf, -1..1 along and across; bilinear, held at the edges.
    #[inline]
    pub(crate) fn at(&self, along: f32, across: f32) -> f32 {
        let place = |c: f32, n: usize| {
            let at = ((c + 1.0) * 0.5 * n as f32 - 0.5).clamp(0.0, (n - 1) as f32);
            let cell = (at as usize).min(n - 2);
            (cell, at - cell as f32)
        };
        let (column, fx) = place(along, self.n_along);
        let (row, fy) = place(across, self.n_across);
        let near = row * self.n_along + column;
        let far = near + self.n_along;
        let mix = |start: usize| self.texels[start] + fx * (self.texels[start + 1] - self.texels[start]);
        let (top, bottom) = (mix(near), mix(far));
        top + fy * (bottom - top)
    }
}

/// A bright midrib and pairs of side veins that run forward from it.
struct Veins {
    spacing_px: f64,
    /// How far a side vein runs forward for each pixel away from the midrib.
    slant: f64,
    shift_px: f64,
    contrast: f64,
}

impl Veins {
    fn new(rng: &mut Pcg64Mcg, half_length_px: f64) -> Self {
        Self {
            spacing_px: (half_length_px * rng.random_range(0.3..0.42)).max(3.0),
            slant: rng.random_range(0.7..1.1),
            shift_px: rng.random_range(0.0..10.0),
            contrast: rng.random_range(0.12..0.26),
        }
    }

    fn at(&self, x: f64, y: f64) -> f64 {
        let side = (x - self.slant * y.abs() + self.shift_px) / self.spacing_px;
        let from_vein_px = (side - side.round()) * self.spacing_px;
        0.34 * bell(y / 0.75) + self.contrast * bell(from_vein_px / 0.8) - 0.5 * self.contrast
    }
}

/// A soft spot, bright or dark.
struct Mark {
    x: f64,
    y: f64,
    radius_px: f64,
    height: f64,
}

impl Mark {
    fn at(&self, x: f64, y: f64) -> f64 {
        self.height * bell((x - self.x).hypot(y - self.y) / self.radius_px)
    }
}

/// Broad blotches that tell the parts of a leaf apart, and small dark spots that pin it down.
fn marks(rng: &mut Pcg64Mcg, half_length_px: f64, half_width_px: f64) -> Vec<Mark> {
    let mut mark = |radius_px: f64, height: f64| Mark {
        x: rng.random_range(-0.85..0.85) * half_length_px,
        y: rng.random_range(-0.8..0.8) * half_width_px,
        radius_px,
        height: height * rng.random_range(0.4..1.0),
    };
    let blotch_px = (half_width_px * 0.6).max(1.5);
    let spot_px = (half_length_px * 0.08).max(0.9);
    [(blotch_px, 0.24), (blotch_px, -0.24), (blotch_px, 0.18), (blotch_px, -0.18)]
        .into_iter()
        .chain([(spot_px, -0.5), (spot_px, -0.5), (spot_px * 1.4, -0.4), (spot_px, 0.4)])
        .map(|(radius_px, height)| mark(radius_px, height))
        .collect()
}

fn bell(x: f64) -> f64 {
    (-x * x).exp()
}
