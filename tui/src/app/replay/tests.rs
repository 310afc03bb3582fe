//! A session is recorded by keys on a real project, and done again on a copy of it.

use std::path::{Path, PathBuf};
use std::time::Duration;

use honami_model::document::Document;
use honami_model::judgement::{Effort, Verdict};
use honami_workbench::store::{Access, Project};
use tempfile::TempDir;

use super::*;
use crate::app::command_log::CommandLog;
use crate::app::fixture;
use crate::app::state::Mode;
use crate::app::update::Judge;

const N_FRAMES: usize = 12;

/// A project of a small clip, and a copy of it.
struct Bench(TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().unwrap());
        let mut clip = b"YUV4MPEG2 W64 H48 F25:1 Cmono\n".to_vec();
        for _ in 0..N_FRAMES {
            clip.extend(b"FRAME\n");
            clip.extend([90; 64 * 48]);
        }
        std::fs::write(bench.path("clip.y4m"), clip).unwrap();
        let made =
            Session::create(&bench.path("p.honami"), &bench.path("clip.y4m"), None, &Default::default());
        drop(made.unwrap());
        std::fs::copy(bench.path("p.honami"), bench.path("copy.honami")).unwrap();
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn session(&self, project: &str) -> Session {
        Session::open(&self.path(project), &Default::default()).unwrap()
    }

    /// The log of a session in which these keys are pressed and the mouse does this, five a second.
    fn record(&self, words: &str) -> String {
        let (waker, _woken) = signals::pair().unwrap();
        let mut world = World::new(self.session("p.honami"), waker);
        let mut state = world.state().unwrap();
        state.log = CommandLog::new(Head::of(&state, world.origin()));
        press(&mut state, &mut world, words);
        world.close(Seat::of(&state), None).unwrap();
        state.log.text()
    }

    /// What a log does with the copy, and what is said.
    fn replay(&self, log: &str) -> (anyhow::Result<Replay>, Vec<String>) {
        let mut said = Vec::new();
        let done = replay(self.session("copy.honami"), log, &mut |_, notice| said.push(notice.text.clone()));
        (done, said)
    }
}

/// Does what the words say, five a second, and what comes of it.
fn press(state: &mut State, world: &mut World, words: &str) {
    for (n, word) in words.split_whitespace().enumerate() {
        update(state, Msg::Clock(Duration::from_millis(200 * n as u64)));
        for effect in update(state, fixture::msg(word)) {
            for fact in world.carry_out(effect, state.now) {
                update(state, Msg::Fact(fact));
            }
        }
    }
}

/// The document, and the labels of all edits.
fn made(path: &Path) -> (Document, Vec<String>) {
    let project = Project::open(path, Access::Read).unwrap();
    let labels = project.history().entries().iter().map(|entry| entry.label.clone()).collect();
    (project.document().clone(), labels)
}

#[test]
fn a_session_done_again_makes_the_same_document() {
    for keys in [
        "a Enter 5 . a 1 0 h J Enter m 3 l H Enter u Ctrl-r",
        "a Enter 4 . Enter m l Enter 8 g f m 2 k Enter X 2 u Ctrl-r",
        "a Enter m l Enter m Esc a Enter d d u U j j Enter Esc m k Enter",
        ": a d d Enter Enter g f 7 Enter m H Enter [ [ X X : u n d o Enter",
        "a Enter z z m 3 l Enter a Enter / 0 Enter f . . m J Enter v q P L P l",
        "a Enter space . m l Enter ; Esc b m l Enter Enter Enter g e space m Enter",
        "a Enter s . 2 l . k . . Backspace Enter u Ctrl-r 5 g f s 2 5 ; l l Esc Enter",
        "a Enter z s press:30,8 ; late:90 drag:31,8 late:80 drag:32,9 late:90 drag:33,9 release:33,9 Enter T l Enter u u",
        "a Enter s press:40,9 release:40,9 5 0 ; j j l Esc Esc s . Backspace Enter Esc m l Enter",
        "a Enter e n b u d Enter 8 . m 3 l Enter 4 , r 2 . x r . Esc o e n space Enter d k",
        "a Enter 8 . m 3 l Enter 4 , e s e d y j y e a e d 2 . r 1 . d r X Y",
        "a Enter 8 . m l Enter g s a 9 l Enter e j Enter u 8 . m k Enter 4 , e x Enter e j Enter u u",
        "a Enter 8 . m 3 l Enter 4 , | m 2 k Tab Tab Tab Enter T l Enter [ ] * P t z Ctrl-Left b Esc S O",
        // What is held until a correction is worked out, and given up, leaves no line.
        "a Enter 8 . m 3 l Enter 4 , | m 2 k Tab Enter T l Esc Esc m 2 j Enter u",
        "a Enter G p 3 l H Enter G R u u Ctrl-r G p Esc v k",
        "a Enter g l a m l Enter ? Esc g k Enter m l Enter 9 9 g f d d u",
        "a Enter e b z Enter Z 2 0 h Enter 5 0 c m Enter Enter u Ctrl-r 3 . d b u",
        "e b z press:30,8 press:60,12 5 Enter c m Enter Backspace Backspace m Enter Enter e b Enter Esc u Ctrl-r d b",
    ] {
        let bench = Bench::new();
        let log = bench.record(keys);
        let (done, said) = bench.replay(&log);
        let done = done.unwrap();
        assert_eq!(done.difference, None, "{keys}\n{log}\n{said:#?}");
        assert_eq!(made(&bench.path("copy.honami")), made(&bench.path("p.honami")), "{keys}\n{log}");
        let n_edits = said.iter().filter(|line| line.contains("undoes)")).count();
        assert!(n_edits >= 2, "{said:?}");
    }
}

