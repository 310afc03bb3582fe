//! Plugins called in this process, through the tables of functions of their library.
#![allow(unsafe_code, reason = "this is where Rust calls into C")]

mod input;
mod library;

pub(crate) use library::{Loaded, load};

use crate::call::CallDesk;
use crate::context::CallContext;
use crate::error::{Code, HostError};
use crate::instance::{Instance, Request};
use crate::manifest::Kind;
use crate::registry::PluginInfo;
use crate::reply::Reply;
use crate::values::Value;
use honami_abi::{self as abi, code, draft, interface, kind};
use input::{InputTable, frame};
use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr::{NonNull, null};
use std::sync::{Arc, MutexGuard, PoisonError};

/// An instance of a plugin of a loaded library.
pub(crate) struct InProcess {
    instance: NonNull<abi::Instance>,
    interfaces: Interfaces,
    desk: Box<CallDesk>,
    library: Arc<Loaded>,
    /// Whether another instance of the library may work at the same time.
    parallel: bool,
}

// SAFETY: the ABI allows every call from any thread, one at a time: `&mut self` and `Drop` see to that.
unsafe impl Send for InProcess {}

/// The tables of functions that the plugin has; they live as long as the library, which is for ever.
#[derive(Default)]
struct Interfaces {
    tracker: Option<&'static abi::TrackerV1>,
    detect: Option<&'static abi::DetectV1>,
    field: Option<&'static abi::FieldV1>,
    clusterer: Option<&'static abi::ClustererV1>,
    structure: Option<&'static draft::StructureV1>,
    simulator: Option<&'static draft::SimulatorV1>,
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
    let mut made = InProcess { instance, interfaces: Interfaces::default(), desk, library, parallel };
    // SAFETY: the plugin has just handed it out.
    let raw = unsafe { instance.as_ref() };
    let complete = abi::has!(raw, abi::Instance, get_interface)
        && raw.destroy.is_some()
        && raw.set_params.is_some()
        && raw.get_interface.is_some();
    if !complete {
        return Err(misbehaved("create", "the instance lacks functions".into()));
    }
    made.interfaces = made.interfaces(info).map_err(|what| misbehaved("get_interface", what))?;
    if let Some(latency) =
        made.interfaces.tracker.map(|table| table.latency).filter(|l| *l != info.caps.latency)
    {
        let what = format!("its manifest has latency {}, its table {latency}", info.caps.latency);
        return Err(misbehaved("get_interface", what));
    }
    Ok(Box::new(made))
}

/// A table of functions, if the plugin announces it; it must then be whole.
macro_rules! interface {
    ($self:ident, $info:ident, $id:expr, $table:ty, $last:ident, [$($function:ident),*]) => {
        match $self.interface($info, $id)? {
            None => None,
            Some(pointer) => {
                // SAFETY: the plugin hands out the table of this id, which lives as long as its library: for ever.
                let table: &'static $table = unsafe { &*pointer.cast::<$table>() };
                let whole = abi::has!(table, $table, $last) $(&& table.$function.is_some())*;
                if !whole {
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
            Kind::Structure => draft::STRUCTURE,
            Kind::Simulator => draft::SIMULATOR,
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
                end,
                [begin, seed, retire, push, end]
            ),
            detect: interface!(self, info, interface::DETECT, abi::DetectV1, detect, [detect]),
            field: interface!(self, info, interface::FIELD, abi::FieldV1, field, [field]),
            clusterer: interface!(self, info, interface::CLUSTERER, abi::ClustererV1, run, [run]),
            structure: interface!(self, info, draft::STRUCTURE, draft::StructureV1, run, [run]),
            simulator: interface!(
                self,
                info,
                draft::SIMULATOR,
                draft::SimulatorV1,
                step,
                [prepare, reset, step]
            ),
        })
    }

    fn interface(&self, info: &PluginInfo, id: &CStr) -> Result<Option<*const c_void>, String> {
        let name = id.to_string_lossy();
        if !info.offers(&name) {
            return Ok(None);
        }
        // SAFETY: the instance is alive and has the function: `create` has looked.
        let table = unsafe { self.instance.as_ref() }
            .get_interface
            .map_or(null(), |get| unsafe { get(self.instance.as_ptr(), id.as_ptr()) });
        let whole = !table.is_null() && table.cast::<u64>().is_aligned();
        if whole { Ok(Some(table)) } else { Err(format!("its manifest has {name}, the instance has none")) }
    }
}

