//! What is set of the colours of motion over the picture.

use std::f64::consts::PI;

use honami_workbench::overlay::{Dial, Mapping};

/// One step of the gain: two of them double it.
const GAIN: f64 = std::f64::consts::SQRT_2;
/// Speeds that can have the full colour, px/s.
const SPEEDS_PX_S: (f64, f64) = (0.1, 100_000.0);
/// What has the full colour where nothing is known of the speeds, px/s.
const FIRST_PX_S: f64 = 50.0;

/// Colours of motion over the picture: thesis 3.2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Whether they are shown.
    pub is_on: bool,
    /// Speed that has its full colour, px/s: one over the gain. `None` until it was first shown or set.
    pub full_px_s: Option<f64>,
    /// Directions that are shown.
    pub dial: Dial,
}

impl Default for Motion {
    fn default() -> Self {
        Self { is_on: false, full_px_s: None, dial: Dial::ALL }
    }
}

impl Motion {
    /// The speed that has its full colour, px/s.
    #[must_use]
    pub fn full_px_s(&self) -> f64 {
        self.full_px_s.unwrap_or(FIRST_PX_S)
    }

    /// From velocities to colours.
    #[must_use]
    pub fn mapping(&self) -> Mapping {
        Mapping { gain_s_px: 1.0 / self.full_px_s(), dial: self.dial }
    }

    /// So many steps more gain, or less.
    pub fn gain(&mut self, steps: i64) {
        let factor = GAIN.powi(i32::try_from(steps.clamp(-100, 100)).unwrap_or(0));
        self.full_px_s = Some((self.full_px_s() / factor).clamp(SPEEDS_PX_S.0, SPEEDS_PX_S.1));
    }

    /// Turns the dial, clockwise on the screen; from all directions to a quarter of them.
    pub fn turn(&mut self, degrees: f64) {
        if self.dial.half_width_rad >= PI {
            self.dial.half_width_rad = PI / 4.0;
        }
        let turned = self.dial.centre_rad.to_degrees() + degrees;
        self.dial.centre_rad = turned.round().rem_euclid(360.0).to_radians();
    }

    /// Opens the dial to both sides, or closes it.
    pub fn open(&mut self, degrees: f64) {
        let opened = self.dial.half_width_rad.to_degrees() + degrees;
        self.dial.half_width_rad = opened.round().clamp(1.0, 180.0).to_radians();
    }

    /// The dial in words: `↘ 45° ± 30°`; `None` for all directions.
    #[must_use]
    pub fn dial_words(&self) -> Option<String> {
        let (centre, width) = (self.dial.centre_rad.to_degrees(), self.dial.half_width_rad.to_degrees());
        let arrow = ['→', '↘', '↓', '↙', '←', '↖', '↑', '↗'][(centre / 45.0).round() as usize % 8];
        (width < 180.0).then(|| format!("{arrow} {centre:.0}° ± {width:.0}°"))
    }
}
