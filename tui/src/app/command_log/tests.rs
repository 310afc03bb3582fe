//! Lines go into the log, onto the disk, and are read again as they were.

use super::*;
use crate::app::fixture;
use crate::app::update::{Effect, Msg, update};
use crate::term::input::Mouse;

/// The log that keys leave, from the fixture.
fn log_of(keys: &str) -> CommandLog {
    let mut state = fixture::state();
    state.log = CommandLog::new(Head::of(&state, Origin::default()));
    for key in keys.split_whitespace() {
        update(&mut state, Msg::Key(key.parse().unwrap()));
    }
    state.log
}

/// The lines of a log after the first, without what they all have.
fn lines(log: &CommandLog) -> Vec<String> {
    let same = |line: &str| line.replace("{\"t_s\":0.0,", "").replace(",\"frame\":0,\"track\":1", "");
    log.text().lines().skip(1).map(|line| same(line.trim_end_matches('}'))).collect()
}

#[test]
fn what_is_done_leaves_lines() {
    for (keys, expect) in [
        (
            "5 . ,",
            &[
                r#""action":"step","in":"review","count":5"#,
                r#""action":"step-back","in":"review","frame":5,"track":1"#,
            ][..],
        ),
        ("1 2 F9", &[]),
        (
            "g f 4 2 Enter",
            &[
                r#""action":"go-frame","in":"review""#,
                r#""text":"4","in":"prompt""#,
                r#""text":"2","in":"prompt""#,
                r#""action":"accept","in":"prompt""#,
            ],
        ),
        // Of the palette there is what was chosen in it; of other lists, also how.
        (
            ": f o l l o w Enter",
            &[r#""action":"follow","in":"review""#, r#""notice":"following the selected track""#],
        ),
        (
            "/ 7 Enter",
            &[
                r#""action":"go-track","in":"review""#,
                r#""text":"7","in":"menu""#,
                r#""action":"accept","in":"menu","chosen":"track 7 ""#,
            ],
        ),
        ("z m", &[r#""action":"zoom-in","in":"review""#, r#""action":"move-sample","in":"review","zoom":1"#]),
        (
            "X",
            &[
                r#""action":"clear-key-frame","in":"review""#,
                r#""error":"no key-frame of the selected track is here; [ and ] go to them""#,
            ],
        ),
    ] {
        assert_eq!(lines(&log_of(keys)), expect, "by {keys}");
    }
}

#[test]
fn a_verdict_is_in_the_line_of_its_action() {
    let log = log_of("n R");
    let reject = log.lines().iter().rev().find_map(|line| line.here.clone()).unwrap();
    let judged = reject.judged.unwrap();
    assert_eq!(Some(judged.track.0), reject.track);
    let (_, read) = read(&log.text()).unwrap();
    assert!(
        read.iter().any(|(_, line)| line.here.as_ref().is_some_and(|h| h.judged == Some(judged.clone())))
    );
}

#[test]
fn every_kind_of_line_is_read_as_it_was_written() {
    let mut state = fixture::state();
    state.log = CommandLog::new(Head::of(&state, Origin::default()));
    for (column, row) in [(40, 10), (40, 23)] {
        update(&mut state, Msg::Mouse(Mouse { kind: MouseKind::Press(0), column, row }));
        update(&mut state, Msg::Mouse(Mouse { kind: MouseKind::WheelUp, column, row }));
    }
    update(&mut state, Msg::Clock(std::time::Duration::new(1, 234_567_891)));
    update(&mut state, Msg::Resize(120, 40));
    update(&mut state, Msg::Key("X".parse().unwrap()));
    state.log.push(Line { t_s: 2.0, what: What::Ended("klt".to_owned()), here: None });
    let (head, read) = read(&state.log.text()).unwrap();
    assert_eq!(head, state.log.head);
    assert!(read.iter().map(|(_, line)| line).eq(state.log.lines()));
    assert!(read.iter().map(|(number, _)| *number).eq(2..2 + read.len()));
}

#[test]
fn the_log_is_bounded_and_says_what_is_missing() {
    let mut log = CommandLog::new(Head::of(&fixture::state(), Origin::default()));
    for n in 0..N_KEPT + 3 {
        log.push(Line { t_s: n as f64, what: What::Ended(n.to_string()), here: None });
    }
    assert_eq!((log.lines().len(), log.n()), (N_KEPT, N_KEPT as u64 + 3));
    assert_eq!(log.since(N_KEPT as u64 + 1).count(), 2);
    assert!(read(&log.text()).unwrap_err().contains("its first 3 lines"));
}

#[test]
fn what_is_no_log_is_refused_and_a_cut_line_left_out() {
    let good = log_of("5 . ,").text();
    assert_eq!(read(&good[..good.len() - 9]).unwrap().1.len(), 1, "the second line was cut off");
    for (text, expect) in [
        (String::new(), "line 1: wanted the first line of a log of honami"),
        ("{\"honami-log\":7}\n".to_owned(), "line 1: wanted a log of format 1, got format 7"),
        (good.replace("\"t_s\"", "\"when\""), "line 2: missing field `t_s`"),
    ] {
        let error = read(&text).unwrap_err();
        assert!(error.starts_with(expect), "{error}");
    }
}

#[test]
fn saved_logs_are_numbered_and_nothing_is_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let project = folder.path().join("malva.honami");
    let names: Vec<String> = ["a", "b", "c"]
        .map(|text| save(text, &project).unwrap().file_name().unwrap().to_string_lossy().into_owned())
        .into();
    assert_eq!(names, ["malva.log.jsonl", "malva-2.log.jsonl", "malva-3.log.jsonl"]);
    assert_eq!(std::fs::read_to_string(folder.path().join("malva-2.log.jsonl")).unwrap(), "b");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3, "nothing else is left");
    assert!(save("d", &folder.path().join("gone/p.honami")).is_err());
}

#[test]
fn a_log_on_the_disk_grows_with_its_session() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.jsonl");
    let mut file = LogFile::create(&path).unwrap();
    assert!(LogFile::create(&path).is_err(), "a log is never overwritten");
    let mut state = fixture::state();
    state.log = CommandLog::new(Head::of(&state, Origin::default()));
    for key in [".", "X", "P"] {
        update(&mut state, Msg::Key(key.parse().unwrap()));
        file.write(&state.log).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), state.log.text(), "after {key}");
    }
    let effects = update(&mut state, Msg::Key("L".parse().unwrap()));
    let [Effect::SaveLog(text)] = &effects[..] else { panic!("{effects:?}") };
    assert_eq!(*text, state.log.text());
}
