//! Pictures that are functions of real coordinates: motion in them is exact, for tests and benchmarks.

/// Octaves: distance of the lattice points in pixels, and amplitude in gray levels.
const OCTAVES: [(f64, f64); 4] = [(37.0, 40.0), (17.0, 30.0), (8.0, 22.0), (4.0, 12.0)];

/// Brightness of an endless texture, about 24..=232 around 128: smooth noise on four lattices.
#[must_use]
pub fn value(seed: u64, x: f64, y: f64) -> f64 {
    let octaves = OCTAVES.iter().zip(seed.wrapping_mul(OCTAVES.len() as u64)..);
    128.0 + octaves.map(|(&(step, amplitude), seed)| amplitude * noise(seed, x / step, y / step)).sum::<f64>()
}

/// Samples a picture at its pixel centres and rounds to 8 bits; row-major, `(height, width)`.
pub fn render(width: u32, height: u32, brightness: impl Fn(f64, f64) -> f64) -> Vec<u8> {
    (0..height)
        .flat_map(|y| (0..width).map(move |x| (f64::from(x), f64::from(y))))
        .map(|(x, y)| brightness(x, y).round().clamp(0.0, 255.0) as u8)
        .collect()
}

/// A number in -1..=1 that looks drawn by chance, always the same for the same place.
#[must_use]
pub fn hash(seed: u64, x: i64, y: i64) -> f64 {
    // splitmix64 of the three numbers.
    let mut z = seed ^ (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (y as u64).rotate_left(32);
    for _ in 0..2 {
        z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
    }
    (z >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Value noise: lattice values blended by the quintic `6t⁵ - 15t⁴ + 10t³` (two continuous derivatives).
fn noise(seed: u64, x: f64, y: f64) -> f64 {
    let (x0, y0) = (x.floor(), y.floor());
    let ease = |t: f64| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let (tx, ty) = (ease(x - x0), ease(y - y0));
    let (x0, y0) = (x0 as i64, y0 as i64);
    let row = |y| {
        let (a, b) = (hash(seed, x0, y), hash(seed, x0 + 1, y));
        a + (b - a) * tx
    };
    let (top, bottom) = (row(y0), row(y0 + 1));
    top + (bottom - top) * ty
}