impl Instance for InProcess {
    fn invoke(&mut self, request: &Request<'_>, cx: &CallContext<'_>, reply: &mut Reply) {
        let _turn = turn(&self.library, self.parallel);
        let (raw, interfaces) = (self.instance.as_ptr(), &self.interfaces);
        self.desk.call(cx, request.schemas(), reply, |call| {
            // SAFETY: instance, tables and context are alive, and what `call_plugin` passes lives until it returns.
            unsafe { call_plugin(raw, interfaces, request, call) }.unwrap_or(code::UNSUPPORTED)
        });
    }
}

impl Drop for InProcess {
    fn drop(&mut self) {
        let _turn = turn(&self.library, self.parallel);
        // SAFETY: alive until here, and nothing of it runs.
        unsafe {
            if let Some(destroy) = self.instance.as_ref().destroy {
                destroy(self.instance.as_ptr());
            }
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
/// `raw`, the tables and `call` are alive.
unsafe fn call_plugin(
    raw: *mut abi::Instance,
    has: &Interfaces,
    request: &Request<'_>,
    call: *const abi::Call,
) -> Option<i32> {
    // SAFETY: the caller's promise; every table below is built here and outlives the call it is passed to.
    unsafe {
        Some(match *request {
            Request::SetParams(values) => set_params(raw, call, values)?,
            Request::Begin(info) => (has.tracker?.begin?)(raw, call, &input::stream(info)),
            Request::Seed(points) => (has.tracker?.seed?)(raw, call, InputTable::points(points).raw()),
            Request::Retire(ids) => (has.tracker?.retire?)(raw, call, ids.as_ptr(), ids.len() as u64),
            Request::Push(view) => (has.tracker?.push?)(raw, call, &frame(view)),
            Request::End => (has.tracker?.end?)(raw, call),
            Request::Detect(wanted) => {
                let (picture, points) = (frame(&wanted.frame), InputTable::points(wanted.points));
                (has.detect?.detect?)(raw, call, &input::detect(wanted, &picture, points.raw()))
            }
            Request::Field { from, to, max_threads } => {
                let (from, to) = (frame(from), frame(to));
                let struct_size = size_of::<abi::FieldInput>() as u32;
                let input =
                    abi::FieldInput { struct_size, max_threads, from: &raw const from, to: &raw const to };
                (has.field?.field?)(raw, call, &input)
            }
            Request::Cluster(tracks) => {
                let (rows, times) = (InputTable::tracks(tracks), InputTable::times(tracks));
                (has.clusterer?.run?)(raw, call, &input::clusterer(tracks, rows.raw(), times.raw()))
            }
            Request::Grow(tracks) => {
                let (rows, times) = (InputTable::tracks(tracks), InputTable::times(tracks));
                (has.structure?.run?)(raw, call, &input::structure(tracks, rows.raw(), times.raw()))
            }
            Request::Prepare { nodes, n_instances, max_threads, seed } => {
                let skeleton = InputTable::skeleton(nodes);
                let input = abi::draft::SimulatorInput {
                    struct_size: size_of::<draft::SimulatorInput>() as u32,
                    max_threads,
                    seed,
                    skeleton: skeleton.raw(),
                    n_instances,
                    reserved: 0,
                };
                (has.simulator?.prepare?)(raw, call, &input)
            }
            Request::Reset => (has.simulator?.reset?)(raw, call),
            Request::Step { dt, n_steps, wind } => {
                let gusts = InputTable::wind(wind);
                let gusts = if wind.is_empty() { null() } else { gusts.raw() };
                (has.simulator?.step?)(raw, call, dt, n_steps, gusts)
            }
        })
    }
}

/// # Safety
/// `raw` and `call` are alive.
unsafe fn set_params(
    raw: *mut abi::Instance,
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
    // SAFETY: the caller's promise; values and strings outlive the call.
    Some(unsafe { ((*raw).set_params?)(raw, call, values.as_ptr(), values.len() as u32) })
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
