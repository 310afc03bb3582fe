//! The parameters: where the graphs are, and what their numbers mean.

use std::path::PathBuf;

use honami_follow::Detection;
use honami_plugin::{choice, params};

choice! {
    /// In which order a graph has the coordinates of a position.
    pub(crate) enum Order {
        /// Down, then right.
        Yx = "yx" => "y, x",
        /// Right, then down.
        Xy = "xy" => "x, y",
    }
}

params! {
    /// What the user may choose.
    pub(crate) struct Settings {
        /// Folder with encoder.onnx, query.onnx and step.onnx.
        graphs: PathBuf = "" => { label: "Graphs", group: "Network", mode: "dir" },
        /// Width and height of the picture that the encoder sees, where its graph leaves them open.
        size: i64 = 256 => { label: "Input size", group: "Network", unit: "px", min: 8, max: 4096, soft_max: 1024 },
        /// Points that are followed together, where the graphs leave their number open.
        batch: i64 = 256 => { label: "Points together", group: "Network", min: 1, max: 100000, soft_max: 1000 },
        /// Coordinates that query.onnx takes.
        query_order: Order = "yx" => { label: "Order of queries", group: "Network" },
        /// Coordinates that step.onnx gives.
        track_order: Order = "xy" => { label: "Order of tracks", group: "Network" },
        /// A point that is less probably visible, and known to a few pixels, is occluded.
        visible: f64 = 0.5 => { label: "Visible from", group: "Tracking", min: 0, max: 1 },
        ..detection: Detection,
    }
}

impl Order {
    /// From x, y to what a graph wants, and back: the same exchange.
    pub(crate) fn arrange(self, [x, y]: [f32; 2]) -> [f32; 2] {
        match self {
            Self::Yx => [y, x],
            Self::Xy => [x, y],
        }
    }
}
