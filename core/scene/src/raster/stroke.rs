//! A stroke: what is near a line, as far as it is not behind what was drawn before.

use super::{BAND, Colour};

/// A stroke between two samples; round ones are as broad as branches.
pub(super) struct Stroke {
    /// Samples from the upper left.
    pub(super) from: [f32; 2],
    pub(super) to: [f32; 2],
    /// Distances before the eye of both ends.
    pub(super) depths: [f32; 2],
    /// Samples.
    pub(super) radii: [f32; 2],
    pub(super) colour: Colour,
    /// How much darker it is on its right than on its left: 0 is flat.
    pub(super) round: f32,
}

impl Stroke {
    /// Into a band of rows from `first` on; `hazy` is what a colour becomes from so far.
    pub(super) fn draw(
        &self,
        first: usize,
        wide: usize,
        colours: &mut [Colour],
        depths: &mut [f32],
        hazy: &dyn Fn(Colour, f32) -> Colour,
    ) {
        let widest = self.radii[0].max(self.radii[1]).max(0.5);
        let span = |axis: usize, most: usize| {
            let (low, high) = (self.from[axis].min(self.to[axis]), self.from[axis].max(self.to[axis]));
            let low = (low - widest - 0.5).floor().clamp(0.0, most as f32) as usize;
            (low, (high + widest + 0.5).ceil().clamp(0.0, most as f32) as usize)
        };
        let n_rows = colours.len() / wide;
        let (top, bottom) = span(1, first + n_rows);
        let (left, right) = span(0, wide);
        if bottom <= first || left >= right {
            return;
        }
        debug_assert!(n_rows <= BAND, "a band");
        let way = [self.to[0] - self.from[0], self.to[1] - self.from[1]];
        let square = (way[0] * way[0] + way[1] * way[1]).max(1e-12);
        let length = square.sqrt();
        let colour = hazy(self.colour, f32::midpoint(self.depths[0], self.depths[1]));
        for y in top.max(first)..bottom {
            for x in left..right {
                let at = [x as f32 + 0.5 - self.from[0], y as f32 + 0.5 - self.from[1]];
                let share = ((at[0] * way[0] + at[1] * way[1]) / square).clamp(0.0, 1.0);
                let off = [at[0] - share * way[0], at[1] - share * way[1]];
                let radius = self.radii[0] + (self.radii[1] - self.radii[0]) * share;
                let away = (off[0] * off[0] + off[1] * off[1]).sqrt();
                if away > radius.max(0.5) || is_left_out(radius, x, y) {
                    continue;
                }
                // Along a line on the screen it is one over the distance that goes evenly.
                let [near, far] = self.depths.map(f32::recip);
                let depth = (near + (far - near) * share).recip();
                let place = (y - first) * wide + x;
                if depth >= depths[place] {
                    continue;
                }
                depths[place] = depth;
                // Right of it, seen along it, where it goes up.
                let across = (off[0] * way[1] - off[1] * way[0]) / (length * radius.max(0.5));
                let across = if way[1] < 0.0 { -across } else { across };
                let shade = 1.0 + self.round * across.clamp(-1.0, 1.0);
                colours[place] = colour.map(|v| v * shade);
            }
        }
    }
}

/// Of what is thinner than a sample so much is left out, sample by sample as if by chance, but always the same.
fn is_left_out(radius: f32, x: usize, y: usize) -> bool {
    if radius >= 0.5 {
        return false;
    }
    let mixed = (x as u32).wrapping_mul(0x9E37_79B1) ^ (y as u32).wrapping_mul(0x85EB_CA77);
    let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x2C1B_3C6D);
    (mixed >> 8) as f32 / (1 << 24) as f32 > 2.0 * radius
}
