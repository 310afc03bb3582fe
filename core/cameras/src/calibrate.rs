//! A camera's numbers, from views of a plane.

use serde::{Deserialize, Serialize};

use crate::bundle::{Bundle, Focal, Model, rms};
use crate::camera::{N_NUMBERS, NUMBERS, middle};
use crate::least::{Fitted, Loss};
use crate::target::{Sighting, Target};
use crate::{Camera, CameraError, Pose, planar, zhang};

/// How cameras are calibrated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Options {
    /// Which numbers are looked for.
    pub model: Model,
    /// What offsets cost.
    pub loss: Loss,
}

impl Options {
    /// For boards: all numbers, least squares, as OpenCV does it.
    pub const BOARD: Self = Self { model: Model::WHOLE, loss: Loss::Squares };
    /// For bars: the focal length, and targets that were taken for others hardly count.
    pub const BARS: Self = Self { model: Model::FOCAL, loss: Loss::Huber(2.0) };
}

/// A calibrated camera.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Its numbers.
    pub camera: Camera,
    /// Their standard errors, in the order of [`Camera::numbers`]; 0 of those that were not looked for.
    pub errors: [f64; N_NUMBERS],
    /// Root mean square distance between what was seen and what should have been, pixels.
    pub rms_px: f64,
    /// Standard deviation of one coordinate of what was seen, pixels: it, and not `rms_px`, leaves out what fitting took. 0 where
    /// there are as many numbers as parameters.
    pub sigma_px: f64,
    /// Each view, in their order.
    pub views: Vec<Standing>,
}

/// How the target stood in a view.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Standing {
    /// `camera_from_target`, in the target's unit.
    pub pose: Pose,
    /// Root mean square distance in this view, pixels.
    pub rms_px: f64,
    /// The greatest, pixels.
    pub worst_px: f64,
}

/// Calibrates a camera with pictures of this size, pixels, from views of a target.
///
/// Zhang's closed form gives a start (with a free centre, and with one in the middle; what comes to fit better is kept), each
/// view's pose is found from its homography, and all are fitted together.
///
/// # Errors
/// [`CameraError::View`] of a view that says too little; [`CameraError::TooFewViews`]; [`CameraError::TooLittle`] where all points together
/// are too few; [`CameraError::SameView`] of a view that was given twice; [`CameraError::Alike`] where views do not tell focal length or centre, as when all are parallel; [`CameraError::Restless`] and [`CameraError::Behind`] where nothing fits.
pub fn calibrate(
    target: &Target,
    views: &[Sighting],
    size: [u32; 2],
    options: &Options,
) -> Result<Calibration, CameraError> {
    let wanted = options.model.fewest_views();
    if views.len() < wanted {
        return Err(CameraError::TooFewViews { wanted, came: views.len() });
    }
    for (second, sighting) in views.iter().enumerate() {
        if let Some(first) = views[..second].iter().position(|other| other == sighting) {
            return Err(CameraError::SameView { first, second });
        }
    }
    let in_view = |view: usize| move |source| CameraError::View { view, source: Box::new(source) };
    let seen_as = |(view, sighting): (usize, &Sighting)| target.seen_as(sighting).map_err(in_view(view));
    let homographies = views.iter().enumerate().map(seen_as).collect::<Result<Vec<_>, _>>()?;
    // Two numbers a point, less six of how the target stands in each view.
    let (n_points, n_views) = (views.iter().map(Vec::len).sum::<usize>(), views.len());
    let (wanted, told) = (options.model.n_numbers(), (2 * n_points).saturating_sub(6 * n_views));
    if told < wanted {
        return Err(CameraError::TooLittle { n_points, n_views, told, wanted });
    }
    let mut starts: Vec<Camera> =
        zhang::starts(&homographies, size).iter().map(|c| options.model.start(c, size)).collect();
    if starts.is_empty() {
        // Noise has the closed forms say that a focal length is imaginary, which a fit may still find.
        let focal = f64::from(size[0] + size[1]) / 2.0;
        starts.push(Camera::pinhole(focal, middle(size)));
    }
    let sightings: Vec<Vec<Sighting>> = views.iter().map(|view| vec![view.clone()]).collect();
    let tried = starts.into_iter().map(|start| from_start(target, &sightings, start, options));
    let mut best: Result<Fitted<Bundle<'_>>, CameraError> = Err(CameraError::Behind);
    for fitted in tried {
        best = match (best, fitted) {
            (Ok(best), Ok(fitted)) => Ok(if fitted.cost < best.cost { fitted } else { best }),
            (Ok(best), Err(_)) => Ok(best),
            (Err(_), fitted) => fitted,
        };
    }
    let fitted = best?;
    determined(&fitted, 0, size)?;
    Ok(report(&fitted))
}

