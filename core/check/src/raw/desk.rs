//! What a plugin may ask of this host during a call.

use super::dress::{Dress, Placed};
use crate::Fault;
use honami_abi::{Call, Code, Column, code, dtype};
use std::collections::BTreeMap;
use std::ffi::{CStr, c_char, c_void};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// No table has more bytes: who asks for more is refused.
const TABLE_BYTES_MAX: u64 = 1 << 28;

/// The calls of one instance, one after the other.
pub(crate) struct Desk {
    call: Placed<Call>,
    open: Box<Open>,
}

#[derive(Default)]
struct Open(Mutex<State>);

#[derive(Default)]
struct State {
    refuses: bool,
    n_refused: u32,
    why: String,
    tables: BTreeMap<String, Table>,
}

struct Table {
    rows: u64,
    committed: Option<u64>,
    columns: BTreeMap<String, (usize, Vec<u64>)>,
}

impl Desk {
    pub(crate) fn new() -> Result<Self, Fault> {
        Self::dressed(Dress::Today)
    }

    pub(crate) fn dressed(dress: Dress) -> Result<Self, Fault> {
        let open = Box::new(Open::default());
        let call = Call {
            struct_size: 0,
            reserved: 0,
            host: std::ptr::from_ref(&*open).cast_mut().cast(),
            progress: Some(progress),
            log: Some(log),
            fail: Some(fail),
            reserve: Some(reserve),
            commit: Some(commit),
            host_ext: Some(host_ext),
        };
        Ok(Self { call: Placed::new(&call, dress)?, open })
    }

    pub(crate) fn raw(&self) -> *const Call {
        self.call.raw()
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.open.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// From now on nobody gets memory for results, or everybody does.
    pub(crate) fn refuse(&self, refuses: bool) {
        self.state().refuses = refuses;
    }

    /// How often somebody was refused.
    pub(crate) fn n_refused(&self) -> u32 {
        self.state().n_refused
    }

    /// What the plugin said of its failure.
    pub(crate) fn why(&self) -> String {
        std::mem::take(&mut self.state().why)
    }

    /// What was committed since it was last asked: names, rows and bytes of all columns.
    pub(crate) fn results(&self) -> Vec<(String, u64, Vec<u8>)> {
        let tables = std::mem::take(&mut self.state().tables);
        let mut results = Vec::new();
        for (schema, table) in tables {
            let Some(rows) = table.committed else { continue };
            let mut bytes = Vec::new();
            for (row_bytes, data) in table.columns.values() {
                let all = data.iter().flat_map(|word| word.to_ne_bytes());
                bytes.extend(all.take(rows as usize * row_bytes));
            }
            results.push((schema, rows, bytes));
        }
        results
    }
}

/// # Safety
/// `call` is a context of this host's whose desk is alive.
unsafe fn state<'a>(call: *const Call) -> MutexGuard<'a, State> {
    // SAFETY: the caller's promise; `host` was set to the desk's state.
    let open = unsafe { &*(*call).host.cast::<Open>() };
    open.0.lock().unwrap_or_else(PoisonError::into_inner)
}

/// # Safety
/// `text` is null or a C string.
unsafe fn text(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: the caller's promise.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

unsafe extern "C" fn progress(_: *const Call, _: f64, _: *const c_char) -> i32 {
    0
}

unsafe extern "C" fn log(_: *const Call, _: i32, _: *const c_char) {}

unsafe extern "C" fn fail(call: *const Call, code: Code, why: *const c_char) -> Code {
    // SAFETY: the plugin keeps the contract of honami_call, here and in the functions below.
    unsafe { state(call).why = text(why) };
    code
}

unsafe extern "C" fn reserve(
    call: *const Call,
    schema: *const c_char,
    rows: u64,
    ncols: u32,
    cols: *mut Column,
) -> Code {
    // SAFETY: see `fail`.
    let (mut state, schema) = unsafe { (state(call), text(schema)) };
    if state.refuses {
        state.n_refused += 1;
        return code::MEMORY;
    }
    if cols.is_null() {
        return code::ARGUMENT;
    }
    // SAFETY: not null, and the header wants `ncols` columns there.
    let cols = unsafe { std::slice::from_raw_parts_mut(cols, ncols as usize) };
    let mut columns = BTreeMap::new();
    for column in cols {
        let Some(row_bytes) = dtype::size(column.dtype).map(|size| size * column.ncomp as usize) else {
            return code::ARGUMENT;
        };
        let Some(bytes) = rows.checked_mul(row_bytes as u64).filter(|bytes| *bytes <= TABLE_BYTES_MAX) else {
            return code::MEMORY;
        };
        let mut data = vec![0_u64; bytes as usize / 8 + 1];
        (column.data, column.rows) = (data.as_mut_ptr().cast(), rows);
        // SAFETY: see `fail`. What the vector holds stays where it is when the vector moves.
        columns.insert(unsafe { text(column.name) }, (row_bytes, data));
    }
    state.tables.insert(schema, Table { rows, committed: None, columns });
    code::OK
}

unsafe extern "C" fn commit(call: *const Call, schema: *const c_char, rows: u64) -> Code {
    // SAFETY: see `fail`.
    let (mut state, schema) = unsafe { (state(call), text(schema)) };
    match state.tables.get_mut(&schema) {
        Some(table) if rows <= table.rows => {
            table.committed = Some(rows);
            code::OK
        }
        _ => code::ARGUMENT,
    }
}

unsafe extern "C" fn host_ext(_: *const Call, _: *const c_char) -> *const c_void {
    std::ptr::null()
}
