//! Quantiles of the chi squared distribution.

/// The value that chi squared of so many degrees of freedom, above 0, stays below with this probability, between 0 and 1.
pub(super) fn quantile(share: f64, freedom: f64) -> f64 {
    // What is looked for lies between: it is never larger than this many deviations above its mean.
    let (mut low, mut high) = (0.0, freedom + 40.0 * (2.0 * freedom).sqrt() + 40.0);
    for _ in 0..200 {
        let middle = f64::midpoint(low, high);
        if below(middle, freedom) < share {
            low = middle;
        } else {
            high = middle;
        }
    }
    f64::midpoint(low, high)
}

/// The probability of less than x: the incomplete gamma function P(freedom / 2, x / 2), by its series, or by the continued
/// fraction of the rest where that converges faster (Abramowitz and Stegun 6.5.29, 6.5.31).
fn below(x: f64, freedom: f64) -> f64 {
    let (a, x) = (freedom / 2.0, x / 2.0);
    if x <= 0.0 {
        return 0.0;
    }
    let front = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum, mut k) = (1.0 / a, 1.0 / a, a);
        while term > sum * f64::EPSILON {
            k += 1.0;
            term *= x / k;
            sum += term;
        }
        return front * sum;
    }
    // From the inside out, with more steps than any x beyond a + 1 needs for 12 digits.
    let steps = 60 + (20.0 * a.sqrt()) as u32;
    let inner = (1..=steps).rev().fold(x, |rest, k| {
        let k = f64::from(k);
        x + (k - a) / (1.0 + k / rest)
    });
    1.0 - front / inner
}

/// Logarithm of the gamma function of a > 0: Stirling's series (Abramowitz and Stegun 6.1.41) from where it has 13 digits on.
fn ln_gamma(a: f64) -> f64 {
    let (mut a, mut shift) = (a, 0.0);
    while a < 12.0 {
        shift -= a.ln();
        a += 1.0;
    }
    let b = 1.0 / (a * a);
    let series = (1.0 / 12.0 - b * (1.0 / 360.0 - b * (1.0 / 1260.0 - b / 1680.0))) / a;
    (a - 0.5) * a.ln() - a + 0.5 * std::f64::consts::TAU.ln() + series + shift
}

#[cfg(test)]
mod tests {
    use super::quantile;

    /// SciPy 1.17, `scipy.stats.chi2.ppf` of 0.025, 0.5 and 0.975.
    const TABLE: [(f64, [f64; 3]); 6] = [
        (1.0, [0.0009820691171752555, 0.454936423119572, 5.023886187314888]),
        (2.0, [0.05063561596857975, 1.386294361119891, 7.377758908227871]),
        (3.7, [0.39457687534151664, 3.058889359041863, 10.618055248352459]),
        (10.0, [3.2469727802368413, 9.34181776559197, 20.483177350807388]),
        (26.0, [13.843904982007603, 25.336458117477264, 41.92317009635392]),
        (240.0, [198.9838512518774, 239.3336635537732, 284.80248374037495]),
    ];

    #[test]
    fn quantiles_are_those_of_tables() {
        for (freedom, wanted) in TABLE {
            for (share, wanted) in [0.025, 0.5, 0.975].into_iter().zip(wanted) {
                let found = quantile(share, freedom);
                assert!((found / wanted - 1.0).abs() < 1e-9, "{freedom} {share}: {found}, wanted {wanted}");
            }
        }
    }
}
