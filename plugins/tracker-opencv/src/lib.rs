//! OpenCV's trackers as honami plugins, for comparison and for who prefers them: LK, DIS, Farneback, SIFT.
//!
//! Each method is a plugin of its own rather than a choice in one, so that a comparison can name several and each
//! form shows only what its method understands. A C++ exception never gets here: the `opencv` crate catches it on its
//! own side of the border and hands it over as an error.
#![cfg(feature = "opencv")]

mod dense;
mod follow;
mod lk;
mod picture;
mod settings;
mod sift;
#[cfg(test)]
mod tests;

use dense::{Dense, Dis, Farneback};
use follow::Follower;
use honami_plugin::export;
use lk::Lk;
use sift::Sift;

export! {
    library: { id: "org.honami.opencv", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [
        tracker Follower<Lk>,
        tracker Follower<Dense<Dis>>,
        tracker Follower<Dense<Farneback>>,
        tracker Follower<Sift>,
    ],
}
