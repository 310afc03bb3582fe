//! Where to put features: the parameters of the detector, and the detector as plugins offer it.

use honami_plugin::{Detect, Feature, Result, choice, params};
use honami_vision::detect;

use crate::picture;

choice! {
    /// What makes a corner strong.
    pub enum Corners {
        /// The smaller eigenvalue of the gradient matrix.
        ShiTomasi = "shi-tomasi" => "Shi-Tomasi",
        /// det - 0.04 trace² of the gradient matrix: prefers corners to line ends.
        Harris = "harris" => "Harris",
    }
}

params! {
    /// Which corners are features.
    pub struct Detection {
        /// What makes a corner strong.
        method: Corners = "shi-tomasi" => { label: "Method", group: "Detection", affects: "seed" },
        /// The most features to detect.
        max_features: i64 = 1000 => {
            label: "Maximum", group: "Detection", min: 1, max: 1000000, soft_max: 5000, affects: "seed",
        },
        /// Corners weaker than this share of the strongest are left out.
        quality: f64 = 0.01 => {
            label: "Quality", group: "Detection", min: 1e-6, max: 1, scale: "log", affects: "seed",
        },
        /// Features keep this distance from each other.
        distance: f64 = 8.0 => {
            label: "Minimum distance", group: "Detection", unit: "px", min: 0, max: 1000, soft_max: 50, affects: "seed",
        },
        /// Radius of the window that the corner is measured in.
        corner_radius: i64 = 1 => {
            label: "Corner radius", group: "Detection", unit: "px", min: 0, max: 20, affects: "seed", advanced: true,
        },
    }
}

impl Detection {
    /// Corners of a frame, strongest first: what [`honami_plugin::DetectFn`] wants.
    ///
    /// # Errors
    /// None of its own.
    pub fn features(&self, wanted: &Detect<'_>) -> Result<Vec<Feature>> {
        let gray = picture(&wanted.frame);
        let mask = wanted.mask.map(|m| (0..m.height).flat_map(|y| m.row(y)).copied().collect::<Vec<u8>>());
        let occupied: Vec<_> = wanted.points.iter().map(|p| [p.x, p.y]).collect();
        let params = detect::Params {
            method: match self.method {
                Corners::ShiTomasi => detect::Method::ShiTomasi,
                Corners::Harris => detect::Method::Harris,
            },
            max_corners: (self.max_features as usize).min(wanted.max_features as usize),
            quality: self.quality as f32,
            min_distance_px: self.distance as f32,
            window_radius_px: self.corner_radius as u32,
        };
        let corners = detect::corners(&gray, mask.as_deref(), &occupied, &params);
        Ok(corners.iter().map(|c| Feature { x: c.at[0], y: c.at[1], score: c.score }).collect())
    }
}
