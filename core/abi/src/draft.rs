//! Structure builders, the mirror of `include/honami_draft.h`: a draft, not part of ABI 1.1.
#![allow(missing_docs, reason = "documented in honami_draft.h, where their meaning is normative")]

use crate::{Call, Code, Instance, Table};
use core::ffi::CStr;

pub const STRUCTURE: &CStr = c"honami.structure/1";

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
