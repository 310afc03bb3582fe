//! Plugins in processes of their own: the same bits as in this one, and nothing that they do there reaches it.

use crate::bad::bad;
use crate::tools::{has_cc, host, isolating, of_zoo, pixels, point, stream, view};
use honami_host::{CallContext, Flow, Host, HostError, Kind, Level, Limits, Points, Values};
use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;

/// What a tracker of the zoo makes of six frames.
fn tracked(host: &Host, name: &str) -> Vec<Points> {
    let cx = CallContext::silent();
    let info = of_zoo(Kind::Tracker, name);
    let (mut tracker, _) = host.tracker(&info, &Values::default(), &cx).unwrap();
    tracker.begin(stream(), &cx).unwrap();
    tracker.seed(&[point(5, 0.1, 0.7), point(9, 3.3, 1.9), point(7, 6.9, 2.25)], &cx).unwrap();
    let mut all: Vec<Points> =
        (0..6).flat_map(|n| tracker.push(&view(&pixels(n), n), &cx).unwrap()).collect();
    all.extend(tracker.end(&cx).unwrap());
    all
}

#[test]
fn a_tracker_does_the_same_wherever_it_works() {
    for name in ["drift", "delayed"] {
        let there = tracked(&isolating(), name);
        assert!(!there.is_empty());
        assert_eq!(there, tracked(&host(), name), "{name}");
    }
}

/// Frames 0, 1 and 2 of a bad tracker in its own process, with what its log says; frames 0 and 1 are always whole.
fn in_frame_2(fault: &str, host: &Host) -> (Result<Vec<Points>, HostError>, String) {
    let log = Mutex::new(String::new());
    let hear = |_: Level, line: &str| {
        let mut log = log.lock().unwrap();
        log.push_str(line);
        log.push('|');
    };
    let cx = CallContext { log: &hear, ..CallContext::silent() };
    let registry = bad(fault, &[]);
    let (mut tracker, _) = host.tracker(&registry.plugins()[0], &Values::default(), &cx).unwrap();
    tracker.begin(stream(), &cx).unwrap();
    tracker.seed(&[point(3, 1.0, 1.0), point(1, 2.0, 1.5)], &cx).unwrap();
    for n in 0..2 {
        assert_eq!(tracker.push(&view(&pixels(n), n), &cx).unwrap()[0].rows.len(), 2, "{fault}");
    }
    let last = tracker.push(&view(&pixels(2), 2), &cx);
    drop(tracker);
    (last, log.into_inner().unwrap())
}

#[test]
fn what_a_start_will_come_to_is_what_it_comes_to() {
    let drift = of_zoo(Kind::Tracker, "drift");
    for host in [host(), isolating()] {
        let told = host.prospect(&drift);
        let (_, origin) = host.tracker(&drift, &Values::default(), &CallContext::silent()).unwrap();
        let came = if origin.sandbox == "in process" { "none" } else { &origin.sandbox };
        assert_eq!((told.sandbox, told.why.is_empty()), (came, came == "full"), "{told:?}");
        assert_eq!(told.is_bare, origin.sandbox == "in process");
    }
}

/// Whether this kernel keeps files away from a process that has given them up; says so if not.
fn is_shut_in() -> bool {
    let info = of_zoo(Kind::Tracker, "drift");
    let (_, origin) = isolating().tracker(&info, &Values::default(), &CallContext::silent()).unwrap();
    if origin.sandbox != "full" {
        eprintln!("skipped: needs landlock in the kernel (the process is shut in {})", origin.sandbox);
    }
    origin.sandbox == "full"
}

fn hasty() -> Host {
    let [tell, end, start, stop] = [20, 2_000, 60_000, 100].map(Duration::from_millis);
    isolating().limits(Limits { tell, end, start, stop, memory_bytes: Some(1 << 29) })
}

#[test]
fn what_a_plugin_does_in_frame_2_costs_that_frame_and_no_more() {
    if !has_cc() {
        return;
    }
    // CALLS looks for it: left open for all that this process starts, as careless programs do.
    let left_open = rustix::io::fcntl_dupfd_cloexec(rustix::stdio::stdin(), 100).unwrap();
    rustix::io::fcntl_setfd(&left_open, rustix::io::FdFlags::empty()).unwrap();
    for (fault, wanted) in [
        (
            "SEGFAULT",
            "org.honami.bad died of SIGSEGV (it used memory that is not its own) in push of frame 2",
        ),
        ("ABORTS", "org.honami.bad died of SIGABRT (it gave up) in push of frame 2"),
        ("EXITS", "org.honami.bad ended its process with status 0 in push of frame 2"),
        ("LOOPS", "org.honami.bad was ended after 2 s without a sign of life in push of frame 2"),
        ("SLEEPS", "org.honami.bad was ended after 2 s without a sign of life in push of frame 2"),
        ("FLOODS", "org.honami.bad was ended after 2 s without a sign of life in push of frame 2"),
        ("FORKS", "org.honami.bad died of SIGSEGV"),
        ("LEAKS", "no memory for a gigabyte"),
        ("SOCKET", "no socket"),
        ("FILES", "no file"),
        ("CONNECTS", "no socket"),
        ("CALLS", "none of the calls"),
        (
            "READS_ON",
            "org.honami.bad died of SIGSEGV (it used memory that is not its own) in push of frame 2",
        ),
    ] {
        if fault == "FILES" && !is_shut_in() {
            continue;
        }
        let (last, _) = in_frame_2(fault, &hasty());
        let got = last.expect_err(fault).to_string();
        assert!(got.contains(wanted), "{fault}: wanted {wanted:?}, got {got:?}");
    }
}

