//! The least against sorting all.

use proptest::prelude::*;

use super::*;

proptest! {
    #![proptest_config(crate::cases(300))]
    #[test]
    fn the_least_are_the_first_of_all_in_order(
        costs in prop::collection::vec(prop_oneof![0_u32..40, 0_u32..9000, Just(u32::MAX)], 1..300),
        share in prop_oneof![0.0..0.1, 0.0..1.0],
    ) {
        let n = ((costs.len() as f64 * share) as usize).max(1);
        let mut all: Vec<usize> = (0..costs.len()).collect();
        all.sort_by_key(|&i| costs[i]);
        all.truncate(n);
        all.sort_unstable();
        // What an earlier search left behind must not count.
        let mut least = Least { found: vec![3; 5] };
        for level in simd::available() {
            let mut found: Vec<usize> = least.find(level, &costs, n).collect();
            found.sort_unstable();
            prop_assert_eq!(&found, &all, "{}", level.name());
        }
    }
}
