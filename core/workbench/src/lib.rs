//! The use-cases of honami as cancellable jobs on a project: what the terminal and the command line both call.
//!
//! A job has three steps. *Prepare* reads what it needs from the project; *run* works on any thread, reports
//! [progress](progress::Progress) and can be stopped; *finish* commits one edit that undo takes back.

pub mod calibrate;
pub mod cluster;
pub mod compare;
pub mod components;
pub mod correct;
pub mod dense;
pub mod densities;
pub mod doctor;
pub mod drive;
mod ear;
mod error;
pub mod export;
pub mod generate;
mod ground;
pub mod grow;
pub mod import;
pub mod matte;
pub mod movie;
pub mod offer;
pub mod plant;
pub mod plots;
pub mod progress;
pub mod rebuilt;
pub mod regroup;
pub mod retrack;
pub mod review;
pub mod scale;
mod scarce;
pub mod script;
pub mod sensors;
pub mod session;
pub mod shape;
pub mod simulate;
pub mod space;
pub mod spectra;
mod stamp;
pub mod sways;
pub mod sync;
pub mod track;
#[cfg(test)]
mod tried;
pub mod used;
pub mod versus;
pub mod view;

pub use error::matte::MatteError;
pub use error::{CamerasError, SensorsError, SpaceError, WorkbenchError};
/// Cameras that measure.
pub use honami_cameras as cameras;
/// What plugins must bear.
pub use honami_check as check;
/// Tracks of other programs.
pub use honami_exchange::foreign;
/// Where files count pixels from.
pub use honami_exchange::origin;
/// Plugins and their parameters.
pub use honami_host as plugins;
/// Opacities of plants.
pub use honami_matting as matting;
/// Plants as beams, in the wind.
pub use honami_mechanics as mechanics;
/// Clips and their frames.
pub use honami_media as media;
/// Motion as colour.
pub use honami_motion::overlay;
/// What is drawn.
pub use honami_scene as scene;
/// Colours of what is drawn.
pub use honami_scene::palette;
/// Projects.
pub use honami_store as store;
/// Generated clips.
pub use honami_synth as synth;
