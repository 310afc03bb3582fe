//! Graphs whose best cut is known, eigenvectors beside a whole solution, affinities beside the formula written out, and what
//! no grouping may depend on.

use nalgebra::{DMatrix, SymmetricEigen};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::cut::{Cut, best};
use super::eigen::second;
use super::graph::Graph;
use super::*;

/// A graph of edges, each given once; every node is joined to itself with the weight 1.
fn graph(n: usize, edges: &[(usize, usize, f64)]) -> Graph {
    let mut rows: Vec<Vec<(u32, f64)>> = (0..n as u32).map(|node| vec![(node, 1.0)]).collect();
    for &(a, b, weight) in edges {
        rows[a].push((b as u32, weight));
        rows[b].push((a as u32, weight));
    }
    rows.iter_mut().for_each(|row| row.sort_by_key(|(other, _)| *other));
    Graph::of_rows(rows.into_iter())
}

/// All pairs of nodes from..to, with a weight each.
fn clique(from: usize, to: usize, weight: impl Fn() -> f64) -> Vec<(usize, usize, f64)> {
    (from..to).flat_map(|a| (a + 1..to).map(move |b| (a, b))).map(|(a, b)| (a, b, weight())).collect()
}

/// Blocks of nodes, tight within and loose between, in an order by chance; with the block of each node.
fn blocks(n: usize, n_blocks: usize, seed: u64) -> (Graph, Vec<usize>) {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut of: Vec<usize> = (0..n).map(|node| node % n_blocks).collect();
    of.shuffle(&mut rng);
    let mut edges = Vec::new();
    for a in 0..n {
        for b in a + 1..n {
            let (share, most) = if of[a] == of[b] { (0.3, 1.0) } else { (0.03, 0.1) };
            if rng.random_range(0.0..1.0) < share {
                edges.push((a, b, rng.random_range(0.1 * most..most)));
            }
        }
    }
    (graph(n, &edges), of)
}

fn dense(graph: &Graph) -> DMatrix<f64> {
    let mut dense = DMatrix::zeros(graph.len(), graph.len());
    for node in 0..graph.len() {
        graph.edges(node).for_each(|(other, weight)| dense[(node, other)] = weight);
    }
    dense
}

/// Sums over ordered pairs, those of a node with itself among them: Ncut by 2.22, and 2 - Nassoc by 2.23.
fn as_printed(graph: &Graph, is_a: &[bool]) -> [f64; 2] {
    let w = dense(graph);
    let sum = |from: &dyn Fn(usize) -> bool, to: &dyn Fn(usize) -> bool| -> f64 {
        let n = graph.len();
        let pairs = (0..n).flat_map(|a| (0..n).map(move |b| (a, b)));
        pairs.filter(|&(a, b)| from(a) && to(b)).map(|(a, b)| w[(a, b)]).sum()
    };
    let (a, b) = (|node: usize| is_a[node], |node: usize| !is_a[node]);
    let all = |_: usize| true;
    let ncut = sum(&a, &b) / sum(&a, &all) + sum(&a, &b) / sum(&b, &all);
    [ncut, 2.0 - sum(&a, &a) / sum(&a, &all) - sum(&b, &b) / sum(&b, &all)]
}

fn best_of(graph: &Graph) -> Cut {
    best(graph, 1, &mut || true).unwrap().expect("a cut")
}

fn divided(graph: Graph, n_levels: u32, order: Order) -> divide::Divided {
    divide(graph, n_levels, order, 1, &mut |_| true).unwrap()
}

/// Whether the groups of a cut are these.
#[track_caller]
fn assert_groups(tree: &Dendrogram, wanted: &[usize]) {
    let n_groups = wanted.iter().max().unwrap() + 1;
    let wanted: Vec<u32> = wanted.iter().map(|&group| group as u32).collect();
    let found = tree.cut(n_groups as u32);
    assert_eq!(crate::score::adjusted_rand_index(&found, &wanted), Some(1.0), "{found:?}");
}

