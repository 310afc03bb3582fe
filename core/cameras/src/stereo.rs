//! Two cameras that stand still, from a target that both have seen.

use nalgebra::{Matrix6, Vector3};
use serde::{Deserialize, Serialize};

use crate::bundle::{Bundle, Model, rms};
use crate::calibrate::{self, Calibration, Options, calibrate};
use crate::camera::N_NUMBERS;
use crate::epipolar::Pair;
use crate::least::{Fitted, Loss};
use crate::target::{Sighting, Target};
use crate::{CameraError, Pixel, Pose, planar};

/// Two calibrated cameras, and how they stand.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stereo {
    /// Both cameras, and how they stand.
    pub pair: Pair,
    /// Standard errors of both cameras' numbers, as in [`Calibration`].
    pub errors: [[f64; N_NUMBERS]; 2],
    /// Covariance of how they stand: a further turn of `right_from_left`, radians, and a further shift.
    pub stand: Matrix6<f64>,
    /// Distance of the cameras, in the target's unit.
    pub baseline: f64,
    /// Its standard error.
    pub baseline_error: f64,
    /// Root mean square distance between what was seen and what should have been, pixels, over both.
    pub rms_px: f64,
    /// Standard deviation of one coordinate, pixels.
    pub sigma_px: f64,
    /// How far what both saw is from the epipolar lines, pixels: root mean square.
    pub epipolar_px: f64,
}

impl Stereo {
    /// Standard errors of the turn about the three axes, radians.
    #[must_use]
    pub fn turn_errors_rad(&self) -> [f64; 3] {
        std::array::from_fn(|k| self.stand[(k, k)].max(0.0).sqrt())
    }

    /// Standard errors of the shift, in the target's unit.
    #[must_use]
    pub fn shift_errors(&self) -> [f64; 3] {
        std::array::from_fn(|k| self.stand[(3 + k, 3 + k)].max(0.0).sqrt())
    }
}

/// Calibrates two cameras, whose pictures have these sizes, pixels, by what both saw of a target in each view, left first.
///
/// Each is calibrated alone by all that it saw; then their poses to one another, their numbers and the target's poses are
/// fitted together. A view that one of them missed is an empty list there.
///
/// # Errors
/// [`CameraError::One`] of a camera that cannot be calibrated, [`CameraError::NeverTogether`] where no view was seen by both, and what
/// [`calibrate()`] says.
pub fn stereo(
    target: &Target,
    views: &[[Sighting; 2]],
    sizes: [[u32; 2]; 2],
    options: &Options,
) -> Result<Stereo, CameraError> {
    let alone = |camera: usize| -> Result<Calibration, CameraError> {
        let its: Vec<Sighting> =
            views.iter().map(|view| view[camera].clone()).filter(|s| !s.is_empty()).collect();
        let one = |source| CameraError::One { camera: ["left", "right"][camera], source: Box::new(source) };
        calibrate(target, &its, sizes[camera], options).map_err(one)
    };
    from_cameras(target, views, sizes, [alone(0)?.camera, alone(1)?.camera], options)
}

/// The same of cameras that have been calibrated, each alone by all that it saw.
///
/// # Errors
/// As [`stereo`].
pub fn from_cameras(
    target: &Target,
    views: &[[Sighting; 2]],
    sizes: [[u32; 2]; 2],
    cameras: [crate::Camera; 2],
    options: &Options,
) -> Result<Stereo, CameraError> {
    let lists = lists(views);
    let fitted = together(target, &lists, cameras.map(|camera| (camera, options.model)), options.loss)?;
    for (camera, size) in sizes.into_iter().enumerate() {
        calibrate::determined(&fitted, camera, size)?;
    }
    report(&fitted, views)
}

/// How two cameras stand whose numbers are known.
///
/// # Errors
/// As [`stereo`].
pub fn stand(
    target: &Target,
    views: &[[Sighting; 2]],
    cameras: [crate::Camera; 2],
    loss: Loss,
) -> Result<Stereo, CameraError> {
    let lists = lists(views);
    let fitted = together(target, &lists, cameras.map(|camera| (camera, Model::KEPT)), loss)?;
    report(&fitted, views)
}

fn lists(views: &[[Sighting; 2]]) -> Vec<Vec<Sighting>> {
    views.iter().map(|view| view.to_vec()).filter(|view| view.iter().any(|seen| !seen.is_empty())).collect()
}

