//! A generated plant in the wind before a fixed camera, with the truth of how every leaf moves.
//!
//! A [`Scene`] is grown from [`Settings`]: a stem, limbs, branches and twigs with textured leaves on them.
//! Every branch turns about its base by a sum of sways and carries all that grows on it, under gusts that
//! pass over the plant. How hard the wind blows is *defined* by the mean displacement of a leaf per frame
//! ([`Level::step_px`]), not by what a tracker makes of it.
//!
//! ```
//! use honami_synth::{Scene, Settings};
//!
//! let scene = Scene::new(&Settings { width: 160, height: 120, n_frames: 10, n_leaves: 40, ..Settings::default() })?;
//! let picture = scene.render(3);
//! assert_eq!(picture.planes().y.width, 160);
//! let leaf = &scene.truth().leaves[7];
//! println!("leaf {} of branch {} is at {:?}", leaf.id, leaf.branch, leaf.path[3]);
//! # Ok::<(), honami_synth::SynthError>(())
//! ```

mod cover;
mod geometry;
mod moving;
mod outline;
mod plant;
mod pose;
mod render;
mod scene;
mod settings;
mod stage;
mod texture;
mod tree;
mod truth;
mod wind;

#[cfg(test)]
mod tests;

pub use moving::Moving;
pub use render::Picture;
pub use scene::Scene;
pub use settings::{Level, Settings, SynthError};
pub use stage::{Carried, Stage};
pub use tree::tree;
pub use truth::{At, BranchTruth, LeafTruth, Truth};
