//! The host's side of one call: the functions behind `honami_call`.
#![allow(unsafe_code, reason = "these functions are called from C")]

use crate::context::{CallContext, Flow, Level};
use crate::plain::plain;
use crate::reply::{Reply, Schema};
use honami_abi::{Call, Code, Column, code, dtype};
use std::any::Any;
use std::borrow::Cow;
use std::ffi::{CStr, c_char, c_void};
use std::panic::AssertUnwindSafe;
use std::ptr::NonNull;
use std::sync::{Mutex, MutexGuard, PoisonError, RwLock};

/// The calls of one instance, one after the other. Its address is what the plugin sees, so it stays where it is.
pub(crate) struct CallDesk {
    raw: Call,
    /// The listener of the call that is going on. Borrowed for that long: the write lock waits for callbacks to leave.
    listener: RwLock<Option<Listener>>,
    open: Mutex<Open>,
}

/// The listener's lifetime ends with the call; `CallDesk::call` sees to it that nobody holds it longer.
struct Listener(CallContext<'static>);

/// What a call has brought so far.
#[derive(Default)]
struct Open {
    /// Result schemas that the function may commit; `None` while no call is going on.
    schemas: Option<&'static [&'static Schema]>,
    reply: Reply,
    panic: Option<Box<dyn Any + Send>>,
    /// Callbacks that came when no call was going on; told at the next one.
    late: Option<&'static str>,
}

// SAFETY: the raw pointer in `raw` is the desk's own address, and everything behind it is locked.
unsafe impl Send for CallDesk {}
// SAFETY: as above.
unsafe impl Sync for CallDesk {}

impl CallDesk {
    pub(crate) fn new() -> Box<Self> {
        let raw = Call {
            struct_size: size_of::<Call>() as u32,
            reserved: 0,
            host: std::ptr::null_mut(),
            progress: Some(progress),
            log: Some(log),
            fail: Some(fail),
            reserve: Some(reserve),
            commit: Some(commit),
            host_ext: Some(host_ext),
        };
        let mut desk = Box::new(Self { raw, listener: RwLock::new(None), open: Mutex::new(Open::default()) });
        desk.raw.host = (&raw const *desk).cast_mut().cast();
        desk
    }

    /// Makes one call: `f` gets the context to pass to the plugin. What came is in `reply`.
    pub(crate) fn call(
        &self,
        cx: &CallContext<'_>,
        schemas: &'static [&'static Schema],
        reply: &mut Reply,
        f: impl FnOnce(*const Call) -> Code,
    ) {
        reply.clear();
        // SAFETY: only the lifetime changes; the listener is taken back, under the write lock, before `cx` can end.
        // Nothing between here and there unwinds: `f` is a call through the C ABI.
        let listener = unsafe { std::mem::transmute::<CallContext<'_>, CallContext<'static>>(*cx) };
        *self.listener.write().unwrap_or_else(PoisonError::into_inner) = Some(Listener(listener));
        {
            let mut open = self.open();
            open.schemas = Some(schemas);
            std::mem::swap(&mut open.reply, reply);
        }
        let answer = f(&raw const self.raw);
        *self.listener.write().unwrap_or_else(PoisonError::into_inner) = None;
        let mut open = self.open();
        open.schemas = None;
        std::mem::swap(&mut open.reply, reply);
        reply.code = answer;
        reply.check_ends();
        if let Some(function) = open.late.take() {
            reply.faults.push(format!("called {function} when no call was going on"));
        }
        if let Some(panic) = open.panic.take() {
            drop(open);
            std::panic::resume_unwind(panic);
        }
    }

    fn open(&self) -> MutexGuard<'_, Open> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets the listener hear something; `None` when no call is going on.
    fn hear<T>(&self, function: &'static str, f: impl FnOnce(&CallContext<'_>) -> T) -> Option<T> {
        let listener = self.listener.read().unwrap_or_else(PoisonError::into_inner);
        let Some(Listener(cx)) = &*listener else {
            self.open().late = Some(function);
            return None;
        };
        // The listener is ours, not the plugin's: its panic goes round the plugin, not through it.
        match std::panic::catch_unwind(AssertUnwindSafe(|| f(cx))) {
            Ok(answer) => Some(answer),
            Err(panic) => {
                self.open().panic = Some(panic);
                None
            }
        }
    }
}

/// # Safety
/// `call` is null, or a context that the host has handed out and whose instance is alive.
unsafe fn desk<'a>(call: *const Call) -> Option<&'a CallDesk> {
    // SAFETY: the caller's promise; `host` was set to the desk's address.
    unsafe { call.as_ref().and_then(|call| call.host.cast::<CallDesk>().as_ref()) }
}

/// # Safety
/// `text` is null or a C string that lives for `'a`.
unsafe fn text<'a>(text: *const c_char) -> Cow<'a, str> {
    match NonNull::new(text.cast_mut()) {
        None => Cow::Borrowed(""),
        // SAFETY: the caller's promise.
        Some(text) => unsafe { CStr::from_ptr(text.as_ptr()) }.to_string_lossy(),
    }
}