#[test]
fn two_cliques_part_at_the_weak_edge_that_joins_them_for_what_it_costs() {
    for (m, weak) in [(3, 0.1), (8, 1e-3), (30, 0.5), (100, 1e-6)] {
        let mut edges = [clique(0, m, || 1.0), clique(m, 2 * m, || 1.0)].concat();
        edges.push((m - 1, m, weak));
        let graph = graph(2 * m, &edges);
        let cut = best_of(&graph);
        assert_eq!(cut.sides, [0..m as u32, m as u32..2 * m as u32].map(Vec::from_iter), "{m} {weak}");
        // assoc of either: m^2 ordered pairs within, and the edge.
        let wanted = 2.0 * weak / ((m * m) as f64 + weak);
        assert!((cut.ncut - wanted).abs() < 1e-12 * wanted.max(1e-3), "{m} {weak}: {} {wanted}", cut.ncut);
    }
}

#[test]
fn the_cut_is_the_least_of_all_there_are() {
    for seed in 0..12 {
        let n = 11;
        let (graph, _) = {
            let mut rng = Pcg64Mcg::seed_from_u64(seed);
            let mut edges = [clique(0, 5, || 1.0), clique(5, n, || 1.0)].concat();
            edges.iter_mut().for_each(|edge| edge.2 = rng.random_range(0.5..1.0));
            edges.extend((0..5).map(|a| (a, 5 + a, rng.random_range(0.01..0.2))));
            (self::graph(n, &edges), ())
        };
        let every = (1..1_u32 << (n - 1)).map(|bits| {
            let is_a: Vec<bool> = (0..n).map(|node| bits >> node & 1 == 1).collect();
            as_printed(&graph, &is_a)
        });
        let (mut least, mut off) = (f64::INFINITY, 0.0_f64);
        for [ncut, by_assoc] in every {
            least = least.min(ncut);
            off = off.max((ncut - by_assoc).abs());
        }
        // Errata Z3.
        assert!(off < 1e-12, "{off}");
        let lambda = second(&graph, 1, &mut || true).unwrap().lambda;
        let found = best_of(&graph).ncut;
        assert!((found - least).abs() < 1e-12 && lambda <= least + 1e-12, "{seed}: {found} {least} {lambda}");
    }
}

#[test]
fn eigenvectors_are_those_of_the_whole_matrix() {
    for (n, n_blocks, seed) in [(41, 2, 1), (120, 3, 2), (300, 2, 3), (300, 8, 4), (500, 1, 5)] {
        let (graph, _) = blocks(n, n_blocks, seed);
        assert_eq!(graph.components().len(), 1);
        let found = second(&graph, 7, &mut || true).unwrap();
        let w = dense(&graph);
        let degrees: Vec<f64> = (0..n).map(|node| w.row(node).sum()).collect();
        let scaled = DMatrix::from_fn(n, n, |a, b| w[(a, b)] / (degrees[a] * degrees[b]).sqrt());
        let mut thetas: Vec<f64> = SymmetricEigen::new(scaled).eigenvalues.iter().copied().collect();
        thetas.sort_by(|a, b| b.total_cmp(a));
        let wanted = 1.0 - thetas[1];
        assert!((found.lambda - wanted).abs() < 1e-9, "{n}: {} {wanted}", found.lambda);
        // (D - W) y = lambda D y, in terms of the largest of y.
        let largest = found.y.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        for node in 0..n {
            let image: f64 = (0..n).map(|other| w[(node, other)] * found.y[other]).sum();
            let off = (degrees[node] * found.y[node] * (1.0 - found.lambda) - image).abs();
            assert!(off < 1e-5 * largest * degrees[node], "{n}, node {node}: {off}");
        }
    }
}

/// Of a ring whose nodes have three edges of weight 1, their own among them, (1 + 2 cos(2 pi / n)) / 3, twice.
#[test]
fn a_ring_has_the_eigenvalue_that_it_has_and_parts_in_the_middle() {
    for n in [6, 24, 40, 41, 200, 1000] {
        let edges: Vec<_> = (0..n).map(|node| (node, (node + 1) % n, 1.0)).collect();
        let ring = graph(n, &edges);
        let wanted = 1.0 - (1.0 + 2.0 * (std::f64::consts::TAU / n as f64).cos()) / 3.0;
        let found = second(&ring, 3, &mut || true).unwrap();
        assert!((found.lambda - wanted).abs() < 1e-9, "{n}: {} {wanted}", found.lambda);
        let cut = best_of(&ring);
        // Two edges of 3 n / 2 on either side; a node more or less where rounding says so.
        assert!((cut.ncut - 8.0 / (3 * n) as f64).abs() < 1e-2 * cut.ncut, "{n}: {}", cut.ncut);
        assert!(cut.sides.iter().all(|side| side.len().abs_diff(n / 2) <= n / 20 + 1), "{cut:?}");
    }
}

