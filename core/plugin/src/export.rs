//! The border: what [`export!`](crate::export!) expands to, and the one door through which every call comes.
#![allow(unsafe_code, reason = "this is where the C contract meets the safe traits")]

pub(crate) mod clusterer;
mod panics;
pub(crate) mod simulator;
mod state;
mod stateless;
pub(crate) mod structure;
pub(crate) mod table;
pub(crate) mod tracker;

pub use crate::manifest::{Note, manifest_len};
pub use clusterer::clusterer;
pub use panics::quiet_panics;
pub use simulator::simulator;
pub use structure::structure;
pub use tracker::tracker;

use crate::params::{Param, Params, Value};
use crate::state::mix;
use crate::{Error, Info, Listener, Result};
use honami_abi::{self as abi, Call, Code, code};
use std::ffi::{CStr, CString, c_char};
use std::marker::PhantomData;
use std::mem::ManuallyDrop;
use std::panic::AssertUnwindSafe;

/// What the border knows of a plugin; made by [`tracker()`] and its like.
#[derive(Clone, Copy, Debug)]
pub struct Descriptor {
    pub(crate) kind: &'static str,
    pub(crate) info: Info,
    pub(crate) interfaces: [(&'static str, bool); 4],
    pub(crate) params: &'static [Param],
    pub(crate) latency: u32,
    pub(crate) create: fn() -> *mut abi::Instance,
}

/// A library record in a static: it is never written to.
#[derive(Debug)]
#[repr(transparent)]
pub struct Exported(pub abi::Library);
// SAFETY: the record and what it points to are constants.
unsafe impl Sync for Exported {}

/// Makes the library: its one exported function, its manifest note, and the door between C and the traits.
///
/// ```text
/// honami_plugin::export! {
///     library: { id: "org.lab.trackers", version: env!("CARGO_PKG_VERSION"), license: "MIT" },
///     plugins: [tracker Klt, clusterer Movement],
/// }
/// ```
/// A plugin is announced by its kind: `tracker`, `clusterer`, `structure` or `simulator`.
#[macro_export]
macro_rules! export {
    (library: { $($field:ident : $value:expr),* $(,)? }, plugins: [$($kind:ident $plugin:ty),* $(,)?] $(,)?) => {
        #[cfg(panic = "abort")]
        compile_error!("a plugin under panic = \"abort\" would take its host down: set panic = \"unwind\"");

        #[allow(unsafe_code, reason = "the exported symbol and the note section")]
        const _: () = {
            static PLUGINS: &[$crate::export::Descriptor] = &[$($crate::export::$kind::<$plugin>()),*];
            const LIBRARY: $crate::Library = $crate::Library { $($field: $value),* };
            const LEN: usize =
                $crate::export::manifest_len(&LIBRARY, &[$($crate::export::$kind::<$plugin>()),*]) + 1;
            #[used]
            #[unsafe(link_section = ".note.honami")]
            static NOTE: $crate::export::Note<LEN> =
                $crate::export::Note::new(&LIBRARY, &[$($crate::export::$kind::<$plugin>()),*]);
            static EXPORTED: $crate::export::Exported =
                $crate::export::Exported($crate::export::library(&NOTE, create));

            unsafe extern "C" fn create(
                host: *const $crate::abi::HostInfo,
                call: *const $crate::abi::Call,
                id: *const ::core::ffi::c_char,
            ) -> *mut $crate::abi::Instance {
                // SAFETY: the host keeps the contract of honami_library.create.
                unsafe { $crate::export::create(PLUGINS, host, call, id) }
            }

            #[unsafe(no_mangle)]
            extern "C" fn honami_library_v1(_: *const $crate::abi::HostInfo) -> *const $crate::abi::Library {
                $crate::export::quiet_panics();
                &raw const EXPORTED.0
            }
        };
    };
}

/// The record that the exported symbol returns.
#[must_use]
pub const fn library<const N: usize>(
    note: &'static Note<N>,
    create: unsafe extern "C" fn(*const abi::HostInfo, *const Call, *const c_char) -> *mut abi::Instance,
) -> abi::Library {
    abi::Library {
        struct_size: size_of::<abi::Library>() as u32,
        abi_minor: abi::ABI_MINOR,
        manifest: note.text().as_ptr().cast(),
        manifest_len: note.text().len() as u64,
        create: Some(create),
    }
}

/// Makes an instance of the plugin with this id.
///
/// # Safety
/// As `honami_library.create` in the header.
pub unsafe fn create(
    plugins: &[Descriptor],
    _host: *const abi::HostInfo,
    call: *const Call,
    id: *const c_char,
) -> *mut abi::Instance {
    // SAFETY: the host's call context lives until we return.
    let Some(call) = (unsafe { HostCall::new(call) }) else { return std::ptr::null_mut() };
    let mut made = std::ptr::null_mut();
    guard(&call, || {
        // SAFETY: null, or a string of the host's.
        let id = unsafe { text(id) };
        let found = plugins.iter().find(|plugin| plugin.info.id == id);
        made = found
            .map(|plugin| (plugin.create)())
            .ok_or_else(|| Error::unsupported(format!("there is no plugin {id} in this library")))?;
        Ok(code::OK)
    });
    made
}

/// The host's side of one call.
pub(crate) struct HostCall<'a> {
    pub(crate) raw: *const Call,
    /// What the host knew of it.
    pub(crate) known: Call,
    lives: PhantomData<&'a Call>,
}

// SAFETY: progress and log may be called from any thread while the call lasts; `Cx` reaches nothing else.
unsafe impl Sync for HostCall<'_> {}

impl HostCall<'_> {
    /// # Safety
    /// `raw` is null or lives for the lifetime of what is made.
    unsafe fn new(raw: *const Call) -> Option<Self> {
        // SAFETY: the caller's promise.
        let known = unsafe { table::given(raw) }.ok()?;
        Some(Self { raw, known, lives: PhantomData })
    }

