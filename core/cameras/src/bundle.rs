//! Cameras and poses of a target, all together: bundle adjustment.

use nalgebra::{DMatrix, DVector, Vector6};
use serde::{Deserialize, Serialize};

use crate::camera::N_NUMBERS;
use crate::least::{self, Block, Fitted, Loss, Problem, Unfitted};
use crate::planar::put;
use crate::target::{Sighting, Target};
use crate::{Camera, CameraError, Pose};

/// Which numbers of a camera are looked for; the others stay as they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Model {
    /// Focal lengths.
    pub focal: Focal,
    /// Where the axis meets the picture; without, it stays in the middle.
    pub centre: bool,
    /// How many of k1, k2, k3, 0..=3.
    pub radial: u8,
    /// p1 and p2.
    pub tangential: bool,
}

/// Which focal lengths are looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Focal {
    /// None.
    Kept,
    /// One for both: pixels are square.
    Square,
    /// One each.
    Free,
}

impl Model {
    /// All nine, as boards bear that fill the picture: what OpenCV looks for.
    pub const WHOLE: Self = Self { focal: Focal::Free, centre: true, radial: 3, tangential: true };
    /// The focal length alone, as the few points of bars bear.
    pub const FOCAL: Self = Self { focal: Focal::Square, centre: false, radial: 0, tangential: false };
    /// Nothing.
    pub const KEPT: Self = Self { focal: Focal::Kept, centre: false, radial: 0, tangential: false };

    /// Numbers of a camera by what is looked for, `(9, n)`.
    fn columns(self) -> DMatrix<f64> {
        let focal: &[&[usize]] = match self.focal {
            Focal::Kept => &[],
            Focal::Square => &[&[0, 1]],
            Focal::Free => &[&[0], &[1]],
        };
        let centre: &[&[usize]] = if self.centre { &[&[2], &[3]] } else { &[] };
        let radial: &[&[usize]] = &[&[4], &[5], &[8]];
        let tangential: &[&[usize]] = if self.tangential { &[&[6], &[7]] } else { &[] };
        let radial = &radial[..usize::from(self.radial).min(3)];
        let all: Vec<&[usize]> = [focal, centre, radial, tangential].concat();
        let mut columns = DMatrix::zeros(N_NUMBERS, all.len());
        for (column, rows) in all.into_iter().enumerate() {
            rows.iter().for_each(|&row| columns[(row, column)] = 1.0);
        }
        columns
    }

    /// How many numbers are looked for.
    pub(crate) fn n_numbers(self) -> usize {
        self.columns().ncols()
    }

    /// How many views of a plane it takes: each gives two equations for focal lengths and centre.
    pub(crate) fn fewest_views(self) -> usize {
        let focal = match self.focal {
            Focal::Kept => 0,
            Focal::Square => 1,
            Focal::Free => 2,
        };
        let centre = if self.centre { 2 } else { 0 };
        usize::div_ceil(focal + centre, 2).max(1)
    }
}

/// Cameras that stand still together, and a target that is moved before them.
#[derive(Clone)]
pub(crate) struct Bundle<'a> {
    pub(crate) target: &'a Target,
    /// What each camera saw in each view, by view and camera.
    pub(crate) views: &'a [Vec<Sighting>],
    pub(crate) cameras: Vec<Camera>,
    columns: Vec<DMatrix<f64>>,
    /// Of each camera; of the first it is no move, and stays.
    pub(crate) camera_from_first: Vec<Pose>,
    /// Of each view.
    pub(crate) first_from_target: Vec<Pose>,
}

impl<'a> Bundle<'a> {
    pub(crate) fn new(
        target: &'a Target,
        views: &'a [Vec<Sighting>],
        cameras: &[(Camera, Model)],
        camera_from_first: Vec<Pose>,
        first_from_target: Vec<Pose>,
    ) -> Self {
        let columns = cameras.iter().map(|(_, model)| model.columns()).collect();
        let cameras = cameras.iter().map(|&(camera, _)| camera).collect();
        Self { target, views, cameras, columns, camera_from_first, first_from_target }
    }

    /// The first column of a camera's numbers, or, of `cameras.len()`, of the poses.
    fn first_column(&self, camera: usize) -> usize {
        self.columns[..camera].iter().map(DMatrix::ncols).sum()
    }

    fn pose_column(&self, camera: usize) -> usize {
        self.first_column(self.cameras.len()) + 6 * (camera - 1)
    }

