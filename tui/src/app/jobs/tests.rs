//! Jobs that do not end when they are told to.

use std::sync::mpsc::sync_channel;

use super::*;
use crate::term::signals;

#[test]
fn one_that_does_not_stop_is_not_waited_for_without_end() {
    let (waker, _woken) = signals::pair().unwrap();
    let (gate, shut) = sync_channel::<()>(1);
    let running = Running::spawn(waker, move |_| {
        assert!(shut.recv().is_err(), "nobody sends");
        Done::Track(Box::new(Err(WorkbenchError::Stopped)))
    });
    let running = running.unwrap();
    running.stop();
    assert!(!running.ends_within(Duration::from_millis(1)), "it hears nobody");
    drop(gate);
    assert!(running.ends_within(Duration::from_secs(60)));
    let Some(Done::Track(done)) = running.join() else { panic!("it has ended") };
    assert!(matches!(*done, Err(WorkbenchError::Stopped)));
}

#[test]
fn one_that_panics_has_ended() {
    let (waker, _woken) = signals::pair().unwrap();
    let running = Running::spawn(waker, |_| panic!("a fault of the job's own")).unwrap();
    assert!(running.ends_within(Duration::from_secs(60)));
    assert!(running.join().is_none());
}

#[test]
fn what_a_plugin_prints_is_told_once_and_bounded() {
    let (waker, _woken) = signals::pair().unwrap();
    let running = Running::spawn(waker, |progress| {
        for n in 0..=N_KEPT {
            progress.hear("mine", Some(7), Level::Info, &n.to_string());
        }
        Done::Track(Box::new(Err(WorkbenchError::Stopped)))
    });
    let running = running.unwrap();
    assert!(running.ends_within(Duration::from_secs(60)));
    let prints = running.prints();
    let texts: Vec<&str> =
        [prints.first(), prints.last()].iter().flatten().map(|print| print.text.as_str()).collect();
    assert_eq!((prints.len(), texts), (N_KEPT, vec!["1", "1000"]), "the oldest goes");
    assert_eq!(running.prints(), []);
}

#[test]
fn a_silent_plugin_is_asked_about_once_it_is_too_long_and_ended_when_its_user_says_so() {
    let at_most = Duration::from_secs(10);
    let silence = |since, is_too_long| {
        Some(Silence { since: Duration::from_secs(since), is_too_long, at_most, is_spared: false })
    };
    let mut watch = Watch::default();
    // Seconds of silence and whether that is too long, what the user then answers, whether they are asked before.
    let steps = [
        (3, false, None, false, Patience::Wait),
        (11, true, None, true, Patience::Wait),
        (12, true, Some(Patience::Wait), true, Patience::Wait),
        (23, true, None, false, Patience::Wait),
        (24, true, Some(Patience::End), true, Patience::Wait),
        (25, true, None, true, Patience::End),
        (26, true, None, true, Patience::Wait),
    ];
    for (since, is_too_long, answer, is_asked, wanted) in steps {
        assert_eq!(watch.look("mine", None, "", silence(since, is_too_long)), wanted, "{since} s");
        assert_eq!(watch.quiet.as_ref().map(|quiet| quiet.is_asked), Some(is_asked), "{since} s");
        answer.into_iter().for_each(|answer| watch.answer(answer));
    }
    assert_eq!(watch.look("mine", None, "", None), Patience::Usual);
    assert_eq!((watch.quiet.take(), watch.waits), (None, Duration::ZERO));
    // Who answers before they are asked is asked later.
    for (since, is_too_long, answer, is_asked) in [
        (3, false, Some(Patience::Wait), false),
        (11, true, None, false),
        (19, true, None, false),
        (20, true, None, true),
    ] {
        assert_eq!(watch.look("mine", None, "", silence(since, is_too_long)), Patience::Wait, "{since} s");
        assert_eq!(watch.quiet.as_ref().map(|quiet| quiet.is_asked), Some(is_asked), "{since} s");
        answer.into_iter().for_each(|answer| watch.answer(answer));
    }
}

#[test]
fn a_death_is_told_at_once_and_among_what_was_printed() {
    let how = "died of SIGSEGV; it last printed: no weights";
    let (waker, _woken) = signals::pair().unwrap();
    let running = Running::spawn(waker, move |progress| {
        progress.at(12);
        progress.died("mine", 12, how, Some("started again at frame 10"));
        // What is not started again the end of the job tells of.
        progress.died("mine", 13, how, None);
        Done::Track(Box::new(Err(WorkbenchError::Stopped)))
    });
    let running = running.unwrap();
    assert!(running.ends_within(Duration::from_secs(60)));
    let print = |frame, level, text: &str| Print {
        frame: Some(frame),
        plugin: "mine".to_owned(),
        level,
        text: text.to_owned(),
    };
    let wanted = [
        print(12, Level::Error, how),
        print(12, Level::Warning, "started again at frame 10"),
        print(13, Level::Error, how),
    ];
    assert_eq!(running.prints(), wanted);
    assert_eq!(running.step().frame, Some(12));
    assert_eq!(running.said(), [format!("mine, frame 12: {how}; started again at frame 10")]);
}