#[test]
fn what_a_plugin_prints_is_a_line_of_the_log_without_what_moves_a_cursor() {
    if !has_cc() {
        return;
    }
    let (last, log) = in_frame_2("ESCAPES", &isolating());
    assert_eq!((last.unwrap().len(), log.as_str()), (1, "red|"));
}

#[test]
fn a_plugin_that_does_not_stop_is_ended() {
    if !has_cc() {
        return;
    }
    let registry = bad("DEAF", &[]);
    let silent = CallContext::silent();
    let (mut tracker, _) = hasty().tracker(&registry.plugins()[0], &Values::default(), &silent).unwrap();
    tracker.begin(stream(), &silent).unwrap();
    let stop = |_: f64, text: &str| if text == "busy" { Flow::Stop } else { Flow::Continue };
    let cx = CallContext { progress: &stop, ..silent };
    let got = tracker.push(&view(&pixels(2), 2), &cx).expect_err("it never stops");
    assert!(matches!(got, HostError::Cancelled { .. }), "{got}");
}

#[test]
fn a_plugin_writes_in_a_folder_of_its_own_that_goes_with_it() {
    if !has_cc() {
        return;
    }
    let told = in_frame_2("SCRIBBLES", &isolating()).0.expect_err("it says where").to_string();
    let place = told.split_whitespace().find(|word| word.ends_with("/scribble"));
    let room = Path::new(place.expect(&told)).parent().unwrap();
    assert!(room.starts_with(std::env::temp_dir()) && !room.exists(), "{told}");
}

#[test]
fn deaths_count_wherever_it_works_until_it_is_let_go_on() {
    if !has_cc() {
        return;
    }
    let registry = bad("WITHERS", &[]);
    let (info, cx) = (&registry.plugins()[0], CallContext::silent());
    let die = |host: &Host, is_pardoned: bool| {
        let (mut tracker, _) = host.tracker(info, &Values::default(), &cx)?;
        tracker.pardon(is_pardoned);
        tracker.begin(stream(), &cx)?;
        tracker.push(&view(&pixels(2), 2), &cx)
    };
    for is_pardoned in [true, true, true, false, false, true, false] {
        let died = die(&isolating(), is_pardoned).expect_err("it dies");
        assert!(matches!(died, HostError::Ended { .. }), "{died}");
    }
    let held = die(&isolating(), false).expect_err("it is held");
    assert!(matches!(held, HostError::Quarantined { .. }), "{held}");
    let seen = die(&isolating().without_quarantine(), false).expect_err("it dies again");
    assert!(matches!(seen, HostError::Ended { .. }), "{seen}");
    assert!(isolating().retry(info).unwrap());
    let died = die(&isolating(), false).expect_err("it may again");
    assert!(matches!(died, HostError::Ended { .. }), "{died}");
}

#[test]
fn a_constructor_can_do_nothing_and_its_end_is_named() {
    if !has_cc() {
        return;
    }
    let file = crate::tools::scratch().join("written-by-a-constructor");
    let named = format!("-DCONSTRUCTOR={:?}", file.display().to_string());
    for (fault, wanted) in [
        ("CTOR_WRITES", None),
        ("CTOR_EXECS", None),
        ("CTOR_DIES", Some("org.honami.bad died of SIGABRT (it gave up) in create")),
    ] {
        if fault == "CTOR_WRITES" && !is_shut_in() {
            continue;
        }
        let registry = bad(fault, &[&named]);
        let made = isolating().tracker(&registry.plugins()[0], &Values::default(), &CallContext::silent());
        match wanted {
            None => assert!(made.is_ok(), "{fault}: {:?}", made.err()),
            Some(wanted) => assert_eq!(made.expect_err(fault).to_string(), wanted),
        }
        assert!(!file.exists(), "{fault}");
    }
}

#[test]
fn what_becomes_of_a_file_does_not_reach_who_works_from_it() {
    if !has_cc() {
        return;
    }
    for host in [host(), isolating()] {
        let registry = bad("NONE", &["-DIN_USE"]);
        let library = registry.plugins()[0].library.clone();
        let whole = std::fs::read(&library).unwrap();
        let cx = CallContext::silent();
        let (mut tracker, _) = host.tracker(&registry.plugins()[0], &Values::default(), &cx).unwrap();
        tracker.begin(stream(), &cx).unwrap();
        tracker.seed(&[point(3, 1.0, 1.0)], &cx).unwrap();
        // Overwritten in place, cut short, and gone.
        std::fs::write(&library, vec![0xA5; whole.len()]).unwrap();
        assert_eq!(tracker.push(&view(&pixels(0), 0), &cx).unwrap()[0].rows.len(), 1);
        std::fs::write(&library, &whole[..whole.len() / 2]).unwrap();
        assert_eq!(tracker.push(&view(&pixels(1), 1), &cx).unwrap()[0].rows.len(), 1);
        let half = crate::tools::named(&[&library]);
        assert_eq!((half.plugins().len(), half.problems().len()), (0, 1), "half a library is none");
        std::fs::remove_file(&library).unwrap();
        assert_eq!(tracker.push(&view(&pixels(2), 2), &cx).unwrap()[0].rows.len(), 1);
    }
}
