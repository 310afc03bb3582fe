//! The least of many costs.
#![allow(unsafe_code, reason = "calls to functions for instructions that the processor was asked about")]

#[cfg(test)]
mod tests;

use crate::simd::{self, Set};

/// Costs that are compared together.
const GROUP: usize = 16;

/// Columns that costs are put into, row by row: the least of each tells how little is little.
const COLUMNS: usize = 64;

/// Where the least of some costs are, and memory to find it out.
#[derive(Debug, Default)]
pub(super) struct Least {
    /// A cost, and beneath its 32 bits its index: of equal costs the first is less.
    found: Vec<u64>,
}

impl Least {
    /// Finds the `n` least, 1..=costs, of equal ones the first; answers their indices, in any order.
    pub(super) fn find(
        &mut self,
        level: simd::Level,
        costs: &[u32],
        n: usize,
    ) -> impl Iterator<Item = usize> + use<'_> {
        match level.set() {
            Set::Scalar => self.search(costs, n, |costs, bound| {
                (0..GROUP).fold(0, |bits, i| bits | u16::from(costs[i] <= bound) << i)
            }),
            // SAFETY: a level is the proof that the processor has these instructions.
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => unsafe { self.search_avx2(costs, n) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => unsafe { self.search_avx512(costs, n) },
        }
        self.found.iter().map(|&found| found as u32 as usize)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn search_avx2(&mut self, costs: &[u32], n: usize) {
        use std::arch::x86_64::*;
        self.search(costs, n, |costs, bound| {
            let bound = _mm256_set1_epi32(bound as i32);
            costs.as_chunks::<8>().0.iter().rev().fold(0, |bits, costs| {
                // SAFETY: these are 32 bytes.
                let costs = unsafe { _mm256_loadu_si256(costs.as_ptr().cast()) };
                let few = _mm256_cmpeq_epi32(_mm256_max_epu32(costs, bound), bound);
                bits << 8 | _mm256_movemask_ps(_mm256_castsi256_ps(few)) as u16
            })
        });
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512bw")]
    fn search_avx512(&mut self, costs: &[u32], n: usize) {
        use std::arch::x86_64::*;
        self.search(costs, n, |costs, bound| {
            // SAFETY: these are 64 bytes.
            let costs = unsafe { _mm512_loadu_si512(costs.as_ptr().cast()) };
            _mm512_cmple_epu32_mask(costs, _mm512_set1_epi32(bound as i32))
        });
    }

    /// In plain words, which compilers turn into the vectors that they may use, but for the question which of a group of
    /// costs are not above a bound, a bit each.
    #[inline(always)]
    fn search(&mut self, costs: &[u32], n: usize, which: impl Fn(&[u32; GROUP], u32) -> u16) {
        let bound = bound(costs, n);
        self.found.clear();
        let (groups, rest) = costs.as_chunks::<GROUP>();
        for (group, first) in groups.iter().zip((0..).step_by(GROUP)) {
            let mut few = which(group, bound);
            while few != 0 {
                let i = few.trailing_zeros() as usize;
                self.found.push(key(group[i], first + i));
                few &= few - 1;
            }
        }
        let rest = rest.iter().zip(GROUP * groups.len()..).filter(|&(cost, _)| *cost <= bound);
        self.found.extend(rest.map(|(&cost, i)| key(cost, i)));
        if n < self.found.len() {
            self.found.select_nth_unstable(n - 1);
            self.found.truncate(n);
        }
    }
}

/// A cost and its index, to be compared at once.
fn key(cost: u32, index: usize) -> u64 {
    u64::from(cost) << 32 | index as u64
}

/// A cost that the `n` least of them are not above.
#[inline(always)]
fn bound(costs: &[u32], n: usize) -> u32 {
    if n > COLUMNS.min(costs.len()) {
        return u32::MAX;
    }
    let mut minima = [u32::MAX; COLUMNS];
    let (rows, rest) = costs.as_chunks::<COLUMNS>();
    for row in rows {
        minima.iter_mut().zip(row).for_each(|(least, &cost)| *least = cost.min(*least));
    }
    minima.iter_mut().zip(rest).for_each(|(least, &cost)| *least = cost.min(*least));
    // The n-th least of the minima has n costs that are not above it: the n least are not above it either.
    let next = |bound: u32| {
        // As differences that wrap, costs that are not above the bound come after all that are.
        let beyond = bound.wrapping_add(1);
        let next = minima.iter().fold(u32::MAX, |least, cost| least.min(cost.wrapping_sub(beyond)));
        let next = next.wrapping_add(beyond);
        if next > bound { next } else { u32::MAX }
    };
    let first = minima.iter().fold(u32::MAX, |least, &cost| least.min(cost));
    (1..n).fold(first, |bound, _| next(bound))
}