/// The one door: a log in which something is changed goes another way there, and is followed up to there.
#[track_caller]
fn check(from: &str, to: &str, expect: (usize, &str)) {
    let bench = Bench::new();
    let log = bench.record("a Enter 3 . m l Enter X");
    let changed = log.replacen(from, to, 1);
    assert_ne!(changed, log, "{from} is not in\n{log}");
    let (done, said) = bench.replay(&changed);
    let (line, how) = done.unwrap().difference.unwrap();
    assert!((line, how.contains(expect.1)) == (expect.0, true), "{line}: {how}\n{changed}");
    let n_edits = made(&bench.path("copy.honami")).1.len() - 1;
    assert_eq!(n_edits, said.iter().filter(|line| line.contains("undoes)")).count());
}

#[test]
fn the_first_difference_is_named() {
    let unknown = "\"action\":\"jump\",";
    for (from, to, expect) in [
        ("\"revision\":0", "\"revision\":9", (1, "began at edit 9, and the project stands at 0")),
        ("\"in\":\"move\"", "\"in\":\"form\"", (7, "done in form, and now it would be done in move")),
        ("\"action\":\"step\",", unknown, (5, "there is no action jump")),
        ("\"action\":\"right\",", "\"action\":\"play\",", (7, "play does nothing in move")),
        ("\"frame\":3,", "\"frame\":70,", (6, "there is no frame 70")),
        ("\"frame\":3,\"track\":", "\"frame\":3,\"track\":70", (6, "there is no track 70")),
        ("placed at frame 0", "placed at frame 1", (4, "and now it is the line “track")),
        ("\"notice\":", "\"error\":", (4, "the log has the error “track")),
        ("{\"t_s\":0.6", "{\"t_s\":-1", (5, "-1 s is no time")),
        ("{\"t_s\":0.6", "{\"t_s\":0.5,\"ended\":\"klt\"}\n{\"t_s\":0.6", (5, "now none is running")),
    ] {
        check(from, to, expect);
    }
}

