//! Where lines through the pixels of a window meet: edges in corners, and what stands across edges in the middle of round things.
//!
//! W. Förstner, E. Gülch, "A fast operator for detection and precise location of distinct points, corners and centres of circular
//! features", 1987: at each pixel the gradient g stands across its edge. Where the edge goes through the corner c,
//! `Σ w g gᵀ (p - c) = 0`; where what stands across it goes through the middle c, the same with g turned by a right angle.

#[cfg(test)]
mod tests;

use honami_model::picture::Gray;

use crate::sample::patch;

const STEPS: usize = 30;

/// Which lines meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lines {
    /// Edges.
    Edges,
    /// What stands across them.
    Across,
}

/// What of a picture is looked at.
pub(crate) struct Window<W> {
    /// What a pixel counts, by how far it lies to the right and down.
    pub(crate) weight: W,
    /// It counts nothing farther away, pixels; and what is found farther from the start is something else.
    pub(crate) radius_px: i32,
    /// The last step is smaller, pixels.
    pub(crate) at_rest_px: f64,
}

/// Where lines meet near a start.
pub(crate) fn meeting<W: Fn([f64; 2]) -> f64>(
    picture: &Gray<'_>,
    start: [f64; 2],
    lines: Lines,
    window: &Window<W>,
) -> Option<[f64; 2]> {
    let (mut at, mut sampled) = (start, Vec::new());
    for _ in 0..STEPS {
        let next = step(picture, at, lines, window, &mut sampled)?;
        let moved = (next[0] - at[0]).hypot(next[1] - at[1]);
        at = next;
        if moved < window.at_rest_px {
            break;
        }
    }
    let far = (at[0] - start[0]).hypot(at[1] - start[1]);
    (far <= f64::from(window.radius_px)).then_some(at)
}

/// One step, by a window that is sampled between pixels so that it lies the same about every place.
fn step<W: Fn([f64; 2]) -> f64>(
    picture: &Gray<'_>,
    [x, y]: [f64; 2],
    lines: Lines,
    window: &Window<W>,
    sampled: &mut Vec<f32>,
) -> Option<[f64; 2]> {
    let radius = window.radius_px;
    patch(picture, [x as f32, y as f32], radius as u32 + 1, sampled);
    let side = 2 * radius as usize + 3;
    let (mut xx, mut xy, mut yy, mut bx, mut by) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for v in -radius..=radius {
        for u in -radius..=radius {
            let off = [f64::from(u), f64::from(v)];
            let weight = (window.weight)(off);
            if weight > 0.0 {
                let at = (v + radius + 1) as usize * side + (u + radius + 1) as usize;
                let gx = f64::from(sampled[at + 1] - sampled[at - 1]);
                let gy = f64::from(sampled[at + side] - sampled[at - side]);
                let [gx, gy] = match lines {
                    Lines::Edges => [gx, gy],
                    Lines::Across => [-gy, gx],
                };
                let (wxx, wxy, wyy) = (weight * gx * gx, weight * gx * gy, weight * gy * gy);
                (xx, xy, yy) = (xx + wxx, xy + wxy, yy + wyy);
                bx += wxx * off[0] + wxy * off[1];
                by += wxy * off[0] + wyy * off[1];
            }
        }
    }
    let determinant = xx * yy - xy * xy;
    // Lines that all go one way meet nowhere.
    (determinant > 1e-6 * (xx + yy).powi(2))
        .then(|| [x + (yy * bx - xy * by) / determinant, y + (xx * by - xy * bx) / determinant])
}

/// The middle of a round thing of this radius, pixels, that lies about a start: a disc, a ring, or either seen obliquely. None where
/// nothing round is there, or where the radius is below 2 px or above a quarter of the picture's longer side.
#[must_use]
pub fn middle(picture: &Gray<'_>, start: [f64; 2], radius_px: f64) -> Option<[f64; 2]> {
    /// Its edge, blurred, lies in the window, and a ring about it does not.
    const REACH: f64 = 1.4;
    const SMALLEST_PX: f64 = 2.0;
    let reach = REACH * radius_px;
    let window = Window {
        weight: |[x, y]: [f64; 2]| f64::from(u8::from(x.hypot(y) <= reach)),
        radius_px: reach.ceil() as i32,
        at_rest_px: 1e-3,
    };
    let largest_px = f64::from(picture.width.max(picture.height)) / 4.0;
    if !(SMALLEST_PX..=largest_px).contains(&radius_px) {
        return None;
    }
    let found = meeting(picture, start, Lines::Across, &window)?;
    ((found[0] - start[0]).hypot(found[1] - start[1]) <= radius_px).then_some(found)
}
