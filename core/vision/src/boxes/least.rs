//! The least of many costs.

/// Costs that are skipped together where even the least of them is too much.
const GROUP: usize = 16;

/// Where the least of some costs are, and memory to find it out.
#[derive(Debug, Default)]
pub(super) struct Least {
    /// `(cost, index)`, least first; of equal ones the first.
    pub(super) found: Vec<(u32, u32)>,
    /// Least cost of every group.
    minima: Vec<u32>,
    sorted: Vec<u32>,
}

impl Least {
    /// Finds the `n` least, 1..=costs.
    pub(super) fn find(&mut self, costs: &[u32], n: usize) {
        let least_of = |group: &[u32]| group.iter().fold(u32::MAX, |least, &cost| least.min(cost));
        self.minima.clear();
        self.minima.extend(costs.chunks(GROUP).map(least_of));
        self.sorted.clone_from(&self.minima);
        // The n-th least of the minima has n costs that are not above it: the n least are not above it either.
        let few = n > self.sorted.len();
        let bound = if few { u32::MAX } else { *self.sorted.select_nth_unstable(n - 1).1 };
        self.found.clear();
        for ((group, &least), first) in costs.chunks(GROUP).zip(&self.minima).zip((0..).step_by(GROUP)) {
            if least <= bound {
                let those = group.iter().zip(first..).filter(|(cost, _)| **cost <= bound);
                self.found.extend(those.map(|(&cost, index)| (cost, index)));
            }
        }
        if n < self.found.len() {
            self.found.select_nth_unstable(n - 1);
            self.found.truncate(n);
        }
        self.found.sort_unstable();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::cases(300))]
        #[test]
        fn the_least_are_the_first_of_all_in_order(
            costs in prop::collection::vec(prop_oneof![0_u32..40, 0_u32..9000, Just(u32::MAX)], 1..300), share in 0.0..1.0,
        ) {
            let n = ((costs.len() as f64 * share) as usize).max(1);
            let mut least = Least { found: vec![(1, 1)], minima: vec![3], sorted: Vec::new() };
            least.find(&costs, n);
            let mut all: Vec<(u32, u32)> = costs.into_iter().zip(0..).collect();
            all.sort_unstable();
            prop_assert_eq!(&least.found[..], &all[..n]);
        }
    }
}
