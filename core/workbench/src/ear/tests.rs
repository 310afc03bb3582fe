//! What listening to a plugin takes and tells.

use super::*;
use crate::progress::{Patience, Silence};

/// Is busy for a millisecond at least whenever it is told how far a job is, and keeps where that is.
#[derive(Default)]
struct Watcher(Mutex<Vec<(&'static str, Option<u32>)>>);

impl Progress for Watcher {
    fn report(&self, _: u64, _: u64, _: &str) -> Flow {
        let begun = Instant::now();
        while begun.elapsed() < Duration::from_millis(1) {}
        Flow::Continue
    }

    fn at(&self, frame: u32) {
        self.0.lock().unwrap().push(("at", Some(frame)));
    }

    fn silent(&self, _: &str, frame: Option<u32>, _: &str, _: Option<Silence>) -> Patience {
        self.0.lock().unwrap().push(("silent", frame));
        Patience::Usual
    }
}

#[test]
fn whoever_watches_is_told_of_the_frame_and_the_time_they_take_is_known() {
    let watcher = Watcher::default();
    let ear = Ear::new("org.lab.mine", &watcher);
    ear.call(0, 9, |_| ());
    assert_eq!(ear.busy(), Duration::ZERO, "nobody was told of anything");
    ear.at(102);
    ear.call(2, 9, |call| {
        (call.progress)(0.5, "");
        (call.progress)(0.8, "");
    });
    assert!(ear.busy() >= Duration::from_millis(2));
    // Whether it lives is told at the end of a call, too.
    assert_eq!(*watcher.0.lock().unwrap(), [("silent", None), ("at", Some(102)), ("silent", Some(102))]);
}
