//! The SDK for authors of honami plugins: safe traits on this side, the C contract of `honami.h` on the other.
//!
//! A plugin is a crate of type `cdylib` that implements a trait and exports it. This one is complete:
//!
//! ```
//! use honami_plugin::{Cx, Frame, Info, Point, Points, Result, Seed, Status, Stream, Tracker, export, params};
//!
//! params! {
//!     /// What the user may choose.
//!     pub struct Choice {
//!         /// How far every point drifts to the right in a frame.
//!         drift: f64 = 1.0 => { label: "Drift", unit: "px/frame", min: -10, max: 10 },
//!     }
//! }
//!
//! /// Reports every point a little to the right of where it was.
//! struct Drift {
//!     step: f32,
//!     points: Vec<Seed>,
//!     started: bool,
//! }
//!
//! impl Tracker for Drift {
//!     type Params = Choice;
//!     const INFO: Info = Info { id: "org.example.drift", name: "Drift", doc: "x += drift", ..Info::NEW };
//!
//!     fn begin(params: &Choice, _: &Stream, _: &Cx<'_>) -> Result<Self> {
//!         Ok(Self { step: params.drift as f32, points: Vec::new(), started: false })
//!     }
//!
//!     fn seed(&mut self, seeds: &[Seed], _: &Cx<'_>) -> Result<()> {
//!         self.points.retain(|point| seeds.iter().all(|seed| seed.id != point.id));
//!         self.points.extend(seeds);
//!         Ok(())
//!     }
//!
//!     fn retire(&mut self, ids: &[u32]) {
//!         self.points.retain(|point| !ids.contains(&point.id));
//!     }
//!
//!     fn push(&mut self, frame: &Frame<'_>, out: &mut Points, cx: &Cx<'_>) -> Result<()> {
//!         cx.progress(0.0, "drifting")?; // `?` is how a cancel gets out
//!         // What is seeded before the first frame holds there; everything else holds in the frame before this one.
//!         let step = if self.started { self.step } else { 0.0 };
//!         self.started = true;
//!         for point in &mut self.points {
//!             point.x += step;
//!             let inside = (-0.5..frame.gray.width as f32 - 0.5).contains(&point.x);
//!             out.add(Point::new(point.id, point.x, point.y, if inside { Status::Tracked } else { Status::Outside }));
//!         }
//!         Ok(())
//!     }
//! }
//!
//! export! {
//!     library: { id: "org.example", version: env!("CARGO_PKG_VERSION"), license: "MIT" },
//!     plugins: [tracker Drift],
//! }
//! ```
//!
//! The pieces: [`Tracker`], [`Clusterer`], [`Structure`], [`Simulator`]; [`params!`] and [`choice!`] for parameters;
//! [`export!`] for the border; [`Cx`] for progress, cancel and log; [`testing`] to run a plugin without a host. The
//! algorithm itself belongs in a library crate that knows nothing of plugins.
//!
//! A panic costs the instance, not the host: it becomes an error, its message goes to the log, and the instance answers
//! nothing but `destroy` from then on. Never print: the terminal is the user's.

mod clusterer;
mod cx;
mod error;
mod info;
mod manifest;
mod simulator;
mod state;
mod structure;
mod tracker;

pub mod export;
pub mod params;
pub mod testing;

pub use clusterer::{Clusterer, Clustering, FrameNote, Merge, Track, Tracks};
pub use cx::{Cx, Listener};
pub use error::{Error, Result};
#[doc(hidden)]
pub use honami_abi as abi;
pub use info::{Info, Library};
pub use params::{Entry, Param, ParamType, Params, Value};
pub use simulator::{Blowing, Detail, Instance, Mode, Node, Plant, Simulator, Steps, Wind};
pub use state::State;
pub use structure::{Filmed, Groups, Joint, Leaf, Skeleton, Structure};
pub use tracker::{
    Chroma, Detect, DetectFn, Feature, Field, FieldFn, Frame, Gray, Point, Points, Range, Seed, Status,
    Stream, Tracker,
};
