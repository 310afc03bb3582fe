//! The parameters of the plugin, and what they mean to the algorithm.

use honami_follow::{Detection, Search};
use honami_plugin::params;
use honami_vision::detect;
use honami_vision::particles::Params;

params! {
    /// What the user may choose.
    pub(crate) struct Settings {
        /// Frames in which a particle lives. A shorter life drifts less, and knows less of its own steadiness.
        life: i64 = 30 => { label: "Life", group: "Particles", unit: "frame", min: 1, max: 10000, soft_max: 200 },
        /// Difference of a particle's last two displacements at which it weighs 1/e.
        scale: f64 = 1.0 => {
            label: "Speed scale", group: "Particles", unit: "px/frame", min: 0.01, max: 1000, soft_max: 10, scale: "log",
        },
        /// How far the motion of a particle reaches.
        reach: f64 = 16.0 => { label: "Reach", group: "Particles", unit: "px", min: 1, max: 1000, soft_max: 60 },
        /// Particles are born no nearer than this to those that live.
        spacing: f64 = 5.0 => { label: "Spacing", group: "Particles", unit: "px", min: 1, max: 1000, soft_max: 40 },
        /// The most particles that live at a time.
        particles: i64 = 8000 => { label: "Most particles", group: "Particles", min: 1, max: 1000000, soft_max: 20000 },
        /// Particles become tracks of their own, wherever the tracker also finds the features.
        emit: bool = true => { label: "Particles as tracks", group: "Particles" },
        /// Radius of the template; its side is 2r+1. Larger windows survive longer and see less detail.
        radius: i64 = 7 => {
            label: "Template radius", group: "Tracking", unit: "px", min: 1, max: 100, soft_max: 31,
        },
        ..search: Search,
        ..detection: Detection,
    }
}

impl Settings {
    pub(crate) fn swarm(&self) -> Params {
        Params {
            klt: self.search.klt(self.radius),
            corners: detect::Params {
                method: detect::Method::ShiTomasi,
                max_corners: self.particles as usize,
                quality: self.detection.quality as f32,
                min_distance_px: self.spacing as f32,
                window_radius_px: self.detection.corner_radius as u32,
            },
            life_frames: self.life as u32,
            scale_px: self.scale,
            reach_px: self.reach as f32,
        }
    }
}
