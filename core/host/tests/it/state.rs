//! What a tracker carries: saved and loaded, here and in its own process, it goes on with the same bits; what it did not
//! save it refuses, and goes on from its beginning.

use crate::tools::{compile, has_cc, host, isolating, named, of_zoo, pixels, point, start_in, stream, view};
use honami_host::{CallContext, Checkpoint, Code, Host, HostError, Kind, PluginInfo, Points, Tracker};

const DATA: Code = Code(-5);

/// The mortal tracker, in whom another version may have saved.
fn mortal(version: u32) -> PluginInfo {
    let version_flag = format!("-DVERSION={version}");
    let library =
        compile("tests/bad/mortal.c", &format!("mortal-{version}"), "../abi/include", &[&version_flag]);
    named(&[&library]).plugins()[0].clone()
}

fn begun(host: &Host, info: &PluginInfo) -> Tracker {
    let mut tracker = start_in(host, info, &[]).unwrap();
    tracker.begin(stream(), &CallContext::silent()).unwrap();
    tracker
}

fn pushed(tracker: &mut Tracker, frames: std::ops::Range<i64>) -> Vec<Points> {
    let cx = CallContext::silent();
    frames.flat_map(|n| tracker.push(&view(&pixels(n), n), &cx).unwrap()).collect()
}

/// A tracker that has seen frames 0 to 3, and what it was then.
fn saved(host: &Host, info: &PluginInfo) -> (Tracker, Checkpoint) {
    let cx = CallContext::silent();
    let mut tracker = begun(host, info);
    tracker.seed(&[point(5, 0.1, 0.7), point(9, 1.3, 1.9), point(7, 2.9, 2.25)], &cx).unwrap();
    let _rows = pushed(&mut tracker, 0..3);
    tracker.retire(&[9], &cx).unwrap();
    let _rows = pushed(&mut tracker, 3..4);
    let checkpoint = tracker.save(&cx).unwrap();
    (tracker, checkpoint)
}

#[test]
fn a_tracker_goes_on_from_what_it_saved_wherever_either_works() {
    if !has_cc() {
        return;
    }
    let (info, cx) = (mortal(1), CallContext::silent());
    let (mut undisturbed, checkpoint) = saved(&host(), &info);
    assert!(undisturbed.can_save() && !undisturbed.can_end());
    let rest = pushed(&mut undisturbed, 4..9);
    for (saver, loader) in [(host(), isolating()), (isolating(), host()), (isolating(), isolating())] {
        let (mut still, again) = saved(&saver, &info);
        assert_eq!(again.bytes, checkpoint.bytes, "the same state is saved as the same bytes");
        assert_eq!(pushed(&mut still, 4..9), rest, "saving changes nothing");
        let mut tracker = begun(&loader, &info);
        tracker.load(&again, &cx).unwrap();
        assert_eq!(pushed(&mut tracker, 4..9), rest);
        // The host, too, knows what was live: a retired point may come back, the next frame is the fifth.
        let mut tracker = begun(&loader, &info);
        tracker.load(&again, &cx).unwrap();
        let early = tracker.push(&view(&pixels(3), 3), &cx).expect_err("frame 3 was pushed").to_string();
        assert!(early.contains("frame 3 does not come after frame 3"), "{early}");
    }
}

#[test]
fn what_a_tracker_did_not_save_is_refused_and_the_stream_goes_on_as_it_was_begun() {
    if !has_cc() {
        return;
    }
    let (info, cx) = (mortal(1), CallContext::silent());
    for host in [host(), isolating()] {
        let (_, whole) = saved(&host, &info);
        let (_, other) = saved(&host, &mortal(2));
        let with = |bytes: Vec<u8>| {
            let mut other = whole.clone();
            other.bytes = bytes;
            other
        };
        let cut = with(whole.bytes[..whole.bytes.len() - 1].to_vec());
        let mut damaged = whole.clone();
        damaged.bytes[40] ^= 1;
        let (none, huge) = (with(Vec::new()), with(vec![7; 5 << 20]));
        let mut tracker = begun(&host, &info);
        for (strange, wanted) in [
            (cut, "what was saved is cut"),
            (damaged, "what was saved is damaged"),
            (other, "what was saved is of another version"),
            (none, "what was saved is cut"),
            (huge, "what was saved is cut"),
        ] {
            let refused = tracker.load(&strange, &cx);
            let is_data = matches!(&refused, Err(HostError::Failed { code, text, .. }) if *code == DATA && text == wanted);
            assert!(is_data, "wanted {wanted:?}, got {refused:?}");
        }
        tracker.seed(&[point(3, 1.0, 1.0)], &cx).unwrap();
        assert_eq!(pushed(&mut tracker, 0..2).len(), 2);
        let late = tracker.load(&whole, &cx).expect_err("the stream goes on").to_string();
        assert!(late.contains("a checkpoint is loaded before the first frame"), "{late}");
    }
}

#[test]
fn a_tracker_that_saves_nothing_says_so_and_goes_on() {
    let cx = CallContext::silent();
    for host in [host(), isolating()] {
        let mut tracker = begun(&host, &of_zoo(Kind::Tracker, "drift"));
        assert!(!tracker.can_save());
        tracker.seed(&[point(3, 1.0, 1.0)], &cx).unwrap();
        assert!(matches!(tracker.save(&cx), Err(HostError::Failed { code: Code(-2), .. })));
        assert_eq!(pushed(&mut tracker, 0..2).len(), 2);
    }
}
