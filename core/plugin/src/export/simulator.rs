//! Simulators across the border.

use super::table::{Reserved, column, given, slice};
use super::{Descriptor, HostCall, State, Told, door, new_instance};
use crate::state::{self, Whose, mix};
use crate::{Cx, Detail, Error, Node, Params, Plant, Result, Simulator, Steps, Wind};
use honami_abi::{self as abi, Call, Code, Instance, code, dtype, interface, schema};
use std::ffi::{CStr, c_void};

/// Describes a simulator to [`export!`](crate::export!).
#[must_use]
pub const fn simulator<T: Simulator>() -> Descriptor {
    Descriptor {
        kind: "simulator",
        info: T::INFO,
        interfaces: [
            ("honami.simulator/1", true),
            ("honami.state/1", T::STATE_VERSION.is_some()),
            ("", false),
            ("", false),
        ],
        params: T::Params::SCHEMA,
        latency: 0,
        create: new_instance::<SimulatorState<T>>,
    }
}

struct SimulatorState<T: Simulator> {
    params: T::Params,
    told: Told,
    running: Option<Running<T>>,
}

struct Running<T> {
    simulator: T,
    n_nodes: usize,
    n_instances: usize,
    /// Of the plant and of the parameters that it was prepared with, by [`mix`].
    under: u64,
}

impl<T: Simulator> State for SimulatorState<T> {
    type Params = T::Params;

    fn new() -> Self {
        Self { params: T::Params::default(), told: Told::default(), running: None }
    }

    fn set(&mut self, params: T::Params, told: Told) -> Result<()> {
        if told.lasting == self.told.lasting {
            if let Some(running) = &mut self.running {
                running.simulator.retune(&params)?;
            }
        } else {
            self.running = None;
        }
        (self.params, self.told) = (params, told);
        Ok(())
    }

    fn interface(id: &CStr) -> *const c_void {
        if id == interface::SIMULATOR {
            (&raw const *Self::SIMULATOR).cast()
        } else if id == interface::STATE && T::STATE_VERSION.is_some() {
            (&raw const *Self::STATE).cast()
        } else {
            std::ptr::null()
        }
    }
}

impl<T: Simulator> SimulatorState<T> {
    const SIMULATOR: &'static abi::SimulatorV1 = &abi::SimulatorV1 {
        struct_size: size_of::<abi::SimulatorV1>() as u32,
        reserved: 0,
        prepare: Some(prepare::<T>),
        reset: Some(reset::<T>),
        step: Some(step::<T>),
    };
    const STATE: &'static abi::StateV1 = &abi::StateV1 {
        struct_size: size_of::<abi::StateV1>() as u32,
        reserved: 0,
        save: Some(save::<T>),
        load: Some(load::<T>),
    };

    fn running(&mut self) -> Result<&mut Running<T>> {
        self.running
            .as_mut()
            .ok_or_else(|| Error::with_code(code::STATE, "there is no plant: call prepare first"))
    }
}

impl<T: Simulator> Running<T> {
    fn whose(&self) -> Whose {
        let version = T::STATE_VERSION.unwrap_or(0);
        Whose { whose: mix(u64::from(version), T::INFO.id.as_bytes()), under: self.under }
    }
}

unsafe extern "C" fn prepare<T: Simulator>(
    instance: *mut Instance,
    call: *const Call,
    input: *const abi::SimulatorInput,
) -> Code {
    // SAFETY: the host keeps the contract of honami_simulator_v1, here and below.
    unsafe {
        door::<SimulatorState<T>>(instance, call, |state, call| {
            state.running = None;
            let input = given(input)?;
            let nodes = read_skeleton(&given(input.skeleton)?)?;
            let instances = match input.instances.is_null() {
                true => vec![crate::Instance::default()],
                false => read_instances(&given(input.instances)?)?,
            };
            let (max_threads, seed) = (input.max_threads.max(1), input.seed);
            let plant = Plant { nodes: &nodes, instances: &instances, max_threads, seed };
            let simulator = T::prepare(&state.params, &plant, &Cx::new(call))?;
            commit_modes(call, &simulator.modes())?;
            let under = mix(state.told.lasting, format!("{nodes:?} {instances:?} {seed}").as_bytes());
            let (n_nodes, n_instances) = (nodes.len(), instances.len());
            state.running = Some(Running { simulator, n_nodes, n_instances, under });
            Ok(code::OK)
        })
    }
}

fn commit_modes(call: &HostCall<'_>, modes: &[crate::Mode]) -> Result<()> {
    if modes.is_empty() {
        return Ok(());
    }
    let columns = [(c"hz", dtype::F64, 1), (c"residual", dtype::F64, 1), (c"certified", dtype::U8, 1)];
    let mut out = Reserved::new(call, schema::MODES, modes.len(), &columns)?;
    out.fill(0, modes.iter().map(|mode| mode.hz));
    out.fill(1, modes.iter().map(|mode| mode.residual));
    out.fill(2, modes.iter().map(|mode| u8::from(mode.certified)));
    out.commit()
}

