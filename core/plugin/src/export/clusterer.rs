//! Clusterers across the border.

use super::stateless::{Function, Stateless};
use super::table::{Reserved, column, given};
use super::{Descriptor, door, new_instance};
use crate::clusterer::{Clusterer, Tracks};
use crate::{Cx, Error, Params, Result};
use honami_abi::{self as abi, Call, Code, Instance, code, dtype, interface, schema};
use std::ffi::CStr;
use std::marker::PhantomData;

/// Describes a clusterer to [`export!`](crate::export!).
#[must_use]
pub const fn clusterer<T: Clusterer>() -> Descriptor {
    Descriptor {
        kind: "clusterer",
        info: T::INFO,
        interfaces: [("honami.clusterer/1", true), ("", false), ("", false), ("", false)],
        params: T::Params::SCHEMA,
        latency: 0,
        create: new_instance::<Stateless<Grouping<T>>>,
    }
}

/// `Clusterer::cluster` as a function of the ABI.
struct Grouping<T>(PhantomData<T>);

impl<T: Clusterer> Function for Grouping<T> {
    type Params = T::Params;
    type Table = abi::ClustererV1;
    const INTERFACE: &'static CStr = interface::CLUSTERER;
    const TABLE: &'static abi::ClustererV1 = &abi::ClustererV1 {
        struct_size: size_of::<abi::ClustererV1>() as u32,
        reserved: 0,
        run: Some(run::<T>),
    };
}

unsafe extern "C" fn run<T: Clusterer>(
    instance: *mut Instance,
    call: *const Call,
    input: *const abi::ClustererInput,
) -> Code {
    // SAFETY: the host keeps the contract of honami_clusterer_v1.
    unsafe {
        door::<Stateless<Grouping<T>>>(instance, call, |state, call| {
            let input = given(input)?;
            let mut tracks = read_tracks(&given(input.tracks)?, &given(input.times)?)?;
            (tracks.width, tracks.height) = (input.width, input.height);
            (tracks.max_threads, tracks.seed) = (input.max_threads.max(1), input.seed);
            let found = T::cluster(&state.params, &tracks, &Cx::new(call))?;
            let columns = [
                (c"a", dtype::U32, 1),
                (c"b", dtype::U32, 1),
                (c"height", dtype::F64, 1),
                (c"size", dtype::U32, 1),
            ];
            let mut out = Reserved::new(call, schema::DENDROGRAM, found.merges.len(), &columns)?;
            out.fill(0, found.merges.iter().map(|m| m.a));
            out.fill(1, found.merges.iter().map(|m| m.b));
            out.fill(2, found.merges.iter().map(|m| m.height));
            out.fill(3, found.merges.iter().map(|m| m.size));
            out.commit()?;
            if !found.frames.is_empty() {
                let columns =
                    [(c"frame", dtype::I64, 1), (c"outlier", dtype::U8, 1), (c"distance", dtype::F64, 1)];
                let mut out = Reserved::new(call, schema::FRAMES, found.frames.len(), &columns)?;
                out.fill(0, found.frames.iter().map(|f| f.frame));
                out.fill(1, found.frames.iter().map(|f| u8::from(f.outlier)));
                out.fill(2, found.frames.iter().map(|f| f.distance));
                out.commit()?;
            }
            Ok(code::OK)
        })
    }
}

/// The tracks, still without what the input struct says of them.
///
/// # Safety
/// The tables are the host's, and their columns live for `'a`.
pub(super) unsafe fn read_tracks<'a>(tracks: &abi::Table, times: &abi::Table) -> Result<Tracks<'a>> {
    // SAFETY: the caller's promise.
    let tracks = unsafe {
        Tracks {
            ids: column(tracks, c"id", 1)?,
            first_frames: column(tracks, c"frame0", 1)?,
            lens: column(tracks, c"len", 1)?,
            offsets: column(tracks, c"offset", 1)?,
            x: column(tracks, c"x", 1)?,
            y: column(tracks, c"y", 1)?,
            status: column(tracks, c"status", 1)?,
            first_time: column::<i64>(times, c"frame", 1)?.first().copied().unwrap_or(0),
            times_s: column(times, c"time_s", 1)?,
            width: 0,
            height: 0,
            max_threads: 1,
            seed: 0,
        }
    };
    let n = tracks.ids.len();
    let samples = tracks.x.len();
    let same = tracks.first_frames.len() == n && tracks.lens.len() == n && tracks.offsets.len() == n;
    if !same || tracks.y.len() != samples || tracks.status.len() != samples || tracks.iter().count() != n {
        return Err(Error::with_code(code::ARGUMENT, "the host's tracks do not fit together"));
    }
    Ok(tracks)
}
