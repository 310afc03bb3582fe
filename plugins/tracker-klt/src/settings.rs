//! The parameters of the KLT plugin, and what they mean to the algorithm.

use honami_follow::{Detection, Losing};
use honami_plugin::{Status, choice, params};
use honami_vision::klt::{self, State};

choice! {
    /// How a window may change from frame to frame.
    pub(crate) enum Model {
        /// It moves.
        Translation = "translation" => "Translation",
        /// It moves, turns, stretches and shears.
        Affine = "affine" => "Affine",
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
        /// How a window may change from frame to frame; an affine one takes several times as long.
        model: Model = "translation" => { label: "Model", group: "Tracking" },
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
        ..losing: Losing,
        ..detection: Detection,
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

    /// What became of a point: where it went, and whether it came back and still looks the same.
    pub(crate) fn judge(&self, state: State, fb: Option<f32>, ncc: Option<f32>) -> Status {
        match state {
            State::Outside => Status::Outside,
            State::Lost(_) => Status::Lost,
            State::Tracked if self.losing.loses(fb, ncc) => Status::Lost,
            State::Tracked => Status::Tracked,
        }
    }
}
