//! The parameters of the plugin, and what they mean to the algorithm.

use honami_follow::{Detection, Losing};
use honami_plugin::{Status, params};
use honami_vision::klt::{self, State};
use honami_vision::robust::{self, Moved, Region};

params! {
    /// What the user may choose.
    pub(crate) struct Settings {
        /// Radius of the region that moves as one; a point is its centre.
        region: i64 = 14 => {
            label: "Region radius", group: "Region", unit: "px", min: 1, max: 200, soft_max: 40,
        },
        /// Distance between the nodes of which a region's motion is made. Closer ones cost more and agree better.
        step: i64 = 4 => { label: "Node distance", group: "Region", unit: "px", min: 1, max: 50, soft_max: 10 },
        /// Noise of a node's displacement: what is closer than this agrees.
        noise: f64 = 0.4 => {
            label: "Noise", group: "Region", unit: "px", min: 0.01, max: 20, soft_max: 1, scale: "log",
        },
        /// A point is lost when a smaller share of its nodes agrees; 0: never.
        lose_share: f64 = 0.0 => { label: "Lose below share", group: "Losing", min: 0, max: 1 },
        /// Radius of the template of a node; its side is 2r+1.
        radius: i64 = 5 => {
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
        /// A node whose gradient matrix has a smaller eigenvalue is flat and says nothing (OpenCV's measure).
        min_eigenvalue: f64 = 1e-4 => {
            label: "Minimum eigenvalue", group: "Tracking", min: 0, max: 1, advanced: true,
        },
        /// Follow regions back, too: measures the forward-backward error, at twice the time.
        backward: bool = false => { label: "Track back", group: "Tracking" },
        ..losing: Losing,
        ..detection: Detection,
    }
}

impl Settings {
    pub(crate) fn tracking(&self) -> Region {
        Region {
            radius_px: self.region as u32,
            step_px: self.step as u32,
            klt: klt::Params {
                radius_px: self.radius as u32,
                levels: self.levels as u32,
                max_iterations: self.iterations as u32,
                epsilon_px: self.epsilon as f32,
                min_eigenvalue: self.min_eigenvalue as f32,
            },
            mode: robust::Params { floor_px: self.noise, ..robust::Params::default() },
        }
    }

    /// Whether regions are followed back: a limit wants to know what it limits.
    pub(crate) fn is_backward(&self) -> bool {
        self.backward || self.losing.lose_fb > 0.0
    }

    /// What became of a point: where its region went, and how far that is to be trusted.
    pub(crate) fn judge(&self, moved: &Moved, fb: Option<f32>, ncc: Option<f32>) -> Status {
        match moved.state {
            State::Outside => Status::Outside,
            State::Lost(_) => Status::Lost,
            State::Tracked if moved.share < self.lose_share || self.losing.loses(fb, ncc) => Status::Lost,
            State::Tracked => Status::Tracked,
        }
    }
}
