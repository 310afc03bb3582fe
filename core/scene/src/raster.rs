//! Pictures of forests without a graphics card, small ones such as terminals show: wood and leaves as round strokes with a
//! depth each, four samples a pixel.
//!
//! The same bits on any number of threads: strokes are laid out copy by copy and drawn in their order, band by band.

mod ground;
mod stroke;
#[cfg(test)]
mod tests;

use rayon::prelude::*;

use crate::camera::Camera;
use crate::forest::ForestScene;
use crate::forest::live::Seen;
use crate::grove::Grove;
use crate::vector::{cross, dot};
use ground::Ground;
use stroke::Stroke;

/// Samples along a side of a pixel.
const FINE: u32 = 2;
/// Copies whose strokes are laid out at a time.
const SOME: usize = 128;
/// Rows of samples that are drawn together.
const BAND: usize = 16;
/// From where the sun shines: length 1.
const SUN: [f32; 3] = [-0.52, -0.43, 0.738];
/// Red, green and blue, 0 to 1.
type Colour = [f32; 3];
const BARK: Colour = [0.45, 0.36, 0.28];
/// Of leaves: what chance makes of them lies between.
const LEAVES: [Colour; 2] = [[0.30, 0.47, 0.13], [0.47, 0.58, 0.20]];
/// Light that comes from all of the sky, and from the sun.
const SKY_LIGHT: f32 = 0.62;
const SUN_LIGHT: f32 = 0.62;

/// What a camera makes of places.
#[derive(Clone, Copy)]
struct Lens {
    eye: [f32; 3],
    /// Right, up, forward.
    axes: [[f32; 3]; 3],
    /// Samples a unit at a distance of 1.
    focal: f32,
    /// Middle of the picture, samples.
    middle: [f32; 2],
}

