//! Structure builders across the border.

use super::clusterer::read_tracks;
use super::stateless::{Function, Stateless};
use super::table::{Reserved, column, given, slice};
use super::{Descriptor, HostCall, door, new_instance};
use crate::structure::{Filmed, Groups, Skeleton, Structure};
use crate::{Cx, Error, Gray, Params, Result};
use honami_abi::{self as abi, Call, Code, Instance, code, dtype, interface, schema};
use std::ffi::CStr;
use std::marker::PhantomData;

/// Describes a structure builder to [`export!`](crate::export!).
#[must_use]
pub const fn structure<T: Structure>() -> Descriptor {
    Descriptor {
        kind: "structure",
        info: T::INFO,
        interfaces: [("honami.structure/1", true), ("", false), ("", false), ("", false)],
        params: T::Params::SCHEMA,
        latency: 0,
        create: new_instance::<Stateless<Growing<T>>>,
    }
}

/// `Structure::grow` as a function of the ABI.
struct Growing<T>(PhantomData<T>);

impl<T: Structure> Function for Growing<T> {
    type Params = T::Params;
    type Table = abi::StructureV1;
    const INTERFACE: &'static CStr = interface::STRUCTURE;
    const TABLE: &'static abi::StructureV1 = &abi::StructureV1 {
        struct_size: size_of::<abi::StructureV1>() as u32,
        reserved: 0,
        run: Some(run::<T>),
    };
}

unsafe extern "C" fn run<T: Structure>(
    instance: *mut Instance,
    call: *const Call,
    input: *const abi::StructureInput,
) -> Code {
    // SAFETY: the host keeps the contract of honami_structure_v1.
    unsafe {
        door::<Stateless<Growing<T>>>(instance, call, |state, call| {
            let filmed = read_filmed(&given(input)?)?;
            commit(call, &T::grow(&state.params, &filmed, &Cx::new(call))?)?;
            Ok(code::OK)
        })
    }
}

/// # Safety
/// The struct is the host's, and what it points to lives for `'a`.
unsafe fn read_filmed<'a>(input: &abi::StructureInput) -> Result<Filmed<'a>> {
    // SAFETY: the caller's promise, here and below; a mask has a row of bytes for every row of the frames.
    let mut tracks = unsafe { read_tracks(&given(input.tracks)?, &given(input.times)?)? };
    (tracks.width, tracks.height) = (input.width, input.height);
    (tracks.max_threads, tracks.seed) = (input.max_threads.max(1), input.seed);
    // SAFETY: see above.
    let groups = unsafe {
        let table = given(input.groups)?;
        Groups { parents: column(&table, c"parent", 1)?, of: column(&table, c"group", 1)? }
    };
    let fits = |of: &i32| usize::try_from(*of).map_or(true, |of| of < groups.parents.len());
    if groups.of.len() != tracks.len() || !groups.of.iter().all(fits) {
        return Err(Error::with_code(code::ARGUMENT, "the host's groups do not fit its tracks"));
    }
    let root = match input.root.is_null() {
        true => None,
        // SAFETY: see above.
        false => unsafe { slice(input.root, 2)? }.as_array::<2>().copied(),
    };
    let mask = match input.mask.is_null() {
        true => None,
        false => {
            let (width, height) = (input.width, input.height);
            let stride = usize::try_from(input.mask_stride)?;
            let n_bytes = u64::from(height).saturating_sub(1) * stride as u64 + u64::from(width);
            // SAFETY: see above.
            Some(Gray { data: unsafe { slice(input.mask, n_bytes)? }, width, height, stride })
        }
    };
    Ok(Filmed { tracks, groups, root, mask })
}

fn commit(call: &HostCall<'_>, skeleton: &Skeleton) -> Result<()> {
    let Skeleton { root, joints, pose, leaves } = skeleton;
    let (i, u, f) = (dtype::I32, dtype::U32, dtype::F64);
    let columns = [(c"parent", i, 1), (c"length", f, 1)];
    let mut out = Reserved::new(call, schema::JOINTS, joints.len(), &columns)?;
    let row = |row: Option<u32>| row.and_then(|row| i32::try_from(row).ok()).unwrap_or(-1);
    out.fill(0, joints.iter().map(|joint| row(joint.parent)));
    out.fill(1, joints.iter().map(|joint| joint.length));
    out.commit()?;
    let mut out = Reserved::new(call, schema::ROOT, 1, &[(c"x", f, 1), (c"y", f, 1), (c"z", f, 1)])?;
    root.iter().enumerate().for_each(|(axis, v)| out.fill(axis, std::iter::once(*v)));
    out.commit()?;
    let mut out = Reserved::new(call, schema::POSE, pose.len(), &[(c"d", f, 3)])?;
    out.fill(0, pose.iter().flatten().copied());
    out.commit()?;
    let pairs = (0_u32..).zip(joints).flat_map(|(row, joint)| joint.groups.iter().map(move |&of| (row, of)));
    let pairs: Vec<(u32, u32)> = pairs.collect();
    let mut out = Reserved::new(call, schema::BEARS, pairs.len(), &[(c"joint", u, 1), (c"group", u, 1)])?;
    out.fill(0, pairs.iter().map(|pair| pair.0));
    out.fill(1, pairs.iter().map(|pair| pair.1));
    out.commit()?;
    if leaves.is_empty() {
        return Ok(());
    }
    let mut out = Reserved::new(call, schema::LEAVES, leaves.len(), &[(c"joint", u, 1), (c"track", u, 1)])?;
    out.fill(0, leaves.iter().map(|leaf| leaf.joint));
    out.fill(1, leaves.iter().map(|leaf| leaf.track));
    out.commit()?;
    let n_offsets = leaves.iter().map(|leaf| leaf.offsets.len()).sum();
    let mut out = Reserved::new(call, schema::OFFSETS, n_offsets, &[(c"d", f, 3)])?;
    out.fill(0, leaves.iter().flat_map(|leaf| &leaf.offsets).flatten().copied());
    out.commit()
}
