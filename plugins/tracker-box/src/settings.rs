//! The parameters of box matching, and what they mean to the algorithm.

use honami_follow::{Detection, Losing};
use honami_plugin::{Status, choice, params};
use honami_vision::boxes;
use honami_vision::klt::State;

choice! {
    /// Which displacements are tried.
    pub(crate) enum Strategy {
        /// All in the coarsest picture, and in finer ones those around the best.
        Pyramidal = "pyramidal" => "Pyramidal",
        /// All of them.
        Exhaustive = "exhaustive" => "Exhaustive",
    }
}

choice! {
    /// What makes two windows alike.
    pub(crate) enum Measure {
        /// Sum of squared differences: brightness must stay.
        Ssd = "ssd" => "Squared differences",
        /// Normalised cross-correlation: brightness and contrast may change.
        Ncc = "ncc" => "Normalised correlation",
    }
}

choice! {
    /// Where the template comes from.
    pub(crate) enum Source {
        /// The frame before: appearance may change, and small errors add up.
        Last = "last" => "Frame before",
        /// The frame it was seeded in: no drift, while it looks the same.
        Key = "key" => "Key-frame",
    }
}

params! {
    /// What the user may choose.
    pub(crate) struct Settings {
        /// Radius of the template; its side is 2r+1. Larger windows are found more surely and see less detail.
        radius: i64 = 10 => {
            label: "Template radius", group: "Tracking", unit: "px", min: 1, max: 50, soft_max: 31,
        },
        /// Farthest displacement from frame to frame, right, left, up and down.
        reach: i64 = 32 => { label: "Search reach", group: "Tracking", unit: "px", min: 1, max: 128, soft_max: 64 },
        /// Where the template comes from.
        template: Source = "last" => { label: "Template from", group: "Tracking" },
        /// What makes two windows alike.
        measure: Measure = "ssd" => { label: "Measure", group: "Tracking" },
        /// Which displacements are tried.
        strategy: Strategy = "pyramidal" => { label: "Strategy", group: "Tracking" },
        /// Levels of the pyramid; each makes template and search window half as large.
        levels: i64 = 2 => { label: "Levels", group: "Tracking", min: 1, max: 10, soft_max: 4 },
        /// Share of the displacements tried on a level, the best of them, that the next finer one starts from.
        share: f64 = 0.007 => { label: "Share carried down", group: "Tracking", min: 0, max: 1, advanced: true },
        /// A template whose brightness varies less (standard deviation, gray levels) is flat, and the point lost.
        min_contrast: f64 = 1.0 => {
            label: "Minimum contrast", group: "Tracking", min: 0, max: 128, soft_max: 10, advanced: true,
        },
        ..losing: Losing,
        ..detection: Detection,
    }
}

impl Settings {
    pub(crate) fn matching(&self) -> boxes::Params {
        boxes::Params {
            radius_px: self.radius as u32,
            search_px: self.reach as u32,
            method: match self.strategy {
                Strategy::Exhaustive => boxes::Method::Exhaustive,
                Strategy::Pyramidal => {
                    boxes::Method::Pyramidal { levels: self.levels as u32, share: self.share as f32 }
                }
            },
            measure: match self.measure {
                Measure::Ssd => boxes::Measure::Ssd,
                Measure::Ncc => boxes::Measure::Ncc,
            },
            min_contrast: self.min_contrast as f32,
        }
    }

    /// What became of a point: whether it was found, came back and still looks the same.
    ///
    /// There is no way back to a key-frame's template, so the limit of that error is none there.
    pub(crate) fn judge(&self, state: State, fb: Option<f32>, ncc: Option<f32>) -> Status {
        let fb = if self.template == Source::Key { Some(0.0) } else { fb };
        match state {
            State::Outside => Status::Outside,
            State::Lost(_) => Status::Lost,
            State::Tracked if self.losing.loses(fb, ncc) => Status::Lost,
            State::Tracked => Status::Tracked,
        }
    }
}
