//! Displacements of a region of which a part moves another way, and what mean and median make of them.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// Displacements of a region.
const N: usize = 40;
/// Noise of a displacement, pixels.
const NOISE_PX: f64 = 0.25;
/// Where the region moves, pixels.
const TRUTH: [f64; 2] = [1.5, -0.75];
/// Draws of each row.
const SEEDS: u64 = 500;

/// A share of the displacements is `away` px to the right of the rest, with the same noise: one-sided, coherent.
fn samples(share: f64, away: f64, seed: u64) -> Vec<[f64; 2]> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let n_out = (share * N as f64).round() as usize;
    let mut noise = || -> f64 { NOISE_PX * Distribution::<f64>::sample(&StandardNormal, &mut rng) };
    let shift = |i: usize| if i < n_out { away } else { 0.0 };
    (0..N).map(|i| [TRUTH[0] + shift(i) + noise(), TRUTH[1] + noise()]).collect()
}

fn mean(samples: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|axis| samples.iter().map(|x| x[axis]).sum::<f64>() / samples.len() as f64)
}

fn median(samples: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|axis| {
        let mut line: Vec<f64> = samples.iter().map(|x| x[axis]).collect();
        line.sort_by(f64::total_cmp);
        f64::midpoint(line[(line.len() - 1) / 2], line[line.len() / 2])
    })
}

/// Root of the mean squared error of mean, median and `mode`, pixels.
pub(super) fn errors(share: f64, away: f64, mode: &dyn Fn(&[[f64; 2]]) -> [f64; 2]) -> [f64; 3] {
    let mut squares = [0.0; 3];
    for seed in 0..SEEDS {
        let samples = samples(share, away, seed);
        for (sum, at) in squares.iter_mut().zip([mean(&samples), median(&samples), mode(&samples)]) {
            *sum += (at[0] - TRUTH[0]).powi(2) + (at[1] - TRUTH[1]).powi(2);
        }
    }
    squares.map(|sum| (sum / SEEDS as f64).sqrt())
}
