//! What trackers carry from frame to frame, across the border.

use super::table::{Reserved, slice};
use super::tracker::TrackerState;
use super::{HostCall, door};
use crate::tracker::Tracker;
use crate::{Error, Result, state};
use honami_abi::{self as abi, Call, Code, Instance, code, dtype, schema};

/// The functions of `honami.state/1`.
pub(super) const fn table<T: Tracker>() -> abi::StateV1 {
    let struct_size = size_of::<abi::StateV1>() as u32;
    abi::StateV1 { struct_size, reserved: 0, save: Some(save::<T>), load: Some(load::<T>) }
}

fn offered<T: Tracker>() -> Result<crate::State<T>> {
    T::STATE.ok_or_else(|| Error::unsupported("this tracker cannot save what it carries"))
}

unsafe extern "C" fn save<T: Tracker>(instance: *mut Instance, call: *const Call) -> Code {
    // SAFETY: the host keeps the contract of honami_state_v1.
    unsafe {
        door::<TrackerState<T>>(instance, call, |state, call| {
            let offered = offered::<T>()?;
            let (tracker, setting) = state.at_work()?;
            let own = (offered.save)(tracker)?;
            write(call, &state::tracker_head(&offered, setting, &own), &own)?;
            Ok(code::OK)
        })
    }
}

pub(super) fn write(call: &HostCall<'_>, head: &[u8], own: &[u8]) -> Result<()> {
    let columns = [(c"bytes", dtype::U8, 1)];
    let mut out = Reserved::new(call, schema::STATE, head.len() + own.len(), &columns)?;
    out.fill_bytes(0, &[head, own]);
    out.commit()
}

unsafe extern "C" fn load<T: Tracker>(
    instance: *mut Instance,
    call: *const Call,
    bytes: *const u8,
    n: u64,
) -> Code {
    // SAFETY: see `save`.
    unsafe {
        door::<TrackerState<T>>(instance, call, |state, _| {
            let bytes = slice(bytes, n)?;
            let (_, setting) = state.at_work()?;
            let loaded = state::load(&offered::<T>()?, state.settings(), setting, bytes)?;
            state.go_on_as(loaded);
            Ok(code::OK)
        })
    }
}