/// A picture of what is seen of a forest: `width` x `height` square pixels, row by row.
#[must_use]
pub fn forest(
    scene: &ForestScene,
    grove: &Grove,
    seen: &[Seen<'_>],
    camera: &Camera,
    [width, height]: [u32; 2],
) -> Vec<[u8; 3]> {
    let (wide, high) = ((width * FINE) as usize, (height * FINE) as usize);
    let lens = Lens::new(camera, [wide, high]);
    let ground = Ground::under(scene);
    let mut colours = vec![[0.0; 3]; wide * high];
    colours.par_chunks_mut(wide).enumerate().for_each(|(y, row)| {
        for (x, colour) in row.iter_mut().enumerate() {
            *colour = ground.behind(&lens, [x as f32 + 0.5, y as f32 + 0.5]);
        }
    });
    let mut depths = vec![f32::INFINITY; colours.len()];
    // Some copies at a time: strokes of a large forest would take gigabytes.
    for some in seen.chunks(SOME) {
        let strokes: Vec<Stroke> =
            some.par_iter().flat_map_iter(|seen| of_copy(scene, grove, seen, &lens)).collect();
        let bands = colours.par_chunks_mut(wide * BAND).zip(depths.par_chunks_mut(wide * BAND));
        bands.enumerate().for_each(|(band, (colours, depths))| {
            for stroke in &strokes {
                stroke.draw(band * BAND, wide, colours, depths, &|colour, depth| ground.hazy(colour, depth));
            }
        });
    }
    let pixel = |k: usize| {
        let (x, y) = (k % width as usize, k / width as usize);
        let fine = FINE as usize;
        let samples =
            (0..fine * fine).map(|at| colours[(y * fine + at / fine) * wide + x * fine + at % fine]);
        let sum = samples.fold([0.0; 3], |sum: Colour, c| std::array::from_fn(|k| sum[k] + c[k]));
        sum.map(|v| (v / (fine * fine) as f32 * 255.0).round().clamp(0.0, 255.0) as u8)
    };
    (0..(width * height) as usize).map(pixel).collect()
}

/// Strokes of all wood and leaves of a copy.
fn of_copy(scene: &ForestScene, grove: &Grove, seen: &Seen<'_>, lens: &Lens) -> Vec<Stroke> {
    let (level, stand) = (&scene.body.levels[seen.level], &scene.stands[seen.copy]);
    let (sin, cos) = stand.turn.sin_cos();
    let turned = |[x, y, z]: [f32; 3]| [cos * x - sin * y, sin * x + cos * y, z];
    let foot: [f32; 3] = grove.places[seen.copy].cast::<f32>().into();
    let shown = |own: [f32; 3]| {
        let own = turned(own);
        std::array::from_fn(|axis| foot[axis] + stand.scale * own[axis])
    };
    let moved = |row: u32| seen.motion[row as usize];
    let centres: Vec<[f32; 3]> = level
        .rings
        .iter()
        .map(|ring| {
            let by = moved(ring.node);
            std::array::from_fn(|axis| ring.rest[axis] + by[axis])
        })
        .collect();
    let mut strokes = Vec::with_capacity(level.rings.len() + level.leaves.len());
    let mut first = 0;
    for n in &level.branches {
        let end = first + *n as usize;
        for k in first + 1..end {
            let [from, to] = [k - 1, k].map(|k| shown(centres[k]));
            let radii = [k - 1, k].map(|k| level.rings[k].radius * stand.scale);
            let light = SKY_LIGHT * (0.3 + 0.7 * level.rings[k].open) + 0.5 * SUN_LIGHT * level.rings[k].open;
            let colour = BARK.map(|v| v * light);
            strokes.extend(lens.stroke([from, to], radii, colour, 0.35));
        }
        first = end;
    }
    for leaf in &level.leaves {
        let ring = &level.rings[leaf.ring as usize];
        let turn = ring.turn(moved);
        let [base, tip, up] = [leaf.base, leaf.tip, leaf.up].map(|v| rotated(v, turn));
        let centre = centres[leaf.ring as usize];
        let hung: [f32; 3] = std::array::from_fn(|axis| centre[axis] + base[axis]);
        let end: [f32; 3] = std::array::from_fn(|axis| hung[axis] + tip[axis] * leaf.length);
        let [from, to] = [hung, end].map(shown);
        let up = turned(up);
        let way: [f32; 3] = std::array::from_fn(|axis| from[axis] - lens.eye[axis]);
        let seen_flat = dot(up, way).abs() / dot(way, way).sqrt().max(f32::MIN_POSITIVE);
        let half = 0.5 * leaf.breadth * leaf.length * stand.scale * seen_flat.max(0.25);
        // The sun shines through from below, too.
        let lit = dot(up, SUN);
        let lit = if lit > 0.0 { lit } else { -0.55 * lit };
        let light = SKY_LIGHT * (0.25 + 0.75 * leaf.open) + SUN_LIGHT * leaf.open * lit;
        let colour =
            std::array::from_fn(|k| (LEAVES[0][k] + (LEAVES[1][k] - LEAVES[0][k]) * leaf.chance) * light);
        strokes.extend(lens.stroke([from, to], [half, half * 0.6], colour, 0.0));
    }
    strokes
}

impl Lens {
    fn new(camera: &Camera, [wide, high]: [usize; 2]) -> Self {
        let focal = high as f32 / 2.0 / (camera.angle / 2.0).tan();
        Self { eye: camera.eye, axes: camera.axes(), focal, middle: [wide as f32 / 2.0, high as f32 / 2.0] }
    }

    /// Where a place is seen, samples from the upper left, and how far before the eye it is.
    fn seen(&self, place: [f32; 3]) -> ([f32; 2], f32) {
        let way: [f32; 3] = std::array::from_fn(|axis| place[axis] - self.eye[axis]);
        let [right, up, depth] = self.axes.map(|axis| dot(axis, way));
        let scale = self.focal / depth.max(f32::MIN_POSITIVE);
        ([self.middle[0] + right * scale, self.middle[1] - up * scale], depth)
    }

    /// The way through a sample, of any length.
    fn way(&self, [x, y]: [f32; 2]) -> [f32; 3] {
        let (right, up) = ((x - self.middle[0]) / self.focal, (self.middle[1] - y) / self.focal);
        std::array::from_fn(|k| self.axes[2][k] + right * self.axes[0][k] + up * self.axes[1][k])
    }

    /// A stroke between two places; none of what reaches behind the eye. What is thinner than a sample is as faint as it is
    /// thin: so much of it is drawn.
    fn stroke(&self, ends: [[f32; 3]; 2], radii: [f32; 2], colour: Colour, round: f32) -> Option<Stroke> {
        let [(from, near), (to, far)] = ends.map(|end| self.seen(end));
        let least = 1e-3 * self.focal * radii[0].max(radii[1]).max(1e-6);
        (near > least && far > least).then(|| Stroke {
            from,
            to,
            depths: [near, far],
            radii: [radii[0] * self.focal / near, radii[1] * self.focal / far],
            colour,
            round,
        })
    }
}

/// Turned about an axis by as many radians as it is long.
fn rotated(v: [f32; 3], turn: [f32; 3]) -> [f32; 3] {
    let angle = dot(turn, turn).sqrt();
    if angle < 1e-6 {
        return v;
    }
    let axis = turn.map(|t| t / angle);
    let ((sin, cos), across, along) = (angle.sin_cos(), cross(axis, v), dot(axis, v));
    std::array::from_fn(|k| v[k] * cos + across[k] * sin + axis[k] * along * (1.0 - cos))
}
