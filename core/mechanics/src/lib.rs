//! Mechanics of plants: beams, their vibration modes, the wind, and how they move in it (thesis chapters 5 and 6).
//!
//! Metres, kilograms, seconds, radians; z up, right-handed. A [`Plant`](honami_model::plant::Plant) becomes [`Beams`],
//! these a pair of matrices that know their tree ([`TreeMatrix`]), and these [`Modes`].

mod beams;
mod bending;
mod element;
mod factor;
mod lanczos;
mod material;
mod modes;
mod oscillator;
mod rig;
mod simd;
mod tree_matrix;
pub mod wind;
mod wind_basis;

pub use beams::{Beams, BeamsError, Options};
pub use bending::{Bending, Form, unstretched};
pub use element::{Section, frame, shape};
pub use factor::Factor;
pub use material::Material;
pub use modes::{Modes, ModesError};
pub use oscillator::{Damping, Oscillator, State, symplectic_limit};
pub use rig::Rig;
pub use tree_matrix::TreeMatrix;
pub use wind_basis::{AIR, Drag, WindBasis};