#[test]
fn what_is_not_connected_falls_apart_first_and_the_largest_leaves_first() {
    let sizes = [4, 9, 1, 6];
    let (mut edges, mut of) = (Vec::new(), Vec::new());
    for (block, size) in sizes.into_iter().enumerate() {
        edges.extend(clique(of.len(), of.len() + size, || 0.25));
        of.extend(std::iter::repeat_n(block, size));
    }
    let found = divided(graph(of.len(), &edges), 4, Order::Levels);
    assert_groups(&found.tree, &of);
    assert_groups(&found.tree, &of.iter().map(|&block| usize::from(block == 1)).collect::<Vec<_>>());
    // At once above all levels; of the cliques, all alike within, one of 9 nodes with weight 1 on themselves is cut still.
    let heights: Vec<f64> = found.tree.merges().iter().rev().map(|merge| merge.height).collect();
    assert!(
        heights[..3].iter().all(|height| (height - 8.0).abs() < 1e-12) && heights[3] < 8.0,
        "{heights:?}"
    );
}

#[test]
fn a_level_is_cut_before_the_next_and_by_cuts_what_falls_apart_most_clearly() {
    // Two pairs of two cliques each, and one of three, which takes a level more.
    let sizes = [6, 6, 6, 6, 6, 6, 6];
    let pair_of = [0, 0, 1, 1, 2, 2, 2];
    let (mut edges, mut clique_of) = (Vec::new(), Vec::new());
    for (block, size) in sizes.into_iter().enumerate() {
        edges.extend(clique(6 * block, 6 * block + size, || 1.0));
        clique_of.extend(std::iter::repeat_n(block, size));
    }
    for a in 0..7 {
        for b in a + 1..7 {
            let weight = if pair_of[a] == pair_of[b] { 0.2 + 0.01 * a as f64 } else { 0.002 };
            edges.push((6 * a + b % 6, 6 * b + a % 6, weight));
        }
    }
    let cliques: Vec<usize> = clique_of.clone();
    let pairs: Vec<usize> = clique_of.iter().map(|&clique| pair_of[clique]).collect();
    let by_cuts = divided(graph(42, &edges), 6, Order::Cuts);
    assert_groups(&by_cuts.tree, &pairs);
    assert_groups(&by_cuts.tree, &cliques);
    let by_levels = divided(graph(42, &edges), 2, Order::Levels);
    assert_eq!(by_levels.n_groups, 4);
    // The cuts of a level lie between its powers of 2; below 1/2 are the joins within groups.
    for tree in [&by_cuts.tree, &by_levels.tree] {
        assert!(tree.merges().is_sorted_by(|a, b| a.height <= b.height), "{tree:?}");
    }
    let heights: Vec<f64> = by_levels.tree.merges().iter().rev().map(|merge| merge.height).collect();
    assert!(heights[0] > 1.0 && heights[0] <= 2.0, "{heights:?}");
    assert!(heights[1..3].iter().all(|height| *height > 0.5 && *height <= 1.0) && heights[3] <= 0.5);
}

