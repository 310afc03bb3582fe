//! What the host and a plugin's own process say to each other.
//!
//! The process has a socket as its standard input: one JSON object a line, every request is answered by one `done`.
//! With the first line come two memories (`SCM_RIGHTS`): one that only the host writes, one that the process writes.
//! Pictures and columns lie there, at places that are bytes from the start, multiples of 64. A plugin of any language
//! can be served so; members that the other side does not know are ignored. After a picture nothing lies in the rest of
//! its 64 KiB nor in the next 64: a process can put a guard there. `lay.rs` is the host's side of a request, `hear.rs` the
//! process'.

mod hear;
mod lay;
pub(crate) mod memory;

use crate::values::Value;
pub(crate) use hear::hear;
pub(crate) use lay::ask;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of what is said here.
pub(crate) const VERSION: u32 = 1;

/// From the host.
#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "m", rename_all = "snake_case")]
pub(crate) enum Ask {
    /// The first line: make an instance of this plugin. The two memories come with it.
    Hello {
        honami: u32,
        plugin: String,
    },
    /// Every parameter at once.
    SetParams {
        values: BTreeMap<String, Value>,
    },
    Begin(Stream),
    Seed {
        points: Columns,
    },
    Retire {
        ids: Columns,
    },
    Push {
        frame: Frame,
    },
    End,
    Save,
    Load {
        state: Columns,
    },
    Detect {
        frame: Frame,
        max_features: u32,
        mask: Option<Plane>,
        points: Columns,
        max_threads: u32,
        seed: u64,
    },
    Field {
        from: Frame,
        to: Frame,
        max_threads: u32,
    },
    Cluster(Movement),
    Grow {
        movement: Movement,
        groups: Columns,
        root: Option<[f64; 2]>,
        mask: Option<Plane>,
    },
    Prepare {
        skeleton: Columns,
        instances: Columns,
        max_threads: u32,
        seed: u64,
    },
    Reset,
    Step {
        dt: f64,
        n_steps: u32,
        wind: Columns,
        n_winds: u64,
        detail: Option<Columns>,
    },
}

/// To the host.
#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "m", rename_all = "snake_case")]
pub(crate) enum Tell {
    /// A line of the plugin's log.
    Log { level: i32, text: String },
    /// Before the plugin is loaded: how far the process has shut itself in.
    ShutIn { level: String },
    /// What the plugin is at; how far is in the memory.
    At { text: String },
    /// The answer to a request.
    Done(Answer),
    /// The answer to `hello`, when there is no instance; the process ends.
    Refused(Refusal),
}

/// Why there is no instance.
#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(crate) enum Refusal {
    /// The plugin says so.
    Failed { code: i32, text: String },
    /// It broke the contract.
    Misbehaved { function: String, what: String },
    /// The library is none.
    Unusable { why: String },
}

/// How a call ended, and what it brought.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Answer {
    /// What the function returned.
    pub(crate) code: i32,
    /// Of a failure, in the plugin's words.
    pub(crate) text: String,
    /// How it broke the contract.
    pub(crate) faults: Vec<String>,
    /// Committed tables by schema.
    pub(crate) tables: BTreeMap<String, Columns>,
}

/// A table: where each column begins.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Columns {
    pub(crate) rows: u64,
    pub(crate) at: BTreeMap<String, u64>,
}

/// Bytes row by row, without gaps.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Plane {
    at: u64,
    width: u32,
    height: u32,
}

/// A frame of a clip.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Frame {
    gray: Plane,
    #[serde(default)]
    chroma: Option<[Plane; 2]>,
    /// `limited` or `full`, if known.
    #[serde(default)]
    range: Option<String>,
    index: i64,
    time_s: f64,
}

/// What is known of a stream before its first frame.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Stream {
    width: u32,
    height: u32,
    fps: Option<f64>,
    n_frames: Option<u64>,
    reversed: bool,
    max_threads: u32,
    seed: u64,
    birth_first: u32,
    birth_count: u32,
}

/// Tracks and the times of their frames.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Movement {
    tracks: Columns,
    n_samples: u64,
    times: Columns,
    width: u32,
    height: u32,
    max_threads: u32,
    seed: u64,
}

const LIMITED: &str = "limited";
const FULL: &str = "full";
