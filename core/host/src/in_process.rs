//! Plugins called in this process, through the tables of functions of their library.
#![allow(unsafe_code, reason = "this is where Rust calls into C")]

mod input;
mod known;
mod library;

pub(crate) use library::{Loaded, keep_same, load, load_copy};

use crate::call::CallDesk;
use crate::context::CallContext;
use crate::error::{Code, HostError};
use crate::instance::{Instance, Request};
use crate::manifest::Kind;
use crate::registry::PluginInfo;
use crate::reply::Reply;
use crate::values::Value;
use honami_abi::{self as abi, code, interface, kind};
use input::{InputTable, frame};
use known::known;
use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr::{NonNull, null};
use std::sync::{Arc, MutexGuard, PoisonError};

/// An instance of a plugin of a loaded library.
pub(crate) struct InProcess {
    instance: NonNull<abi::Instance>,
    /// What the plugin knew of it.
    known: abi::Instance,
    interfaces: Interfaces,
    desk: Box<CallDesk>,
    library: Arc<Loaded>,
    /// Whether another instance of the library may work at the same time.
    parallel: bool,
}

// SAFETY: the ABI allows every call from any thread, one at a time: `&mut self` and `Drop` see to that.
unsafe impl Send for InProcess {}

/// What the plugin knew of the tables of functions that it has.
#[derive(Default)]
struct Interfaces {
    tracker: Option<abi::TrackerV1>,
    detect: Option<abi::DetectV1>,
    field: Option<abi::FieldV1>,
    state: Option<abi::StateV1>,
    clusterer: Option<abi::ClustererV1>,
    structure: Option<abi::StructureV1>,
    simulator: Option<abi::SimulatorV1>,
}

/// Makes an instance of a plugin.
pub(crate) fn create(
    info: &PluginInfo,
    library: Arc<Loaded>,
    cx: &CallContext<'_>,
) -> Result<Box<dyn Instance>, HostError> {
    let misbehaved = |function, what| HostError::Misbehaved { plugin: info.id.clone(), function, what };
    let desk = CallDesk::new();
    let id = CString::new(info.id.as_str()).map_err(|error| misbehaved("create", error.to_string()))?;
    let mut reply = Reply::default();
    let mut made = std::ptr::null_mut();
    let make = library.create();
    let turn = library.turn.lock().unwrap_or_else(PoisonError::into_inner);
    desk.call(cx, &[], &mut reply, |call| {
        // SAFETY: the library's function, with arguments that live until it returns.
        made = unsafe { make(library::host_info(), call, id.as_ptr()) };
        code::OK
    });
    drop(turn);
    let Some(instance) = NonNull::new(made) else {
        let text = if reply.text.is_empty() { "gives no instance and no reason".into() } else { reply.text };
        let code = Code(code::UNSUPPORTED);
        return Err(HostError::Failed { plugin: info.id.clone(), function: "create", code, text });
    };
    let parallel = info.caps.parallel_instances;
    // SAFETY: the plugin has just handed it out, with its size.
    let known = unsafe { known(instance.as_ptr()) };
    let complete = known.destroy.is_some() && known.set_params.is_some() && known.get_interface.is_some();
    let mut made = InProcess { instance, known, interfaces: Interfaces::default(), desk, library, parallel };
    if !complete {
        return Err(misbehaved("create", "the instance lacks functions".into()));
    }
    made.interfaces = made.interfaces(info).map_err(|what| misbehaved("get_interface", what))?;
    if let Some(latency) =
        made.interfaces.tracker.as_ref().map(|table| table.latency).filter(|l| *l != info.caps.latency)
    {
        let what = format!("its manifest has latency {}, its table {latency}", info.caps.latency);
        return Err(misbehaved("get_interface", what));
    }
    Ok(Box::new(made))
}

/// A table of functions, if the plugin announces it; it must then be whole.
macro_rules! interface {
    ($self:ident, $info:ident, $id:expr, $table:ty, [$($function:ident),*]) => {
        match $self.interface($info, $id)? {
            None => None,
            Some(pointer) => {
                // SAFETY: the plugin hands out the table of this id, with its size; it lives for ever.
                let table = unsafe { known(pointer.cast::<$table>()) };
                if !($(table.$function.is_some())&&*) {
                    return Err(format!("the table of {} lacks functions", $id.to_string_lossy()));
                }
                Some(table)
            }
        }
    };
}

