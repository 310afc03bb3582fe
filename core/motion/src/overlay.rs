//! Motion as colour over the picture: where it goes is the hue, how fast is the opacity.
//!
//! Thesis 3.2 with the misprint of its colours mended (errata E8): in HSL a lightness of 1 is white whatever the
//! hue, so the single cone that the text draws is HSV: `H = θ`, `S = 1`, `V = min(c ρ, 1)`. `V` is laid over the
//! picture as opacity: half of the speed is half of the colour. Were the colour itself darker too, slow motion would
//! be a shadow on the picture; on black the two are the same.
//! Directions are those of the image, y down: 0 is right, a quarter turn is down.

mod dense;

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use honami_model::clip::FrameTimes;
use honami_model::track::Span;

pub use dense::{VelocityField, paint_field};

/// Soft discs reach this far at least and at most, screen pixels.
const DISC: (f64, f64) = (1.5, 6.0);
/// So many velocities tell what is usual.
const ENOUGH: usize = 20_000;
/// Rows that are painted together.
const BAND: usize = 64;
/// The usual speed is one that so many of all velocities do not pass.
const USUAL: f64 = 0.9;

/// The directions that are shown, those with ‖θ − θ*‖ ≤ δθ on the circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dial {
    /// Direction in the middle, θ*, radians.
    pub centre_rad: f64,
    /// How far from it to both sides, δθ, radians; π is all round.
    pub half_width_rad: f64,
}

impl Dial {
    /// All directions.
    pub const ALL: Self = Self { centre_rad: 0.0, half_width_rad: PI };

    /// Whether a direction is shown, its ends included.
    #[must_use]
    pub fn shows(self, direction_rad: f64) -> bool {
        // Sums of steps of a dial miss its ends by roundings.
        angular_distance(direction_rad, self.centre_rad) <= self.half_width_rad + 1e-9
    }
}

/// Distance of two directions on the circle, radians, 0 to π.
#[must_use]
pub fn angular_distance(a_rad: f64, b_rad: f64) -> f64 {
    let apart = (a_rad - b_rad).rem_euclid(TAU);
    apart.min(TAU - apart)
}

/// From a velocity to its colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mapping {
    /// The gain c, seconds per pixel: a motion of 1 / c px/s has its full colour.
    pub gain_s_px: f64,
    /// Directions that are shown.
    pub dial: Dial,
}

/// A colour and how much of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tint {
    /// The colour, sRGB.
    pub rgb: [u8; 3],
    /// Opacity, over 0 to 1.
    pub alpha: f64,
}

impl Mapping {
    /// Colour of a velocity in px/s; `None` for rest, for directions that are not shown, and for what is no number.
    #[must_use]
    pub fn tint(&self, [u, v]: [f64; 2]) -> Option<Tint> {
        let value = (self.gain_s_px * u.hypot(v)).min(1.0);
        let direction_rad = v.atan2(u);
        let is_shown = value > 0.0 && self.dial.shows(direction_rad);
        is_shown.then(|| Tint { rgb: hue(direction_rad).map(|c| (255.0 * c).round() as u8), alpha: value })
    }
}

/// The strong colour of a direction: HSV with S = V = 1, each channel 0 to 1.
#[must_use]
pub fn hue(direction_rad: f64) -> [f64; 3] {
    let sixth = direction_rad.rem_euclid(TAU) / TAU * 6.0;
    // Each channel is a trapezium over the circle, a third of it from the next: red round 0, green round 1/3.
    [0.0, 2.0, 4.0].map(|peak: f64| {
        let apart = (sixth - peak).abs();
        (2.0 - apart.min(6.0 - apart)).clamp(0.0, 1.0)
    })
}

/// Velocity of a track in a frame, px/s: the difference over the frames beside it, at the ends and beside frames
/// in which it is not seen over one of them; `None` where it is not seen, or alone.
#[must_use]
pub fn velocity(span: &Span, times: &FrameTimes, frame: u32) -> Option<[f64; 2]> {
    let seen = |frame: u32| {
        let sample = span.get(frame).filter(|sample| sample.status.is_seen())?;
        Some((times.get(frame)?, [f64::from(sample.x), f64::from(sample.y)]))
    };
    let here = seen(frame)?;
    let (t0, from) = frame.checked_sub(1).and_then(seen).unwrap_or(here);
    let (t1, to) = seen(frame + 1).unwrap_or(here);
    (t1 > t0).then(|| [0, 1].map(|axis| (to[axis] - from[axis]) / (t1 - t0)))
}

