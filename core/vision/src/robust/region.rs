//! Regions that move as most of their nodes do.

use super::{Degenerate, Mode, Params, mode, spread_px};
use crate::klt;
use crate::pyramid::Pyramid;
use crate::work::{in_looks, shared, threads};
use crate::{Gray, Point};

/// How regions are followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Radius of a region, pixels.
    pub radius_px: u32,
    /// Distance between nodes, pixels, at least 1. Nodes stand on one lattice of the picture that all regions share.
    pub step_px: u32,
    /// How a node is followed.
    pub klt: klt::Params,
    /// How nodes come to agree.
    pub mode: Params,
}

/// Where the centre of a region went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moved {
    /// Position in the next picture; where it was, unless it was found. Finite if that was.
    pub to: Point,
    /// Whether it was found.
    pub state: State,
    /// Share of its nodes that decided, 0..=1: samples that count by the kernel ([`Mode::effective`]), of the nodes in the
    /// picture.
    pub share: f64,
    /// How far those that decided are apart, pixels ([`spread_px`]).
    pub spread_px: f64,
}

/// Whether a region was found in the next picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Found.
    Tracked,
    /// Its centre is, or went, beyond the picture, or most of its nodes did.
    Outside,
    /// The displacements of its nodes have no mode. Nodes without texture have no displacement.
    Lost(Degenerate),
}

/// Follows the centres of regions from one picture to the next, on up to `max_threads` threads.
///
/// One entry a centre, in order, the same bits for any number of threads. `go_on` is told the share that is done and
/// may end the work: then there is no answer.
///
/// # Panics
/// As [`klt::track`].
#[track_caller]
pub fn follow(
    [prev, next]: [&Pyramid; 2],
    centres: &[Point],
    region: &Region,
    max_threads: usize,
    go_on: &mut dyn FnMut(f64) -> bool,
) -> Option<Vec<Moved>> {
    /// For a node of a region: to find it, and to weigh its displacement in every step to the mode.
    const FIND_NS: f64 = 5.0;
    const WEIGH_NS: f64 = 150.0;
    let mut lattice = Lattice::new(prev.picture(), region);
    let n_nodes = f64::from(2 * region.radius_px / lattice.step + 1).powi(2);
    // Shares of the time: most of it goes to the nodes.
    let nodes =
        in_looks(centres, FIND_NS * n_nodes, &mut |share| go_on(0.1 * share), |part| lattice.need(part))?;
    let flows = in_looks(&nodes, region.klt.cost_ns(), &mut |share| go_on(0.1 + 0.7 * share), |part| {
        klt::track(prev, next, part, None, &region.klt, max_threads)
    })?;
    let look = Look { lattice: &lattice, nodes: &nodes, flows: &flows, region };
    let cost_ns = WEIGH_NS * n_nodes;
    in_looks(centres, cost_ns, &mut |share| go_on(0.8 + 0.2 * share), |part| {
        let mut moved: Vec<_> = part.iter().map(|&centre| stays(centre, State::Outside)).collect();
        shared([&mut moved], 1, threads(part.len(), cost_ns, max_threads), |_, [moved]| {
            moved.iter_mut().for_each(|moved| *moved = look.one(moved.to));
        });
        moved
    })
}

/// A region that was not found.
fn stays(centre: Point, state: State) -> Moved {
    Moved { to: centre, state, share: 0.0, spread_px: 0.0 }
}

/// The nodes of a picture, and which of them are followed.
struct Lattice<'a> {
    picture: Gray<'a>,
    step: u32,
    radius: f32,
    /// Nodes in x and y.
    n: [u32; 2],
    /// Number of each node among those that are followed, row-major.
    numbers: Vec<Option<u32>>,
    n_needed: u32,
}

impl<'a> Lattice<'a> {
    fn new(picture: Gray<'a>, region: &Region) -> Self {
        let step = region.step_px.max(1);
        let n = [picture.width, picture.height].map(|size| size.div_ceil(step));
        let numbers = vec![None; n[0] as usize * n[1] as usize];
        Self { picture, step, radius: region.radius_px as f32, n, numbers, n_needed: 0 }
    }

    /// Nodes of a region, as indices and positions.
    fn around(&self, centre: Point) -> impl Iterator<Item = (usize, Point)> {
        // A centre that is no number has no nodes: it is in no range.
        let along = |axis: usize| {
            let step = self.step as f32;
            let first = ((centre[axis] - self.radius) / step).ceil().max(0.0);
            let last = ((centre[axis] + self.radius) / step).floor().min(self.n[axis] as f32 - 1.0);
            if first <= last { first as u32..last as u32 + 1 } else { 0..0 }
        };
        let (columns, rows) = (along(0), along(1));
        let at = move |x: u32, y: u32| [(x * self.step) as f32, (y * self.step) as f32];
        let all = rows.flat_map(move |y| columns.clone().map(move |x| (x, y)));
        all.filter_map(move |(x, y)| {
            let node = at(x, y);
            let is_in = (node[0] - centre[0]).hypot(node[1] - centre[1]) <= self.radius;
            is_in.then_some(((y * self.n[0] + x) as usize, node))
        })
    }

    /// Numbers the nodes of these regions that have none yet, and returns them.
    fn need(&mut self, centres: &[Point]) -> Vec<Point> {
        let mut nodes = Vec::new();
        for &centre in centres {
            let found: Vec<_> = self.around(centre).collect();
            for (index, at) in found {
                if self.numbers[index].is_none() {
                    self.numbers[index] = Some(self.n_needed);
                    self.n_needed += 1;
                    nodes.push(at);
                }
            }
        }
        nodes
    }
}

/// What is known of the nodes of a picture.
struct Look<'a> {
    lattice: &'a Lattice<'a>,
    nodes: &'a [Point],
    flows: &'a [klt::Flow],
    region: &'a Region,
}

impl Look<'_> {
    fn one(&self, centre: Point) -> Moved {
        if !centre.iter().all(|c| c.is_finite()) {
            return stays(centre, State::Lost(Degenerate::NotFinite));
        }
        if !self.lattice.picture.holds(centre) {
            return stays(centre, State::Outside);
        }
        let numbers = self.lattice.around(centre).filter_map(|(index, _)| self.lattice.numbers[index]);
        let (mut n_nodes, mut n_outside, mut samples) = (0, 0, Vec::new());
        for k in numbers.map(|k| k as usize) {
            n_nodes += 1;
            let (from, flow) = (self.nodes[k], self.flows[k]);
            match flow.state {
                klt::State::Tracked => {
                    samples.push([0, 1].map(|axis| f64::from(flow.to[axis]) - f64::from(from[axis])));
                }
                klt::State::Outside => n_outside += 1,
                klt::State::Lost(_) => {}
            }
        }
        if n_outside > samples.len() {
            return stays(centre, State::Outside);
        }
        let Mode { at, covariance, effective, .. } = match mode(&samples, &self.region.mode) {
            Ok(mode) => mode,
            Err(fault) => return stays(centre, State::Lost(fault)),
        };
        let to = [0, 1].map(|axis| (f64::from(centre[axis]) + at[axis]) as f32);
        let state = if self.lattice.picture.holds(to) { State::Tracked } else { State::Outside };
        Moved { to, state, share: effective / f64::from(n_nodes), spread_px: spread_px(covariance) }
    }
}
