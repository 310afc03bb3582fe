//! The structs of ABI 1.1, field by field as in `honami.h`; function pointers may be null there, so they are `Option`s.
#![allow(missing_docs, reason = "documented in honami.h, where their meaning is normative")]

use crate::Code;
use core::ffi::{c_char, c_void};

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Column {
    pub name: *const c_char,
    pub dtype: u32,
    pub ncomp: u32,
    pub data: *mut c_void,
    pub rows: u64,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Table {
    pub struct_size: u32,
    pub ncols: u32,
    pub schema: *const c_char,
    pub cols: *const Column,
    pub rows: u64,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Value {
    pub id: *const c_char,
    pub kind: u32,
    pub reserved: u32,
    pub i: i64,
    pub f: [f64; 4],
    pub text: *const c_char,
}

#[repr(C)]
#[derive(Debug)]
pub struct Call {
    pub struct_size: u32,
    pub reserved: u32,
    pub host: *mut c_void,
    pub progress: Option<unsafe extern "C" fn(*const Call, f64, *const c_char) -> i32>,
    pub log: Option<unsafe extern "C" fn(*const Call, i32, *const c_char)>,
    pub fail: Option<unsafe extern "C" fn(*const Call, Code, *const c_char) -> Code>,
    pub reserve: Option<unsafe extern "C" fn(*const Call, *const c_char, u64, u32, *mut Column) -> Code>,
    pub commit: Option<unsafe extern "C" fn(*const Call, *const c_char, u64) -> Code>,
    pub host_ext: Option<unsafe extern "C" fn(*const Call, *const c_char) -> *const c_void>,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct HostInfo {
    pub struct_size: u32,
    pub abi_minor: u32,
    pub name: *const c_char,
    pub version: *const c_char,
}

#[repr(C)]
#[derive(Debug)]
pub struct Instance {
    pub struct_size: u32,
    pub reserved: u32,
    pub this: *mut c_void,
    pub destroy: Option<unsafe extern "C" fn(*mut Instance)>,
    pub set_params: Option<unsafe extern "C" fn(*mut Instance, *const Call, *const Value, u32) -> Code>,
    pub get_interface: Option<unsafe extern "C" fn(*mut Instance, *const c_char) -> *const c_void>,
}

#[repr(C)]
#[derive(Debug)]
pub struct Library {
    pub struct_size: u32,
    pub abi_minor: u32,
    pub manifest: *const c_char,
    pub manifest_len: u64,
    pub create: Option<unsafe extern "C" fn(*const HostInfo, *const Call, *const c_char) -> *mut Instance>,
}

/// The type of `honami_library_v1`.
pub type LibraryFn = unsafe extern "C" fn(*const HostInfo) -> *const Library;

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub struct_size: u32,
    pub pixel: u32,
    pub width: u32,
    pub height: u32,
    pub stride: i64,
    pub data: *const u8,
    pub index: i64,
    pub time_s: f64,
    pub cb: *const u8,
    pub cr: *const u8,
    pub chroma_stride: i64,
    pub range: u32,
    pub reserved: u32,
    pub chroma_width: u32,
    pub chroma_height: u32,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StreamInfo {
    pub struct_size: u32,
    pub pixel: u32,
    pub width: u32,
    pub height: u32,
    pub fps: f64,
    pub nframes: i64,
    pub direction: i32,
    pub max_threads: u32,
    pub seed: u64,
    pub birth_first: u32,
    pub birth_count: u32,
}

#[repr(C)]
#[derive(Debug)]
pub struct TrackerV1 {
    pub struct_size: u32,
    pub latency: u32,
    pub begin: Option<unsafe extern "C" fn(*mut Instance, *const Call, *const StreamInfo) -> Code>,
    pub seed: Option<unsafe extern "C" fn(*mut Instance, *const Call, *const Table) -> Code>,
    pub retire: Option<unsafe extern "C" fn(*mut Instance, *const Call, *const u32, u64) -> Code>,
    pub push: Option<unsafe extern "C" fn(*mut Instance, *const Call, *const Frame) -> Code>,
    pub end: Option<unsafe extern "C" fn(*mut Instance, *const Call) -> Code>,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct DetectInput {
    pub struct_size: u32,
    pub max_features: u32,
    pub frame: *const Frame,
    pub mask: *const u8,
    pub mask_stride: i64,
    pub points: *const Table,
    pub max_threads: u32,
    pub reserved: u32,
    pub seed: u64,
}

#[repr(C)]
#[derive(Debug)]
pub struct DetectV1 {
    pub struct_size: u32,
    pub reserved: u32,
    pub detect: Option<unsafe extern "C" fn(*mut Instance, *const Call, *const DetectInput) -> Code>,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FieldInput {
    pub struct_size: u32,
    pub max_threads: u32,
    pub from: *const Frame,
    pub to: *const Frame,
}

#[repr(C)]
#[derive(Debug)]
pub struct FieldV1 {
    pub struct_size: u32,
    pub reserved: u32,
    pub field: Option<unsafe extern "C" fn(*mut Instance, *const Call, *const FieldInput) -> Code>,
}

#[repr(C)]
#[derive(Debug)]
pub struct StateV1 {
    pub struct_size: u32,
    pub reserved: u32,
    pub save: Option<unsafe extern "C" fn(*mut Instance, *const Call) -> Code>,
    pub load: Option<unsafe extern "C" fn(*mut Instance, *const Call, *const u8, u64) -> Code>,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ClustererInput {
    pub struct_size: u32,
    pub max_threads: u32,
    pub width: u32,
    pub height: u32,
    pub seed: u64,
    pub tracks: *const Table,
    pub times: *const Table,
}

#[repr(C)]
#[derive(Debug)]
pub struct ClustererV1 {
    pub struct_size: u32,
    pub reserved: u32,
    pub run: Option<unsafe extern "C" fn(*mut Instance, *const Call, *const ClustererInput) -> Code>,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StructureInput {
    pub struct_size: u32,
    pub max_threads: u32,
    pub width: u32,
    pub height: u32,
    pub seed: u64,
    pub tracks: *const Table,
    pub times: *const Table,
    pub groups: *const Table,
    pub root: *const f64,
    pub mask: *const u8,
    pub mask_stride: i64,
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
    pub instances: *const Table,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StepInput {
    pub struct_size: u32,
    pub n_steps: u32,
    pub dt: f64,
    pub wind: *const Table,
    pub detail: *const Table,
}

#[repr(C)]
#[derive(Debug)]
pub struct SimulatorV1 {
    pub struct_size: u32,
    pub reserved: u32,
    pub prepare: Option<unsafe extern "C" fn(*mut Instance, *const Call, *const SimulatorInput) -> Code>,
    pub reset: Option<unsafe extern "C" fn(*mut Instance, *const Call) -> Code>,
    pub step: Option<unsafe extern "C" fn(*mut Instance, *const Call, *const StepInput) -> Code>,
}
