//! The parameters of the plugin, and what they mean to the algorithm.

use honami_follow::{Detection, Losing, Search};
use honami_plugin::params;
use honami_vision::robust::{self, Region};

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
        /// Follow regions back, too: measures the forward-backward error, at twice the time.
        backward: bool = false => { label: "Track back", group: "Tracking" },
        ..search: Search,
        ..losing: Losing,
        ..detection: Detection,
    }
}

impl Settings {
    pub(crate) fn region(&self) -> Region {
        Region {
            radius_px: self.region as u32,
            step_px: self.step as u32,
            klt: self.search.klt(self.radius),
            mode: robust::Params { floor_px: self.noise, ..robust::Params::default() },
        }
    }

    /// Whether regions are followed back: a limit wants to know what it limits.
    pub(crate) fn is_backward(&self) -> bool {
        self.backward || self.losing.lose_fb > 0.0
    }
}
