//! What lies far behind the plant, out of focus: sky above, hedge and ground below, discs of light.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::paint::Canvas;
use crate::settings::Settings;

/// Colours from top to bottom: (share of the height, RGB).
const FALL: [(f32, [f32; 3]); 4] = [
    (0.0, [222.0, 226.0, 206.0]),
    (0.4, [178.0, 196.0, 156.0]),
    (0.8, [112.0, 130.0, 84.0]),
    (1.0, [88.0, 92.0, 60.0]),
];

/// Paints it for a picture of the size asked for.
pub(crate) fn paint(settings: &Settings, rng: &mut Pcg64Mcg) -> Canvas {
    let (width, height) = (settings.width as usize, settings.height as usize);
    let mut pixels = Vec::with_capacity(width * height);
    for row in 0..height {
        let [r, g, b] = fall(row as f32 / (height - 1) as f32);
        pixels.extend(std::iter::repeat_n([r, g, b, 0.0], width));
    }
    let mut canvas = Canvas { width, height, pixels };
    // A far hedge: broad patches, darker towards the ground.
    for _ in 0..150 {
        let y = rng.random_range(0.15_f32..1.1);
        let tone = fall((y + 0.12).min(1.0));
        let light = rng.random_range(0.62..1.16);
        let tint = [rng.random_range(0.88..1.06), 1.0, rng.random_range(0.82..1.02)];
        let colour = [0, 1, 2].map(|c| tone[c] * light * tint[c]);
        let disc = Disc::new(rng, y, [0.05, 0.17], 1.0, colour, 0.5);
        canvas.disc(&disc);
    }
    // Light that falls through it.
    for _ in 0..46 {
        let y = rng.random_range(-0.02_f32..0.72);
        let warm = rng.random_range(0.86..1.0);
        let strength = rng.random_range(0.06..0.2);
        let disc = Disc::new(rng, y, [0.014, 0.042], 0.3, [244.0, 244.0, 214.0 * warm], strength);
        canvas.disc(&disc);
    }
    canvas
}

/// Colour at a share of the height.
fn fall(share: f32) -> [f32; 3] {
    let next = FALL.iter().position(|stop| stop.0 >= share).unwrap_or(FALL.len() - 1).max(1);
    let ((from, above), (to, below)) = (FALL[next - 1], FALL[next]);
    let part = (share - from) / (to - from);
    [0, 1, 2].map(|c| above[c] + part * (below[c] - above[c]))
}

/// A round patch with a soft edge.
struct Disc {
    /// Place and radius in picture heights, the place across in picture widths.
    x: f32,
    y: f32,
    radius: f32,
    /// Share of the radius over which it fades.
    softness: f32,
    colour: [f32; 3],
    strength: f32,
}

impl Disc {
    fn new(
        rng: &mut Pcg64Mcg,
        y: f32,
        radii: [f32; 2],
        softness: f32,
        colour: [f32; 3],
        strength: f32,
    ) -> Self {
        let x = rng.random_range(-0.05..1.05);
        Self { x, y, radius: rng.random_range(radii[0]..radii[1]), softness, colour, strength }
    }
}

impl Canvas {
    fn disc(&mut self, disc: &Disc) {
        let (width, height) = (self.width as f32, self.height as f32);
        let (x, y, radius) = (disc.x * width, disc.y * height, disc.radius * height);
        let span = |centre: f32, n: usize| {
            let last = (centre + radius).ceil().clamp(0.0, n as f32) as usize;
            (centre - radius).floor().max(0.0) as usize..last
        };
        for row in span(y, self.height) {
            for column in span(x, self.width) {
                let off = (column as f32 - x).hypot(row as f32 - y) / radius;
                let fade = ((1.0 - off) / disc.softness).clamp(0.0, 1.0);
                let cover = disc.strength * fade * fade * (3.0 - 2.0 * fade);
                let pixel = &mut self.pixels[row * self.width + column];
                for (under, over) in pixel.iter_mut().zip(disc.colour) {
                    *under += cover * (over - *under);
                }
            }
        }
    }
}
