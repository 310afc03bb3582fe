//! Particle image velocimetry as a honami plugin; the algorithm is `honami_vision::piv`.

#[cfg(test)]
mod tests;

use honami_follow::{Detection, Follower, Losing, Motion, Trust};
use honami_plugin::{Info, choice, export, params};
use honami_vision::Gray;
use honami_vision::field::Field;
use honami_vision::piv::{self, Params};

choice! {
    /// What counts how much in a window.
    pub(crate) enum Weighting {
        /// A Gaussian whose standard deviation is half the radius.
        Gaussian = "gaussian" => "Gaussian",
        /// All pixels alike.
        Uniform = "uniform" => "Uniform",
    }
}

params! {
    /// What the user may choose.
    pub(crate) struct Settings {
        /// Radius of the windows of the last passes; their side is 2r+1. Smaller ones see more detail, and need texture.
        radius: i64 = 8 => {
            label: "Window radius", group: "Tracking", unit: "px", min: 2, max: 64, soft_max: 32,
        },
        /// Passes with larger windows, each with twice the radius of the next; they see farther displacements.
        coarser: i64 = 2 => { label: "Coarser passes", group: "Tracking", min: 0, max: 4 },
        /// Passes with the smallest windows again, moved by fractions of a pixel: the error becomes smaller.
        repeats: i64 = 1 => { label: "Repeats", group: "Tracking", min: 0, max: 10, soft_max: 3 },
        /// From a node of the field to the next.
        step: i64 = 8 => { label: "Grid step", group: "Tracking", unit: "px", min: 1, max: 100, soft_max: 32 },
        /// What counts how much in a window.
        weighting: Weighting = "gaussian" => { label: "Weights", group: "Tracking", advanced: true },
        /// A peak less than so many times as high as the next best is not believed.
        peak_ratio: f64 = 1.2 => {
            label: "Peak ratio", group: "Believing", min: 0, max: 10, soft_min: 1, soft_max: 3,
        },
        /// A vector farther from the median of its neighbours than so many of their usual distances is not believed; 0: all are.
        median_limit: f64 = 2.0 => { label: "Median test", group: "Believing", min: 0, max: 100, soft_max: 5 },
        /// Whether motion is measured back, too: the forward-backward error of samples, at twice the time.
        backward: bool = true => { label: "There and back", group: "Tracking" },
        ..losing: Losing,
        ..detection: Detection,
    }
}

/// A picture of its own memory.
pub(crate) struct Kept {
    data: Vec<u8>,
    width: u32,
    height: u32,
}

impl Motion for Settings {
    const INFO: Info = Info {
        id: "org.honami.piv",
        name: "Particle image velocimetry",
        doc: "Correlates windows of one frame with the next at all displacements, through their Fourier transforms: \
              `ρ(d) = Σ w (A - Ā) B(p + d) / √(Var A · Var B)`; Gaussian peaks to a fraction of a pixel, passes from large windows \
              to small, peaks and vectors that are not believed left out (normalised median test). Points follow that motion; where \
              it is not known they are lost. Made for particles in fluids; a window that holds two motions gives one of them.",
        cite: &["Raffel, Willert, Kompenhans", "Westerweel, Scarano 2005", "Diener 2009, 2.4.1 and 2.4.4"],
        ..Info::NEW
    };
    type Kept = Kept;

    fn keep(&self, picture: &Gray<'_>, _: usize) -> Kept {
        let data = (0..picture.height).flat_map(|y| picture.row(y)).copied().collect();
        Kept { data, width: picture.width, height: picture.height }
    }

    fn kept(kept: &Kept) -> Gray<'_> {
        Gray::packed(&kept.data, kept.width, kept.height)
    }

    fn measure(
        &self,
        from: &Kept,
        to: &Kept,
        n_threads: usize,
        go_on: &dyn Fn(f64) -> bool,
    ) -> Option<Field> {
        let params = Params {
            radius_px: self.radius as u32,
            coarser: self.coarser as u32,
            repeats: self.repeats as u32,
            step_px: self.step as u32,
            weighting: match self.weighting {
                Weighting::Gaussian => piv::Weighting::Gaussian,
                Weighting::Uniform => piv::Weighting::Uniform,
            },
            peak_ratio: self.peak_ratio as f32,
            median_limit: self.median_limit as f32,
        };
        piv::measure(&Self::kept(from), &Self::kept(to), &params, n_threads, go_on)
    }

    fn is_backward(&self) -> bool {
        self.backward
    }

    fn trust(&self) -> Trust<'_> {
        Trust { radius_px: self.radius as u32, losing: &self.losing }
    }

    fn detection(&self) -> &Detection {
        &self.detection
    }
}

/// Points that follow the motion of windows.
type Piv = Follower<Settings>;

export! {
    library: { id: "org.honami.piv", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [tracker Piv],
}
