//! The nouns of honami and the edits on them. Pure: no IO, no clock, no randomness.
//!
//! Image coordinates: x right, y down, pixels; (0, 0) is the centre of the top-left pixel.
//! Times are seconds, frames count from 0, a clip has T frames.

pub mod brief;
pub mod clip;
pub mod compose;
pub mod correct;
pub mod curve;
pub mod document;
pub mod edit;
pub mod hierarchy;
pub mod history;
pub mod judgement;
pub mod mesh;
pub mod over;
pub mod picture;
pub mod plant;
pub mod provenance;
pub mod regroup;
pub mod scale;
pub mod shape;
pub mod skeleton;
pub mod space;
pub mod track;
pub mod turn;
pub mod unfinished;