/// The speed that nine of ten velocities of the tracks do not pass, px/s; `None` where nothing moves.
#[must_use]
pub fn usual_speed(tracks: &[&Span], times: &FrameTimes) -> Option<f64> {
    let n: usize = tracks.iter().map(|span| span.samples.len()).sum();
    let every = n.div_ceil(ENOUGH).max(1);
    let frames = tracks.iter().flat_map(|span| span.frames().step_by(every).map(move |f| (*span, f)));
    let mut speeds: Vec<f64> =
        frames.filter_map(|(span, f)| velocity(span, times, f)).map(|[u, v]| u.hypot(v)).collect();
    speeds.sort_by(f64::total_cmp);
    let at = (speeds.len().saturating_sub(1) as f64 * USUAL).round() as usize;
    speeds.get(at).copied().filter(|speed| *speed > 0.0)
}

/// A tint about a point of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Where, picture pixels; (0, 0) is the centre of the first.
    pub at: [f64; 2],
    /// What.
    pub tint: Tint,
}

/// Radius for so many discs on so many pixels, pixels: neighbours touch, where they are not too far apart.
#[must_use]
pub fn disc_radius(n_discs: usize, n_pixels: usize) -> f64 {
    (n_pixels as f64 / n_discs.max(1) as f64).sqrt().clamp(DISC.0, DISC.1)
}

/// Paints soft discs into a picture of row-major pixels, `columns` wide. Where discs overlap, the colour is their mean
/// by opacity and the opacity that of the strongest: the order of the discs does not matter.
///
/// `radius` is across and down, pixels: those of a screen need not be square.
pub fn paint_discs(pixels: &mut [[u8; 3]], columns: usize, discs: &[Disc], radius: [f64; 2]) {
    // Sums of a few rows at a time: those of a large picture are five times as large as it.
    let mut sums = vec![[0.0_f64; 5]; BAND * columns];
    for (band, pixels) in pixels.chunks_mut((BAND * columns).max(1)).enumerate() {
        let top = band * BAND;
        sums.fill([0.0; 5]);
        add(&mut sums, columns, top..top + pixels.len() / columns, discs, radius);
        for (pixel, [r, g, b, weight, alpha]) in pixels.iter_mut().zip(&sums) {
            if *weight > 0.0 {
                *pixel = blended(*pixel, [r, g, b].map(|sum| sum / weight), *alpha);
            }
        }
    }
}

/// Adds up discs in some rows: colours by weight, weights, and the largest of these.
fn add(sums: &mut [[f64; 5]], columns: usize, rows: Range<usize>, discs: &[Disc], radius: [f64; 2]) {
    for disc in discs {
        let reach = |axis: usize, n: Range<usize>| {
            let first = (disc.at[axis] - radius[axis]).ceil().max(0.0) as usize;
            let end = (disc.at[axis] + radius[axis] + 1.0).floor().max(0.0) as usize;
            first.max(n.start)..end.min(n.end)
        };
        for y in reach(1, rows.clone()) {
            for x in reach(0, 0..columns) {
                let apart = [x as f64 - disc.at[0], y as f64 - disc.at[1]];
                let r2 = (apart[0] / radius[0]).powi(2) + (apart[1] / radius[1]).powi(2);
                let weight = disc.tint.alpha * (1.0 - r2).max(0.0);
                let sum = &mut sums[(y - rows.start) * columns + x];
                (0..3).for_each(|c| sum[c] += weight * f64::from(disc.tint.rgb[c]));
                sum[3] += weight;
                sum[4] = sum[4].max(weight);
            }
        }
    }
}

/// A pixel with a tint over it.
#[must_use]
pub fn over(pixel: [u8; 3], tint: Tint) -> [u8; 3] {
    blended(pixel, tint.rgb.map(f64::from), tint.alpha)
}

fn blended(pixel: [u8; 3], colour: [f64; 3], alpha: f64) -> [u8; 3] {
    let mix = |c: usize| (f64::from(pixel[c]) * (1.0 - alpha) + colour[c] * alpha).round() as u8;
    [mix(0), mix(1), mix(2)]
}

#[cfg(test)]
mod tests;
