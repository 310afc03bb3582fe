//! Two sets of places brought over one another, and how far they are then.
//!
//! S. Umeyama, "Least-squares estimation of transformation parameters between two point patterns", PAMI 13 (1991), 376-380.

use nalgebra::{Matrix3, Rotation3, Vector3};
use serde::{Deserialize, Serialize};

use crate::{CameraError, Place};

/// Scaled, turned and shifted: `to = scale · rotation · from + translation`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Similarity {
    /// Lengths of `to` by those of `from`.
    pub scale: f64,
    /// The turn; never a mirror.
    pub rotation: Rotation3<f64>,
    /// The shift.
    pub translation: Vector3<f64>,
}

impl Similarity {
    /// Where a place comes to lie.
    #[must_use]
    pub fn of(&self, place: &Place) -> Place {
        self.scale * (self.rotation * place) + self.translation
    }
}

/// What brings `from` over `to`, place by place, with the least sum of squared distances; with a scale of 1 unless it is free.
///
/// # Errors
/// [`CameraError::Unaligned`] of fewer than three places, of places on a line, and of others than finite ones.
///
/// # Panics
/// When there are not as many of one as of the other.
#[track_caller]
pub fn aligned(from: &[Place], to: &[Place], with_scale: bool) -> Result<Similarity, CameraError> {
    /// Second singular value of places on a line, of the first: what is below is rounding.
    const LINE: f64 = 1e-9;
    assert_eq!(from.len(), to.len(), "places in pairs");
    let n = from.len() as f64;
    let unaligned = CameraError::Unaligned { came: from.len() };
    if from.len() < 3 || from.iter().chain(to).any(|place| place.iter().any(|c| !c.is_finite())) {
        return Err(unaligned);
    }
    let [from_middle, to_middle] = [from, to].map(|places| places.iter().sum::<Place>() / n);
    let (mut across, mut spread) = (Matrix3::zeros(), 0.0);
    for (from, to) in from.iter().zip(to) {
        across += (to - to_middle) * (from - from_middle).transpose() / n;
        spread += (from - from_middle).norm_squared() / n;
    }
    let svd = across.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else { return Err(unaligned) };
    let mut values = svd.singular_values;
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| values[j].total_cmp(&values[i]));
    if values[order[0]] <= 0.0 || values[order[1]] <= LINE * values[order[0]] {
        return Err(unaligned);
    }
    // The least certain direction is turned over rather than mirrored.
    let mut sign = Vector3::repeat(1.0);
    sign[order[2]] = (u.determinant() * v_t.determinant()).signum();
    values.component_mul_assign(&sign);
    let rotation = Rotation3::from_matrix_unchecked(u * Matrix3::from_diagonal(&sign) * v_t);
    let scale = if with_scale { values.sum() / spread } else { 1.0 };
    Ok(Similarity { scale, rotation, translation: to_middle - scale * (rotation * from_middle) })
}

/// How far one coordinate is off, over time: a cell of table 2.1 of the thesis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Deviation {
    /// Root mean square of the differences.
    pub rms: f64,
    /// Mean of their sizes (errata E12: the "average" of the table is that of |d|, as RMS² = mean² + std² tells).
    pub mean: f64,
    /// Standard deviation of their sizes, of all of them: divided by their number.
    pub std: f64,
}

