//! Arc tangents of many numbers at once.

/// Coefficients of x^3, x^5 … x^17 (Abramowitz and Stegun, 4.4.49): right to 2e-8 from -1 to 1.
const ODD: [f32; 8] = [
    -0.333_331_45,
    0.199_935_51,
    -0.142_089,
    0.106_562_64,
    -0.075_289_64,
    0.042_909_614,
    -0.016_165_737,
    0.002_866_225_7,
];

/// The arc tangent, right to 3e-7; without a branch, so that a loop of it becomes vectors.
#[inline(always)]
pub(super) fn arc_tangent(x: f32) -> f32 {
    let size = x.abs();
    let is_steep = size > 1.0;
    let t = if is_steep { -1.0 / size } else { size };
    let square = t * t;
    let series = ODD.iter().rev().fold(0.0, |sum, c| (sum + c) * square);
    let arc = t + t * series;
    let arc = if is_steep { arc + std::f32::consts::FRAC_PI_2 } else { arc };
    arc.copysign(x)
}
