//! The parameters of the KLT plugin.

use honami_follow::{Detection, Losing, Search};
use honami_plugin::{choice, params};

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
        /// How a window may change from frame to frame; an affine one takes several times as long.
        model: Model = "translation" => { label: "Model", group: "Tracking" },
        ..search: Search,
        ..losing: Losing,
        ..detection: Detection,
    }
}
