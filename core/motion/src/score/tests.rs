//! The index against scikit-learn's documented values and its own symmetries.

use super::adjusted_rand_index;

#[test]
fn known_values() {
    // Values of sklearn.metrics.adjusted_rand_score.
    let cases: [(&[u32], &[u32], f64); 5] = [
        (&[0, 0, 1, 1], &[0, 0, 1, 1], 1.0),
        (&[0, 0, 1, 1], &[1, 1, 0, 0], 1.0),
        (&[0, 0, 1, 2], &[0, 0, 1, 1], 4.0 / 7.0),
        (&[0, 0, 0, 0], &[0, 1, 2, 3], 0.0),
        (&[0, 0, 1, 1], &[0, 1, 0, 1], -0.5),
    ];
    for (a, b, wanted) in cases {
        let got = adjusted_rand_index(a, b).unwrap();
        assert!((got - wanted).abs() < 1e-12, "{a:?} {b:?}: {got}, wanted {wanted}");
        assert_eq!(adjusted_rand_index(b, a), Some(got));
    }
    assert_eq!(adjusted_rand_index(&[3, 3], &[9, 9]), Some(1.0));
    assert_eq!(adjusted_rand_index(&[0], &[0]), None);
    assert_eq!(adjusted_rand_index(&[0, 1], &[0]), None);
}
