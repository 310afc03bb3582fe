//! Mechanics of plants: beams, their vibration modes, the wind, and how they move in it (thesis chapters 5 and 6).
//!
//! Metres, kilograms, seconds, radians; z up, right-handed. A [`Plant`](honami_model::plant::Plant) becomes [`Beams`],
//! these a pair of matrices that know their tree ([`TreeMatrix`]), and these [`Modes`].

mod beams;
mod bending;
mod element;
mod factor;
mod forest;
mod lanczos;
mod leaves;
mod material;
mod modes;
mod oscillator;
mod rig;
mod roof;
mod shapes;
mod simd;
mod six;
mod stirring;
mod threads;
mod tree_matrix;
mod turning;
pub mod wind;
mod wind_basis;

pub use beams::{Beams, BeamsError, MOST_NODES, Options};
pub use bending::{Bending, Form};
pub use forest::{
    Blowing, Detail, DetailError, Details, Felt, Forest, ForestError, Numbers, Pace, Pose, Round, Stand,
    StateError, View, Winds,
};
pub use leaves::{Leaves, LeavesError};
pub use material::{Material, MaterialError};
pub use modes::{Modes, ModesError};
pub use oscillator::{Damping, Integrator, LimitError, Oscillator, State, Step};
pub use rig::Rig;
pub use roof::Roof;
pub use shapes::{Shapes, ShapesError, Sums};
pub use stirring::{Following, PullError, Stirring};
pub use threads::{Threads, ThreadsError};
pub use tree_matrix::TreeMatrix;
pub use turning::Turning;

/// Three numbers in space: a place, a way or a velocity.
pub type Vector = nalgebra::Vector3<f64>;
pub use wind_basis::{AIR, Drag, WindBasis};
