//! Structure builders and simulators, the mirror of `include/honami_draft.h`: drafts, not part of ABI 1.0.
#![allow(missing_docs, reason = "documented in honami_draft.h, where their meaning is normative")]

use crate::{Call, Code, Instance, Table};
use core::ffi::CStr;

pub const SKELETON: &CStr = c"honami.skeleton/1";
pub const WIND: &CStr = c"honami.wind/1";
pub const MOTION: &CStr = c"honami.motion/1";
pub const STRUCTURE: &CStr = c"honami.structure/1";
pub const SIMULATOR: &CStr = c"honami.simulator/1";

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StructureInput {
    pub struct_size: u32,
    pub max_threads: u32,
    pub seed: u64,
    pub tracks: *const Table,
    pub times: *const Table,
    pub dendrogram: *const Table,
}

#[repr(C)]
#[derive(Debug)]
pub struct StructureV1 {
    pub struct_size: u32,
    pub reserved: u32,
    pub run: Option<unsafe extern "C" fn(*mut Instance, *const Call, *const StructureInput) -> Code>,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct SimulatorInput {
    pub struct_size: u32,
    pub max_threads: u32,
    pub seed: u64,
    pub skeleton: *const Table,
    pub n_instances: u32,
    pub reserved: u32,
}

#[repr(C)]
#[derive(Debug)]
pub struct SimulatorV1 {
    pub struct_size: u32,
    pub reserved: u32,
    pub prepare: Option<unsafe extern "C" fn(*mut Instance, *const Call, *const SimulatorInput) -> Code>,
    pub reset: Option<unsafe extern "C" fn(*mut Instance, *const Call) -> Code>,
    pub step: Option<unsafe extern "C" fn(*mut Instance, *const Call, f64, u32, *const Table) -> Code>,
}
