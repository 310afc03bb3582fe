//! Structs of a plugin's, which may end before the newest field that this host knows.

use honami_abi as abi;
use std::mem::MaybeUninit;
use std::ptr::copy_nonoverlapping;

/// A struct that plugins hand out.
///
/// # Safety
/// It begins with `struct_size: u32`, has no padding, and zeros are a value of every field.
pub(super) unsafe trait Growing: Sized {}

macro_rules! growing {
    ($($ty:ty),*) => { $(
        // SAFETY: asserted by the layout table of honami-abi; the fields are numbers, pointers and optional functions.
        unsafe impl Growing for $ty {}
    )* };
}
growing!(
    abi::Library,
    abi::Instance,
    abi::TrackerV1,
    abi::DetectV1,
    abi::FieldV1,
    abi::StateV1,
    abi::ClustererV1,
    abi::StructureV1,
    abi::SimulatorV1
);

/// As much of a plugin's struct as the plugin knew; the fields after that are zero, functions among them missing.
///
/// # Safety
/// As many bytes as `struct_size`, its first field, says can be read at `given`.
pub(super) unsafe fn known<T: Growing>(given: *const T) -> T {
    // SAFETY: every struct that grows is at least its size.
    let size = unsafe { given.cast::<u32>().read_unaligned() } as usize;
    let size = size.min(size_of::<T>());
    let whole_fields = size - size % align_of::<T>();
    let mut known = MaybeUninit::<T>::zeroed();
    // SAFETY: the caller's promise, and not more than `known` holds; what is not copied is zero, which `Growing` allows.
    unsafe {
        copy_nonoverlapping(given.cast::<u8>(), known.as_mut_ptr().cast::<u8>(), whole_fields);
        known.assume_init()
    }
}
