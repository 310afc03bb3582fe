//! Structure builders and simulators across the border.

use super::clusterer::read_tracks;
use super::stateless::{Function, Stateless};
use super::table::{Reserved, column, given};
use super::{Descriptor, State, door, new_instance};
use crate::draft::{Gust, Node, Plant, Simulator, Structure};
use crate::{Cx, Error, Params, Result};
use honami_abi::{self as abi, Call, Code, Instance, code, draft, dtype};
use std::ffi::{CStr, c_void};
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

/// Describes a simulator to [`export!`](crate::export!).
#[must_use]
pub const fn simulator<T: Simulator>() -> Descriptor {
    Descriptor {
        kind: "simulator",
        info: T::INFO,
        interfaces: [("honami.simulator/1", true), ("", false), ("", false), ("", false)],
        params: T::Params::SCHEMA,
        latency: 0,
        create: new_instance::<SimulatorState<T>>,
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
            let mut out = Reserved::new(call, draft::SKELETON, nodes.len(), &columns)?;
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

struct SimulatorState<T: Simulator> {
    params: T::Params,
    running: Option<Running<T>>,
}

struct Running<T> {
    simulator: T,
    motion: Vec<[f32; 3]>,
}

impl<T: Simulator> State for SimulatorState<T> {
    type Params = T::Params;

    fn new() -> Self {
        Self { params: T::Params::default(), running: None }
    }

    fn params(&mut self) -> Result<&mut T::Params> {
        // New parameters need a new prepare.
        self.running = None;
        Ok(&mut self.params)
    }

    fn interface(id: &CStr) -> *const c_void {
        if id == draft::SIMULATOR { (&raw const *Self::SIMULATOR).cast() } else { std::ptr::null() }
    }
}

impl<T: Simulator> SimulatorState<T> {
    const SIMULATOR: &'static draft::SimulatorV1 = &draft::SimulatorV1 {
        struct_size: size_of::<draft::SimulatorV1>() as u32,
        reserved: 0,
        prepare: Some(prepare::<T>),
        reset: Some(reset::<T>),
        step: Some(step::<T>),
    };

    fn running(&mut self) -> Result<&mut Running<T>> {
        self.running
            .as_mut()
            .ok_or_else(|| Error::with_code(code::STATE, "there is no plant: call prepare first"))
    }
}

unsafe extern "C" fn prepare<T: Simulator>(
    instance: *mut Instance,
    call: *const Call,
    input: *const draft::SimulatorInput,
) -> Code {
    // SAFETY: the host keeps the contract of honami_simulator_v1, here and below.
    unsafe {
        door::<SimulatorState<T>>(instance, call, |state, call| {
            let input = given(input)?;
            let nodes = read_skeleton(&given(input.skeleton)?)?;
            let motion = vec![[0.0; 3]; nodes.len() * input.n_instances as usize];
            let (max_threads, seed) = (input.max_threads.max(1), input.seed);
            let plant = Plant { nodes, n_instances: input.n_instances, max_threads, seed };
            let simulator = T::prepare(&state.params, &plant, &Cx::new(call))?;
            state.running = Some(Running { simulator, motion });
            Ok(code::OK)
        })
    }
}

/// # Safety
/// The table is one of the host's and alive.
unsafe fn read_skeleton(table: &abi::Table) -> Result<Vec<Node>> {
    // SAFETY: the caller's promise.
    let (parent, x, y, z, radius, track) = unsafe {
        (
            column::<i32>(table, c"parent", 1)?,
            column::<f32>(table, c"x", 1)?,
            column::<f32>(table, c"y", 1)?,
            column::<f32>(table, c"z", 1)?,
            column::<f32>(table, c"radius", 1)?,
            column::<i32>(table, c"track", 1)?,
        )
    };
    let n = parent.len();
    if [x.len(), y.len(), z.len(), radius.len(), track.len()] != [n; 5] {
        return Err(Error::with_code(code::ARGUMENT, "the columns of the skeleton differ in length"));
    }
    let node = |k: usize| Node {
        parent: u32::try_from(parent[k]).ok(),
        position: [x[k], y[k], z[k]],
        radius: radius[k],
        track: u32::try_from(track[k]).ok(),
    };
    Ok((0..n).map(node).collect())
}

unsafe extern "C" fn reset<T: Simulator>(instance: *mut Instance, call: *const Call) -> Code {
    // SAFETY: see `prepare`.
    unsafe {
        door::<SimulatorState<T>>(instance, call, |state, _| {
            state.running()?.simulator.reset();
            Ok(code::OK)
        })
    }
}

unsafe extern "C" fn step<T: Simulator>(
    instance: *mut Instance,
    call: *const Call,
    dt: f64,
    n_steps: u32,
    wind: *const abi::Table,
) -> Code {
    // SAFETY: see `prepare`.
    unsafe {
        door::<SimulatorState<T>>(instance, call, |state, call| {
            let wind: Vec<Gust> = match wind.is_null() {
                true => Vec::new(),
                false => {
                    let table = given(wind)?;
                    let (times, winds) =
                        (column::<f64>(&table, c"time_s", 1)?, column::<f32>(&table, c"wind", 3)?);
                    let gust = |(&time_s, w): (&f64, &[f32])| Gust { time_s, wind: [w[0], w[1], w[2]] };
                    times.iter().zip(winds.chunks_exact(3)).map(gust).collect()
                }
            };
            let Running { simulator, motion } = state.running()?;
            simulator.step(dt, n_steps, &wind, motion, &Cx::new(call))?;
            let mut out = Reserved::new(call, draft::MOTION, motion.len(), &[(c"d", dtype::F32, 3)])?;
            out.fill(0, motion.iter().flatten().copied());
            out.commit()?;
            Ok(code::OK)
        })
    }
}
