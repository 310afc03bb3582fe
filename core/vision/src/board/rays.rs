//! Corners as the meeting of four edges.

use honami_model::picture::Gray;

use super::response;
use crate::sample::bilinear;

/// Samples of a ring.
const SAMPLES: usize = 32;
/// Opposite edges are one line, bent by a lens at most, radians.
const BENT_RAD: f64 = 0.5;
/// Edges closer than this are not told apart, radians.
const CLOSE_RAD: f64 = 0.25;

/// A place where four edges meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// Pixels.
    pub(super) at: [f64; 2],
    /// Directions of the edges, radians, clockwise on the screen, the first least.
    pub(super) rays: [f64; 4],
    /// Whether it is brighter clockwise of the first; of the others it alternates.
    pub(super) first_rises: bool,
    /// Bright less dark, gray levels.
    pub(super) contrast: f64,
}

impl Corner {
    /// Whether it is brighter clockwise of an edge than on its other side.
    pub(super) fn rises(&self, ray: usize) -> bool {
        self.first_rises == ray.is_multiple_of(2)
    }
}

/// All corners of a picture, strongest first.
pub(super) fn corners(picture: &Gray<'_>) -> Vec<Corner> {
    let peaks = response::peaks(picture);
    let ring = f64::from(response::RADIUS_PX);
    peaks.into_iter().filter_map(|[x, y]| corner(picture, [f64::from(x), f64::from(y)], ring)).collect()
}

/// The corner near a place, by a ring of this radius, pixels; `None` where there is none
/// near it, or the ring leaves the picture.
pub(super) fn corner(picture: &Gray<'_>, near: [f64; 2], radius_px: f64) -> Option<Corner> {
    let at = saddle(picture, near, (0.6 * radius_px).clamp(2.0, 4.0) as i32)?;
    let far = (at[0] - near[0]).hypot(at[1] - near[1]) > (radius_px / 2.5).max(1.5);
    let [right, bottom] = [picture.width, picture.height].map(|size| f64::from(size) - 1.0 - radius_px);
    let inside = (radius_px..=right).contains(&at[0]) && (radius_px..=bottom).contains(&at[1]);
    if far || !inside {
        return None;
    }
    let ring: [f64; SAMPLES] = std::array::from_fn(|k| {
        let (sin, cos) = angle(k as f64).sin_cos();
        f64::from(bilinear(picture, [(at[0] + radius_px * cos) as f32, (at[1] + radius_px * sin) as f32]))
    });
    let ring: [f64; SAMPLES] = std::array::from_fn(|k| {
        (ring[(k + SAMPLES - 1) % SAMPLES] + 2.0 * ring[k] + ring[(k + 1) % SAMPLES]) / 4.0
    });
    let (dark, bright) = ring.iter().fold((f64::MAX, f64::MIN), |(d, b), &v| (d.min(v), b.max(v)));
    let middle = f64::midpoint(dark, bright);
    let mut crossings = Vec::with_capacity(4);
    for k in 0..SAMPLES {
        let (here, next) = (ring[k] - middle, ring[(k + 1) % SAMPLES] - middle);
        if (here < 0.0) != (next < 0.0) {
            crossings.push((angle(k as f64 + here / (here - next)), next > here));
        }
    }
    let &[(a, first_rises), (b, _), (c, _), (d, _)] = crossings.as_slice() else { return None };
    let straight = |from: f64, to: f64| (to - from - std::f64::consts::PI).abs() < BENT_RAD;
    let apart = [b - a, c - b, d - c, a + std::f64::consts::TAU - d].into_iter().all(|gap| gap > CLOSE_RAD);
    let is_corner = straight(a, c) && straight(b, d) && apart;
    is_corner.then_some(Corner { at, rays: [a, b, c, d], first_rises, contrast: bright - dark })
}

fn angle(sample: f64) -> f64 {
    sample / SAMPLES as f64 * std::f64::consts::TAU
}

/// The saddle of the quadric that fits brightness around a place best; `None` where that is no saddle.
fn saddle(picture: &Gray<'_>, near: [f64; 2], radius: i32) -> Option<[f64; 2]> {
    // On a square grid about the place, the six functions are orthogonal but for the constant: sums say all.
    let n = f64::from(2 * radius + 1);
    let second: f64 = (-radius..=radius).map(|x| f64::from(x * x)).sum();
    let fourth: f64 = (-radius..=radius).map(|x| f64::from(x * x * x * x)).sum();
    let (mut sum, mut x1, mut y1, mut x2, mut y2, mut xy) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    for dy in -radius..=radius {
        for dx in -radius..=radius {
            let (x, y) = (f64::from(dx), f64::from(dy));
            let value = f64::from(bilinear(picture, [(near[0] + x) as f32, (near[1] + y) as f32]));
            sum += value;
            (x1, y1, xy) = (x1 + x * value, y1 + y * value, xy + x * y * value);
            (x2, y2) = (x2 + x * x * value, y2 + y * y * value);
        }
    }
    let (gx, gy, hxy) = (x1 / (n * second), y1 / (n * second), xy / (second * second));
    let spread = n * fourth - second * second;
    let [hxx, hyy] = [x2, y2].map(|squares| 2.0 * (squares - second / n * sum) / spread);
    let determinant = hxx * hyy - hxy * hxy;
    if determinant >= 0.0 {
        return None;
    }
    Some([near[0] - (hyy * gx - hxy * gy) / determinant, near[1] - (hxx * gy - hxy * gx) / determinant])
}
