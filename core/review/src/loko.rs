//! Leave one key-frame out: how well a correction model finds a key-frame from the others.

/// A key-frame: its frame, and where the feature is, pixels.
pub type Placed = (u32, [f32; 2]);

/// How far a model is from key-frames that it was not told of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOut {
    /// Key-frames that could be predicted, at least one.
    pub n: usize,
    /// Mean distance, pixels.
    pub mean_px: f64,
}

/// Leaves out each key-frame in turn; `predict` is given the others and the frame of the one left out, and says where
/// the model puts the feature there, `None` where it cannot.
///
/// `None` when no key-frame could be predicted.
pub fn loko(keys: &[Placed], mut predict: impl FnMut(&[Placed], u32) -> Option<[f32; 2]>) -> Option<LeftOut> {
    let mut errors = Vec::with_capacity(keys.len());
    for (k, &(frame, [x, y])) in keys.iter().enumerate() {
        let others: Vec<Placed> = keys[..k].iter().chain(&keys[k + 1..]).copied().collect();
        if let Some([px, py]) = predict(&others, frame) {
            errors.push(f64::from(px - x).hypot(f64::from(py - y)));
        }
    }
    let n = errors.len();
    (n > 0).then(|| LeftOut { n, mean_px: errors.iter().sum::<f64>() / n as f64 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_to_what_the_model_says_without_the_key_frame() {
        let keys = [(0, [0.0, 0.0]), (10, [10.0, 3.0]), (20, [20.0, 0.0]), (30, [30.0, 4.0])];
        // Between the neighbours, half-way; the ends cannot be predicted.
        let linear = |others: &[Placed], frame: u32| {
            let after = others.iter().position(|(at, _)| *at > frame)?;
            let ((_, a), (_, b)) = (others[after.checked_sub(1)?], others[after]);
            Some([(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0])
        };
        // At 10: 3 px from (10, 0). At 20: 3.5 px from (20, 3.5).
        let want = LeftOut { n: 2, mean_px: 3.25 };
        assert_eq!(loko(&keys, linear), Some(want));
        assert_eq!(loko(&keys, |_, _| None), None);
        assert_eq!(loko(&[], linear), None);
        let still = loko(&keys, |others, _| Some(others[0].1)).map(|out| (out.n, out.mean_px));
        // The first from the second, and the others from the first: 10.44, 10.44, 20 and 30.27 px.
        assert!(still.is_some_and(|(n, px)| n == 4 && (px - 17.79).abs() < 0.01), "{still:?}");
    }
}
