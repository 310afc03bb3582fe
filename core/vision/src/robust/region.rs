//! Regions that move as most of their nodes do.

use super::{Mode, Params, mode, spread_px};
use crate::Point;
use crate::klt::{self, State};
use crate::pyramid::Pyramid;

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
    /// Whether its nodes have a mode, and whether that leads out of the picture.
    pub state: State,
    /// Share of its nodes that decided, 0..=1: samples that count by the kernel ([`Mode::effective`]), of the nodes in the
    /// picture.
    pub share: f64,
    /// How far those that decided are apart, pixels ([`spread_px`]).
    pub spread_px: f64,
}

/// Nodes that are followed between two looks at whether to go on.
const NODES_A_CHUNK: usize = 2048;
/// Samples that are weighed between two such looks.
const SAMPLES_A_CHUNK: usize = 1 << 17;

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
    /// Of the time, for the nodes.
    const NODES: f64 = 0.8;
    let mut lattice = Lattice::new(prev, region);
    let nodes = lattice.need(centres);
    let mut flows = Vec::with_capacity(nodes.len());
    for chunk in nodes.chunks(NODES_A_CHUNK) {
        if !go_on(NODES * flows.len() as f64 / nodes.len() as f64) {
            return None;
        }
        flows.extend(klt::track(prev, next, chunk, None, &region.klt, max_threads));
    }
    let look = Look { lattice: &lattice, nodes: &nodes, flows: &flows, region };
    let mut moved = Vec::with_capacity(centres.len());
    let side = (2 * region.radius_px / lattice.step + 1) as usize;
    for chunk in centres.chunks((SAMPLES_A_CHUNK / (side * side)).max(1)) {
        if !go_on(NODES + (1.0 - NODES) * moved.len() as f64 / centres.len() as f64) {
            return None;
        }
        moved.extend(look.all(chunk, max_threads));
    }
    Some(moved)
}

/// The nodes of a picture, and which of them are followed.
struct Lattice {
    step: u32,
    radius: f32,
    size: [u32; 2],
    /// Nodes in x and y.
    n: [u32; 2],
    /// Number of each node among those that are followed, row-major.
    numbers: Vec<Option<u32>>,
}

impl Lattice {
    fn new(picture: &Pyramid, region: &Region) -> Self {
        let step = region.step_px.max(1);
        let size = [picture.picture().width, picture.picture().height];
        let n = size.map(|size| size.div_ceil(step));
        let radius = region.radius_px as f32;
        Self { step, radius, size, n, numbers: vec![None; n[0] as usize * n[1] as usize] }
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

    /// Numbers the nodes of all regions, each once, and returns them.
    fn need(&mut self, centres: &[Point]) -> Vec<Point> {
        let mut nodes = Vec::new();
        for &centre in centres {
            let found: Vec<_> = self.around(centre).collect();
            for (index, at) in found {
                if self.numbers[index].is_none() {
                    self.numbers[index] = Some(nodes.len() as u32);
                    nodes.push(at);
                }
            }
        }
        nodes
    }

    fn holds(&self, [x, y]: Point) -> bool {
        let [width, height] = self.size.map(|size| size as f32 - 0.5);
        (-0.5..=width).contains(&x) && (-0.5..=height).contains(&y)
    }
}

/// What is known of the nodes of a picture.
struct Look<'a> {
    lattice: &'a Lattice,
    nodes: &'a [Point],
    flows: &'a [klt::Flow],
    region: &'a Region,
}

impl Look<'_> {
    fn all(&self, centres: &[Point], max_threads: usize) -> Vec<Moved> {
        /// Fewer regions than this are not worth a thread.
        const REGIONS_A_THREAD: usize = 256;
        let n_threads = max_threads.min(centres.len() / REGIONS_A_THREAD).max(1);
        let mut parts = centres.chunks(centres.len().div_ceil(n_threads).max(1));
        let run = |part: &[Point]| part.iter().map(|&centre| self.one(centre)).collect::<Vec<_>>();
        std::thread::scope(|scope| {
            let first = parts.next();
            let others: Vec<_> = parts.map(|part| scope.spawn(move || run(part))).collect();
            let mut moved = first.map(run).unwrap_or_default();
            for other in others {
                match other.join() {
                    Ok(part) => moved.extend(part),
                    Err(panic) => std::panic::resume_unwind(panic),
                }
            }
            moved
        })
    }

    fn one(&self, centre: Point) -> Moved {
        let stays = |state| Moved { to: centre, state, share: 0.0, spread_px: 0.0 };
        if !centre.iter().all(|c| c.is_finite()) {
            return stays(State::Lost(klt::Reason::NotFinite));
        }
        if !self.lattice.holds(centre) {
            return stays(State::Outside);
        }
        let numbers = self.lattice.around(centre).filter_map(|(index, _)| self.lattice.numbers[index]);
        let (mut n_nodes, mut n_outside, mut samples) = (0, 0, Vec::new());
        for k in numbers.map(|k| k as usize) {
            n_nodes += 1;
            let (from, flow) = (self.nodes[k], self.flows[k]);
            match flow.state {
                State::Tracked => {
                    samples.push([0, 1].map(|axis| f64::from(flow.to[axis]) - f64::from(from[axis])));
                }
                State::Outside => n_outside += 1,
                State::Lost(_) => {}
            }
        }
        if n_outside > samples.len() {
            return stays(State::Outside);
        }
        // Nodes without texture say nothing, and one alone cannot be agreed with.
        let Ok(Mode { at, covariance, effective, .. }) = mode(&samples, &self.region.mode) else {
            return stays(State::Lost(klt::Reason::Flat));
        };
        let to = [0, 1].map(|axis| (f64::from(centre[axis]) + at[axis]) as f32);
        let state = if self.lattice.holds(to) { State::Tracked } else { State::Outside };
        Moved { to, state, share: effective / f64::from(n_nodes), spread_px: spread_px(covariance) }
    }
}
