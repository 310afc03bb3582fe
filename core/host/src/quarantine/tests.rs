//! Too many failures within ten minutes, by the clock of the test.

use super::*;

#[test]
fn the_third_death_within_ten_minutes_holds_a_library_until_it_is_released() {
    let folder = tempfile::tempdir().unwrap();
    let quarantine = Quarantine(folder.path().join("new"));
    let [mut tally, rebuilt] = ["abc", "rebuilt"].map(|hash| Tally::new(quarantine.clone(), hash.into()));
    let segfault = Ended::Signal(11);
    let why = "died of SIGSEGV (it used memory that is not its own)";
    for wanted in [None, None, Some(why)] {
        // Neither who was asked to stop has died, nor who begins where another has.
        tally.ended(&Ended::Stopped, "");
        tally.pause(true);
        tally.ended(&segfault, "");
        tally.pause(false);
        tally.ended(&segfault, "");
        assert_eq!(tally.held().as_deref(), wanted);
    }
    assert_eq!(rebuilt.held(), None);
    for _ in 0..2 {
        quarantine.release("abc").unwrap();
    }
    tally.ended(&segfault, "");
    assert_eq!(tally.held(), None);
}

#[test]
fn failures_of_long_ago_and_of_a_clock_that_went_ahead_count_no_more() {
    let folder = tempfile::tempdir().unwrap();
    let quarantine = Quarantine(folder.path().to_owned());
    let at = |minutes: u64| UNIX_EPOCH + Duration::from_secs(1_000_000 + minutes * 60);
    for (minutes, wanted) in [(0, 1), (5, 2), (9, 3), (11, 3), (30, 1), (20, 1), (21, 2)] {
        assert_eq!(quarantine.count("abc", at(minutes)).unwrap(), wanted, "after {minutes} minutes");
    }
}

/// What a trail says.
const SNAIL: &str = "snail\n/lab/snail.so";

#[test]
fn the_trail_of_a_dead_process_keeps_its_library_out_until_it_is_let_in() {
    let folder = tempfile::tempdir().unwrap();
    let quarantine = Quarantine(folder.path().join("new"));
    assert_eq!(quarantine.follow_trails(), []);
    let leave = |sha256| quarantine.leave_trail(sha256, "klt", Path::new("/lab/klt.so")).unwrap();
    let _inside = [leave("alive"), leave("alive")];
    let over = [leave("over"), leave("over")];
    assert_eq!(quarantine.follow_trails(), [], "its process lives");
    let trails = || {
        let names =
            fs::read_dir(&quarantine.0).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
        names.filter(|name| name.ends_with(".inside")).count()
    };
    for (trail, left) in over.into_iter().zip([2, 1]) {
        drop(trail);
        assert_eq!(trails(), left, "it goes with the last instance");
    }
    // Two processes that have died with it, and one that has died before its trail had a name.
    for (name, plugin) in [("abc.7.inside", SNAIL), ("abc.8.inside", SNAIL), ("abc.9.new", SNAIL)] {
        fs::write(quarantine.0.join(name), plugin).unwrap();
    }
    assert!(!quarantine.is_kept_out("abc"));
    assert_eq!(quarantine.follow_trails(), [("snail".to_owned(), "/lab/snail.so".into())]);
    assert_eq!(quarantine.follow_trails(), [], "it is told once");
    assert_eq!(["abc", "alive", "rebuilt"].map(|hash| quarantine.is_kept_out(hash)), [true, false, false]);
    // One that has failed too often since may start again, but not inside.
    fs::write(quarantine.held("abc"), "").unwrap();
    quarantine.release("abc").unwrap();
    assert_eq!((quarantine.why("abc"), quarantine.is_kept_out("abc")), (None, true));
    assert_eq!([(); 2].map(|()| quarantine.let_in("abc").unwrap()), [true, false]);
    assert!(!quarantine.is_kept_out("abc"));
    ended_well();
    let left: Vec<_> = fs::read_dir(&quarantine.0).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, ["abc.9.new"]);
}

#[test]
fn failures_that_several_sessions_count_at_once_are_all_counted() {
    let folder = tempfile::tempdir().unwrap();
    let (quarantine, now) =
        (Quarantine(folder.path().to_owned()), UNIX_EPOCH + Duration::from_secs(1_000_000));
    std::thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(|| (0..10).for_each(|_| assert!(quarantine.count("abc", now).unwrap() > 0)));
        }
    });
    assert_eq!(quarantine.count("abc", now).unwrap(), 81);
}
