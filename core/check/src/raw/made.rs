//! An instance, and what it is told.

use super::desk::Desk;
use super::library::Library;
use super::{Sized32, known};
use crate::Fault;
use honami_abi::{self as abi, kind};
use honami_host::{Param, ParamKind, PluginInfo, Value};
use std::ffi::{CStr, CString, c_void};
use std::ptr::NonNull;

/// An instance; destroyed when it is dropped.
pub(crate) struct Made {
    raw: NonNull<abi::Instance>,
    known: abi::Instance,
}

impl Made {
    /// Of this plugin.
    pub(crate) fn of(library: &Library, desk: &Desk, info: &PluginInfo) -> Result<Self, Fault> {
        let id = c_text(&info.id)?;
        let Some(raw) = library.create(desk, &id)? else {
            return Err(Fault(format!("create made no instance: {}", desk.why())));
        };
        // SAFETY: the plugin has just handed it out, with its size.
        let known = unsafe { known(raw.as_ptr()) };
        let made = Self { raw, known };
        let is_whole = [
            ("destroy", made.known.destroy.is_some()),
            ("set_params", made.known.set_params.is_some()),
            ("get_interface", made.known.get_interface.is_some()),
        ];
        match is_whole.iter().find(|(_, is_there)| !is_there) {
            Some((name, _)) => Err(Fault(format!("its instance lacks {name}"))),
            None => Ok(made),
        }
    }

    pub(crate) fn raw(&self) -> *mut abi::Instance {
        self.raw.as_ptr()
    }

    /// Where the interface with this id lies; null, if it has none.
    pub(crate) fn interface(&self, id: &CStr) -> Result<*const c_void, Fault> {
        let get = self.known.get_interface.ok_or_else(|| Fault("its instance lacks get_interface".into()))?;
        // SAFETY: the instance is alive, the id a string.
        Ok(unsafe { get(self.raw(), id.as_ptr()) })
    }

    /// The functions of an interface that the manifest announces.
    ///
    /// # Safety
    /// `T` is the struct of that interface.
    pub(crate) unsafe fn table<T: Sized32>(&self, id: &CStr) -> Result<T, Fault> {
        let (name, at) = (id.to_string_lossy(), self.interface(id)?);
        if at.is_null() {
            return Err(Fault(format!("its manifest has {name}, its instance has none")));
        }
        if self.interface(id)? != at {
            return Err(Fault(format!("it gave another table of {name} the second time")));
        }
        // SAFETY: not null, and of this type by the caller's promise; it lives for ever.
        Ok(unsafe { known(at.cast::<T>()) })
    }

    /// Sets every parameter to its default, or leaves that to the plugin.
    pub(crate) fn set_defaults(
        &self,
        desk: &Desk,
        info: &PluginInfo,
        all: bool,
        reserved: u32,
    ) -> Result<abi::Code, Fault> {
        let set = self.known.set_params.ok_or_else(|| Fault("its instance lacks set_params".into()))?;
        let sent: Vec<Sent> =
            if all { info.params.iter().map(Sent::of).collect::<Result<_, _>>()? } else { Vec::new() };
        let values: Vec<abi::Value> = sent.iter().map(|sent| sent.raw(reserved)).collect();
        let at = if values.is_empty() { std::ptr::null() } else { values.as_ptr() };
        // SAFETY: the instance is alive; values and their strings outlive the call.
        Ok(unsafe { set(self.raw(), desk.raw(), at, values.len() as u32) })
    }
}

impl Drop for Made {
    fn drop(&mut self) {
        if let Some(destroy) = self.known.destroy {
            // SAFETY: alive until here, and nothing of it runs.
            unsafe { destroy(self.raw()) };
        }
    }
}

/// A value with its strings.
struct Sent {
    id: CString,
    text: CString,
    kind: u32,
    value: Value,
}

impl Sent {
    fn of(param: &Param) -> Result<Self, Fault> {
        let value = param.default();
        let text = if let Value::Text(text) = &value { c_text(text)? } else { CString::default() };
        let kind = match param.kind {
            ParamKind::Bool { .. } => kind::BOOL,
            ParamKind::Int(_) => kind::INT,
            ParamKind::Float(_) => kind::FLOAT,
            ParamKind::Enum { .. } | ParamKind::String { .. } | ParamKind::Path { .. } => kind::TEXT,
            ParamKind::Vec2 { .. } => kind::VEC2,
            ParamKind::Rect { .. } => kind::RECT,
            ParamKind::Seed { .. } => kind::SEED,
        };
        Ok(Self { id: c_text(&param.id)?, text, kind, value })
    }

    fn raw(&self, reserved: u32) -> abi::Value {
        let text = std::ptr::null();
        let mut raw = abi::Value { id: self.id.as_ptr(), kind: self.kind, reserved, i: 0, f: [0.0; 4], text };
        match &self.value {
            Value::Bool(b) => raw.i = i64::from(*b),
            Value::Int(i) => raw.i = *i,
            Value::Float(x) => raw.f[0] = *x,
            Value::Text(_) => raw.text = self.text.as_ptr(),
            Value::List(list) => raw.f.iter_mut().zip(list).for_each(|(place, number)| *place = *number),
        }
        raw
    }
}

fn c_text(text: &str) -> Result<CString, Fault> {
    CString::new(text).map_err(|error| Fault(format!("{text:?} has a NUL in it: {error}")))
}
