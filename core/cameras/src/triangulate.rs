//! Where in space something is that cameras see.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3, Vector4};

use crate::least::{self, Block, Loss, Problem};
use crate::planar::put;
use crate::{Camera, CameraError, Pixel, Place, Pose};

/// A place, and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fix {
    /// In the axes that the cameras' poses lead from.
    pub place: Place,
    /// Its covariance, for the errors that were given.
    pub covariance: Matrix3<f64>,
    /// Root mean square distance of what the cameras see of it from what should be there, pixels: of one place it is about as
    /// large as the errors, of two that were taken for one larger.
    pub rms_px: f64,
}

impl Fix {
    /// Standard errors along the axes.
    #[must_use]
    pub fn errors(&self) -> [f64; 3] {
        std::array::from_fn(|k| self.covariance[(k, k)].max(0.0).sqrt())
    }

    /// Standard errors along the line of sight from a place, and in a direction across it.
    #[must_use]
    pub fn along_and_across(&self, from: &Place) -> [f64; 2] {
        let total = self.covariance.trace();
        let sight = (self.place - from).try_normalize(0.0).unwrap_or_else(Vector3::z);
        let along = (sight.transpose() * self.covariance * sight)[0];
        [along, (total - along) / 2.0].map(|variance| variance.max(0.0).sqrt())
    }
}

/// A camera, how it stands (`camera_from_world`), and the pixel in which it sees the place.
pub type Sight = (Camera, Pose, Pixel);

/// The place that two cameras or more see, where one coordinate of a pixel has a standard deviation of `sigma_px`.
///
/// A start comes from eq. 2.2 of the thesis, with pixels freed of distortion first: each camera gives the two rows
/// `x p³ - p¹` and `y p³ - p²` of its matrix `P = [R t]`, and the place is the vector that all shorten most. (The second and third rows of
/// the matrix as it is printed have the numbers of row and camera the other way round.) Then the distances in the pictures are
/// made least, which are what is measured.
///
/// # Errors
/// [`CameraError::TooFewSights`] of one camera; [`CameraError::Reach`] of pixels beyond a camera's distortion; [`CameraError::Parallel`] where
/// the rays hardly meet, as of cameras in one place; [`CameraError::BehindBoth`] where they meet behind a camera.
pub fn triangulate(sights: &[Sight], sigma_px: f64) -> Result<Fix, CameraError> {
    if sights.len() < 2 {
        return Err(CameraError::TooFewSights { came: sights.len() });
    }
    let place = linear(sights)?;
    let fitted = least::fit(Meeting { sights, place }, Loss::Squares).map_err(|why| match why {
        least::Unfitted::Start => CameraError::BehindBoth,
        least::Unfitted::Loose | least::Unfitted::Restless => CameraError::Parallel,
    })?;
    let covariance: Matrix3<f64> = fitted.own[0].fixed_view::<3, 3>(0, 0) * (sigma_px * sigma_px);
    let squares: f64 = fitted.offsets[0].iter().map(Pixel::norm_squared).sum();
    let rms_px = (squares / sights.len() as f64).sqrt();
    Ok(Fix { place: fitted.problem.place, covariance, rms_px })
}

/// Eq. 2.2.
fn linear(sights: &[Sight]) -> Result<Place, CameraError> {
    /// The sine of the angle between two rays that do not tell where they meet.
    const PARALLEL: f64 = 1e-6;
    let mut rows = DMatrix::zeros((2 * sights.len()).max(4), 4);
    let mut widest = 0.0_f64;
    let mut rays: Vec<Vector3<f64>> = Vec::with_capacity(sights.len());
    for (i, (camera, pose, at)) in sights.iter().enumerate() {
        let ray = camera.undistort(at)?;
        let turn = pose.rotation.matrix();
        let p = |row: usize| {
            let [a, b, c] = [0, 1, 2].map(|column| turn[(row, column)]);
            Vector4::new(a, b, c, pose.translation[row])
        };
        rows.row_mut(2 * i).copy_from(&(p(2) * ray.x - p(0)).transpose());
        rows.row_mut(2 * i + 1).copy_from(&(p(2) * ray.y - p(1)).transpose());
        let in_world = (pose.rotation.inverse() * ray.push(1.0)).normalize();
        widest = rays.iter().map(|other| other.cross(&in_world).norm()).fold(widest, f64::max);
        rays.push(in_world);
    }
    if widest < PARALLEL {
        return Err(CameraError::Parallel);
    }
    let svd = rows.svd(false, true);
    let vectors = svd.v_t.ok_or(CameraError::Parallel)?;
    let vector = vectors.row(svd.singular_values.imin());
    let place = Vector3::new(vector[0], vector[1], vector[2]) / vector[3];
    if place.iter().all(|c| c.is_finite()) { Ok(place) } else { Err(CameraError::Parallel) }
}

struct Meeting<'a> {
    sights: &'a [Sight],
    place: Place,
}

