//! Perlin's gradient noise as wind (Perlin, 1985, with the fifth-order fade of 2002): for each component another one.

use super::{Wind, is_whole};
use nalgebra::{Vector3, Vector4};

/// Turbulence from gradient noise in space and time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Speed at which it is scaled, metres per second: no component exceeds it.
    pub speed: f64,
    /// Size of its cells in space, metres.
    pub cell: f64,
    /// And in time, seconds.
    pub second: f64,
    /// Of its gradients.
    pub seed: u64,
    /// After so many cells in time it begins again; `None`: never.
    pub n_cells: Option<u32>,
}

impl Wind for Noise {
    fn sample(&self, place: &Vector3<f64>, time: f64) -> Vector3<f64> {
        let at = (place / self.cell).push(time / self.second);
        Vector3::from_fn(|axis, _| {
            self.speed * self.value(&at, self.seed.wrapping_mul(3).wrapping_add(axis as u64))
        })
    }

    fn repeats(&self, seconds: f64) -> bool {
        self.n_cells.is_some_and(|n| is_whole(seconds / (self.second * f64::from(n))))
    }
}

impl Noise {
    /// Gradient noise in four dimensions, -1 to 1; 0 at whole numbers.
    fn value(&self, at: &Vector4<f64>, seed: u64) -> f64 {
        let (corner, inside) = (at.map(f64::floor), at.map(|v| v - v.floor()));
        let fade = inside.map(|t| t * t * t * (t * (t * 6.0 - 15.0) + 10.0));
        let mut sum = 0.0;
        for which in 0..16_u32 {
            let bits = Vector4::from_fn(|axis, _| f64::from(which >> axis & 1));
            let weight: f64 =
                (0..4).map(|axis| if bits[axis] > 0.0 { fade[axis] } else { 1.0 - fade[axis] }).product();
            let mut corner = corner + bits;
            if let Some(n) = self.n_cells {
                corner.w = corner.w.rem_euclid(f64::from(n));
            }
            sum += weight * gradient(&corner, seed).dot(&(inside - bits));
        }
        sum.clamp(-1.0, 1.0)
    }
}

/// A gradient by the whole numbers of a corner: each component -1 to 1.
fn gradient(corner: &Vector4<f64>, seed: u64) -> Vector4<f64> {
    let mut bits =
        corner.iter().fold(seed ^ 0x9e37_79b9_7f4a_7c15, |bits, v| mix(bits ^ (*v as i64).cast_unsigned()));
    Vector4::from_fn(|_, _| {
        bits = mix(bits);
        // The highest 53 bits as a number from -1 to 1.
        (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    })
}

/// Spreads bits (the finaliser of SplitMix64).
fn mix(bits: u64) -> u64 {
    let bits = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}