#[test]
fn a_sketch_is_laid_as_late_as_it_was_drawn() {
    let bench = Bench::new();
    let log = bench.record(
        "a Enter s press:30,8 ; late:90 drag:32,8 late:80 drag:36,9 late:90 drag:38,9 release:38,9 Enter",
    );
    let accept = log.lines().find(|line| line.contains("\"sketched\"")).unwrap();
    assert!(accept.contains(r#""from_s":0.0,"rate":0.5,"delay_s":0.205"#), "{accept}");
    assert!(!log.contains("drag") && log.contains("release"), "{log}");
    let (done, _) = bench.replay(&log.replace("\"delay_s\":0.205", "\"delay_s\":0.115"));
    assert_eq!(done.unwrap().difference, None, "another delay is said in the same words");
    let (here, there) = (made(&bench.path("p.honami")), made(&bench.path("copy.honami")));
    assert!(here.1 == there.1 && here.0 != there.0, "and laid elsewhere");
}

#[test]
fn an_error_that_the_log_has_not_is_a_difference_and_a_line_is_none() {
    let bench = Bench::new();
    let log = bench.record("a Enter Enter X X");
    let without = |what: &str| -> String {
        log.lines().filter(|line| !line.contains(what)).map(|line| format!("{line}\n")).collect()
    };
    let (done, _) = bench.replay(&without("\"notice\":"));
    assert_eq!(done.unwrap().difference, None, "a log written by hand need not have them");
    let bench = Bench::new();
    let log = bench.record("X");
    let without: String = log.lines().take(2).map(|line| format!("{line}\n")).collect();
    let (line, how) = bench.replay(&without).0.unwrap().difference.unwrap();
    assert!(
        line == 2 && how.starts_with("the log has no error, and now there is the error"),
        "{line}: {how}"
    );
}

#[test]
fn a_log_of_another_clip_is_refused() {
    let bench = Bench::new();
    let log = bench.record("a Enter");
    let sha256 = Project::open(&bench.path("p.honami"), Access::Read).unwrap().clip().sha256.clone();
    let (done, said) = bench.replay(&log.replace(&sha256, "0123"));
    assert!(done.unwrap_err().to_string().starts_with("the log is of another clip") && said.is_empty());
}

/// Its file is taken away under the program, and given back.
#[test]
fn what_cannot_be_written_is_open_again_and_kept_once_it_can() {
    let bench = Bench::new();
    let (waker, _woken) = signals::pair().unwrap();
    let mut world = World::new(bench.session("p.honami"), waker);
    let mut state = world.state().unwrap();
    let failed = |state: &State| state.notice.as_ref().is_some_and(|notice| notice.is_error);
    press(&mut state, &mut world, "a Enter 8 . m 3 l Enter");
    assert!(!failed(&state), "{:?}", state.notice);
    std::fs::rename(bench.path("p.honami"), bench.path("away")).unwrap();
    for (keys, asks, is_back) in [
        ("4 , m 2 k", "Enter", &(|mode: &Mode| matches!(mode, Mode::Move(_))) as &dyn Fn(&Mode) -> bool),
        ("a", "Enter", &|mode| matches!(mode, Mode::Place(_))),
        ("e n b u d", "Enter", &|mode| matches!(mode, Mode::Name(name) if name == "bud")),
    ] {
        press(&mut state, &mut world, keys);
        press(&mut state, &mut world, asks);
        assert!(failed(&state) && is_back(&state.mode), "{keys}: {:?} {:?}", state.notice, state.mode);
        press(&mut state, &mut world, "Esc");
    }
    press(&mut state, &mut world, "2 u");
    assert!(failed(&state) && state.tracks.len() == 1, "{:?}", state.notice);
    press(&mut state, &mut world, "m 2 k Enter");
    std::fs::rename(bench.path("away"), bench.path("p.honami")).unwrap();
    press(&mut state, &mut world, "Enter");
    assert!(!failed(&state) && matches!(state.mode, Mode::Review), "{:?}", state.notice);
    world.close(Seat::of(&state), None).unwrap();
    assert_eq!(made(&bench.path("p.honami")).1.len(), 4);
}

#[test]
fn what_a_segment_takes_adds_up_over_its_verdicts() {
    let bench = Bench::new();
    let (waker, _woken) = signals::pair().unwrap();
    let mut world = World::new(bench.session("p.honami"), waker);
    let mut state = world.state().unwrap();
    press(&mut state, &mut world, "a Enter 8 . m 3 l Enter");
    let track = state.selected.unwrap();
    let effort = Effort { keystrokes: 3, key_frames: 1, seconds: 2.0 };
    for verdict in [Verdict::Later, Verdict::Fixed] {
        let reasons = Vec::new();
        let judge = Judge { track, frames: 0..9, verdict, reasons, effort };
        world.carry_out(Effect::Judge(judge), Duration::ZERO);
    }
    world.close(Seat::of(&state), None).unwrap();
    let (document, _) = made(&bench.path("p.honami"));
    let judgement = &document.track(track).unwrap().judgements[&0];
    assert_eq!(judgement.verdict, Verdict::Fixed);
    assert_eq!(judgement.effort, Effort { keystrokes: 6, key_frames: 2, seconds: 4.0 });
}
