//! A plant that moves by itself: filmed as it is, with leaves on the ends of its branches.

use std::sync::Arc;

use crate::geometry::{Frame, Point};
use crate::plant::Plant;
use crate::pose::{LeafPose, Pose};
use crate::settings::{Settings, SynthError};

/// Share of the picture's width and height that the plant moves in, and of the height below which it stands.
const FILLED: f64 = 0.9;
const GROUND: f64 = 0.97;
/// Radius of the thinnest branches, pixels.
const THINNEST_PX: f64 = 0.6;

/// Where the nodes of a plant are in every frame, seen from the side.
#[derive(Clone, Debug, PartialEq)]
pub struct Moving {
    /// The node before each; `None` for the root, the first.
    pub parents: Vec<Option<u32>>,
    /// Of the segment that leads to each, metres.
    pub radii: Vec<f64>,
    /// Of every frame, where every node is: metres to the right and up.
    pub frames: Vec<Vec<[f64; 2]>>,
}

/// The same in the picture.
#[derive(Clone, Debug)]
pub(crate) struct Given {
    /// Ends of every branch, as rows of the nodes.
    ends: Arc<[[usize; 2]]>,
    /// Of every frame.
    places: Vec<Vec<Point>>,
}

/// A branch at rest: its ends and its radius, pixels; whether it bears leaves.
pub(crate) struct Stick {
    pub(crate) ends: [Point; 2],
    pub(crate) radius_px: f64,
    pub(crate) is_end: bool,
}

impl Moving {
    /// Into the picture, as large as fits; with the branches as they are in the first frame.
    pub(crate) fn given(&self, settings: &Settings) -> Result<(Given, Vec<Stick>), SynthError> {
        let n = self.parents.len();
        let is_tree = (1..n).all(|k| self.parents[k].is_some_and(|parent| (parent as usize) < k));
        let is_whole = n > 1 && is_tree && self.radii.len() == n && self.frames.iter().all(|f| f.len() == n);
        let numbers = self.frames.iter().flatten().flatten().chain(&self.radii);
        if !is_whole
            || self.frames.len() != settings.n_frames as usize
            || !numbers.clone().all(|v| v.is_finite())
        {
            return Err(SynthError::Moving { n_nodes: n, n_frames: self.frames.len() });
        }
        let span = |axis: usize| {
            let values = self.frames.iter().flatten().map(|at| at[axis]);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
        };
        let ((left, right), (low, high)) = (span(0), span(1));
        let (width, height) = (f64::from(settings.width), f64::from(settings.height));
        let fits = (FILLED * width / (right - left).max(1e-9)).min(FILLED * height / (high - low).max(1e-9));
        let shown = |at: &[f64; 2]| {
            let across = at[0] - f64::midpoint(left, right);
            Point::new(width / 2.0 + fits * across, GROUND * height - fits * (at[1] - low))
        };
        let places: Vec<Vec<Point>> =
            self.frames.iter().map(|frame| frame.iter().map(shown).collect()).collect();
        let mut is_end = vec![true; n];
        self.parents.iter().flatten().for_each(|parent| is_end[*parent as usize] = false);
        let ends: Vec<[usize; 2]> = self
            .parents
            .iter()
            .enumerate()
            .filter_map(|(k, parent)| Some([(*parent)? as usize, k]))
            .collect();
        let sticks = ends.iter().map(|[base, tip]| Stick {
            ends: [places[0][*base], places[0][*tip]],
            radius_px: (fits * self.radii[*tip]).max(THINNEST_PX),
            is_end: is_end[*tip],
        });
        let sticks = sticks.collect();
        Ok((Given { ends: ends.into(), places }, sticks))
    }
}

impl Given {
    /// The plant in a frame: leaves are as stiff as what bears them.
    pub(crate) fn pose(&self, plant: &Plant, frame: u32) -> Pose {
        let places = &self.places[frame as usize];
        let branches: Vec<Frame> = self
            .ends
            .iter()
            .map(|[base, tip]| {
                let way = places[*tip] - places[*base];
                Frame::new(places[*base], way.y.atan2(way.x))
            })
            .collect();
        let leaf = |leaf: &crate::plant::Leaf| {
            let carrier = branches[leaf.branch];
            let angle_rad = carrier.angle_rad + leaf.turn_rad;
            let centre = carrier.out(leaf.base) + Point::unit(angle_rad) * leaf.reach_px();
            LeafPose { frame: Frame::new(centre, angle_rad), roll_rad: leaf.roll_rad }
        };
        let leaves = plant.leaves.iter().map(leaf).collect();
        Pose { branches, leaves }
    }
}
