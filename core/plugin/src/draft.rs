//! Structure builders and simulators: drafts, not part of ABI 1.0. Metres, z up, right-handed.

use crate::{Cx, Info, Params, Result, Tracks};

/// Grows a skeleton from grouped tracks.
pub trait Structure: Sized + Send + 'static {
    /// Its parameters, made by [`params!`](crate::params!) (or `()`).
    type Params: Params;
    /// Id, name and description.
    const INFO: Info;

    /// Grows it.
    ///
    /// # Errors
    /// Whatever keeps it from that.
    fn grow(params: &Self::Params, tracks: &Tracks<'_>, cx: &Cx<'_>) -> Result<Vec<Node>>;
}

/// Moves instances of a plant in the wind.
pub trait Simulator: Sized + Send + 'static {
    /// Its parameters, made by [`params!`](crate::params!) (or `()`).
    type Params: Params;
    /// Id, name and description.
    const INFO: Info;

    /// Takes the plant, at rest at time 0.
    ///
    /// # Errors
    /// Whatever keeps it from working on it.
    fn prepare(params: &Self::Params, plant: &Plant, cx: &Cx<'_>) -> Result<Self>;

    /// Back to rest at time 0.
    fn reset(&mut self);

    /// Goes `n_steps` steps of `dt` seconds, then writes every node's displacement from rest, metres:
    /// `(n_instances, n_nodes)` row-major.
    ///
    /// # Errors
    /// Whatever keeps it from that.
    fn step(&mut self, dt: f64, n_steps: u32, wind: &[Gust], out: &mut [[f32; 3]], cx: &Cx<'_>)
    -> Result<()>;
}

/// A node of a skeleton at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Row of its parent, before its own; `None` for the root, row 0.
    pub parent: Option<u32>,
    /// Metres.
    pub position: [f32; 3],
    /// Metres.
    pub radius: f32,
    /// Row of the track it was grown from.
    pub track: Option<u32>,
}

/// What a simulator moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Plant {
    /// At rest.
    pub nodes: Vec<Node>,
    /// Copies, each in a state of its own.
    pub n_instances: u32,
    /// Threads that may work at a time, at least 1.
    pub max_threads: u32,
    /// Seed of every random choice.
    pub seed: u64,
}

/// Wind at a time, everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gust {
    /// Seconds.
    pub time_s: f64,
    /// Metres per second.
    pub wind: [f32; 3],
}
