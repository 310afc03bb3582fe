//! What is behind: the sky, and the ground with the shadows of crowns on it.

use super::{Colour, Lens, SUN};
use crate::forest::ForestScene;
use crate::vector::dot;

const HORIZON: Colour = [0.84, 0.88, 0.91];
const ZENITH: Colour = [0.42, 0.60, 0.83];
const GROUND: Colour = [0.50, 0.53, 0.36];
/// Haze hides half of what is so many heights of the plant away,
const HAZE: f32 = 60.0;
/// and so many sides of the forest.
const HAZE_OF_SIDE: f32 = 2.5;
/// Cells of shadows along a side.
const CELLS: usize = 192;
/// A crown reaches so far, of the height of its plant, and takes so much of the light.
const CROWN: f32 = 0.33;
const SHADE: f32 = 0.55;

/// The ground under a forest.
pub(super) struct Ground {
    least: [f32; 2],
    cell: f32,
    /// How much light is left, cell by cell.
    light: Vec<f32>,
    haze: f32,
}

impl Ground {
    pub(super) fn under(scene: &ForestScene) -> Self {
        let height = scene.stirring.height().max(1e-3) as f32;
        let ends = |axis: usize| {
            let along = || scene.places.iter().map(|place| place[axis]);
            [along().fold(f32::INFINITY, f32::min), along().fold(f32::NEG_INFINITY, f32::max)]
        };
        let [[left, right], [near, far]] = [ends(0), ends(1)];
        let (side, room) = ((right - left).max(far - near), 1.5 * height);
        let cell = (side + 2.0 * room) / CELLS as f32;
        let mut light = vec![1.0; CELLS * CELLS];
        let least = [left - room, near - room];
        // A shadow lies away from the sun, by half of the height of the crown's middle.
        let off: [f32; 2] = [0, 1].map(|axis| -0.3 * height * SUN[axis] / SUN[2]);
        for (place, stand) in scene.places.iter().zip(&scene.stands) {
            let radius = CROWN * height * stand.scale;
            let at: [f32; 2] =
                [0, 1].map(|axis| (place[axis] + off[axis] * stand.scale - least[axis]) / cell);
            let reach = radius / cell;
            let cells = |middle: f32| {
                let low = (middle - 1.6 * reach).floor().clamp(0.0, CELLS as f32) as usize;
                low..((middle + 1.6 * reach).ceil().clamp(0.0, CELLS as f32) as usize)
            };
            for y in cells(at[1]) {
                for x in cells(at[0]) {
                    let square = ((x as f32 + 0.5 - at[0]).powi(2) + (y as f32 + 0.5 - at[1]).powi(2))
                        / reach.powi(2).max(1e-6);
                    light[y * CELLS + x] *= 1.0 - SHADE * (-1.4 * square * square).exp();
                }
            }
        }
        Self { least, cell, light, haze: HAZE * height + HAZE_OF_SIDE * side }
    }

    /// What is behind everything at a sample.
    pub(super) fn behind(&self, lens: &Lens, sample: [f32; 2]) -> Colour {
        let way = lens.way(sample);
        let length = dot(way, way).sqrt();
        let up = way[2] / length;
        if up >= 0.0 || lens.eye[2] <= 0.0 {
            let share = 1.0 - (1.0 - up.max(0.0)).powi(4);
            return mixed(HORIZON, ZENITH, share.clamp(0.0, 1.0));
        }
        let times = -lens.eye[2] / way[2];
        let at = [lens.eye[0] + times * way[0], lens.eye[1] + times * way[1]];
        self.hazy(GROUND.map(|v| v * self.light_at(at)), times)
    }

    /// A colour as it is seen from so far.
    pub(super) fn hazy(&self, colour: Colour, depth: f32) -> Colour {
        mixed(colour, HORIZON, 1.0 - (-depth / self.haze * std::f32::consts::LN_2).exp())
    }

    /// Between the middles of cells.
    fn light_at(&self, [x, y]: [f32; 2]) -> f32 {
        let (x, y) = ((x - self.least[0]) / self.cell - 0.5, (y - self.least[1]) / self.cell - 0.5);
        let of = |x: f32, y: f32| {
            let inside = |v: f32| (0.0..CELLS as f32).contains(&v);
            if inside(x) && inside(y) { self.light[y as usize * CELLS + x as usize] } else { 1.0 }
        };
        let (left, top) = (x.floor(), y.floor());
        let (across, down) = (x - left, y - top);
        let row = |y: f32| of(left, y) * (1.0 - across) + of(left + 1.0, y) * across;
        row(top) * (1.0 - down) + row(top + 1.0) * down
    }
}

fn mixed(a: Colour, b: Colour, share: f32) -> Colour {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * share)
}