#[test]
fn nodes_in_another_order_are_divided_the_same() {
    let (graph, _) = blocks(150, 3, 21);
    let mut order: Vec<u32> = (0..150).collect();
    order.shuffle(&mut Pcg64Mcg::seed_from_u64(5));
    // Node k of the second is order[k] of the first.
    let mut number = vec![0_u32; 150];
    (0_u32..).zip(&order).for_each(|(k, &node)| number[node as usize] = k);
    let row = |&node: &u32| {
        let mut row: Vec<(u32, f64)> =
            graph.edges(node as usize).map(|(other, weight)| (number[other], weight)).collect();
        row.sort_by_key(|(other, _)| *other);
        row
    };
    let mixed = Graph::of_rows(order.iter().map(row));
    let (straight, mixed) = (divided(graph, 3, Order::Cuts).tree, divided(mixed, 3, Order::Cuts).tree);
    for n_groups in 2..150 {
        let (straight, mixed) = (straight.cut(n_groups), mixed.cut(n_groups));
        let straight: Vec<u32> = order.iter().map(|&node| straight[node as usize]).collect();
        assert_eq!(crate::score::adjusted_rand_index(&straight, &mixed), Some(1.0), "{n_groups}");
    }
}

const N: usize = 36;
const T: usize = 70;

/// Three branches in turn, each of a place and of frequencies of its own, every track with amounts of its own, and noise.
fn branches(noise_px: f64, seed: u64) -> Positions {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut positions = Positions::new(N, T);
    for track in 0..N {
        let branch = (track % 3) as f64;
        let amounts: [f64; 4] = std::array::from_fn(|_| rng.random_range(2.0..4.0));
        let place = [60.0 * branch + rng.random_range(0.0..90.0), rng.random_range(0.0..200.0)];
        for frame in 0..T {
            let t = frame as f64;
            let swing = [((0.2 + 0.09 * branch) * t + branch).sin(), ((0.7 + 0.13 * branch) * t).cos()];
            let at: [f64; 2] = std::array::from_fn(|axis| {
                let moved = amounts[axis] * swing[0] + 0.3 * amounts[2 + axis] * swing[1];
                place[axis] + moved + noise_px * rng.random_range(-1.7..1.7)
            });
            positions.set(track, frame, at.map(|v| v as f32));
        }
    }
    positions
}

fn of(positions: &Positions, options: &Options) -> Ncut {
    ncut(positions, options, &mut |_| true).unwrap()
}

fn truth() -> Vec<usize> {
    (0..N).map(|track| track % 3).collect()
}

/// Z1 and the sums written out: all weights of the graph, and which there are. Where frames are missing all tracks are
/// elsewhere afterwards: that is no step.
#[test]
fn weights_are_those_of_the_formula_and_the_largest_are_kept() {
    let whole: Vec<usize> = (0..T).collect();
    let halves: Vec<usize> = (0..30).chain(41..T).collect();
    let thirds: Vec<usize> = (0..T).step_by(3).filter(|frame| !(30..40).contains(frame)).collect();
    for (frames, apart) in [(whole, 1), (halves, 1), (thirds, 3)] {
        assert_weights(&frames, apart);
    }
}

