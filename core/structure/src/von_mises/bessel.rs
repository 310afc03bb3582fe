//! Modified Bessel functions of orders 0 and 1, as far as angles need them (Abramowitz and Stegun 9.6.10, 9.7.1): what is
//! printed for them solves the equation of the ordinary ones (errata Z4).

use std::f64::consts::TAU;

use super::MAX_KAPPA;

/// From here on e^-2x is nothing beside 1, and the series in 1/x is exact.
const LARGE: f64 = 20.0;
/// What is smaller changes no sum.
const NOTHING: f64 = 1e-18;
/// Halvings of the range of ln κ that leave no digit open.
const HALVINGS: u32 = 64;

/// Two sums: I₀ and I₁ beside what both share.
struct Sums {
    i0: f64,
    i1: f64,
    /// I₀ - I₁, not by subtraction where they are nearly one.
    apart: f64,
}

/// In powers of x.
fn near(x: f64) -> Sums {
    let (mut term, mut i0, mut i1, mut m) = (1.0, 0.0, 0.0, 0.0);
    while term > NOTHING * i0 {
        i0 += term;
        i1 += term * x / 2.0 / (m + 1.0);
        m += 1.0;
        term *= x * x / 4.0 / (m * m);
    }
    Sums { i0, i1, apart: i0 - i1 }
}

/// In powers of 1/x, both times e^-x √(2πx).
fn far(x: f64) -> Sums {
    let (mut zero, mut one, mut k): (f64, f64, f64) = (1.0, 1.0, 0.0);
    let mut sums = Sums { i0: 1.0, i1: 1.0, apart: 0.0 };
    while zero > NOTHING {
        k += 1.0;
        let odd = (2.0 * k - 1.0) * (2.0 * k - 1.0);
        zero *= odd / (8.0 * k * x);
        one *= (odd - 4.0) / (8.0 * k * x);
        sums = Sums { i0: sums.i0 + zero, i1: sums.i1 + one, apart: sums.apart + (zero - one) };
    }
    sums
}

fn sums(x: f64) -> Sums {
    if x < LARGE { near(x) } else { far(x) }
}

/// e^-x I₀(x), x at least 0.
pub(super) fn i0_scaled(x: f64) -> f64 {
    let i0 = sums(x).i0;
    if x < LARGE { i0 * (-x).exp() } else { i0 / (TAU * x).sqrt() }
}

/// I₁(x) / I₀(x), and what it lacks to 1; x at least 0.
pub(super) fn ratio(x: f64) -> (f64, f64) {
    let sums = sums(x);
    (sums.i1 / sums.i0, sums.apart / sums.i0)
}

/// The x of a ratio, 0 to [`MAX_KAPPA`], given with what it lacks to 1: the smaller of the two is the one with digits.
pub(super) fn inverse(wanted: f64, gap: f64) -> f64 {
    let is_beyond = |x: f64| {
        let (found, lacks) = ratio(x);
        if wanted < gap { found > wanted } else { lacks < gap }
    };
    // Below, the ratio is half of x to all digits.
    let least: f64 = 1e-9;
    if !is_beyond(MAX_KAPPA) {
        return MAX_KAPPA;
    }
    if is_beyond(least) {
        return (2.0 * wanted).min(least);
    }
    let (mut low, mut high) = (least.ln(), MAX_KAPPA.ln());
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        if is_beyond(middle.exp()) { high = middle } else { low = middle }
    }
    f64::midpoint(low, high).exp()
}