/// # Safety
/// The table is one of the host's and alive.
unsafe fn read_skeleton(table: &abi::Table) -> Result<Vec<Node>> {
    // SAFETY: the caller's promise.
    let (parent, x, y, z, radius) = unsafe {
        (
            column::<i32>(table, c"parent", 1)?,
            column::<f32>(table, c"x", 1)?,
            column::<f32>(table, c"y", 1)?,
            column::<f32>(table, c"z", 1)?,
            column::<f32>(table, c"radius", 1)?,
        )
    };
    // SAFETY: the caller's promise. It may be missing.
    let track = unsafe { column::<i32>(table, c"track", 1) }.unwrap_or_default();
    let n = parent.len();
    if [x.len(), y.len(), z.len(), radius.len()] != [n; 4] {
        return Err(Error::with_code(code::ARGUMENT, "the columns of the skeleton differ in length"));
    }
    let node = |k: usize| Node {
        parent: u32::try_from(parent[k]).ok(),
        position: [x[k], y[k], z[k]],
        radius: radius[k],
        track: track.get(k).and_then(|row| u32::try_from(*row).ok()),
    };
    Ok((0..n).map(node).collect())
}

/// # Safety
/// The table is one of the host's and alive.
unsafe fn read_instances(table: &abi::Table) -> Result<Vec<crate::Instance>> {
    // SAFETY: the caller's promise.
    let (yaw, scale, mass) = unsafe {
        (
            column::<f32>(table, c"yaw", 1)?,
            column::<f32>(table, c"scale", 1)?,
            column::<f32>(table, c"mass", 1)?,
        )
    };
    let rows = yaw.iter().zip(scale).zip(mass);
    Ok(rows.map(|((&yaw, &scale), &mass)| crate::Instance { yaw, scale, mass }).collect())
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
    input: *const abi::StepInput,
) -> Code {
    // SAFETY: see `prepare`.
    unsafe {
        door::<SimulatorState<T>>(instance, call, |state, call| {
            let input = given(input)?;
            let Running { simulator, n_nodes, n_instances, .. } = state.running()?;
            let wind = match input.wind.is_null() {
                true => Wind::default(),
                false => read_wind(&given(input.wind)?)?,
            };
            let detail = match input.detail.is_null() {
                true => None,
                false => Some(read_detail(&given(input.detail)?)?),
            };
            let wanted = |detail: &Vec<Detail>| detail.iter().map(|copy| copy.nodes as usize).sum();
            let rows = detail.as_ref().map_or(*n_nodes * *n_instances, wanted);
            let mut out = Reserved::new(call, schema::MOTION, rows, &[(c"d", dtype::F32, 3)])?;
            let (dt, n) = (input.dt, input.n_steps);
            let steps = Steps { dt, n, wind, detail: detail.as_deref() };
            simulator.step(&steps, out.elements(0).as_chunks_mut().0, &Cx::new(call))?;
            out.commit()?;
            Ok(code::OK)
        })
    }
}

/// # Safety
/// The table is one of the host's, and its columns live for `'a`.
unsafe fn read_wind<'a>(table: &abi::Table) -> Result<Wind<'a>> {
    // SAFETY: the caller's promise.
    unsafe {
        let velocities = column::<f32>(table, c"wind", 3)?.as_chunks().0;
        Ok(Wind { times_s: column(table, c"time_s", 1)?, velocities })
    }
}

/// # Safety
/// The table is one of the host's and alive.
unsafe fn read_detail(table: &abi::Table) -> Result<Vec<Detail>> {
    // SAFETY: the caller's promise.
    let (nodes, modes) = unsafe { (column::<u32>(table, c"nodes", 1)?, column::<u32>(table, c"modes", 1)?) };
    Ok(nodes.iter().zip(modes).map(|(&nodes, &modes)| Detail { nodes, modes }).collect())
}

unsafe extern "C" fn save<T: Simulator>(instance: *mut Instance, call: *const Call) -> Code {
    // SAFETY: the host keeps the contract of honami_state_v1, here and below.
    unsafe {
        door::<SimulatorState<T>>(instance, call, |state, call| {
            let running = state.running()?;
            let own = running.simulator.save()?;
            super::state::write(call, &state::head(running.whose(), &own), &own)?;
            Ok(code::OK)
        })
    }
}

unsafe extern "C" fn load<T: Simulator>(
    instance: *mut Instance,
    call: *const Call,
    bytes: *const u8,
    n: u64,
) -> Code {
    // SAFETY: see `save`.
    unsafe {
        door::<SimulatorState<T>>(instance, call, |state, _| {
            let running = state.running()?;
            let own = state::own(running.whose(), slice(bytes, n)?)?;
            running.simulator.load(own).map_err(|error| state::unreadable(&error))?;
            Ok(code::OK)
        })
    }
}
