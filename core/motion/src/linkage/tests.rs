//! Against SciPy's output, against the definitions written out, and what errata E17-E19 say must hold.

use proptest::prelude::*;
use rand::{RngExt, SeedableRng};

use super::*;

fn random(len: usize, seed: u64) -> Vec<f64> {
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    (0..len).map(|_| rng.random_range(0.0..10.0)).collect()
}

/// Leaves below every cluster, single leaves first.
fn members(tree: &Dendrogram) -> Vec<Vec<usize>> {
    let mut members: Vec<Vec<usize>> = (0..tree.n_leaves() as usize).map(|leaf| vec![leaf]).collect();
    for merge in tree.merges() {
        let both = [merge.a, merge.b].map(|c| members[c as usize].clone()).concat();
        members.push(both);
    }
    members
}

fn is_monotone(tree: &Dendrogram) -> bool {
    tree.merges().windows(2).all(|pair| pair[1].height >= pair[0].height - 1e-12)
}

/// `truth/linkage_scipy.txt`, written by `tests/peers/linkage_scipy.py --truth`: the distances of random,
/// non-metric data, then the rows a, b, height, size of `scipy.cluster.hierarchy.linkage`.
#[test]
fn equals_scipy() {
    let text = include_str!("../../truth/linkage_scipy.txt");
    let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
    let numbers = |line: &str| -> Vec<f64> { line.split(' ').map(|word| word.parse().unwrap()).collect() };
    let condensed = numbers(lines[0]);
    let n = 32;
    for (criterion, rows) in [(Criterion::Average, &lines[1..n]), (Criterion::Ward, &lines[n..])] {
        let tree = linkage(condensed.clone(), n, criterion).unwrap();
        assert_eq!(rows.len(), tree.merges().len());
        for (merge, row) in tree.merges().iter().zip(rows) {
            let [a, b, height, size] = numbers(row)[..] else { panic!("four numbers a row") };
            assert_eq!([merge.a, merge.b, merge.size], [a, b, size].map(|k| k as u32), "{criterion:?}");
            assert!((merge.height - height).abs() < 1e-9, "{criterion:?}: {} {height}", merge.height);
        }
    }
}

#[test]
fn average_heights_are_the_means_of_eq_4_5() {
    let n = 25;
    let condensed = random(n * (n - 1) / 2, 1);
    let tree = linkage(condensed.clone(), n, Criterion::Average).unwrap();
    let members = members(&tree);
    let d = |i: usize, j: usize| condensed[i.min(j) * (2 * n - i.min(j) - 1) / 2 + i.max(j) - i.min(j) - 1];
    for merge in tree.merges() {
        let (a, b) = (&members[merge.a as usize], &members[merge.b as usize]);
        let sum: f64 = a.iter().flat_map(|&i| b.iter().map(move |&j| (i, j))).map(|(i, j)| d(i, j)).sum();
        assert!((merge.height - sum / (a.len() * b.len()) as f64).abs() < 1e-12);
    }
    assert!(is_monotone(&tree));
}

/// On points of a plane: Δ of eq. 4.9 from the centres of gravity, h = √(2Δ) (E18), and the sum of all Δ is
/// N times the total inertia (E17).
#[test]
fn ward_heights_are_increases_of_inertia() {
    let n = 30;
    let points: Vec<[f64; 2]> = random(2 * n, 2).chunks(2).map(|p| [p[0], p[1]]).collect();
    let distance = |i: usize, j: usize| (points[i][0] - points[j][0]).hypot(points[i][1] - points[j][1]);
    let condensed = (0..n).flat_map(|i| (i + 1..n).map(move |j| distance(i, j))).collect();
    let tree = linkage(condensed, n, Criterion::Ward).unwrap();
    let members = members(&tree);
    let centre = |group: &[usize]| {
        [0, 1].map(|axis| group.iter().map(|&i| points[i][axis]).sum::<f64>() / group.len() as f64)
    };
    let mut total = 0.0;
    for merge in tree.merges() {
        let (a, b) = (&members[merge.a as usize], &members[merge.b as usize]);
        let (ga, gb) = (centre(a), centre(b));
        let share = (a.len() * b.len()) as f64 / (a.len() + b.len()) as f64;
        let delta = share * ((ga[0] - gb[0]).powi(2) + (ga[1] - gb[1]).powi(2));
        assert!((merge.height - (2.0 * delta).sqrt()).abs() < 1e-9, "{} {delta}", merge.height);
        total += merge.height.powi(2) / 2.0;
    }
    let centre = centre(&(0..n).collect::<Vec<_>>());
    let inertia: f64 = points.iter().map(|p| (p[0] - centre[0]).powi(2) + (p[1] - centre[1]).powi(2)).sum();
    assert!((total - inertia).abs() < 1e-9, "{total} {inertia}");
}

proptest! {
    /// Errata E19: no inversion, and every merge is the least increase by the recurrence 4.10, whatever the
    /// dissimilarity.
    #[test]
    fn ward_is_the_greedy_merging_of_eq_4_10(seed: u64, n in 2_usize..14) {
        let condensed = random(n * (n - 1) / 2, seed);
        let tree = linkage(condensed.clone(), n, Criterion::Ward).unwrap();
        prop_assert!(is_monotone(&tree));
        let mut increase = vec![vec![f64::INFINITY; n]; n];
        for (k, (i, j)) in (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))).enumerate() {
            let start = condensed[k].powi(2) / 2.0; // E18
            (increase[i][j], increase[j][i]) = (start, start);
        }
        let mut size = vec![1.0; n];
        for merge in tree.merges() {
            let alive: Vec<usize> = (0..n).filter(|&i| size[i] > 0.0).collect();
            let pairs = alive.iter().flat_map(|&i| alive.iter().map(move |&j| (i, j))).filter(|(i, j)| i < j);
            let (i, j) = pairs.min_by(|a, b| increase[a.0][a.1].total_cmp(&increase[b.0][b.1])).unwrap();
            let least = increase[i][j];
            prop_assert!((merge.height - (2.0 * least).sqrt()).abs() < 1e-9);
            for &m in alive.iter().filter(|&&m| m != i && m != j) {
                let sum = (size[i] + size[m]) * increase[i][m] + (size[j] + size[m]) * increase[j][m] - size[m] * least;
                let merged = sum / (size[i] + size[j] + size[m]);
                (increase[i][m], increase[m][i]) = (merged, merged);
            }
            size[i] += std::mem::replace(&mut size[j], 0.0);
        }
    }
}

#[test]
fn what_is_no_matrix_of_distances_is_refused() {
    let cases = [
        (vec![], 1, "grouping needs at least 2 tracks, came 1"),
        (vec![1.0], 3, "3 tracks have 3 distances, came 1"),
        (
            vec![1.0, f64::NAN, 1.0],
            3,
            "distance 1 of the condensed matrix is NaN; wanted finite numbers, 0 or more",
        ),
        (
            vec![1.0, 1.0, -2.0],
            3,
            "distance 2 of the condensed matrix is -2; wanted finite numbers, 0 or more",
        ),
    ];
    for (condensed, n, wanted) in cases {
        assert_eq!(linkage(condensed, n, Criterion::Ward).unwrap_err().to_string(), wanted);
    }
    let huge = linkage(vec![1e300, 2e300, 3e300], 3, Criterion::Ward).unwrap();
    assert!(huge.merges().iter().all(|merge| merge.height.is_finite()));
    let same = linkage(vec![0.0; 6], 4, Criterion::Average).unwrap();
    assert!(same.merges().iter().all(|merge| merge.height.abs() < 1e-300));
}