/// Both poses that each view can have give ways the cameras may stand; the one under which all views fit best is refined.
fn together<'a>(
    target: &'a Target,
    views: &'a [Vec<Sighting>],
    cameras: [(crate::Camera, Model); 2],
    loss: Loss,
) -> Result<Fitted<Bundle<'a>>, CameraError> {
    let poses = views.iter().enumerate().map(|(view, sightings)| {
        let of = |camera: usize| match &sightings[camera] {
            seen if seen.is_empty() => Ok(Vec::new()),
            seen => planar::poses(&cameras[camera].0, target, seen, loss)
                .map_err(|source| CameraError::View { view, source: Box::new(source) }),
        };
        Ok([of(0)?, of(1)?].map(|poses| poses.into_iter().map(|(pose, _)| pose).collect::<Vec<_>>()))
    });
    let poses: Vec<[Vec<Pose>; 2]> = poses.collect::<Result<_, CameraError>>()?;
    let pairs = poses
        .iter()
        .flat_map(|[left, right]| left.iter().flat_map(move |l| right.iter().map(move |r| (l, r))));
    let candidates = pairs.map(|(left, right)| right.after(&left.inverse()));
    let cost = |right_from_left: &Pose| -> f64 {
        views
            .iter()
            .zip(&poses)
            .map(|(view, poses)| best_pose(target, view, &cameras, poses, right_from_left).1)
            .sum()
    };
    let right_from_left =
        candidates.map(|candidate| (cost(&candidate), candidate)).min_by(|a, b| a.0.total_cmp(&b.0));
    let right_from_left = right_from_left.ok_or(CameraError::NeverTogether)?.1;
    let stands = views
        .iter()
        .zip(&poses)
        .map(|(view, poses)| best_pose(target, view, &cameras, poses, &right_from_left).0);
    Bundle::new(target, views, &cameras, vec![Pose::identity(), right_from_left], stands.collect()).fit(loss)
}

/// Which of a view's poses, as either camera has them, suits both, and the sum of its distances, pixels: not of their squares, so that a
/// view that is wrong does not decide.
fn best_pose(
    target: &Target,
    view: &[Sighting],
    cameras: &[(crate::Camera, Model); 2],
    [left, right]: &[Vec<Pose>; 2],
    right_from_left: &Pose,
) -> (Pose, f64) {
    /// What is not before a camera is as wrong as this, pixels.
    const BEHIND_PX: f64 = 1e4;
    let far = |pose: &Pose| -> f64 {
        let stands = [*pose, right_from_left.after(pose)];
        let seen = view.iter().zip(cameras).zip(stands);
        let offsets = seen.flat_map(|((sighting, (camera, _)), stand)| {
            sighting.iter().map(move |&(point, at)| {
                camera.project(&stand.of(&target.place(point))).map_or(BEHIND_PX, |seen| (seen - at).norm())
            })
        });
        offsets.sum()
    };
    let from_right = right.iter().map(|pose| right_from_left.inverse().after(pose));
    let poses = left.iter().copied().chain(from_right).map(|pose| (pose, far(&pose)));
    // A view has been seen by one of them at least, and each sight has a pose.
    poses.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((Pose::identity(), f64::INFINITY))
}

fn report(fitted: &Fitted<Bundle<'_>>, views: &[[Sighting; 2]]) -> Result<Stereo, CameraError> {
    let bundle = &fitted.problem;
    let right_from_left = bundle.camera_from_first[1];
    let pair = Pair { cameras: [bundle.cameras[0], bundle.cameras[1]], right_from_left };
    let stand: Matrix6<f64> = fitted.stand(1).fixed_view::<6, 6>(0, 0).into_owned();
    let baseline = right_from_left.translation.norm();
    let along: Vector3<f64> = right_from_left.translation / baseline;
    let shift = stand.fixed_view::<3, 3>(3, 3);
    let mut squares = Vec::new();
    for [left, right] in views {
        for (point, at) in left {
            if let Some((_, other)) = right.iter().find(|(same, _)| same == point) {
                let seen: [Pixel; 2] = [*at, *other];
                squares.push(pair.epipolar_px(&seen)?.powi(2));
            }
        }
    }
    Ok(Stereo {
        pair,
        errors: [0, 1].map(|camera| fitted.errors(camera, fitted.sigma_px)),
        stand,
        baseline,
        baseline_error: (along.transpose() * shift * along)[0].max(0.0).sqrt(),
        rms_px: fitted.rms_px(),
        sigma_px: fitted.sigma_px,
        epipolar_px: rms(squares.into_iter()),
    })
}

#[cfg(test)]
mod tests;