    fn fail(&self, code: Code, why: &str) -> Code {
        if let Some(fail) = self.known.fail {
            let why = c_text(why);
            // SAFETY: the host's function, its own context, a string that outlives the call.
            unsafe { fail(self.raw, code, why.as_ptr()) };
        }
        code
    }
}

impl Listener for HostCall<'_> {
    fn progress(&self, fraction: f64, text: &str) -> bool {
        let text = c_text(text);
        // SAFETY: as in `fail`.
        self.known
            .progress
            .is_some_and(|progress| unsafe { progress(self.raw, fraction, text.as_ptr()) } != 0)
    }

    fn log(&self, level: i32, text: &str) {
        if let Some(log) = self.known.log {
            let text = c_text(text);
            // SAFETY: as in `fail`.
            unsafe { log(self.raw, level, text.as_ptr()) };
        }
    }
}

fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

/// # Safety
/// `string` is null or a C string that lives for `'a`.
pub(crate) unsafe fn text<'a>(string: *const c_char) -> &'a str {
    if string.is_null() {
        return "";
    }
    // SAFETY: the caller's promise.
    unsafe { CStr::from_ptr(string) }.to_str().unwrap_or("")
}

/// An instance as the host sees it, and behind it the plugin's state.
#[repr(C)]
struct Slot<S> {
    raw: abi::Instance,
    poisoned: bool,
    state: S,
}

/// What a kind of plugin keeps in an instance.
pub(crate) trait State: Sized + 'static {
    type Params: Params;
    fn new() -> Self;
    /// Takes other parameters, if they may be set now.
    fn set(&mut self, params: Self::Params, told: Told) -> Result<()>;
    /// The table of functions behind an interface id.
    fn interface(id: &CStr) -> *const std::ffi::c_void;
}

/// Numbers for the parameters that were set, others for others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Told {
    /// Of those that affect `"step"`,
    pub(crate) passing: u64,
    /// and of all others.
    pub(crate) lasting: u64,
}

impl Told {
    fn add(&mut self, schema: &[Param], id: &str, value: Value<'_>) {
        let affects_step = |param: &Param| param.attributes.contains(&("affects", "\"step\""));
        let is_passing = schema.iter().any(|param| param.id == id && affects_step(param));
        let sum = if is_passing { &mut self.passing } else { &mut self.lasting };
        // They come in any order.
        *sum = sum.wrapping_add(mix(0, format!("{id} {value:?}").as_bytes()));
    }

    pub(crate) fn all(self) -> u64 {
        self.passing.wrapping_add(self.lasting)
    }
}

