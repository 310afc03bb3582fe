//! Where a plane stands before a known camera.

use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector2, Vector3, Vector6};

use crate::homography::homography;
use crate::least::{self, Block, Loss, Problem};
use crate::target::Target;
use crate::{Camera, CameraError, Pixel, Pose};

/// `camera_from_target`, with the least offsets in the picture.
///
/// From afar, a plane and one that leans the other way look nearly alike (G. Schweighofer, A. Pinz, "Robust pose estimation from a planar
/// target", PAMI 28 (2006)): both are refined, and the one that fits better is given.
///
/// # Errors
/// What [`Target`] and [`homography`] say of too few points, and of points on a line or in mirrored order;
/// [`CameraError::Reach`] of pixels beyond the camera's distortion; [`CameraError::Behind`] where no pose fits.
pub fn pose(
    camera: &Camera,
    target: &Target,
    seen: &[(usize, Pixel)],
    loss: Loss,
) -> Result<Pose, CameraError> {
    Ok(poses(camera, target, seen, loss)?[0].0)
}

/// Both poses that a plane can have, the better first, with the cost of each, px².
pub(crate) fn poses(
    camera: &Camera,
    target: &Target,
    seen: &[(usize, Pixel)],
    loss: Loss,
) -> Result<Vec<(Pose, f64)>, CameraError> {
    target.seen_as(seen)?;
    let places: Vec<_> = seen.iter().map(|&(point, _)| target.place(point).xy()).collect();
    let rays = seen.iter().map(|(_, at)| camera.undistort(at)).collect::<Result<Vec<_>, _>>()?;
    let first = of_homography(&homography(&places, &rays)?);
    let mut found: Vec<(Pose, f64)> = Vec::new();
    let mut start = first;
    for _ in 0..2 {
        let problem = Standing { camera, target, seen, pose: start };
        if let Ok(fitted) = least::fit(problem, loss) {
            found.push((fitted.problem.pose, fitted.cost));
        }
        start = other_way(found.first().map_or(&first, |found| &found.0), &places);
    }
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    if found.is_empty() { Err(CameraError::Behind) } else { Ok(found) }
}

/// The pose whose first two columns and shift a homography to directions has, before the camera.
pub(crate) fn of_homography(h: &Matrix3<f64>) -> Pose {
    let size = (h.column(0).norm() * h.column(1).norm()).sqrt();
    let h = h / size;
    let [right, down] = [h.column(0).into_owned(), h.column(1).into_owned()];
    let turned = Matrix3::from_columns(&[right, down, right.cross(&down)]);
    Pose {
        rotation: Rotation3::from_matrix_eps(&turned, 1e-12, 100, near(&right, &down)),
        translation: h.column(2).into_owned(),
    }
}

/// A turn near one with these first two columns, to start from.
fn near(right: &Vector3<f64>, down: &Vector3<f64>) -> Rotation3<f64> {
    let x = right.try_normalize(0.0).unwrap_or_else(Vector3::x);
    let z = x.cross(down).try_normalize(0.0).unwrap_or_else(Vector3::z);
    Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, z.cross(&x), z]))
}

/// The plane leaning the other way, as seen from the camera: its normal is mirrored about the line of sight to its middle.
fn other_way(pose: &Pose, places: &[Vector2<f64>]) -> Pose {
    let middle = places.iter().sum::<Vector2<f64>>() / places.len() as f64;
    let centre = pose.of(&middle.push(0.0));
    let sight = centre.try_normalize(0.0).unwrap_or_else(Vector3::z);
    let normal = pose.rotation * Vector3::z();
    let mirrored = 2.0 * sight.dot(&normal) * sight - normal;
    let turn = Rotation3::rotation_between(&normal, &mirrored).unwrap_or_else(Rotation3::identity);
    let rotation = turn * pose.rotation;
    Pose { rotation, translation: centre - rotation * middle.push(0.0) }
}

/// A target before a known camera.
#[derive(Clone, Copy)]
struct Standing<'a> {
    camera: &'a Camera,
    target: &'a Target,
    seen: &'a [(usize, Pixel)],
    pose: Pose,
}

impl Problem for Standing<'_> {
    fn n_shared(&self) -> usize {
        0
    }

    fn n_own(&self) -> usize {
        6
    }

    fn n_blocks(&self) -> usize {
        1
    }

    fn block(&self, _: usize) -> Option<Block> {
        let mut block = Block::zeros(self.seen.len(), 0, 6);
        for (i, &(point, at)) in self.seen.iter().enumerate() {
            let place = self.target.place(point);
            let seen = self.camera.project_with_slopes(&self.pose.of(&place))?;
            block.offsets[i] = seen.at - at;
            let by_turn = seen.by_place * self.pose.by_turn(&place);
            put(&mut block.by_own, 2 * i, 0, &by_turn);
            put(&mut block.by_own, 2 * i, 3, &seen.by_place);
        }
        Some(block)
    }

    fn stepped(&self, _: &DVector<f64>, own: &[DVector<f64>]) -> Self {
        Self { pose: self.pose.stepped(&Vector6::from_column_slice(own[0].as_slice())), ..*self }
    }
}

/// Adds a small matrix to a large one.
pub(crate) fn put<const C: usize>(
    to: &mut DMatrix<f64>,
    row: usize,
    column: usize,
    what: &nalgebra::SMatrix<f64, 2, C>,
) {
    let mut there = to.fixed_view_mut::<2, C>(row, column);
    there += what;
}

#[cfg(test)]
mod tests;
