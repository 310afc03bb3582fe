//! The contract between honami and its plugins, as Rust sees it: the mirror of `include/honami.h`.
//!
//! The header is the norm and carries the documentation: what each function does, on which thread and in which state it
//! may be called, who owns what. Names here are those of the header without the prefix. Every size and offset of both
//! is asserted from the one table in [`layout`]. Plugin authors want `honami-plugin`, which is safe.
#![no_std]

mod structs;

pub mod layout;

pub use structs::{
    Call, ClustererInput, ClustererV1, Column, DetectInput, DetectV1, FieldInput, FieldV1, Frame, HostInfo,
    Instance, Library, LibraryFn, SimulatorInput, SimulatorV1, StateV1, StepInput, StreamInfo,
    StructureInput, StructureV1, Table, TrackerV1, Value,
};

use core::ffi::CStr;

/// The major version: a different one is a different exported symbol.
pub const ABI_MAJOR: u32 = 1;
/// The newest minor of it that this mirror knows.
pub const ABI_MINOR: u32 = 1;
/// The one symbol that a plugin library exports.
pub const LIBRARY_SYMBOL: &CStr = c"honami_library_v1";
/// Section of the ELF note with the manifest.
pub const NOTE_SECTION: &str = ".note.honami";
/// Owner name of that note; its type is 1.
pub const NOTE_NAME: &CStr = c"honami";

/// What a call returns: a number from [`code`].
pub type Code = i32;

/// The numbers that calls return; negative ones are failures.
pub mod code {
    #![allow(missing_docs, reason = "documented in honami.h, where their meaning is normative")]
    pub const OK: i32 = 0;
    pub const AGAIN: i32 = 2;
    pub const FAILED: i32 = -1;
    pub const UNSUPPORTED: i32 = -2;
    pub const ARGUMENT: i32 = -3;
    pub const STATE: i32 = -4;
    pub const DATA: i32 = -5;
    pub const MEMORY: i32 = -6;
    pub const IO: i32 = -7;
    pub const CANCELLED: i32 = -8;
    pub const INTERNAL: i32 = -10;
}

/// Severities of log lines.
pub mod log {
    #![allow(missing_docs, reason = "documented in honami.h, where their meaning is normative")]
    pub const DEBUG: i32 = 0;
    pub const INFO: i32 = 1;
    pub const WARNING: i32 = 2;
    pub const ERROR: i32 = 3;
}

/// Element types of columns.
pub mod dtype {
    #![allow(missing_docs, reason = "documented in honami.h, where their meaning is normative")]
    pub const U8: u32 = 1;
    pub const I32: u32 = 2;
    pub const U32: u32 = 3;
    pub const I64: u32 = 4;
    pub const U64: u32 = 5;
    pub const F32: u32 = 6;
    pub const F64: u32 = 7;

    /// Bytes of an element, `None` for an unknown type.
    #[must_use]
    pub const fn size(dtype: u32) -> Option<usize> {
        match dtype {
            U8 => Some(1),
            I32 | U32 | F32 => Some(4),
            I64 | U64 | F64 => Some(8),
            _ => None,
        }
    }
}

/// Status of a point in a frame.
pub mod status {
    #![allow(missing_docs, reason = "documented in honami.h, where their meaning is normative")]
    pub const LOST: u8 = 0;
    pub const TRACKED: u8 = 1;
    pub const OCCLUDED: u8 = 2;
    pub const OUTSIDE: u8 = 3;
    pub const REJECTED: u8 = 4;
    pub const NEWBORN: u8 = 5;
}

/// Kinds of parameter values.
pub mod kind {
    #![allow(missing_docs, reason = "documented in honami.h, where their meaning is normative")]
    pub const BOOL: u32 = 1;
    pub const INT: u32 = 2;
    pub const FLOAT: u32 = 3;
    pub const TEXT: u32 = 4;
    pub const VEC2: u32 = 5;
    pub const RECT: u32 = 6;
    pub const SEED: u32 = 7;
}

/// Ids of tables; the required columns are in the header.
pub mod schema {
    #![allow(missing_docs, reason = "documented in honami.h, where their meaning is normative")]
    use core::ffi::CStr;
    pub const POINTS: &CStr = c"honami.points/1";
    pub const FEATURES: &CStr = c"honami.features/1";
    pub const VECTORS: &CStr = c"honami.vectors/1";
    pub const GRID: &CStr = c"honami.grid/1";
    pub const TRACKS: &CStr = c"honami.tracks/1";
    pub const TIMES: &CStr = c"honami.times/1";
    pub const DENDROGRAM: &CStr = c"honami.dendrogram/1";
    pub const FRAMES: &CStr = c"honami.frames/1";
    pub const STATE: &CStr = super::interface::STATE;
    pub const SKELETON: &CStr = c"honami.skeleton/1";
    pub const GROUPS: &CStr = c"honami.groups/1";
    pub const JOINTS: &CStr = c"honami.joints/1";
    pub const ROOT: &CStr = c"honami.root/1";
    pub const POSE: &CStr = c"honami.pose/1";
    pub const BEARS: &CStr = c"honami.bears/1";
    pub const LEAVES: &CStr = c"honami.leaves/1";
    pub const OFFSETS: &CStr = c"honami.offsets/1";
    pub const INSTANCES: &CStr = c"honami.instances/1";
    pub const WIND: &CStr = c"honami.wind/1";
    pub const DETAIL: &CStr = c"honami.detail/1";
    pub const MOTION: &CStr = c"honami.motion/1";
    pub const MODES: &CStr = c"honami.modes/1";
}

/// Ids of interfaces.
pub mod interface {
    #![allow(missing_docs, reason = "documented in honami.h, where their meaning is normative")]
    use core::ffi::CStr;
    pub const TRACKER: &CStr = c"honami.tracker/1";
    pub const DETECT: &CStr = c"honami.detect/1";
    pub const FIELD: &CStr = c"honami.field/1";
    pub const STATE: &CStr = c"honami.state/1";
    pub const CLUSTERER: &CStr = c"honami.clusterer/1";
    pub const STRUCTURE: &CStr = c"honami.structure/1";
    pub const SIMULATOR: &CStr = c"honami.simulator/1";
}

/// A byte a pixel, luma as coded.
pub const GRAY8: u32 = 1;

/// Which bytes mean black and white.
pub mod range {
    #![allow(missing_docs, reason = "documented in honami.h, where their meaning is normative")]
    pub const LIMITED: u32 = 1;
    pub const FULL: u32 = 2;
}

/// `latency` of a tracker whose results all come in `end`.
pub const LATENCY_ALL: u32 = u32::MAX;
/// `fb` where the forward-backward error was not measured.
pub const FB_NONE: f32 = -1.0;
/// `ncc` where the correlation was not measured.
pub const NCC_NONE: f32 = -2.0;

/// Whether the struct behind a reference to `$T` was made by somebody who knew its field `$f`.
#[macro_export]
macro_rules! has {
    ($reference:expr, $T:ty, $f:ident) => {
        $reference.struct_size as usize >= $crate::size_to!($T, $f)
    };
}

/// Size of struct `$T` up to and including field `$f`.
#[macro_export]
macro_rules! size_to {
    ($T:ty, $f:ident) => {
        ::core::mem::offset_of!($T, $f) + $crate::layout::size_of_field(|s: &$T| &s.$f)
    };
}
