//! What is shown to cameras to calibrate them: points on a plane whose places are known.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::homography::homography;
use crate::{CameraError, Pixel, Place};

/// A point of a target, by its number, where a camera saw it in one view.
pub type Sighting = Vec<(usize, Pixel)>;

/// Points on a plane, `z = 0`; x and y in the unit in which lengths are wanted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Target {
    points: Vec<[f64; 2]>,
    two_sided: bool,
}

impl Target {
    /// Points on a plane. One that is `two_sided` may be seen from behind, as bars may; of others, points in mirrored order
    /// are a mistake, which is told.
    ///
    /// # Errors
    /// [`CameraError::TooFewPoints`] of fewer than 4, [`CameraError::Collinear`] where they do not span a plane.
    pub fn new(points: Vec<[f64; 2]>, two_sided: bool) -> Result<Self, CameraError> {
        let places: Vec<Vector2<f64>> = points.iter().copied().map(Vector2::from).collect();
        homography(&places, &places)?;
        Ok(Self { points, two_sided })
    }

    /// Inner corners of a chessboard, row by row: x along a row, y down, z away from whoever looks at it.
    ///
    /// # Errors
    /// [`CameraError::Board`] where there are fewer than 2 either way, or squares have no size.
    pub fn board(columns: usize, rows: usize, square: f64) -> Result<Self, CameraError> {
        if columns < 2 || rows < 2 || !(square.is_finite() && square > 0.0) {
            return Err(CameraError::Board { columns, rows, square });
        }
        let at = |i: usize| [(i % columns) as f64 * square, (i / columns) as f64 * square];
        Self::new((0..columns * rows).map(at).collect(), false)
    }

    /// Targets on two bars that cross at a right angle (thesis 2.3.2, fig. 2.9): where they cross, then those along the first bar at
    /// these distances from there, then those along the second; negative distances lie on its other side.
    ///
    /// The thesis has three along a bar of five metres, and two along one of one metre. Whichever way the bars are turned, they are
    /// seen from both sides; of two that look alike from behind, nobody can tell from which.
    ///
    /// # Errors
    /// As [`Target::new`]: each bar needs two targets beside the crossing.
    pub fn bars(along_first: &[f64], along_second: &[f64]) -> Result<Self, CameraError> {
        let first = along_first.iter().map(|&x| [x, 0.0]);
        let second = along_second.iter().map(|&y| [0.0, y]);
        Self::new(std::iter::once([0.0, 0.0]).chain(first).chain(second).collect(), true)
    }

    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Never: a plane has points.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// A point's place on the plane.
    ///
    /// # Panics
    /// When there is no point of this number.
    #[must_use]
    #[track_caller]
    pub fn place(&self, point: usize) -> Place {
        let [x, y] = self.points[point];
        Place::new(x, y, 0.0)
    }

    /// The homography from the plane to what was seen of it.
    pub(crate) fn seen_as(&self, sighting: &[(usize, Pixel)]) -> Result<nalgebra::Matrix3<f64>, CameraError> {
        let mut numbers: Vec<usize> = sighting.iter().map(|&(point, _)| point).collect();
        numbers.sort_unstable();
        if let Some(&point) = numbers.last().filter(|&&last| last >= self.len()) {
            return Err(CameraError::NoSuchPoint { point, n_points: self.len() });
        }
        if let Some(pair) = numbers.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(CameraError::SeenTwice { point: pair[0] });
        }
        if let Some((point, _)) = sighting.iter().find(|(_, at)| at.iter().any(|c| !c.is_finite())) {
            return Err(CameraError::NotFinite { point: *point });
        }
        let from: Vec<_> = sighting.iter().map(|&(point, _)| Vector2::from(self.points[point])).collect();
        let to: Vec<_> = sighting.iter().map(|&(_, at)| at).collect();
        if to.len() >= 4 && is_thin(&to) {
            return Err(CameraError::Collinear);
        }
        let h = homography(&from, &to)?;
        if !self.two_sided && h.determinant() < 0.0 {
            return Err(CameraError::Mirrored);
        }
        Ok(h)
    }
}

/// Whether pixels lie on a line, to what corners are known to.
fn is_thin(pixels: &[Pixel]) -> bool {
    /// Root mean square distance from the line, pixels.
    const THIN_PX: f64 = 0.5;
    let n = pixels.len() as f64;
    let middle = pixels.iter().sum::<Pixel>() / n;
    let scatter: nalgebra::Matrix2<f64> =
        pixels.iter().map(|p| (p - middle) * (p - middle).transpose()).sum();
    (scatter / n).symmetric_eigenvalues().min() < THIN_PX * THIN_PX
}
