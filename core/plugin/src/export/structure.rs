//! Structure builders across the border.

use super::clusterer::read_tracks;
use super::stateless::{Function, Stateless};
use super::table::{Reserved, given};
use super::{Descriptor, door, new_instance};
use crate::draft::Structure;
use crate::{Cx, Params};
use honami_abi::{Call, Code, Instance, code, draft, dtype, schema};
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
    type Table = draft::StructureV1;
    const INTERFACE: &'static CStr = draft::STRUCTURE;
    const TABLE: &'static draft::StructureV1 = &draft::StructureV1 {
        struct_size: size_of::<draft::StructureV1>() as u32,
        reserved: 0,
        run: Some(grow::<T>),
    };
}

unsafe extern "C" fn grow<T: Structure>(
    instance: *mut Instance,
    call: *const Call,
    input: *const draft::StructureInput,
) -> Code {
    // SAFETY: the host keeps the contract of honami_structure_v1.
    unsafe {
        door::<Stateless<Growing<T>>>(instance, call, |state, call| {
            let input = given(input)?;
            let mut tracks = read_tracks(&given(input.tracks)?, &given(input.times)?)?;
            (tracks.max_threads, tracks.seed) = (input.max_threads.max(1), input.seed);
            let nodes = T::grow(&state.params, &tracks, &Cx::new(call))?;
            let (i, f) = (dtype::I32, dtype::F32);
            let columns = [
                (c"parent", i, 1),
                (c"x", f, 1),
                (c"y", f, 1),
                (c"z", f, 1),
                (c"radius", f, 1),
                (c"track", i, 1),
            ];
            let mut out = Reserved::new(call, schema::SKELETON, nodes.len(), &columns)?;
            out.fill(0, nodes.iter().map(|n| row_or_none(n.parent)));
            for axis in 0..3 {
                out.fill(1 + axis, nodes.iter().map(|n| n.position[axis]));
            }
            out.fill(4, nodes.iter().map(|n| n.radius));
            out.fill(5, nodes.iter().map(|n| row_or_none(n.track)));
            out.commit()?;
            Ok(code::OK)
        })
    }
}

fn row_or_none(row: Option<u32>) -> i32 {
    row.and_then(|row| i32::try_from(row).ok()).unwrap_or(-1)
}
