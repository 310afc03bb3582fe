//! What white noise does to singular values: the law of Marchenko and Pastur (Math. USSR Sbornik 1, 1967).

/// Points of the integral: the median is right to 1e-7.
const STEPS: usize = 4096;

/// The largest singular value that white noise makes of a table, from the median of all: sigma (sqrt T + sqrt M), with
/// sigma = median / sqrt(max(T, M) mu) (Gavish and Donoho, IEEE Trans. Inf. Theory 60, 2014, eq. 10). Right as long as
/// less than half of the components are motion.
#[must_use]
pub fn edge(singular: &[f64], n_rows: usize, n_columns: usize) -> f64 {
    let (short, long) = (n_rows.min(n_columns) as f64, n_rows.max(n_columns) as f64);
    if short == 0.0 {
        return 0.0;
    }
    median(singular) / (long * median_square(short / long)).sqrt() * (short.sqrt() + long.sqrt())
}

/// The middle one, of two their mean; 0 of none.
fn median(falling: &[f64]) -> f64 {
    let n = falling.len();
    if n == 0 { 0.0 } else { f64::midpoint(falling[(n - 1) / 2], falling[n / 2]) }
}

/// The median of the squares of singular values of a table of unit noise with sides in the ratio beta, 0 to 1, divided by
/// its longer side.
///
/// Their density sqrt((b - x)(x - a)) / (2 pi beta x) between a, b = (1 -+ sqrt beta)^2 becomes smooth with
/// x = 1 + beta + 2 sqrt(beta) cos angle: 2 sin^2 / (pi x) of the angle.
#[must_use]
pub fn median_square(beta: f64) -> f64 {
    let step = std::f64::consts::PI / STEPS as f64;
    let x = |angle: f64| 1.0 + beta + 2.0 * beta.sqrt() * angle.cos();
    let mut above = 0.0;
    for k in 0..STEPS {
        let angle = (k as f64 + 0.5) * step;
        let more = step * 2.0 * angle.sin().powi(2) / (std::f64::consts::PI * x(angle));
        if above + more >= 0.5 {
            return x((k as f64 + (0.5 - above) / more) * step);
        }
        above += more;
    }
    x(std::f64::consts::PI)
}