impl InProcess {
    fn interfaces(&self, info: &PluginInfo) -> Result<Interfaces, String> {
        let main = match info.kind {
            Kind::Tracker => interface::TRACKER,
            Kind::Clusterer => interface::CLUSTERER,
            Kind::Structure => interface::STRUCTURE,
            Kind::Simulator => interface::SIMULATOR,
        };
        if !info.offers(&main.to_string_lossy()) {
            return Err(format!("a {} needs {}, its manifest has none", info.kind, main.to_string_lossy()));
        }
        Ok(Interfaces {
            tracker: interface!(
                self,
                info,
                interface::TRACKER,
                abi::TrackerV1,
                [begin, seed, retire, push, end]
            ),
            detect: interface!(self, info, interface::DETECT, abi::DetectV1, [detect]),
            field: interface!(self, info, interface::FIELD, abi::FieldV1, [field]),
            state: interface!(self, info, interface::STATE, abi::StateV1, [save, load]),
            clusterer: interface!(self, info, interface::CLUSTERER, abi::ClustererV1, [run]),
            structure: interface!(self, info, interface::STRUCTURE, abi::StructureV1, [run]),
            simulator: interface!(self, info, interface::SIMULATOR, abi::SimulatorV1, [prepare, reset, step]),
        })
    }

    fn interface(&self, info: &PluginInfo, id: &CStr) -> Result<Option<*const c_void>, String> {
        let name = id.to_string_lossy();
        if !info.offers(&name) {
            return Ok(None);
        }
        let table = self.known.get_interface.map_or(null(), |get| {
            // SAFETY: the instance is alive, the id a constant.
            unsafe { get(self.instance.as_ptr(), id.as_ptr()) }
        });
        if table.is_null() {
            return Err(format!("its manifest has {name}, the instance has none"));
        }
        Ok(Some(table))
    }
}

impl Instance for InProcess {
    fn invoke(&mut self, request: &Request<'_>, cx: &CallContext<'_>, reply: &mut Reply) {
        let _turn = turn(&self.library, self.parallel);
        self.desk.call(cx, request.schemas(), reply, |call| {
            // SAFETY: the context is alive, and what `call_plugin` passes lives until it returns.
            unsafe { call_plugin(self, request, call) }.unwrap_or(code::UNSUPPORTED)
        });
    }

    fn can_end(&self) -> bool {
        false
    }
}

impl Drop for InProcess {
    fn drop(&mut self) {
        let _turn = turn(&self.library, self.parallel);
        // An instance without it stays: there is no other way to free it.
        if let Some(destroy) = self.known.destroy {
            // SAFETY: alive until here, and nothing of it runs.
            unsafe { destroy(self.instance.as_ptr()) };
        }
    }
}

/// Waits for the other instances of a library whose instances must not work at once.
fn turn(library: &Loaded, parallel: bool) -> Option<MutexGuard<'_, ()>> {
    (!parallel).then(|| library.turn.lock().unwrap_or_else(PoisonError::into_inner))
}

