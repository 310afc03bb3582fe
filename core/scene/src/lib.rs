//! What is drawn: scenes, which one program writes and another shows, and pictures of them without a graphics card.
//!
//! A [`Scene`] is all that whoever draws has to know: a skeleton as it moves, or a forest with its plant, its modes and its
//! wind. The viewer draws it by wgpu, the terminal and movies by the painter and the rasteriser here. Metres, seconds,
//! radians; z up, right-handed; of skeletons pixels of the clip.

pub mod body;
pub mod camera;
pub mod control;
pub mod file;
pub mod forest;
pub mod grove;
pub mod paint;
pub mod palette;
pub mod raster;
pub mod skeleton;
pub mod sky;
#[cfg(test)]
mod testing;
pub mod tubes;
pub mod vector;
pub mod weather;

pub use camera::{Camera, Orbit};
pub use forest::ForestScene;
pub use skeleton::SkeletonScene;

use serde::{Deserialize, Serialize};

/// What is drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Scene {
    /// The bones behind tracks, over the clip or in space.
    Skeleton(Box<SkeletonScene>),
    /// Copies of a plant in the wind.
    Forest(Box<ForestScene>),
}

impl Scene {
    /// What of it cannot be drawn, in words.
    pub(crate) fn odd(&self) -> Option<String> {
        match self {
            Self::Skeleton(scene) => scene.odd(),
            Self::Forest(scene) => scene.odd(),
        }
    }
}
