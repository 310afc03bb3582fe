//! Loads libraries from the store, each content once, and never unloads them.
//!
//! There is no sound way to unload: thread-local destructors and threads of the library's may still be there.

use crate::error::HostError;
use crate::manifest::Manifest;
use crate::registry::{PluginInfo, Trust};
use crate::{note, store};
use honami_abi as abi;
use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
use std::collections::BTreeMap;
use std::ffi::{c_char, c_int};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// A loaded library.
pub(crate) struct Loaded {
    create: CreateFn,
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

/// The library of a trusted plugin, as its file is now.
pub(crate) fn load(info: &PluginInfo, folder: &Path) -> Result<Arc<Loaded>, HostError> {
    static LOADED: Mutex<BTreeMap<String, Arc<Loaded>>> = Mutex::new(BTreeMap::new());
    if let Trust::No(why) = &info.trust {
        return Err(HostError::NotTrusted { path: info.library.clone(), why: why.clone() });
    }
    let stored = store::keep(&info.library, folder)?;
    let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(library) = loaded.get(&stored.sha256) {
        return Ok(Arc::clone(library));
    }
    let create = open(&stored.path, info)?;
    let library = Arc::new(Loaded { create, sha256: stored.sha256.clone(), turn: Mutex::new(()) });
    loaded.insert(stored.sha256, Arc::clone(&library));
    Ok(library)
}

fn open(copy: &Path, info: &PluginInfo) -> Result<CreateFn, HostError> {
    let file_error = |why: String| HostError::File { path: info.library.clone(), why };
    let manifest: Option<(Manifest, Vec<u8>)> = note::read(copy)?;
    let (_, json) = manifest.ok_or_else(|| file_error("carries no manifest any more".into()))?;
    // SAFETY: loading runs the library's constructors; it is trusted, and the copy is what was hashed.
    let library = unsafe { Library::open(Some(copy), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE) }
        .map_err(|e| file_error(format!("cannot be loaded: {e}")))?;
    // SAFETY: the header gives the symbol this type.
    let entry = unsafe { library.get::<abi::LibraryFn>(abi::LIBRARY_SYMBOL) };
    let entry = *entry.map_err(|e| file_error(format!("does not export honami_library_v1: {e}")))?;
    // The handle is given up, not closed: the library stays for the life of the process.
    library.into_raw();
    // SAFETY: the library's function; the host's record is a constant.
    let record = unsafe { entry(host_info()).as_ref() };
    let record = record.ok_or_else(|| file_error("refuses this honami".into()))?;
    if !abi::has!(record, abi::Library, create) {
        return Err(file_error(format!("its library record is too small, {} bytes", record.struct_size)));
    }
    let Some(create) = record.create else {
        return Err(file_error("its library record has no create".into()));
    };
    let len = usize::try_from(record.manifest_len).unwrap_or(usize::MAX);
    if record.manifest.is_null() || len != json.len() {
        return Err(file_error("its library record has another manifest than its note".into()));
    }
    // SAFETY: not null, and as long as the note's.
    let told = unsafe { std::slice::from_raw_parts(record.manifest.cast::<u8>(), len) };
    if told != json {
        return Err(file_error("its library record has another manifest than its note".into()));
    }
    Ok(create)
}