/// Passes a request to the function of its table; `None` when the plugin has no such table.
///
/// # Safety
/// `call` is alive.
unsafe fn call_plugin(plugin: &InProcess, request: &Request<'_>, call: *const abi::Call) -> Option<i32> {
    let (raw, has) = (plugin.instance.as_ptr(), &plugin.interfaces);
    // SAFETY: the caller's promise; the instance is alive as long as `plugin`; every table below is built here and outlives the call it is passed to.
    unsafe {
        Some(match *request {
            Request::SetParams(values) => set_params(plugin, call, values)?,
            Request::Begin(info) => (has.tracker.as_ref()?.begin?)(raw, call, &input::stream(info)),
            Request::Seed(points) => {
                (has.tracker.as_ref()?.seed?)(raw, call, InputTable::points(points).raw())
            }
            Request::Retire(ids) => {
                (has.tracker.as_ref()?.retire?)(raw, call, ids.as_ptr(), ids.len() as u64)
            }
            Request::Push(view) => (has.tracker.as_ref()?.push?)(raw, call, &frame(view)),
            Request::End => (has.tracker.as_ref()?.end?)(raw, call),
            Request::Save => (has.state.as_ref()?.save?)(raw, call),
            Request::Load(bytes) => {
                (has.state.as_ref()?.load?)(raw, call, bytes.as_ptr(), bytes.len() as u64)
            }
            Request::Detect(wanted) => {
                let (picture, points) = (frame(&wanted.frame), InputTable::points(wanted.points));
                (has.detect.as_ref()?.detect?)(raw, call, &input::detect(wanted, &picture, points.raw()))
            }
            Request::Field { from, to, max_threads } => {
                let (from, to) = (frame(from), frame(to));
                let struct_size = size_of::<abi::FieldInput>() as u32;
                let input =
                    abi::FieldInput { struct_size, max_threads, from: &raw const from, to: &raw const to };
                (has.field.as_ref()?.field?)(raw, call, &input)
            }
            Request::Cluster(tracks) => {
                let (rows, times) = (InputTable::tracks(tracks), InputTable::times(tracks));
                (has.clusterer.as_ref()?.run?)(raw, call, &input::clusterer(tracks, rows.raw(), times.raw()))
            }
            Request::Grow(filmed) => {
                let (rows, times) = (InputTable::tracks(filmed.tracks), InputTable::times(filmed.tracks));
                let groups = InputTable::groups(filmed.groups);
                let input = input::structure(filmed, [&rows, &times, &groups]);
                (has.structure.as_ref()?.run?)(raw, call, &input)
            }
            Request::Prepare { nodes, instances, max_threads, seed } => {
                let (skeleton, copies) = (InputTable::skeleton(nodes), InputTable::instances(instances));
                let struct_size = size_of::<abi::SimulatorInput>() as u32;
                let (skeleton, instances) = (skeleton.raw(), copies.raw());
                let input = abi::SimulatorInput { struct_size, max_threads, seed, skeleton, instances };
                (has.simulator.as_ref()?.prepare?)(raw, call, &input)
            }
            Request::Reset => (has.simulator.as_ref()?.reset?)(raw, call),
            Request::Step(steps) => {
                let wind = InputTable::wind(steps.wind);
                let detail = steps.detail.map(InputTable::detail);
                (has.simulator.as_ref()?.step?)(raw, call, &input::steps(steps, &wind, detail.as_ref()))
            }
        })
    }
}

/// # Safety
/// `call` is alive.
unsafe fn set_params(
    plugin: &InProcess,
    call: *const abi::Call,
    values: &[(&str, &Value, u32)],
) -> Option<i32> {
    // Strings live here until the call returns; a NUL inside cannot be: `Param::check` refuses it.
    let strings: Vec<(CString, CString)> = values
        .iter()
        .map(|(id, value, _)| {
            let text = if let Value::Text(text) = value { text.as_str() } else { "" };
            (CString::new(*id).unwrap_or_default(), CString::new(text).unwrap_or_default())
        })
        .collect();
    let values: Vec<abi::Value> = values
        .iter()
        .zip(&strings)
        .map(|((_, value, kind), (id, text))| raw_value(value, *kind, id.as_ptr(), text.as_ptr()))
        .collect();
    // SAFETY: the caller's promise; the instance is alive; values and strings outlive the call.
    Some(unsafe {
        (plugin.known.set_params?)(plugin.instance.as_ptr(), call, values.as_ptr(), values.len() as u32)
    })
}

fn raw_value(value: &Value, value_kind: u32, id: *const c_char, text: *const c_char) -> abi::Value {
    let mut raw = abi::Value { id, kind: value_kind, reserved: 0, i: 0, f: [0.0; 4], text: null() };
    match value {
        Value::Bool(b) => raw.i = i64::from(*b),
        Value::Int(i) => raw.i = *i,
        Value::Float(x) => raw.f[0] = *x,
        Value::Text(_) => raw.text = text,
        Value::List(list) => raw.f.iter_mut().zip(list).for_each(|(place, number)| *place = *number),
    }
    debug_assert!((kind::BOOL..=kind::SEED).contains(&value_kind), "kind {value_kind}");
    raw
}
