//! The parameters of the mean-shift plugin, and what they mean to the algorithm.

use honami_follow::Detection;
use honami_plugin::params;
use honami_vision::meanshift::{Bins, Params};

params! {
    /// What the user may choose.
    pub(crate) struct Settings {
        /// Radius of the region whose colours are followed; about as far it can jump in a frame.
        region: f64 = 15.0 => { label: "Region radius", group: "Tracking", unit: "px", min: 2, max: 200, soft_max: 50 },
        /// Parts of luma in the histogram; 1: brightness does not count.
        luma_bins: i64 = 24 => { label: "Luma bins", group: "Colours", min: 1, max: 32 },
        /// Parts of each chroma channel in the histogram, best odd; 1: colour does not count.
        chroma_bins: i64 = 23 => { label: "Chroma bins", group: "Colours", min: 1, max: 32 },
        /// The most steps in a frame.
        iterations: i64 = 20 => {
            label: "Iterations", group: "Tracking", min: 1, max: 1000, soft_max: 100, advanced: true,
        },
        /// A shorter step ends the search.
        epsilon: f64 = 0.05 => {
            label: "Epsilon", group: "Tracking", unit: "px", min: 1e-3, max: 5, scale: "log", advanced: true,
        },
        /// Tries regions a tenth smaller and larger too, and keeps a tenth of the difference. It takes three times as long.
        adapt: bool = false => { label: "Adapt the size", group: "Tracking" },
        /// A region whose colours are less like those at its key-frame (Bhattacharyya's coefficient) is lost.
        lose_similarity: f64 = 0.7 => { label: "Lose below similarity", group: "Losing", min: 0, max: 1 },
        ..detection: Detection,
    }
}

impl Settings {
    pub(crate) fn bins(&self) -> Bins {
        Bins { luma: self.luma_bins as u32, chroma: self.chroma_bins as u32 }
    }

    /// How large a region may become, radius in pixels.
    pub(crate) fn largest_px(&self) -> f64 {
        if self.adapt { 2.0 * self.region } else { self.region }
    }

    pub(crate) fn search(&self) -> Params {
        Params { max_iterations: self.iterations as u32, epsilon_px: self.epsilon as f32, adapts: self.adapt }
    }
}
