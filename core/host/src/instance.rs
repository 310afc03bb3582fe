//! The seam between typed handles and what hosts a plugin: requests go in, unchecked replies come out.
//!
//! Handles know only [`Instance`]: one calls the library in this process, one asks another process.

use crate::context::CallContext;
use crate::error::{Code, HostError};
use crate::isolated::Ended;
use crate::quarantine::{Tally, Trail};
use crate::reply::{self, Reply, Schema};
use crate::simulator::{PlantInstance, Steps};
use crate::types::{DetectRequest, Filmed, FrameView, Node, Point, StreamInfo, Tracks};
use crate::values::Value;
use honami_abi::code;

/// A function of the ABI with what it is given.
#[derive(Debug)]
pub(crate) enum Request<'a> {
    SetParams(&'a [(&'a str, &'a Value, u32)]),
    Begin(&'a StreamInfo),
    Seed(&'a [Point]),
    Retire(&'a [u32]),
    Push(&'a FrameView<'a>),
    End,
    /// What the tracker carries: for a later `Load`, which comes directly after `Begin`.
    Save,
    Load(&'a [u8]),
    Detect(&'a DetectRequest<'a>),
    Field {
        from: &'a FrameView<'a>,
        to: &'a FrameView<'a>,
        max_threads: u32,
    },
    Cluster(&'a Tracks),
    Grow(&'a Filmed<'a>),
    Prepare {
        nodes: &'a [Node],
        instances: &'a [PlantInstance],
        max_threads: u32,
        seed: u64,
    },
    Reset,
    Step(&'a Steps<'a>),
}

impl Request<'_> {
    /// The function's name in the header.
    pub(crate) fn function(&self) -> &'static str {
        match self {
            Self::SetParams(_) => "set_params",
            Self::Begin(_) => "begin",
            Self::Seed(_) => "seed",
            Self::Retire(_) => "retire",
            Self::Push(_) => "push",
            Self::End => "end",
            Self::Save => "save",
            Self::Load(_) => "load",
            Self::Detect(_) => "detect",
            Self::Field { .. } => "field",
            Self::Cluster(_) | Self::Grow(_) => "run",
            Self::Prepare { .. } => "prepare",
            Self::Reset => "reset",
            Self::Step(_) => "step",
        }
    }

    /// Whether the plugin may refuse it and go on as it was.
    fn can_be_refused(&self) -> bool {
        matches!(self, Self::SetParams(_) | Self::Save | Self::Load(_))
    }

    /// The tables that it may commit.
    pub(crate) fn schemas(&self) -> &'static [&'static Schema] {
        match self {
            Self::Push(_) | Self::End => &[&reply::POINTS],
            Self::Save => &[&reply::STATE],
            Self::Detect(_) => &[&reply::FEATURES],
            Self::Field { .. } => &[&reply::VECTORS, &reply::GRID],
            Self::Cluster(_) => &[&reply::DENDROGRAM, &reply::FRAMES],
            Self::Grow(_) => {
                use reply::{BEARS, JOINTS, LEAVES, OFFSETS, POSE, ROOT};
                &[&JOINTS, &ROOT, &POSE, &BEARS, &LEAVES, &OFFSETS]
            }
            Self::Prepare { .. } => &[&reply::MODES],
            Self::Step(_) => &[&reply::MOTION],
            _ => &[],
        }
    }
}

/// One plugin at work, wherever it runs.
pub(crate) trait Instance: Send {
    /// Passes on a request and fills the reply. Types and sizes of its tables are right; nothing else is sure.
    fn invoke(&mut self, request: &Request<'_>, cx: &CallContext<'_>, reply: &mut Reply);

    /// Whether it can end while this process goes on.
    fn can_end(&self) -> bool;
}

/// What every typed handle does: asks, reads the code, and gives up on an instance that failed.
pub(crate) struct Handle {
    pub(crate) plugin: String,
    instance: Box<dyn Instance>,
    failed: bool,
    /// Where its deaths are counted, if they are.
    pub(crate) tally: Option<Tally>,
    /// What it leaves in this process: it goes after the instance.
    _trail: Option<Trail>,
}

/// How a call ended that did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Done {
    Ok,
    /// Accepted; the result comes later.
    Again,
}

impl Handle {
    pub(crate) fn new(
        plugin: String,
        instance: Box<dyn Instance>,
        tally: Option<Tally>,
        trail: Option<Trail>,
    ) -> Self {
        Self { plugin, instance, failed: false, tally, _trail: trail }
    }

    pub(crate) fn ask(
        &mut self,
        request: &Request<'_>,
        cx: &CallContext<'_>,
        reply: &mut Reply,
    ) -> Result<Done, HostError> {
        if self.failed {
            return Err(self.usage("has failed before; make it anew"));
        }
        self.instance.invoke(request, cx, reply);
        let function = request.function();
        if let Some(how) = reply.ended.take() {
            self.failed = true;
            let last_words = std::mem::take(&mut reply.last_words);
            if let Some(tally) = &self.tally {
                tally.ended(&how, &last_words);
            }
            let plugin = self.plugin.clone();
            if how == Ended::Stopped {
                return Err(HostError::Cancelled { plugin });
            }
            let frame = match request {
                Request::Push(view) => Some(view.index),
                _ => None,
            };
            return Err(HostError::Ended { plugin, function, frame, how, last_words });
        }
        if let Some(what) = reply.faults.first() {
            return Err(self.misbehaved(function, what.clone()));
        }
        match reply.code {
            code::AGAIN => Ok(Done::Again),
            0.. => Ok(Done::Ok),
            code::CANCELLED if reply.stopped => Err(HostError::Cancelled { plugin: self.plugin.clone() }),
            failure => {
                // Refused parameters leave the former ones in force; a fault is a fault in any function.
                self.failed = !request.can_be_refused() || failure == code::INTERNAL;
                let text = if reply.text.is_empty() { "gives no reason".into() } else { reply.text.clone() };
                Err(HostError::Failed { plugin: self.plugin.clone(), function, code: Code(failure), text })
            }
        }
    }

    /// Whether it answers nothing any more.
    pub(crate) fn has_failed(&self) -> bool {
        self.failed
    }

    pub(crate) fn can_end(&self) -> bool {
        self.instance.can_end()
    }

    /// The error of a broken contract; ends the instance.
    pub(crate) fn misbehaved(&mut self, function: &'static str, what: impl Into<String>) -> HostError {
        self.failed = true;
        HostError::Misbehaved { plugin: self.plugin.clone(), function, what: what.into() }
    }

    pub(crate) fn usage(&self, what: impl Into<String>) -> HostError {
        HostError::Usage { plugin: self.plugin.clone(), what: what.into() }
    }
}

impl std::fmt::Debug for Handle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Handle").field("plugin", &self.plugin).field("failed", &self.failed).finish()
    }
}
