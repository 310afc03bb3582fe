//! What panics say, kept from the panic hook until the door reports it.

use std::any::Any;
use std::cell::Cell;
use std::sync::{Mutex, Once, PoisonError};

thread_local! {
    /// What the latest panic of this thread said.
    static HERE: Cell<Option<String>> = const { Cell::new(None) };
}

/// What the latest panic of any thread said.
static ANYWHERE: Mutex<Option<String>> = Mutex::new(None);

/// Keeps panics off the terminal: their message is kept for the door, which gives it to the host.
pub fn quiet_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| std::panic::set_hook(Box::new(|panic| keep(panic.to_string()))));
}

pub(super) fn keep(said: String) {
    // A thread that panics while it ends has no place of its own any more.
    HERE.try_with(|here| here.set(Some(said.clone()))).unwrap_or_default();
    *ANYWHERE.lock().unwrap_or_else(PoisonError::into_inner) = Some(said);
}

/// Forgets what an earlier panic of this thread said, which somebody has caught.
pub(super) fn forget() {
    HERE.take();
}

/// What the panic with this payload, just caught by this thread, said. One that began in another thread and was resumed
/// here is known by its payload.
pub(super) fn report(payload: &(dyn Any + Send)) -> String {
    let text = payload
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("panicked");
    let elsewhere = || {
        let mut said = ANYWHERE.lock().unwrap_or_else(PoisonError::into_inner);
        said.take_if(|said| said.contains(text))
    };
    HERE.take().or_else(elsewhere).unwrap_or_else(|| text.to_owned())
}
