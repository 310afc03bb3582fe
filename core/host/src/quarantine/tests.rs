//! Too many failures within ten minutes, by the clock of the test.

use super::*;

#[test]
fn the_third_failure_within_ten_minutes_holds_a_library_until_it_is_released() {
    let folder = tempfile::tempdir().unwrap();
    let quarantine = Quarantine(folder.path().join("new"));
    for n in 1..=3 {
        assert_eq!(quarantine.is_too_much("abc", "died of SIGSEGV"), n == 3, "failure {n}");
    }
    assert_eq!(quarantine.why("abc").as_deref(), Some("died of SIGSEGV"));
    assert_eq!(quarantine.why("rebuilt"), None);
    quarantine.release("abc").unwrap();
    quarantine.release("abc").unwrap();
    assert_eq!(quarantine.why("abc"), None);
    assert!(!quarantine.is_too_much("abc", "again"));
}

#[test]
fn failures_of_long_ago_count_no_more() {
    let folder = tempfile::tempdir().unwrap();
    let quarantine = Quarantine(folder.path().to_owned());
    let at = |minutes: u64| UNIX_EPOCH + Duration::from_secs(1_000_000 + minutes * 60);
    for (minutes, wanted) in [(0, 1), (5, 2), (9, 3), (11, 3), (30, 1)] {
        assert_eq!(quarantine.count("abc", at(minutes)).unwrap(), wanted, "after {minutes} minutes");
    }
}
