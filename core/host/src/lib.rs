//! The host of plugins: finds them, reads what they are without running them, loads them, and checks what they return.
//!
//! The way of a plugin: [`Registry::scan`] reads manifests from files along the search path; [`Registry::find`] gives a
//! [`PluginInfo`], whose parameters a form is drawn from; [`Host::tracker`] and its like make a handle to one
//! at work. A handle's calls take a [`CallContext`] for progress, cancel and log, and give results that have been
//! checked: whatever breaks the contract of `honami.h` is a [`HostError::Misbehaved`] with names and numbers, and
//! nothing of it reaches the caller.
//!
//! Handles do not know where a plugin runs: in this process, or in one of its own ([`Hosting`]). Either way it is loaded
//! from a copy in the store that is named by its hash, and never unloaded.

mod call;
mod clusterer;
mod context;
mod error;
mod host;
mod in_process;
mod instance;
mod isolated;
mod manifest;
mod note;
mod plain;
mod plughost;
mod prospect;
mod quarantine;
mod rebuilt;
mod registry;
mod regular;
mod reply;
mod script;
mod shell;
mod simulator;
mod store;
mod structure;
mod tracker;
mod trust;
mod types;
mod values;
mod wire;

pub mod sdk;

pub use clusterer::Clusterer;
pub use context::{CallContext, Flow, Level, Patience, Silence};
pub use error::{Code, HostError};
pub use host::{Host, Hosting, Origin};
pub use isolated::{Ended, Limits, program};
pub use manifest::{Caps, Entry, Kind, Needs, Numeric, Param, ParamKind};
pub use note::needed;
pub use plain::plain;
pub use plughost::{serve, shut_in};
pub use prospect::Prospect;
pub use quarantine::ended_well;
pub use rebuilt::Watch;
pub use registry::{PluginInfo, Registry, SearchPath, Trust};
pub use script::{Part, manifest_of as file_of, parts_of};
pub use shell::quoted;
pub use simulator::{Detail, ModeRow, PlantInstance, Simulator, Steps, WindRows};
pub use structure::{Grown, Structure};
pub use tracker::{Checkpoint, Tracker};
pub use trust::TrustBook;
pub use types::{
    Clustering, DetectRequest, Feature, Field, Filmed, FrameNote, FrameView, GroupTree, Node, Point,
    PointRow, Points, StreamInfo, Tracks,
};
pub use values::{Value, ValueError, Values};