/// Of tracks that are seen in these frames, of which those so far apart follow one another.
fn assert_weights(frames: &[usize], apart: usize) {
    let mut positions = Positions::new(N, T);
    let all = branches(0.5, 1);
    for (track, &frame) in (0..N).flat_map(|track| frames.iter().map(move |frame| (track, frame))) {
        let jump = if frame > 35 && frames.len() < T { 40.0 + (track % 5) as f32 } else { 0.0 };
        positions.set(track, frame, all.get(track, frame).unwrap().map(|v| v + jump));
    }
    let at = |track: usize, frame: usize| positions.get(track, frame).unwrap().map(f64::from);
    let mean = |track: usize| {
        [0, 1].map(|axis| frames.iter().map(|&t| at(track, t)[axis]).sum::<f64>() / frames.len() as f64)
    };
    let follow = || frames.iter().filter(|&&t| frames.contains(&(t + apart)));
    let steps = |track: usize| -> Vec<[f64; 2]> {
        let step = |t: usize| [0, 1].map(|axis| at(track, t + apart)[axis] - at(track, t)[axis]);
        let steps: Vec<[f64; 2]> = follow().map(|&t| step(t)).collect();
        let mean = [0, 1].map(|axis| steps.iter().map(|v| v[axis]).sum::<f64>() / steps.len() as f64);
        steps.iter().map(|v| [v[0] - mean[0], v[1] - mean[1]]).collect()
    };
    let rho = |i: usize, j: usize| {
        let (a, b) = (steps(i), steps(j));
        let re: f64 = a.iter().zip(&b).map(|(a, b)| a[0] * b[0] + a[1] * b[1]).sum();
        let im: f64 = a.iter().zip(&b).map(|(a, b)| a[1] * b[0] - a[0] * b[1]).sum();
        let square = |v: &[[f64; 2]]| v.iter().map(|v| v[0] * v[0] + v[1] * v[1]).sum::<f64>();
        re.hypot(im) / (square(&a) * square(&b)).sqrt()
    };
    let far = |i: usize, j: usize| (mean(i)[0] - mean(j)[0]).hypot(mean(i)[1] - mean(j)[1]);
    let pairs = || (0..N).flat_map(|i| (0..N).map(move |j| (i, j)));
    let s = (pairs().map(|(i, j)| far(i, j).powi(2)).sum::<f64>() / (N * N) as f64).sqrt();
    let table = Table::new(&positions, &mut |_| true).unwrap();
    for weight in [0.0, 1.0, 2.5] {
        let wanted =
            DMatrix::from_fn(N, N, |i, j| rho(i, j) * (-0.5 * (weight * far(i, j) / s).powi(2)).exp());
        let tracks = Tracks::new(&table, table.series(), weight);
        let whole = dense(&tracks.graph(N, &mut |_| true).unwrap());
        assert!((&whole - &wanted).amax() < 1e-5, "{weight}: {}", (whole - wanted).amax());
        let few = dense(&tracks.graph(5, &mut |_| true).unwrap());
        for i in 0..N {
            let rank =
                |i: usize, j: usize| (0..N).filter(|&k| k != i && whole[(i, k)] > whole[(i, j)]).count();
            for j in (0..N).filter(|&j| j != i) {
                let is_kept = rank(i, j) < 5 || rank(j, i) < 5;
                let wanted = if is_kept { whole[(i, j)] } else { 0.0 };
                assert!((few[(i, j)] - wanted).abs() < 1e-15, "{i} {j}: {} {wanted}", few[(i, j)]);
            }
        }
    }
}

#[test]
fn branches_are_found_and_noise_is_taken_off_where_it_hides_them() {
    let movement = Options { position_weight: 0.0, order: Order::Cuts, ..Options::default() };
    assert_groups(&of(&branches(0.05, 2), &movement).tree, &truth());
    assert_groups(&of(&branches(0.05, 2), &Options { n_neighbours: 8, ..movement }).tree, &truth());
    let noisy = branches(2.0, 3);
    let score = |denoises| {
        let found = of(&noisy, &Options { denoises, ..movement });
        assert_eq!(found.n_components.is_some(), denoises);
        let wanted: Vec<u32> = truth().iter().map(|&group| group as u32).collect();
        crate::score::adjusted_rand_index(&found.tree.cut(3), &wanted).unwrap()
    };
    assert!(score(true) > 0.9 && score(false) < 0.7, "{} {}", score(true), score(false));
}

/// Errata Z1: turning the picture, or a track going the other way, does not change what is alike.
#[test]
fn a_circle_is_like_itself_and_not_like_its_mirror_image() {
    let mut positions = Positions::new(4, 60);
    for frame in 0..60 {
        let (sin, cos) = (std::f64::consts::TAU * frame as f64 / 12.0).sin_cos();
        let circles = [[cos, sin], [-sin, cos], [3.0 * cos, -3.0 * sin], [cos, -sin]];
        for (track, at) in circles.into_iter().enumerate() {
            positions.set(track, frame, at.map(|v| (100.0 + v) as f32));
        }
    }
    let table = Table::new(&positions, &mut |_| true).unwrap();
    let w = dense(&Tracks::new(&table, table.series(), 0.0).graph(3, &mut |_| true).unwrap());
    assert!(w[(0, 1)] > 0.999 && w[(2, 3)] > 0.999 && w[(0, 2)] < 0.05 && w[(1, 3)] < 0.05, "{w}");
}