/// Poses before a start, everything together, and again where a plane may have leaned the other way.
fn from_start<'a>(
    target: &'a Target,
    views: &'a [Vec<Sighting>],
    start: Camera,
    options: &Options,
) -> Result<Fitted<Bundle<'a>>, CameraError> {
    /// One comes to rest in two rounds, if planes lean the other way under the first camera.
    const ROUNDS: usize = 4;
    let poses_before = |camera: &Camera| {
        views
            .iter()
            .map(|view| planar::pose(camera, target, &view[0], options.loss))
            .collect::<Result<Vec<_>, _>>()
    };
    let fit = |camera: Camera, poses: Vec<Pose>| {
        let cameras = [(camera, options.model)];
        Bundle::new(target, views, &cameras, vec![Pose::identity()], poses).fit(options.loss)
    };
    let mut fitted = fit(start, poses_before(&start)?)?;
    for _ in 0..ROUNDS {
        let camera = fitted.problem.cameras[0];
        let Ok(poses) = poses_before(&camera) else { break };
        let turned = |(a, b): (&Pose, &Pose)| a.rotation.angle_to(&b.rotation) > 0.05;
        if !poses.iter().zip(&fitted.problem.first_from_target).any(turned) {
            break;
        }
        match fit(camera, poses) {
            Ok(again) if again.cost < fitted.cost => fitted = again,
            _ => break,
        }
    }
    Ok(fitted)
}

impl Model {
    /// A camera to start from, with what is not looked for as it must be.
    fn start(self, found: &Camera, size: [u32; 2]) -> Camera {
        let mut camera = *found;
        if self.focal == Focal::Square {
            let focal = (camera.fx * camera.fy).sqrt();
            (camera.fx, camera.fy) = (focal, focal);
        }
        if !self.centre {
            let middle = middle(size);
            (camera.cx, camera.cy) = (middle.x, middle.y);
        }
        camera
    }
}

/// Whether the views tell a camera's focal lengths and centre.
pub(crate) fn determined(
    fitted: &Fitted<Bundle<'_>>,
    camera: usize,
    size: [u32; 2],
) -> Result<(), CameraError> {
    /// Nobody sees corners better, pixels.
    const BEST_PX: f64 = 0.05;
    /// Standard error of a number that is not told, of the focal length or the picture's size.
    const UNTOLD: f64 = 0.05;
    let found = &fitted.problem.cameras[camera];
    let errors = fitted.errors(camera, fitted.sigma_px.max(BEST_PX));
    let whole = [found.fx, found.fy, f64::from(size[0]), f64::from(size[1])];
    let shares = errors.iter().zip(whole).map(|(error, whole)| error / whole);
    let worst = shares.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    match worst {
        _ if !found.is_sound() => Err(CameraError::Alike { number: NUMBERS[0], share: f64::INFINITY }),
        Some((number, share)) if share > UNTOLD => Err(CameraError::Alike { number: NUMBERS[number], share }),
        _ => Ok(()),
    }
}

fn report(fitted: &Fitted<Bundle<'_>>) -> Calibration {
    let squares = |view: usize| fitted.offsets[view].iter().map(nalgebra::Vector2::norm_squared);
    let stand = |(view, &pose): (usize, &Pose)| Standing {
        pose,
        rms_px: rms(squares(view)),
        worst_px: squares(view).fold(0.0, f64::max).sqrt(),
    };
    Calibration {
        camera: fitted.problem.cameras[0],
        errors: fitted.errors(0, fitted.sigma_px),
        rms_px: fitted.rms_px(),
        sigma_px: fitted.sigma_px,
        views: fitted.problem.first_from_target.iter().enumerate().map(stand).collect(),
    }
}

#[cfg(test)]
mod tests;
