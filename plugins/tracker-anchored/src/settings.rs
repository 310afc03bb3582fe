//! The parameters of the anchored plugin, and what they mean to the algorithm.

use honami_follow::Detection;
use honami_plugin::params;
use honami_vision::{anchor, klt};

params! {
    /// What the user may choose.
    pub(crate) struct Settings {
        /// Radius of the key-frame's template; its side is 2r+1. About half the width of a leaf.
        radius: i64 = 7 => {
            label: "Template radius", group: "Tracking", unit: "px", min: 2, max: 50, soft_max: 21,
        },
        /// How far from where it is expected a point is looked for.
        search: i64 = 4 => { label: "Search", group: "Tracking", unit: "px", min: 0, max: 64, soft_max: 16 },
        /// Levels of the pyramid of the prediction; each doubles the displacement that can be followed.
        levels: i64 = 4 => { label: "Levels", group: "Tracking", min: 1, max: 10, soft_max: 6 },
        /// Points around a point that tell where it is, at most; 0: each point by itself.
        neighbours: i64 = 32 => { label: "Neighbours", group: "Tracking", min: 0, max: 256, soft_max: 64 },
        /// Corners around it that are followed for the sake of a point with fewer neighbours; 0: none.
        companions: i64 = 24 => { label: "Companions", group: "Tracking", min: 0, max: 256, soft_max: 64 },
        /// A point that correlates as much carries others, and teaches its template which pixels are its own.
        sure: f64 = 0.7 => { label: "Sure from correlation", group: "Tracking", min: 0, max: 1, advanced: true },
        /// Neighbours whose distance changes by as much count a quarter.
        kin: f64 = 3.0 => {
            label: "Kinship", group: "Tracking", unit: "px", min: 0.1, max: 100, soft_max: 10, advanced: true,
        },
        /// How fast a template learns which of its pixels belong to something else; 0: never.
        learning: f64 = 0.1 => { label: "Learning", group: "Tracking", min: 0, max: 1, advanced: true },
        /// A point that correlates less with its key-frame is hidden. Lower finds more, and more that is wrong.
        accept: f64 = 0.4 => { label: "Hidden below correlation", group: "Losing", min: 0, max: 1 },
        /// What correlation a point loses for each squared standard deviation off where its neighbours say it is; more
        /// for one that looks like what is around it.
        stray_cost: f64 = 0.015 => {
            label: "Cost of straying", group: "Losing", min: 0, max: 1, soft_max: 0.1, advanced: true,
        },
        /// A point that was hidden must correlate by as much more to be found again.
        return_cost: f64 = 0.1 => {
            label: "Cost of returning", group: "Losing", min: 0, max: 1, soft_max: 0.5, advanced: true,
        },
        /// A point that has been hidden for more frames in a row is lost.
        patience: i64 = 250 => {
            label: "Patience", group: "Losing", unit: "frames", min: 0, max: 1000000, soft_max: 1000,
        },
        ..detection: Detection,
    }
}

impl Settings {
    /// For dense motion, which has no template to hold on to: a larger window.
    pub(crate) fn dense(&self) -> klt::Params {
        klt::Params { levels: self.levels as u32, ..klt::Params::default() }
    }

    pub(crate) fn tracking(&self) -> anchor::Params {
        let usual = anchor::Params::default();
        let radius_px = self.radius as u32;
        anchor::Params {
            radius_px,
            // The bell is as wide for its window as the usual one.
            spread_px: usual.spread_px * radius_px as f32 / usual.radius_px as f32,
            search_px: self.search as u32,
            klt: klt::Params { radius_px, levels: self.levels as u32, ..usual.klt },
            accept: self.accept as f32,
            stray_cost: self.stray_cost as f32,
            return_cost: self.return_cost as f32,
            patience: self.patience as u32,
            sure: self.sure as f32,
            neighbours: self.neighbours as u32,
            companions: self.companions as u32,
            kin_px: self.kin as f32,
            learning: self.learning as f32,
            ..usual
        }
    }
}
