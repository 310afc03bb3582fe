//! The parameters of the KLT plugin, and what they mean to the algorithm.

use honami_plugin::{Status, choice, params};
use honami_vision::detect;
use honami_vision::klt::{self, State};

choice! {
    /// What makes a corner strong.
    pub(crate) enum Method {
        /// The smaller eigenvalue of the gradient matrix.
        ShiTomasi = "shi-tomasi" => "Shi-Tomasi",
        /// det - 0.04 trace² of the gradient matrix: prefers corners to line ends.
        Harris = "harris" => "Harris",
    }
}

params! {
    /// What the user may choose.
    pub(crate) struct Settings {
        /// Radius of the template; its side is 2r+1. Larger windows survive longer and see less detail.
        radius: i64 = 10 => {
            label: "Template radius", group: "Tracking", unit: "px", min: 1, max: 100, soft_max: 31,
        },
        /// Levels of the pyramid; each doubles the displacement that can be followed.
        levels: i64 = 4 => { label: "Levels", group: "Tracking", min: 1, max: 10, soft_max: 6 },
        /// The most steps on each level.
        iterations: i64 = 30 => {
            label: "Iterations", group: "Tracking", min: 1, max: 1000, soft_max: 100, advanced: true,
        },
        /// A shorter step ends the search on a level.
        epsilon: f64 = 0.01 => {
            label: "Epsilon", group: "Tracking", unit: "px", min: 1e-5, max: 1, scale: "log", advanced: true,
        },
        /// A template whose gradient matrix has a smaller eigenvalue is flat, and the point lost (OpenCV's measure).
        min_eigenvalue: f64 = 1e-4 => {
            label: "Minimum eigenvalue", group: "Tracking", min: 0, max: 1, advanced: true,
        },
        /// A point whose way there and back ends farther than this from its start is lost; 0: never, the quality says it.
        lose_fb: f64 = 0.0 => {
            label: "Lose at forward-backward error", group: "Losing", unit: "px", min: 0, max: 100, soft_max: 5,
        },
        /// A point whose template correlates less with the new window is lost; 0: never.
        lose_ncc: f64 = 0.0 => { label: "Lose below correlation", group: "Losing", min: 0, max: 1 },
        /// What makes a corner strong.
        method: Method = "shi-tomasi" => { label: "Method", group: "Detection", affects: "seed" },
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

impl Settings {
    pub(crate) fn tracking(&self) -> klt::Params {
        klt::Params {
            radius_px: self.radius as u32,
            levels: self.levels as u32,
            max_iterations: self.iterations as u32,
            epsilon_px: self.epsilon as f32,
            min_eigenvalue: self.min_eigenvalue as f32,
        }
    }

    pub(crate) fn detection(&self, max_features: u32) -> detect::Params {
        detect::Params {
            method: match self.method {
                Method::ShiTomasi => detect::Method::ShiTomasi,
                Method::Harris => detect::Method::Harris,
            },
            max_corners: (self.max_features as usize).min(max_features as usize),
            quality: self.quality as f32,
            min_distance_px: self.distance as f32,
            window_radius_px: self.corner_radius as u32,
        }
    }

    /// What became of a point: where it went, and whether it came back and still looks the same.
    pub(crate) fn judge(&self, state: State, fb: Option<f32>, ncc: Option<f32>) -> Status {
        // What could not be measured is worse than any limit.
        let astray = self.lose_fb > 0.0 && fb.is_none_or(|fb| f64::from(fb) > self.lose_fb);
        let changed = self.lose_ncc > 0.0 && ncc.is_none_or(|ncc| f64::from(ncc) < self.lose_ncc);
        match state {
            State::Outside => Status::Outside,
            State::Lost(_) => Status::Lost,
            State::Tracked if astray || changed => Status::Lost,
            State::Tracked => Status::Tracked,
        }
    }
}
