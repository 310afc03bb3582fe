//! Where a reviewer should look: how doubtful every sample is, why, and in what order.
//!
//! [`evidence`] measures what speaks against a sample, [`suspicion`] makes a calibrated probability of it,
//! [`queue`] ranks the doubtful segments of all tracks; a [`Review`] holds where all that stands. [`fuse`] finds the best path through the candidates of
//! several trackers, [`loko`] tells how well a correction model does from the key-frames there are.
//!
//! Nothing here does input or output, keeps a clock or draws a random number; results do not depend on the order
//! of tracks nor on the number of threads.

pub mod evidence;
pub mod fuse;
pub mod loko;
pub mod queue;
mod review;
pub mod suspicion;

pub use review::{Review, Standing};