#[test]
fn tracks_at_rest_in_one_place_never_seen_or_drifting_have_a_place_in_the_hierarchy() {
    // Four sway, three are at rest, two drift evenly and are at rest but for that, one is never seen.
    let mut positions = Positions::new(10, 50);
    for frame in 0..50 {
        let t = frame as f32;
        (0..4).for_each(|k| positions.set(k, frame, [10.0 * k as f32 + (0.4 * t).sin(), 5.0]));
        (4..7).for_each(|k| positions.set(k, frame, [10.0 * k as f32, 50.0]));
        (7..9).for_each(|k| positions.set(k, frame, [10.0 * k as f32 + 0.25 * t, 50.0]));
    }
    let found = of(&positions, &Options { n_levels: 0, ..Options::default() });
    assert_eq!((found.n_unseen, found.n_groups), (1, 3));
    assert_groups(&found.tree, &[0, 0, 0, 0, 1, 1, 1, 1, 1, 2]);
    // All the same: one group, at no height.
    let mut same = Positions::new(48, 30);
    (0..48 * 30).for_each(|k| same.set(k / 30, k % 30, [(0.5 * (k % 30) as f32).sin(), 1.0]));
    for denoises in [false, true] {
        let found = of(&same, &Options { denoises, ..Options::default() });
        assert_eq!(found.n_groups, 1);
        assert!(found.tree.merges().iter().all(|merge| merge.height < 1e-6), "{:?}", found.tree);
    }
    // Nothing moves: place alone.
    let mut still = Positions::new(6, 30);
    let x = [0.0, 1.0, 2.0, 500.0, 501.0, 502.0];
    (0..6 * 30).for_each(|k| still.set(k / 30, k % 30, [x[k / 30], 1.0]));
    for denoises in [false, true] {
        let found =
            of(&still, &Options { denoises, position_weight: 3.0, n_levels: 1, ..Options::default() });
        assert_groups(&found.tree, &[0, 0, 0, 1, 1, 1]);
    }
}

#[test]
fn the_same_bits_for_any_number_of_threads_and_what_cannot_be_done_is_said() {
    let positions = branches(0.3, 6);
    let options = Options { n_neighbours: 7, ..Options::default() };
    let with = |n_threads| of(&positions, &Options { n_threads, ..options });
    let one = with(1);
    assert!([0, 2, 3].iter().all(|&n| with(n) == one));
    let refused = |positions: &Positions, options: &Options| {
        ncut(positions, options, &mut |_| true).unwrap_err().to_string()
    };
    for came in [-1.0, f64::NAN, f64::INFINITY] {
        let said = refused(&positions, &Options { position_weight: came, ..options });
        assert!(said.starts_with("the weight of position"), "{said}");
    }
    assert_eq!(refused(&Positions::new(1, 9), &options), "grouping needs at least 2 tracks, came 1");
    assert_eq!(refused(&Positions::new(3, 1), &options), "movement needs at least 2 frames, came 1");
    let mut shares = Vec::new();
    let stopped = ncut(&positions, &options, &mut |done| {
        shares.push(done);
        done < 0.7
    });
    assert_eq!(stopped, Err(MotionError::Stopped));
    assert!(shares.is_sorted() && shares.iter().all(|done| (0.0..=1.0).contains(done)), "{shares:?}");
}

/// Sums over threads and vectors of processors: the graph of many tracks is the same with one and with several.
#[test]
fn a_large_graph_has_the_same_bits_for_any_number_of_threads() {
    let n = 1500;
    let mut rng = Pcg64Mcg::seed_from_u64(8);
    let mut positions = Positions::new(n, 20);
    for track in 0..n {
        let at: [f32; 2] = [rng.random_range(0.0..900.0), rng.random_range(0.0..700.0)];
        for frame in 0..20 {
            positions.set(
                track,
                frame,
                at.map(|v| v + rng.random_range(-1.0..1.0) + (frame as f32 + v / 300.0).sin()),
            );
        }
    }
    let options = Options { n_neighbours: 12, n_levels: 6, position_weight: 4.0, ..Options::default() };
    let with = |n_threads| of(&positions, &Options { n_threads, ..options });
    let one = with(1);
    assert!(
        one == with(3) && one.residual <= 1e-7 && one.n_groups == 64,
        "{} {}",
        one.residual,
        one.n_groups
    );
}
