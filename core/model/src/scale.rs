//! A scale bar: something in the picture whose length is known, which says how many metres a pixel is.

use serde::{Deserialize, Serialize};

/// Shorter bars say nothing: pixels between the ends.
const SHORTEST_PX: f64 = 2.0;

/// Something of known length in a frame.
///
/// It measures along itself, in the plane that it lies in: what is nearer to the camera or farther away has another scale, and
/// what moves towards the camera is not measured at all.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScaleBar {
    /// The frame that it was seen in.
    pub frame: u32,
    /// Where its ends are, pixels right and down.
    pub ends: [[f64; 2]; 2],
    /// How long it is, metres.
    pub length_m: f64,
    /// Standard error of that, metres.
    pub length_error_m: f64,
    /// Standard error of where an end was placed, pixels.
    pub end_error_px: f64,
}

/// Why something is no scale bar.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BarError {
    /// Not finite, or below 0.
    #[error("a scale bar has ends, a length above 0 and errors of 0 or more, all finite numbers")]
    Numbers,
    /// Its ends are one place.
    #[error("the ends of a scale bar are at least {SHORTEST_PX} px apart, came {came_px:.2} px")]
    Short {
        /// How far they are apart, pixels.
        came_px: f64,
    },
    /// The errors are as large as the bar.
    #[error("a scale bar that is wrong by {:.0} % measures nothing: a longer one, or smaller errors", 100.0 * share)]
    Vague {
        /// Relative error of the scale.
        share: f64,
    },
}

impl ScaleBar {
    /// Whether it measures.
    ///
    /// # Errors
    /// [`BarError`].
    pub fn check(&self) -> Result<(), BarError> {
        let errors = [self.length_error_m, self.end_error_px];
        let is_sound = self.ends.as_flattened().iter().all(|v| v.is_finite())
            && self.length_m.is_finite()
            && self.length_m > 0.0
            && errors.iter().all(|error| error.is_finite() && *error >= 0.0);
        let (came_px, share) = (self.length_px(), self.relative_error());
        match is_sound {
            false => Err(BarError::Numbers),
            true if came_px < SHORTEST_PX => Err(BarError::Short { came_px }),
            true if share >= 0.5 => Err(BarError::Vague { share }),
            true => Ok(()),
        }
    }

    /// How far its ends are apart, pixels.
    #[must_use]
    pub fn length_px(&self) -> f64 {
        let [a, b] = self.ends;
        (b[0] - a[0]).hypot(b[1] - a[1])
    }

    /// Metres of a pixel, along it and in its plane.
    #[must_use]
    pub fn m_per_px(&self) -> f64 {
        self.length_m / self.length_px()
    }

    /// Standard error of [`ScaleBar::m_per_px`], in parts of it: that of the length, and of both ends along the bar.
    #[must_use]
    pub fn relative_error(&self) -> f64 {
        (self.length_error_m / self.length_m)
            .hypot(std::f64::consts::SQRT_2 * self.end_error_px / self.length_px())
    }

    /// The angle of its line with the horizontal, as seen, counter-clockwise: 0 to π, radians.
    #[must_use]
    pub fn direction_rad(&self) -> f64 {
        let [a, b] = self.ends;
        (a[1] - b[1]).atan2(b[0] - a[0]).rem_euclid(std::f64::consts::PI)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar() -> ScaleBar {
        let ends = [[10.0, 50.0], [40.0, 10.0]];
        ScaleBar { frame: 0, ends, length_m: 0.5, length_error_m: 0.005, end_error_px: 0.5 }
    }

    #[test]
    fn a_bar_says_what_a_pixel_is_and_how_well() {
        // 3-4-5: 50 px, up to the right.
        let bar = bar();
        bar.check().unwrap();
        assert!((bar.length_px() - 50.0).abs() < 1e-12 && (bar.m_per_px() - 0.01).abs() < 1e-15);
        assert!((bar.direction_rad() - (4.0_f64 / 3.0).atan()).abs() < 1e-12);
        let back = ScaleBar { ends: [bar.ends[1], bar.ends[0]], ..bar };
        assert!((back.direction_rad() - bar.direction_rad()).abs() < 1e-12);
        // What the ends make of it, by trying: a grid of errors with the standard deviation that is told.
        let (mut squares, mut n) = (0.0, 0.0);
        for k in 0..625_u32 {
            // Five places each, of standard deviation 0.5.
            let off = |place: u32| (f64::from(k / 5_u32.pow(place) % 5) - 2.0) * 0.5 / 2.0_f64.sqrt();
            let ends = [[10.0 + off(0), 50.0 + off(1)], [40.0 + off(2), 10.0 + off(3)]];
            let tried = ScaleBar { ends, ..bar };
            squares += (tried.m_per_px() / bar.m_per_px() - 1.0).powi(2);
            n += 1.0;
        }
        let told = ScaleBar { length_error_m: 0.0, ..bar }.relative_error();
        assert!((f64::sqrt(squares / n) / told - 1.0).abs() < 0.02, "{told}");
        assert!((bar.relative_error() - told.hypot(0.01)).abs() < 1e-12);
    }

    #[test]
    fn what_measures_nothing_is_named() {
        for (wrong, wanted) in [
            (ScaleBar { length_m: 0.0, ..bar() }, BarError::Numbers),
            (ScaleBar { length_error_m: -1.0, ..bar() }, BarError::Numbers),
            (ScaleBar { ends: [[f64::NAN, 0.0], [9.0, 9.0]], ..bar() }, BarError::Numbers),
            (ScaleBar { ends: [[3.0, 4.0]; 2], ..bar() }, BarError::Short { came_px: 0.0 }),
            (ScaleBar { length_error_m: 0.5, end_error_px: 0.0, ..bar() }, BarError::Vague { share: 1.0 }),
        ] {
            assert_eq!(wrong.check(), Err(wanted));
        }
    }
}
