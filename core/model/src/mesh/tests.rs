//! Weights sum up to 1, whatever they were made of.

use proptest::prelude::*;

use super::*;

#[test]
fn bones_are_named_once_and_those_without_weight_not_at_all() {
    let binding = |shares| {
        let made = Binding::new(shares);
        (made.bones(), made.weights())
    };
    let twice = [(7, 1.0), (3, 1.0), (7, 1.0), (9, 0.0)];
    assert_eq!(binding(twice), ([7, 3, 0, 0], [1.0 - 1.0 / 3.0_f32, 1.0 / 3.0, 0.0, 0.0]));
    let alone = [(5, 1e-300), (6, 0.0), (7, 0.0), (8, 0.0)];
    assert_eq!(binding(alone), ([5, 0, 0, 0], [1.0, 0.0, 0.0, 0.0]));
    let nothing = [(5, 0.0), (6, f64::NAN), (7, -1.0), (8, f64::INFINITY)];
    assert_eq!(binding(nothing), ([0; 4], [1.0, 0.0, 0.0, 0.0]));
    // Too little for a float of 32 bits is nothing.
    assert_eq!(binding([(5, 1.0), (6, 1e-60), (0, 0.0), (0, 0.0)]), ([5, 0, 0, 0], [1.0, 0.0, 0.0, 0.0]));
}

proptest! {
    #[test]
    fn weights_sum_up_to_one(shares in prop::array::uniform4((0..6_u16, 0.0..3.0_f64))) {
        let binding = Binding::new(shares);
        let total: f64 = binding.shares().map(|(_, weight)| weight).sum();
        prop_assert!((total - 1.0).abs() < 1e-7, "{binding:?}");
        prop_assert!(binding.weights().iter().all(|weight| (0.0..=1.0).contains(weight)));
    }
}
