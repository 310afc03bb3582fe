//! Loading a library, and asking it for its record.

use super::desk::Desk;
use super::dress::{Dress, Placed};
use super::known;
use crate::{Fault, Subject};
use honami_abi as abi;
use honami_host::plain;
use std::ffi::{CStr, CString};
use std::os::unix::ffi::OsStrExt as _;
use std::ptr::NonNull;

/// A library in this process, from which it never goes again.
pub(crate) struct Library {
    entry: abi::LibraryFn,
    host: Placed<abi::HostInfo>,
}

impl Library {
    /// Loads it, after this process has given up what a plugin's own process gives up.
    pub(crate) fn open(subject: &Subject) -> Result<Self, Fault> {
        Self::dressed(subject, Dress::Today)
    }

    pub(crate) fn dressed(subject: &Subject, dress: Dress) -> Result<Self, Fault> {
        let copy = subject.copy()?;
        let path = CString::new(copy.as_os_str().as_bytes()).map_err(|error| Fault(error.to_string()))?;
        // How much of it the kernel could do is said by the check that starts it as honami does.
        let _level = honami_host::shut_in(copy, &[]);
        // SAFETY: runs the library's constructors; a person has asked for it to be checked.
        let handle =
            unsafe { libc::dlopen(path.as_ptr(), libc::RTLD_NOW | libc::RTLD_LOCAL | libc::RTLD_NODELETE) };
        if handle.is_null() {
            return Err(Fault(format!("it cannot be loaded: {}", trouble())));
        }
        // SAFETY: a handle that was just given, and a constant.
        let symbol = unsafe { libc::dlsym(handle, abi::LIBRARY_SYMBOL.as_ptr()) };
        if symbol.is_null() {
            return Err(Fault("it does not export honami_library_v1".into()));
        }
        // SAFETY: the header gives the symbol this type.
        let entry = unsafe { std::mem::transmute::<*mut libc::c_void, abi::LibraryFn>(symbol) };
        let abi_minor = match dress {
            Dress::Older => 0,
            Dress::Newer => abi::ABI_MINOR + 100,
            Dress::Today | Dress::Reserved(_) => abi::ABI_MINOR,
        };
        let (name, version) = (c"honami".as_ptr(), c"0".as_ptr());
        let host = abi::HostInfo { struct_size: 0, abi_minor, name, version };
        Ok(Self { entry, host: Placed::new(&host, dress)? })
    }

    /// Where its record lies.
    pub(crate) fn enter(&self) -> Result<NonNull<abi::Library>, Fault> {
        // SAFETY: the library's function; the host's record lives as long as the library is used.
        let record = unsafe { (self.entry)(self.host.raw()) };
        NonNull::new(record.cast_mut()).ok_or_else(|| Fault("its entry refuses this host".into()))
    }

    fn record(&self) -> Result<abi::Library, Fault> {
        let at = self.enter()?;
        // SAFETY: the plugin has just handed it out, with its size.
        let record = unsafe { known(at.as_ptr()) };
        if record.create.is_none() || record.manifest.is_null() {
            return Err(Fault(format!(
                "its record of {} bytes lacks create or the manifest",
                record.struct_size
            )));
        }
        Ok(record)
    }

    /// The manifest of its record.
    pub(crate) fn manifest(&self) -> Result<&[u8], Fault> {
        let record = self.record()?;
        let len = usize::try_from(record.manifest_len).map_err(|error| Fault(error.to_string()))?;
        // SAFETY: the record says that so much text lies there, and a library's record lives for ever.
        Ok(unsafe { std::slice::from_raw_parts(record.manifest.cast(), len) })
    }

    /// Where a new instance of the plugin with this id lies.
    pub(crate) fn create(&self, desk: &Desk, id: &CStr) -> Result<Option<NonNull<abi::Instance>>, Fault> {
        let Some(create) = self.record()?.create else { return Ok(None) };
        // SAFETY: the library's function, with arguments that live until it returns.
        Ok(NonNull::new(unsafe { create(self.host.raw(), desk.raw(), id.as_ptr()) }))
    }
}

/// What the loader says.
fn trouble() -> String {
    // SAFETY: null, or a string that lives until the loader is called again.
    let text = unsafe {
        let text = libc::dlerror();
        if text.is_null() { c"" } else { CStr::from_ptr(text) }
    };
    plain(&text.to_string_lossy())
}