/// Of x, y and z how far places are off from others, pair by pair; `None` of none.
///
/// # Panics
/// When there are not as many of one as of the other.
#[must_use]
#[track_caller]
pub fn deviations(places: &[Place], others: &[Place]) -> Option<[Deviation; 3]> {
    assert_eq!(places.len(), others.len(), "places in pairs");
    let n = places.len() as f64;
    (!places.is_empty()).then(|| {
        std::array::from_fn(|axis| {
            let sizes = || places.iter().zip(others).map(move |(a, b)| (a[axis] - b[axis]).abs());
            let mean = sizes().sum::<f64>() / n;
            let variance = sizes().map(|size| (size - mean).powi(2)).sum::<f64>() / n;
            Deviation {
                rms: (sizes().map(|size| size * size).sum::<f64>() / n).sqrt(),
                mean,
                std: variance.sqrt(),
            }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::staged::Noise;

    fn places(n: usize, seed: u64) -> Vec<Place> {
        let mut noise = Noise::new(seed, 1.0);
        (0..n).map(|_| Vector3::new(noise.draw(), 2.0 * noise.draw(), 0.3 * noise.draw())).collect()
    }

    fn moved() -> Similarity {
        let rotation = Rotation3::new(Vector3::new(0.7, -2.0, 0.4));
        Similarity { scale: 2.5, rotation, translation: Vector3::new(1.0, -7.0, 3.0) }
    }

    #[test]
    fn what_was_moved_is_moved_back() {
        for n in [3, 4, 50] {
            let from = places(n, 1);
            let to: Vec<_> = from.iter().map(|place| moved().of(place)).collect();
            let found = aligned(&from, &to, true).unwrap();
            assert!((found.scale - 2.5).abs() < 1e-9, "{found:?}");
            assert!((found.rotation.matrix() - moved().rotation.matrix()).norm() < 1e-9);
            assert!((found.translation - moved().translation).norm() < 1e-9);
            let rigid = Similarity { scale: 1.0, ..moved() };
            let to: Vec<_> = from.iter().map(|place| rigid.of(place)).collect();
            let found = aligned(&from, &to, false).unwrap();
            assert!((found.of(&from[0]) - to[0]).norm() < 1e-9);
        }
    }

    #[test]
    fn a_mirror_image_is_turned_and_never_mirrored() {
        let from = places(30, 2);
        let to: Vec<_> = from.iter().map(|p| Vector3::new(p.x, p.y, -p.z)).collect();
        let found = aligned(&from, &to, false).unwrap();
        assert!((found.rotation.matrix().determinant() - 1.0).abs() < 1e-9);
        let cost = |similarity: &Similarity| -> f64 {
            from.iter().zip(&to).map(|(from, to)| (similarity.of(from) - to).norm_squared()).sum()
        };
        // Any other turn is worse.
        for turn in places(200, 3) {
            let other = Similarity { rotation: Rotation3::new(turn * 0.05) * found.rotation, ..found };
            assert!(cost(&other) >= cost(&found) - 1e-9);
        }
    }

    #[test]
    fn places_that_tell_no_turn_are_named() {
        let line: Vec<Place> = (0..5).map(|i| Vector3::new(1.0, 2.0, -1.0) * f64::from(i)).collect();
        for from in [line, places(2, 1), vec![Place::zeros(); 4], vec![Place::repeat(f64::NAN); 4]] {
            assert_eq!(aligned(&from, &from, true), Err(CameraError::Unaligned { came: from.len() }));
        }
    }

    #[test]
    fn deviations_are_those_of_table_2_1() {
        // Differences -1, 2, -3: sizes 1, 2, 3.
        let places = [-1.0, 2.0, -3.0].map(|x| Place::new(x, 0.0, 0.0));
        let [x, y, _] = deviations(&places, &[Place::zeros(); 3]).unwrap();
        assert!((x.mean - 2.0).abs() < 1e-12 && (x.rms - (14.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((x.std - (2.0_f64 / 3.0).sqrt()).abs() < 1e-12, "{x:?}");
        assert_eq!((y.rms, y.mean, y.std), (0.0, 0.0, 0.0));
        assert_eq!(deviations(&[], &[]), None);
        // E12: the thesis's own cells keep RMS² = mean² + std², to their last digit.
        for (rms, mean, std) in [(1.56_f64, 1.15_f64, 1.06_f64), (3.02, 2.57, 1.59), (6.43, 4.70, 4.39)] {
            assert!((mean.hypot(std) - rms).abs() < 0.01);
        }
        let (a, b) = (super::tests::places(100, 4), super::tests::places(100, 5));
        for cell in deviations(&a, &b).unwrap() {
            assert!((cell.mean.hypot(cell.std) - cell.rms).abs() < 1e-12);
        }
    }
}
