//! The top of a surface to a fraction of a pixel.

/// Where the quadratic that fits nine costs best has its minimum, `[x, y]`, from the middle one, pixels.
///
/// `costs` are rows of a 3x3 neighbourhood. With `f(d) = a + bᵀd + dᵀH d / 2` in the sense of least squares, it is
/// `-H⁻¹ b`; `None` where `H` is not positive definite, or the minimum lies a pixel away or more.
pub(super) fn minimum(costs: &[f64; 9]) -> Option<[f64; 2]> {
    let moment = |weight: fn(f64, f64) -> f64| -> f64 {
        let at = |i: usize| (i % 3) as f64 - 1.0;
        costs.iter().enumerate().map(|(i, cost)| weight(at(i), at(i / 3)) * cost).sum()
    };
    // The normal equations of the nine points, solved by hand.
    let (bx, by) = (moment(|x, _| x) / 6.0, moment(|_, y| y) / 6.0);
    let hxx = moment(|x, _| 3.0 * x * x - 2.0) / 3.0;
    let hyy = moment(|_, y| 3.0 * y * y - 2.0) / 3.0;
    let hxy = moment(|x, y| x * y) / 4.0;
    let determinant = hxx * hyy - hxy * hxy;
    if !(hxx > 0.0 && determinant > 0.0) {
        return None;
    }
    let (x, y) = ((hxy * by - hyy * bx) / determinant, (hxy * bx - hxx * by) / determinant);
    (x.abs() < 1.0 && y.abs() < 1.0).then_some([x, y])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quadratic_s_minimum_is_found_exactly() {
        for (at, h) in
            [([0.3, -0.2], [2.0, 0.5, 1.0]), ([0.0, 0.0], [1.0, 0.0, 1.0]), ([-0.7, 0.45], [3.0, -1.2, 0.9])]
        {
            let costs = std::array::from_fn(|i| {
                let (x, y) = ((i % 3) as f64 - 1.0 - at[0], (i / 3) as f64 - 1.0 - at[1]);
                7.0 + h[0] * x * x / 2.0 + h[1] * x * y + h[2] * y * y / 2.0
            });
            let got = minimum(&costs);
            assert!(got.is_some_and(|d| (d[0] - at[0]).hypot(d[1] - at[1]) < 1e-12), "{got:?} for {at:?}");
        }
    }

    #[test]
    fn saddles_ridges_flats_and_far_minima_have_none() {
        let of = |f: fn(f64, f64) -> f64| {
            minimum(&std::array::from_fn(|i| f((i % 3) as f64 - 1.0, (i / 3) as f64 - 1.0)))
        };
        assert_eq!(of(|_, _| 4.0), None);
        assert_eq!(of(|x, y| x * x - y * y), None);
        assert_eq!(of(|x, _| x * x), None);
        assert_eq!(of(|x, y| -x * x - y * y), None);
        assert_eq!(of(|x, y| (x - 1.5).powi(2) + y * y), None);
    }
}