pub(crate) fn new_instance<S: State>() -> *mut abi::Instance {
    let raw = abi::Instance {
        struct_size: size_of::<abi::Instance>() as u32,
        reserved: 0,
        this: std::ptr::null_mut(),
        destroy: Some(destroy::<S>),
        set_params: Some(set_params::<S>),
        get_interface: Some(get_interface::<S>),
    };
    let slot = Box::into_raw(Box::new(Slot { raw, poisoned: false, state: S::new() }));
    // SAFETY: just made, nobody else has it.
    unsafe { (*slot).raw.this = slot.cast() };
    slot.cast()
}

/// The door: every call on an instance comes through here.
///
/// # Safety
/// `instance` is null or was made by [`new_instance`] for the same `S`; `call` is null or lives until the return.
pub(crate) unsafe fn door<S: State>(
    instance: *mut abi::Instance,
    call: *const Call,
    f: impl FnOnce(&mut S, &HostCall<'_>) -> Result<Code>,
) -> Code {
    // SAFETY: the caller's promise; calls on one instance never overlap, so the slot is ours alone.
    let (slot, call) = unsafe { (instance.cast::<Slot<S>>().as_mut(), HostCall::new(call)) };
    let (Some(slot), Some(call)) = (slot, call) else { return code::ARGUMENT };
    if slot.poisoned {
        return call.fail(code::STATE, "this instance panicked earlier; make a new one");
    }
    let answer = guard(&call, || f(&mut slot.state, &call));
    slot.poisoned = answer == code::INTERNAL;
    answer
}

/// Runs a function; a failure or panic becomes a code and a text for the host.
fn guard(call: &HostCall<'_>, f: impl FnOnce() -> Result<Code>) -> Code {
    panics::forget();
    match std::panic::catch_unwind(AssertUnwindSafe(f)) {
        Ok(Ok(answer)) => answer,
        Ok(Err(error)) => call.fail(error.code(), &error.to_string()),
        Err(payload) => {
            let text = panics::report(&*payload);
            call.log(abi::log::ERROR, &text);
            // Never dropped: the payload is the plugin's, and its drop may panic again.
            let _payload = ManuallyDrop::new(payload);
            call.fail(code::INTERNAL, &text)
        }
    }
}

unsafe extern "C" fn destroy<S: State>(instance: *mut abi::Instance) {
    if instance.is_null() {
        return;
    }
    // SAFETY: made by `new_instance::<S>`, and the host is done with it.
    let slot = unsafe { Box::from_raw(instance.cast::<Slot<S>>()) };
    // A panic in its drop has nobody to hear it: there is no call.
    let _outcome = std::panic::catch_unwind(AssertUnwindSafe(|| drop(slot))).map_err(ManuallyDrop::new);
}

unsafe extern "C" fn get_interface<S: State>(
    _: *mut abi::Instance,
    id: *const c_char,
) -> *const std::ffi::c_void {
    if id.is_null() {
        return std::ptr::null();
    }
    // SAFETY: not null, so a string of the host's.
    S::interface(unsafe { CStr::from_ptr(id) })
}

unsafe extern "C" fn set_params<S: State>(
    instance: *mut abi::Instance,
    call: *const Call,
    values: *const abi::Value,
    n: u32,
) -> Code {
    // SAFETY: the host keeps the contract of honami_instance.set_params.
    unsafe {
        door::<S>(instance, call, |state, _| {
            let (mut params, mut told) = (S::Params::default(), Told::default());
            for value in table::slice(values, u64::from(n))? {
                let (id, value) = (text(value.id), value_of(value)?);
                params.set(id, value)?;
                told.add(S::Params::SCHEMA, id, value);
            }
            state.set(params, told)?;
            Ok(code::OK)
        })
    }
}

/// # Safety
/// `value.text` is null or a C string that lives for `'a`.
unsafe fn value_of(value: &abi::Value) -> Result<Value<'_>> {
    use honami_abi::kind;
    let [x, y, ..] = value.f;
    Ok(match value.kind {
        kind::BOOL => Value::Bool(value.i != 0),
        kind::INT => Value::Int(value.i),
        kind::FLOAT => Value::Float(x),
        // SAFETY: the caller's promise.
        kind::TEXT => Value::Text(unsafe { text(value.text) }),
        kind::VEC2 => Value::Vec2([x, y]),
        kind::RECT => Value::Rect(value.f),
        kind::SEED => Value::Seed(value.i.cast_unsigned()),
        other => return Err(Error::with_code(code::ARGUMENT, format!("there is no kind of value {other}"))),
    })
}

#[cfg(test)]
mod tests;
