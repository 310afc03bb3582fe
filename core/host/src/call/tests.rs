//! Callbacks at the wrong time, and listeners that panic: neither reaches the plugin's caller unnoticed.

use super::*;
use crate::reply::POINTS;

#[test]
fn callbacks_after_the_call_are_refused_and_told_at_the_next() {
    let (desk, mut reply, cx) = (CallDesk::new(), Reply::default(), CallContext::silent());
    let mut kept = std::ptr::null();
    desk.call(&cx, &[&POINTS], &mut reply, |call| {
        kept = call;
        code::OK
    });
    assert!(reply.faults.is_empty());
    // SAFETY: the desk is alive, which is what these functions need.
    unsafe {
        assert_eq!(progress(kept, 0.5, std::ptr::null()), 1, "nobody to go on for");
        log(kept, 1, c"too late".as_ptr());
        assert_eq!(commit(kept, POINTS.id.as_ptr(), 0), code::ARGUMENT);
    }
    desk.call(&cx, &[], &mut reply, |_| code::OK);
    assert_eq!(reply.faults, ["called commit when no call was going on"]);
    desk.call(&cx, &[], &mut reply, |_| code::OK);
    assert!(reply.faults.is_empty(), "told once");
}

#[test]
fn a_listener_that_panics_stops_the_plugin_and_goes_on_panicking_behind_it() {
    let (desk, mut reply) = (CallDesk::new(), Reply::default());
    let panics = |_: f64, _: &str| panic!("the listener");
    let cx = CallContext { progress: &panics, ..CallContext::silent() };
    let mut told = 0;
    let caught = std::panic::catch_unwind(AssertUnwindSafe(|| {
        desk.call(&cx, &[], &mut reply, |call| {
            // SAFETY: the call's own context.
            told = unsafe { progress(call, f64::NAN, std::ptr::null()) };
            code::CANCELLED
        });
    }));
    assert_eq!(told, 1);
    assert_eq!(caught.expect_err("the panic").downcast_ref(), Some(&"the listener"));
}

#[test]
fn null_pointers_are_answered() {
    // SAFETY: null is allowed for.
    unsafe {
        assert_eq!(progress(std::ptr::null(), 0.0, std::ptr::null()), 1);
        log(std::ptr::null(), 0, std::ptr::null());
        assert_eq!(fail(std::ptr::null(), code::DATA, std::ptr::null()), code::DATA);
        assert_eq!(reserve(std::ptr::null(), std::ptr::null(), 0, 0, std::ptr::null_mut()), code::ARGUMENT);
        assert_eq!(commit(std::ptr::null(), std::ptr::null(), 0), code::ARGUMENT);
    }
    let (desk, mut reply) = (CallDesk::new(), Reply::default());
    desk.call(&CallContext::silent(), &[&POINTS], &mut reply, |call| {
        // SAFETY: the call's own context, and null columns.
        unsafe { reserve(call, POINTS.id.as_ptr(), 1, 4, std::ptr::null_mut()) }
    });
    assert_eq!(reply.faults, ["reserved honami.points/1 with no columns"]);
}
