//! Who covers whom: which leaf centres are in the picture and under no nearer leaf or branch.

use crate::geometry::Point;
use crate::outline::{BranchOutline, LeafOutline, Outline};
use crate::plant::{Item, Plant};
use crate::pose::Pose;
use crate::settings::Settings;
use crate::truth::At;

/// Side of a cell of the grid, pixels.
const CELL_PX: f64 = 24.0;

/// The leaves of one frame, sorted into cells of the picture.
pub(crate) struct Cover<'a> {
    plant: &'a Plant,
    pose: &'a Pose,
    size_px: Point,
    /// Place of each leaf and each branch from far to near.
    leaf_rank: Vec<usize>,
    branch_rank: Vec<usize>,
    n_columns: usize,
    /// Leaves that may reach into each cell.
    cells: Vec<Vec<u32>>,
}

impl<'a> Cover<'a> {
    pub(crate) fn new(settings: &Settings, plant: &'a Plant, pose: &'a Pose) -> Self {
        let size_px = Point::new(f64::from(settings.width), f64::from(settings.height));
        let n_columns = (size_px.x / CELL_PX).ceil() as usize;
        let n_rows = (size_px.y / CELL_PX).ceil() as usize;
        let mut leaf_rank = vec![0; plant.leaves.len()];
        let mut branch_rank = vec![0; plant.branches.len()];
        for (rank, item) in plant.order.iter().enumerate() {
            match *item {
                Item::Leaf(leaf) => leaf_rank[leaf] = rank,
                Item::Branch(branch) => branch_rank[branch] = rank,
            }
        }
        let mut cells = vec![Vec::new(); n_columns * n_rows];
        for (id, (leaf, at)) in (0_u32..).zip(plant.leaves.iter().zip(&pose.leaves)) {
            // The petiole is the longest way from the centre.
            let reach_px = leaf.reach_px() + 1.0;
            let span = |centre: f64, n: usize| {
                let cell = |px: f64| ((px + 0.5) / CELL_PX).floor().clamp(-1.0, n as f64) as isize;
                let (first, last) = (cell(centre - reach_px), cell(centre + reach_px));
                first.max(0) as usize..(last + 1).clamp(0, n as isize) as usize
            };
            for row in span(at.frame.origin.y, n_rows) {
                for column in span(at.frame.origin.x, n_columns) {
                    cells[row * n_columns + column].push(id);
                }
            }
        }
        Self { plant, pose, size_px, leaf_rank, branch_rank, n_columns, cells }
    }

    /// Where every leaf is, and whether it is seen.
    pub(crate) fn observe(&self) -> Vec<At> {
        let leaves = self.pose.leaves.iter().zip(&self.leaf_rank);
        leaves
            .map(|(leaf, &rank)| {
                let centre = leaf.frame.origin;
                At { x: centre.x, y: centre.y, visible: self.inside(centre) && !self.covered(centre, rank) }
            })
            .collect()
    }

    fn inside(&self, at: Point) -> bool {
        (-0.5..self.size_px.x - 0.5).contains(&at.x) && (-0.5..self.size_px.y - 0.5).contains(&at.y)
    }

    /// Whether anything nearer than `rank` lies over a place of the picture.
    fn covered(&self, at: Point, rank: usize) -> bool {
        let cell = |px: f64| ((px + 0.5) / CELL_PX) as usize;
        let here = &self.cells[cell(at.y) * self.n_columns + cell(at.x)];
        let by_leaf = here.iter().map(|&id| id as usize).any(|id| {
            let (leaf, pose) = (&self.plant.leaves[id], &self.pose.leaves[id]);
            self.leaf_rank[id] > rank && {
                let local = pose.frame.into_local(at);
                LeafOutline::new(leaf, pose).depth_px(local.x as f32, local.y as f32) > 0.0
            }
        });
        by_leaf
            || self.plant.branches.iter().zip(&self.pose.branches).zip(&self.branch_rank).any(
                |((branch, frame), &branch_rank)| {
                    let local = frame.into_local(at);
                    branch_rank > rank
                        && BranchOutline::new(branch).depth_px(local.x as f32, local.y as f32) > 0.0
                },
            )
    }
}
