//! The parameters of each method, and where each keeps those that all trackers share.

use honami_follow::{Detection, Losing};
use honami_plugin::{Params, choice, params};

/// What all methods let the user choose.
pub(crate) trait Shared: Params + Clone {
    /// Radius of the windows that `ncc` compares, pixels.
    fn ncc_radius_px(&self) -> u32;

    /// From which quality on a point is lost.
    fn losing(&self) -> &Losing;

    /// Which corners are features.
    fn detection(&self) -> &Detection;
}

/// Says where each method keeps what all of them have.
macro_rules! shared {
    ($($settings:ident by $radius:ident),*) => { $(
        impl Shared for $settings {
            fn ncc_radius_px(&self) -> u32 {
                self.$radius as u32
            }
            fn losing(&self) -> &Losing {
                &self.losing
            }
            fn detection(&self) -> &Detection {
                &self.detection
            }
        }
    )* };
}

shared!(LkSettings by radius, DisSettings by ncc_radius, FarnebackSettings by ncc_radius, SiftSettings by ncc_radius);

params! {
    /// Of `calcOpticalFlowPyrLK`.
    pub(crate) struct LkSettings {
        /// Radius of the template; its side is 2r+1. Larger windows survive longer and see less detail.
        radius: i64 = 10 => {
            label: "Template radius", group: "Tracking", unit: "px", min: 1, max: 100, soft_max: 31,
        },
        /// Levels of the pyramid; each doubles the displacement that can be followed.
        levels: i64 = 4 => { label: "Levels", group: "Tracking", min: 1, max: 10, soft_max: 6 },
        /// The most steps on each level.
        iterations: i64 = 30 => {
            label: "Iterations", group: "Tracking", min: 1, max: 100, advanced: true,
        },
        /// A shorter step ends the search on a level.
        epsilon: f64 = 0.01 => {
            label: "Epsilon", group: "Tracking", unit: "px", min: 1e-5, max: 1, scale: "log", advanced: true,
        },
        /// A template whose gradient matrix has a smaller eigenvalue is flat, and the point lost.
        min_eigenvalue: f64 = 1e-4 => {
            label: "Minimum eigenvalue", group: "Tracking", min: 0, max: 1, advanced: true,
        },
        ..losing: Losing,
        ..detection: Detection,
    }
}

choice! {
    /// How thoroughly DIS looks.
    pub(crate) enum Preset {
        /// Half the resolution, patches far apart, no refinement.
        Ultrafast = "ultrafast" => "Ultrafast",
        /// Half the resolution, refined.
        Fast = "fast" => "Fast",
        /// Patches close together, refined.
        Medium = "medium" => "Medium",
    }
}

params! {
    /// Of `DISOpticalFlow`.
    pub(crate) struct DisSettings {
        /// How thoroughly to look: OpenCV's presets.
        preset: Preset = "medium" => { label: "Preset", group: "Flow" },
        /// Measures the flow back too, for the forward-backward error. Doubles the time.
        back: bool = true => { label: "Measure the way back", group: "Flow" },
        /// Radius of the windows that the correlation compares; it changes no position.
        ncc_radius: i64 = 10 => {
            label: "Correlation radius", group: "Flow", unit: "px", min: 1, max: 100, soft_max: 31, advanced: true,
        },
        ..losing: Losing,
        ..detection: Detection,
    }
}

params! {
    /// Of `calcOpticalFlowFarneback`.
    pub(crate) struct FarnebackSettings {
        /// Radius of the window that the motion is averaged over; its side is 2r+1.
        radius: i64 = 7 => {
            label: "Averaging radius", group: "Flow", unit: "px", min: 1, max: 100, soft_max: 31,
        },
        /// Levels of the pyramid; each doubles the displacement that can be followed.
        levels: i64 = 4 => { label: "Levels", group: "Flow", min: 1, max: 10, soft_max: 6 },
        /// Steps on each level.
        iterations: i64 = 3 => { label: "Iterations", group: "Flow", min: 1, max: 100, soft_max: 10, advanced: true },
        /// Radius of the neighbourhood that a polynomial describes.
        neighbourhood: i64 = 2 => {
            label: "Neighbourhood", group: "Flow", unit: "px", min: 1, max: 10, soft_max: 3, advanced: true,
        },
        /// Standard deviation of the weights in that neighbourhood.
        sigma: f64 = 1.1 => {
            label: "Sigma", group: "Flow", unit: "px", min: 0.3, max: 10, soft_max: 3, advanced: true,
        },
        /// Measures the flow back too, for the forward-backward error. Doubles the time.
        back: bool = true => { label: "Measure the way back", group: "Flow" },
        /// Radius of the windows that the correlation compares; it changes no position.
        ncc_radius: i64 = 10 => {
            label: "Correlation radius", group: "Flow", unit: "px", min: 1, max: 100, soft_max: 31, advanced: true,
        },
        ..losing: Losing,
        ..detection: Detection,
    }
}

choice! {
    /// Which descriptor a point is looked for with.
    pub(crate) enum Template {
        /// That of the frame it was seeded in: no drift, but it must keep its looks.
        Seed = "seed" => "Of the seed",
        /// That of the frame it was last found in: follows changing looks, and drifts.
        Last = "last" => "Of the last frame",
    }
}

params! {
    /// Of SIFT matching.
    pub(crate) struct SiftSettings {
        /// How far from where it was last found a key-point is looked for.
        search: f64 = 24.0 => {
            label: "Search radius", group: "Matching", unit: "px", min: 1, max: 1000, soft_max: 100,
        },
        /// A point is carried by the key-point nearest to it, at most this far away.
        reach: f64 = 12.0 => {
            label: "Reach", group: "Matching", unit: "px", min: 0.5, max: 100, soft_max: 30,
        },
        /// The best match must be this much nearer than the best elsewhere (Lowe's ratio).
        ratio: f64 = 0.8 => { label: "Ratio", group: "Matching", min: 0.1, max: 1 },
        /// A match whose descriptor differs by more than this share of its length is none; unrelated ones differ by about 1.
        difference: f64 = 0.6 => { label: "Largest difference", group: "Matching", min: 0.05, max: 1.5 },
        /// Which descriptor a point is looked for with.
        template: Template = "seed" => { label: "Descriptor", group: "Matching" },
        /// Key-points with less contrast are left out; the brightness of a picture is 1.
        contrast: f64 = 0.02 => {
            label: "Contrast", group: "Key-points", min: 0.001, max: 1, soft_max: 0.1, scale: "log",
        },
        /// Key-points on edges, whose curvatures differ by more than this factor, are left out.
        edge: f64 = 10.0 => { label: "Edge", group: "Key-points", min: 1, max: 1000, soft_max: 30, advanced: true },
        /// Radius of the windows that the correlation compares; it changes no position.
        ncc_radius: i64 = 10 => {
            label: "Correlation radius", group: "Matching", unit: "px", min: 1, max: 100, soft_max: 31, advanced: true,
        },
        ..losing: Losing,
        ..detection: Detection,
    }
}