impl Problem for Meeting<'_> {
    fn n_shared(&self) -> usize {
        0
    }

    fn n_own(&self) -> usize {
        3
    }

    fn n_blocks(&self) -> usize {
        1
    }

    fn block(&self, _: usize) -> Option<Block> {
        let mut block = Block::zeros(self.sights.len(), 0, 3);
        for (i, (camera, pose, at)) in self.sights.iter().enumerate() {
            let seen = camera.project_with_slopes(&pose.of(&self.place))?;
            block.offsets[i] = seen.at - at;
            put(&mut block.by_own, 2 * i, 0, &(seen.by_place * pose.rotation));
        }
        Some(block)
    }

    fn stepped(&self, _: &DVector<f64>, own: &[DVector<f64>]) -> Self {
        Self { place: self.place + own[0].fixed_rows::<3>(0), ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::staged::{LENS, Noise};

    fn cameras() -> [(Camera, Pose); 3] {
        let stand = |turn: [f64; 3], shift: [f64; 3]| Pose::new(turn.into(), shift.into());
        [
            (LENS, Pose::identity()),
            (Camera { fx: 600.0, fy: 610.0, k1: 0.05, ..LENS }, stand([0.02, 0.5, 0.0], [-3.0, 0.1, 0.8])),
            (Camera::pinhole(800.0, Pixel::new(320.0, 240.0)), stand([-0.4, 0.1, 0.1], [-0.4, 2.0, 0.5])),
        ]
    }

    fn sights(n: usize, place: &Place, noise: &mut Noise) -> Vec<Sight> {
        let see = |&(camera, pose): &(Camera, Pose)| {
            (camera, pose, camera.project(&pose.of(place)).unwrap() + noise.pixel())
        };
        cameras()[..n].iter().map(see).collect()
    }

    #[test]
    fn exact_rays_meet_where_they_come_from() {
        for place in [[0.3, -0.4, 6.0], [-1.2, 0.8, 5.0], [1.0, 1.0, 8.0]].map(Place::from) {
            for n in [2, 3] {
                let found = triangulate(&sights(n, &place, &mut Noise::new(0, 0.0)), 1.0).unwrap();
                assert!((found.place - place).norm() < 1e-8, "{}", found.place);
                assert!(found.rms_px < 1e-8);
                assert!((linear(&sights(n, &place, &mut Noise::new(0, 0.0))).unwrap() - place).norm() < 1e-8);
            }
        }
    }

    #[test]
    fn covariance_is_that_of_many_trials_and_deepest_along_the_sight() {
        let (place, n) = (Place::new(0.3, -0.4, 6.0), 1000);
        let mut noise = Noise::new(11, 0.5);
        let mut scatter = Matrix3::zeros();
        let (mut told, mut squares) = (Matrix3::zeros(), 0.0);
        for _ in 0..n {
            let found = triangulate(&sights(2, &place, &mut noise), 0.5).unwrap();
            let off = found.place - place;
            scatter += off * off.transpose() / f64::from(n);
            told = found.covariance;
            squares += found.rms_px.powi(2) / f64::from(n);
        }
        for k in 0..3 {
            let ratio = (scatter[(k, k)] / told[(k, k)]).sqrt();
            assert!((ratio - 1.0).abs() < 0.1, "axis {k}: {ratio}");
        }
        assert!(told[(2, 2)] > 2.0 * told[(0, 0)], "{told}");
        // Four numbers less three of the place leave one, of two pixels.
        assert!((squares / (0.25 / 2.0) - 1.0).abs() < 0.15, "{squares}");
    }

    #[test]
    fn distances_in_pictures_end_less_than_the_linear_start_has_them() {
        let place = Place::new(-0.8, 0.5, 4.0);
        let mut noise = Noise::new(5, 3.0);
        for _ in 0..50 {
            let seen = sights(3, &place, &mut noise);
            let cost = |place: &Place| -> f64 {
                seen.iter()
                    .map(|(camera, pose, at)| (camera.project(&pose.of(place)).unwrap() - at).norm_squared())
                    .sum()
            };
            let found = triangulate(&seen, 1.0).unwrap();
            assert!(cost(&found.place) <= cost(&linear(&seen).unwrap()) + 1e-9);
            for axis in 0..3 {
                for step in [1e-3, -1e-3] {
                    let mut beside = found.place;
                    beside[axis] += step;
                    assert!(cost(&beside) > cost(&found.place));
                }
            }
        }
    }

    #[test]
    fn rays_that_do_not_meet_before_the_cameras_are_named() {
        let place = Place::new(0.3, -0.4, 6.0);
        let seen = sights(2, &place, &mut Noise::new(0, 0.0));
        assert_eq!(triangulate(&seen[..1], 1.0), Err(CameraError::TooFewSights { came: 1 }));
        assert_eq!(triangulate(&[seen[0], seen[0]], 1.0), Err(CameraError::Parallel));
        // Looking apart: the rays meet behind both.
        let camera = Camera::pinhole(500.0, Pixel::new(320.0, 240.0));
        let aside = Pose::new(Vector3::zeros(), Vector3::new(-1.0, 0.0, 0.0));
        let apart =
            [(camera, Pose::identity(), Pixel::new(120.0, 240.0)), (camera, aside, Pixel::new(520.0, 240.0))];
        assert_eq!(triangulate(&apart, 1.0), Err(CameraError::BehindBoth));
    }
}