unsafe extern "C" fn progress(call: *const Call, fraction: f64, words: *const c_char) -> i32 {
    // SAFETY: the plugin keeps the contract of honami_call, here and in the functions below.
    let (desk, words) = unsafe { (desk(call), text(words)) };
    let Some(desk) = desk else { return 1 };
    let fraction = if fraction.is_nan() { -1.0 } else { fraction.min(1.0) };
    // With no call or a broken listener there is nobody to go on for.
    let flow = desk.hear("progress", |cx| (cx.progress)(fraction, &plain(&words))).unwrap_or(Flow::Stop);
    if flow == Flow::Stop {
        desk.open().reply.stopped = true;
    }
    i32::from(flow == Flow::Stop)
}

unsafe extern "C" fn log(call: *const Call, level: i32, line: *const c_char) {
    // SAFETY: see `progress`.
    let (desk, line) = unsafe { (desk(call), text(line)) };
    if let Some(desk) = desk {
        desk.hear("log", |cx| (cx.log)(Level::of(level), &plain(&line)));
    }
}

unsafe extern "C" fn fail(call: *const Call, code: Code, why: *const c_char) -> Code {
    // SAFETY: see `progress`.
    let (desk, why) = unsafe { (desk(call), text(why)) };
    if let Some(desk) = desk {
        desk.open().reply.text = plain(&why);
    }
    code
}

unsafe extern "C" fn reserve(
    call: *const Call,
    schema: *const c_char,
    rows: u64,
    ncols: u32,
    cols: *mut Column,
) -> Code {
    // SAFETY: see `progress`.
    let (Some(desk), id) = (unsafe { (desk(call), text(schema)) }) else { return code::ARGUMENT };
    let mut open = desk.open();
    let Some(schema) = open.expected("reserve", &id) else { return code::ARGUMENT };
    if open.reply.table(schema).is_some() {
        open.reply.faults.push(format!("reserved {id} after committing it"));
        return code::ARGUMENT;
    }
    if cols.is_null() || ncols == 0 {
        open.reply.faults.push(format!("reserved {id} with no columns"));
        return code::ARGUMENT;
    }
    // SAFETY: not null, and the header wants `ncols` columns there.
    let cols = unsafe { std::slice::from_raw_parts_mut(cols, ncols as usize) };
    // SAFETY: the header wants a name in each.
    let types = match unsafe { column_types(schema, cols) } {
        Ok(types) => types,
        Err(fault) => {
            open.reply.faults.push(fault);
            return code::ARGUMENT;
        }
    };
    let starts =
        usize::try_from(rows).ok().and_then(|rows| open.reply.slot(schema).reserve(rows, types.into_iter()));
    let Some(starts) = starts else { return code::MEMORY };
    for (column, start) in cols.iter_mut().zip(starts) {
        (column.data, column.rows) = (start.cast::<c_void>(), rows);
    }
    code::OK
}

/// Which columns the host knows, and how many bytes a row of each takes.
///
/// # Safety
/// Names are null or C strings.
unsafe fn column_types(
    schema: &'static Schema,
    cols: &[Column],
) -> Result<Vec<(Option<&'static crate::reply::ColumnType>, usize)>, String> {
    let mut types = Vec::with_capacity(cols.len());
    for column in cols {
        // SAFETY: the caller's promise.
        let name = unsafe { text(column.name) };
        let known = schema.column(&name);
        let size = dtype::size(column.dtype).filter(|_| column.ncomp > 0 && !name.is_empty());
        let Some(size) = size.filter(|_| known.is_none_or(|k| (k.1, k.2) == (column.dtype, column.ncomp)))
        else {
            let (dtype, ncomp) = (column.dtype, column.ncomp);
            return Err(format!("reserved column {name:?} of {:?} as type {dtype} x {ncomp}", schema.id));
        };
        if known.is_some() && types.iter().any(|&(other, _)| other == known) {
            return Err(format!("reserved column {name:?} of {:?} twice", schema.id));
        }
        types.push((known, size.saturating_mul(column.ncomp as usize)));
    }
    let missing =
        schema.required.iter().find(|wanted| !types.iter().any(|&(known, _)| known == Some(wanted)));
    missing
        .map_or(Ok(types), |missing| Err(format!("reserved {:?} without column {:?}", schema.id, missing.0)))
}

unsafe extern "C" fn commit(call: *const Call, schema: *const c_char, rows: u64) -> Code {
    // SAFETY: see `progress`.
    let (Some(desk), id) = (unsafe { (desk(call), text(schema)) }) else { return code::ARGUMENT };
    let mut open = desk.open();
    let Some(schema) = open.expected("commit", &id) else { return code::ARGUMENT };
    match open.reply.slot(schema).commit(rows) {
        Ok(()) => code::OK,
        Err(fault) => {
            open.reply.faults.push(fault);
            code::ARGUMENT
        }
    }
}

impl Open {
    /// The schema with this id, if the function may commit it.
    fn expected(&mut self, function: &'static str, id: &str) -> Option<&'static Schema> {
        let Some(schemas) = self.schemas else {
            self.late = Some(function);
            return None;
        };
        let found = schemas.iter().find(|schema| schema.id.to_bytes() == id.as_bytes());
        if found.is_none() {
            self.reply
                .faults
                .push(format!("called {function} for {id:?}, which is no result of this function"));
        }
        found.copied()
    }
}

unsafe extern "C" fn host_ext(_: *const Call, _: *const c_char) -> *const c_void {
    std::ptr::null()
}

#[cfg(test)]
mod tests;
