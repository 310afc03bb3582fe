//! How alike two groupings are.

use std::collections::BTreeMap;

/// Adjusted Rand index of two groupings of the same things: 1 the same, about 0 by chance, below 0 worse.
///
/// Hubert and Arabie, Comparing partitions, J. Classification 2 (1985) 193-218, eq. 5. `None` when the lists
/// differ in length or hold fewer than two things.
#[must_use]
pub fn adjusted_rand_index(a: &[u32], b: &[u32]) -> Option<f64> {
    if a.len() != b.len() || a.len() < 2 {
        return None;
    }
    let pairs = |counts: BTreeMap<(u32, u32), u64>| -> f64 {
        counts.into_values().map(|n| (n * (n - 1)) as f64 / 2.0).sum()
    };
    let count = |keys: &mut dyn Iterator<Item = (u32, u32)>| {
        let mut counts = BTreeMap::new();
        keys.for_each(|key| *counts.entry(key).or_insert(0) += 1);
        pairs(counts)
    };
    let both = count(&mut a.iter().copied().zip(b.iter().copied()));
    let (in_a, in_b) = (count(&mut a.iter().map(|&g| (g, 0))), count(&mut b.iter().map(|&g| (g, 0))));
    let expected = in_a * in_b / ((a.len() * (a.len() - 1)) as f64 / 2.0);
    let most = f64::midpoint(in_a, in_b);
    // Both one group, or both all apart: the same grouping, and 0 / 0.
    Some(if most > expected { (both - expected) / (most - expected) } else { 1.0 })
}

#[cfg(test)]
mod tests;
