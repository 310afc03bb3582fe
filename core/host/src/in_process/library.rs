//! Loads libraries from the store, each content once, and never unloads them.
//!
//! There is no sound way to unload: thread-local destructors and threads of the library's may still be there.

use super::known::known;
use crate::error::HostError;
use crate::note;
use crate::plain::plain;
use crate::registry::{PluginInfo, Trust};
use crate::store::{self, Stored};
use honami_abi as abi;
use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
use std::collections::BTreeMap;
use std::ffi::{c_char, c_int};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// A loaded library.
pub(crate) struct Loaded {
    create: CreateFn,
    /// As it stands in the library's note.
    manifest: Vec<u8>,
    /// Of the content that was loaded.
    pub(crate) sha256: String,
    /// Held while an instance works that must not work beside another.
    pub(crate) turn: Mutex<()>,
}

type CreateFn =
    unsafe extern "C" fn(*const abi::HostInfo, *const abi::Call, *const c_char) -> *mut abi::Instance;

impl Loaded {
    pub(crate) fn create(&self) -> CreateFn {
        self.create
    }
}

/// Same value on Linux and the BSDs of today; libloading has no name for it.
const RTLD_NODELETE: c_int = 0x1000;

/// What plugins are told of this host.
struct Host(abi::HostInfo);
// SAFETY: constants.
unsafe impl Sync for Host {}
static HOST: Host = Host(abi::HostInfo {
    struct_size: size_of::<abi::HostInfo>() as u32,
    abi_minor: abi::ABI_MINOR,
    name: c"honami".as_ptr(),
    version: VERSION.as_ptr().cast(),
});
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");

pub(crate) fn host_info() -> *const abi::HostInfo {
    &raw const HOST.0
}

/// The library of a trusted plugin, as its file is now; its manifest must still be the one that `info` was read from.
pub(crate) fn load(info: &PluginInfo, folder: &Path) -> Result<Arc<Loaded>, HostError> {
    open_once(info, keep(info, folder)?)
}

/// A copy of a trusted plugin's library in the store.
fn keep(info: &PluginInfo, folder: &Path) -> Result<Stored, HostError> {
    if let Trust::No(why) = &info.trust {
        return Err(HostError::NotTrusted { path: info.library.clone(), why: why.clone() });
    }
    let stored = store::keep(&info.library, folder)?;
    match &info.trust {
        Trust::Allowed { sha256 } if *sha256 != stored.sha256 => {
            let why = "it has changed since you allowed it".into();
            Err(HostError::NotTrusted { path: info.library.clone(), why })
        }
        _ => Ok(stored),
    }
}

/// The same of one whose manifest is still the one that `info` was read from.
pub(crate) fn keep_same(info: &PluginInfo, folder: &Path) -> Result<Stored, HostError> {
    let stored = keep(info, folder)?;
    let manifest = note::read(&stored.path)?.map(|(_, json)| json).unwrap_or_default();
    still(info, &manifest).map(|()| stored)
}

/// The library of a plugin whose file is a copy in the store already.
pub(crate) fn load_copy(info: &PluginInfo, copy: &Path) -> Result<Arc<Loaded>, HostError> {
    open_once(info, Stored::named(copy))
}

fn open_once(info: &PluginInfo, stored: Stored) -> Result<Arc<Loaded>, HostError> {
    static LOADED: Mutex<BTreeMap<String, Arc<Loaded>>> = Mutex::new(BTreeMap::new());
    let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(library) = loaded.get(&stored.sha256) {
        return still(info, &library.manifest).map(|()| Arc::clone(library));
    }
    let manifest = note::read(&stored.path)?.map(|(_, json)| json).unwrap_or_default();
    still(info, &manifest)?;
    let create = open(&stored.path, info)?;
    let sha256 = stored.sha256.clone();
    let library = Arc::new(Loaded { create, manifest, sha256, turn: Mutex::new(()) });
    loaded.insert(stored.sha256, Arc::clone(&library));
    Ok(library)
}

/// Whether a manifest is the one that was scanned: parameters and abilities of another build may be others.
fn still(info: &PluginInfo, manifest: &[u8]) -> Result<(), HostError> {
    if *info.manifest == *manifest {
        return Ok(());
    }
    let why = "was rebuilt with another manifest since honami looked at it: start honami again".into();
    Err(HostError::File { path: info.library.clone(), why })
}

/// An error, and what has led to it.
fn chain(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(error.source(), |error| error.source());
    plain(&causes.fold(error.to_string(), |text, cause| format!("{text}: {cause}")))
}

fn open(copy: &Path, info: &PluginInfo) -> Result<CreateFn, HostError> {
    let file_error = |why: String| HostError::File { path: info.library.clone(), why };
    // SAFETY: loading runs the library's constructors; it is trusted, and the copy is what was hashed.
    let library = unsafe { Library::open(Some(copy), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE) }
        .map_err(|e| file_error(format!("cannot be loaded: {}", chain(&e))))?;
    // SAFETY: the header gives the symbol this type.
    let entry = unsafe { library.get::<abi::LibraryFn>(abi::LIBRARY_SYMBOL) };
    let entry = *entry.map_err(|e| file_error(format!("does not export honami_library_v1: {e}")))?;
    // The handle is given up, not closed: the library stays for the life of the process.
    library.into_raw();
    // SAFETY: the library's function; the host's record is a constant.
    let record = unsafe { entry(host_info()) };
    if record.is_null() {
        return Err(file_error("refuses this honami".into()));
    }
    // SAFETY: not null, so the library's record, with its size.
    let record = unsafe { known(record) };
    if !abi::has!(record, abi::Library, create) {
        return Err(file_error(format!("its library record is too small, {} bytes", record.struct_size)));
    }
    let Some(create) = record.create else {
        return Err(file_error("its library record has no create".into()));
    };
    let len = usize::try_from(record.manifest_len).unwrap_or(usize::MAX);
    let as_long = !record.manifest.is_null() && len == info.manifest.len();
    // SAFETY: not null, and as long as the note's.
    if !as_long || unsafe { std::slice::from_raw_parts(record.manifest.cast::<u8>(), len) } != &*info.manifest
    {
        return Err(file_error("its library record has another manifest than its note".into()));
    }
    Ok(create)
}
