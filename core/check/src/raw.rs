//! A second host, which shares nothing with the first: it calls a library by the header alone, as hosts of other times
//! would.
#![allow(unsafe_code, reason = "this is where Rust calls into C")]

mod desk;
mod dress;
mod library;
mod made;
mod play;

pub(crate) use desk::Desk;
pub(crate) use dress::Dress;
pub(crate) use library::Library;
pub(crate) use made::Made;
pub(crate) use play::{Played, Scene, play};

use honami_abi as abi;
use std::mem::MaybeUninit;

/// A struct that begins with `struct_size: u32`, without padding; zeros are a value of all its fields.
///
/// # Safety
/// As it says.
pub(crate) unsafe trait Sized32: Sized {
    /// Its size in ABI 1.0.
    const OLD_BYTES: usize;
    /// Where its reserved field lies, a `u32`.
    const RESERVED_AT: Option<usize>;
}

macro_rules! sized {
    ($($ty:ty: $last:ident, $reserved:expr;)*) => { $(
        // SAFETY: asserted by the layout table of honami-abi; the fields are numbers, pointers and optional functions.
        unsafe impl Sized32 for $ty {
            const OLD_BYTES: usize = abi::size_to!($ty, $last);
            const RESERVED_AT: Option<usize> = $reserved;
        }
    )* };
}
sized! {
    abi::HostInfo: version, None;
    abi::Call: host_ext, Some(std::mem::offset_of!(abi::Call, reserved));
    abi::Table: rows, None;
    abi::Frame: time_s, Some(std::mem::offset_of!(abi::Frame, reserved));
    abi::StreamInfo: birth_count, None;
    abi::DetectInput: seed, Some(std::mem::offset_of!(abi::DetectInput, reserved));
    abi::FieldInput: to, None;
    abi::ClustererInput: times, None;
    abi::StructureInput: mask_stride, None;
    abi::SimulatorInput: instances, None;
    abi::StepInput: detail, None;
    abi::Library: create, None;
    abi::Instance: get_interface, None;
    abi::TrackerV1: end, None;
    abi::DetectV1: detect, None;
    abi::FieldV1: field, None;
    abi::ClustererV1: run, None;
    abi::StructureV1: run, None;
    abi::SimulatorV1: step, None;
}

/// As much of a plugin's struct as the plugin knew; the rest is zero.
///
/// # Safety
/// As many bytes as `struct_size` says can be read at `at`, which is not null.
unsafe fn known<T: Sized32>(at: *const T) -> T {
    let mut known = MaybeUninit::<T>::zeroed();
    // SAFETY: the caller's promise, and not more than fits; zeros are a value of what is not copied.
    unsafe {
        let size = at.cast::<u32>().read_unaligned() as usize;
        std::ptr::copy_nonoverlapping(at.cast::<u8>(), known.as_mut_ptr().cast(), size.min(size_of::<T>()));
        known.assume_init()
    }
}
