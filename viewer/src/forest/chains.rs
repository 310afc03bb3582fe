//! Nodes in chains, along which ways are added up: of one rank all at once, and each after those that bear it.

use honami_mechanics::Turning;

/// Chains of the nodes of a plant, in the order that they are drawn in.
#[derive(Debug, PartialEq)]
pub(super) struct Chains {
    /// First of its nodes, how many, and the node that bears the first: rows of the order. Rank after rank.
    pub(super) chains: Vec<[u32; 3]>,
    /// Rows of the order, chain after chain.
    pub(super) nodes: Vec<u32>,
    /// Where the chains of each rank begin, and where the last rank ends.
    pub(super) ranks: Vec<u32>,
}

impl Chains {
    /// Every node but the root, which comes first, is in one of them. A fork goes on where the most nodes follow, so that
    /// there are few ranks: no more than twice halves the plant.
    pub(super) fn new(turning: &Turning, order: &[u32]) -> Self {
        let mut rows = vec![0_u32; order.len()];
        (0..).zip(order).for_each(|(row, node)| rows[*node as usize] = row);
        // Of every row but the first, the row that bears it: a lower one.
        let bearers: Vec<u32> = std::iter::once(0)
            .chain(order.iter().skip(1).map(|node| rows[turning.parents()[*node as usize - 1] as usize]))
            .collect();
        let mut sizes = vec![1_u32; order.len()];
        for row in (1..order.len()).rev() {
            sizes[bearers[row] as usize] += sizes[row];
        }
        let mut next: Vec<Option<u32>> = vec![None; order.len()];
        for (row, bearer) in (0_u32..).zip(&bearers).skip(1) {
            let next = &mut next[*bearer as usize];
            if next.is_none_or(|other| sizes[row as usize] > sizes[other as usize]) {
                *next = Some(row);
            }
        }
        let mut rank_of = vec![0_usize; order.len()];
        let mut by_rank: Vec<Vec<u32>> = Vec::new();
        for (row, bearer) in (0_u32..).zip(&bearers).skip(1) {
            let on = rank_of[*bearer as usize];
            // What hangs on the root itself is of the first rank.
            let goes_on = *bearer > 0 && next[*bearer as usize] == Some(row);
            let rank = if goes_on || *bearer == 0 { on } else { on + 1 };
            rank_of[row as usize] = rank;
            if !goes_on {
                by_rank.resize_with(by_rank.len().max(rank + 1), Vec::new);
                by_rank[rank].push(row);
            }
        }
        let (mut chains, mut nodes, mut ranks) = (Vec::new(), Vec::new(), vec![0]);
        for heads in by_rank {
            for head in heads {
                let first = nodes.len() as u32;
                nodes.extend(std::iter::successors(Some(head), |row| next[*row as usize]));
                chains.push([first, nodes.len() as u32 - first, bearers[head as usize]]);
            }
            ranks.push(chains.len() as u32);
        }
        Self { chains, nodes, ranks }
    }
}