    pub(crate) fn fit(self, loss: Loss) -> Result<Fitted<Self>, CameraError> {
        let number = if self.first_column(self.cameras.len()) > 0 { "numbers" } else { "place" };
        least::fit(self, loss).map_err(|why| match why {
            Unfitted::Start => CameraError::Behind,
            Unfitted::Loose => CameraError::Alike { number, share: f64::INFINITY },
            Unfitted::Restless => CameraError::Restless,
        })
    }
}

impl Fitted<Bundle<'_>> {
    /// Standard errors of a camera's numbers, for errors of `sigma_px`; 0 of what was not looked for.
    pub(crate) fn errors(&self, camera: usize, sigma_px: f64) -> [f64; N_NUMBERS] {
        let columns = &self.problem.columns[camera];
        let (first, n) = (self.problem.first_column(camera), columns.ncols());
        let covariance = columns * self.shared.view((first, first), (n, n)) * columns.transpose();
        std::array::from_fn(|k| sigma_px * covariance[(k, k)].max(0.0).sqrt())
    }

    /// Covariance of how a camera stands to the first: turn, radians, and shift.
    pub(crate) fn stand(&self, camera: usize) -> DMatrix<f64> {
        let first = self.problem.pose_column(camera);
        self.shared.view((first, first), (6, 6)) * (self.sigma_px * self.sigma_px)
    }

    /// Root mean square of the offsets, pixels.
    pub(crate) fn rms_px(&self) -> f64 {
        rms(self.offsets.iter().flatten().map(nalgebra::Vector2::norm_squared))
    }
}

pub(crate) fn rms(squares: impl Iterator<Item = f64> + Clone) -> f64 {
    let n = squares.clone().count();
    if n == 0 { 0.0 } else { (squares.sum::<f64>() / n as f64).sqrt() }
}

impl Problem for Bundle<'_> {
    fn n_shared(&self) -> usize {
        self.first_column(self.cameras.len()) + 6 * (self.cameras.len() - 1)
    }

    fn n_own(&self) -> usize {
        6
    }

    fn n_blocks(&self) -> usize {
        self.views.len()
    }

    fn block(&self, view: usize) -> Option<Block> {
        let (sightings, stand) = (&self.views[view], &self.first_from_target[view]);
        let n_seen = sightings.iter().map(Vec::len).sum();
        let mut block = Block::zeros(n_seen, self.n_shared(), 6);
        let mut i = 0;
        for (camera, sighting) in sightings.iter().enumerate() {
            let from_first = &self.camera_from_first[camera];
            for &(point, at) in sighting {
                let place = self.target.place(point);
                let in_first = stand.of(&place);
                let seen = self.cameras[camera].project_with_slopes(&from_first.of(&in_first))?;
                block.offsets[i] = seen.at - at;
                let numbers = seen.by_numbers * &self.columns[camera];
                block
                    .by_shared
                    .view_mut((2 * i, self.first_column(camera)), numbers.shape())
                    .copy_from(&numbers);
                if camera > 0 {
                    let column = self.pose_column(camera);
                    put(
                        &mut block.by_shared,
                        2 * i,
                        column,
                        &(seen.by_place * from_first.by_turn(&in_first)),
                    );
                    put(&mut block.by_shared, 2 * i, column + 3, &seen.by_place);
                }
                let by_first = seen.by_place * from_first.rotation;
                put(&mut block.by_own, 2 * i, 0, &(by_first * stand.by_turn(&place)));
                put(&mut block.by_own, 2 * i, 3, &by_first);
                i += 1;
            }
        }
        Some(block)
    }

    fn stepped(&self, shared: &DVector<f64>, own: &[DVector<f64>]) -> Self {
        let mut next = self.clone();
        for (camera, columns) in self.columns.iter().enumerate() {
            let step = columns * shared.rows(self.first_column(camera), columns.ncols());
            let numbers = self.cameras[camera].numbers();
            next.cameras[camera] = Camera::of(std::array::from_fn(|k| numbers[k] + step[k]));
            if camera > 0 {
                let step = Vector6::from_column_slice(shared.rows(self.pose_column(camera), 6).as_slice());
                next.camera_from_first[camera] = self.camera_from_first[camera].stepped(&step);
            }
        }
        for (pose, step) in next.first_from_target.iter_mut().zip(own) {
            *pose = pose.stepped(&Vector6::from_column_slice(step.as_slice()));
        }
        next
    }
}

#[cfg(test)]
mod tests;
