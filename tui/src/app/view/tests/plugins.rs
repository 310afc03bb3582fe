//! What the screen says of plugins at work.

use std::time::Duration;

use honami_model::document::RunId;

use super::check;
use crate::app::fixture;
use crate::app::recovery::Recovery;
use crate::app::state::{Job, Notice, Quiet, State};
use crate::app::update::Effect;

#[test]
fn what_plugins_print() {
    check("prints_80x24", (80, 24), "P o", fixture::prints);
    check("prints_40x12", (40, 12), "P o", fixture::prints);
    check("prints_120x40", (120, 40), "P o P w", fixture::prints);
    // A line is looked at while many others come.
    let many = |state: &mut State| (0..9).for_each(|_| fixture::prints(state));
    check("prints_before_80x24", (80, 24), "P o 2 0 k", many);
    // Nothing becomes a key-frame by this.
    check("prints_gone_to_80x24", (80, 24), "P o 2 k Enter", fixture::prints);
    check("prints_gone_nowhere_80x24", (80, 24), "P o 5 k Enter", fixture::prints);
}

/// A run in frame 40 whose plugin has been silent for so long.
fn silent(seconds: u64, is_asked: bool) -> impl FnOnce(&mut State) {
    move |state| {
        let (plugin, at) = ("my-flow".to_owned(), "level 2".to_owned());
        let frame = Some(40);
        let quiet = Some(Quiet { plugin: plugin.clone(), frame, seconds, limit_s: 10, at, is_asked });
        let (what, since) = ("frame".to_owned(), Duration::ZERO);
        // The frames 10 to 99 of the clip.
        let (done, first) = ((30, 90), 10);
        let (keeps_frames, is_stopping) = (true, false);
        state.job = Some(Job { plugin, what, done, first, since, keeps_frames, is_stopping, frame, quiet });
    }
}

#[test]
fn a_plugin_that_is_silent() {
    check("silent_80x24", (80, 24), "", silent(4, false));
    check("silent_asked_80x24", (80, 24), "", silent(12, true));
    check("silent_asked_40x12", (40, 12), "", silent(12, true));
    // Both answers are taken before the question comes, too.
    check("silent_waits_80x24", (80, 24), "W", silent(4, false));
    check("silent_ended_80x24", (80, 24), "I", silent(12, true));
}

#[test]
fn what_can_be_done_about_a_plugin_that_died() {
    let died = |state: &mut State| {
        let text = "my-flow failed at frame 41, 3 tracks up to there kept: org.lab.my-flow has failed three times within ten \
                    minutes and is not started again (died of SIGSEGV (it used memory that is not its own))";
        state.notice = Some(Notice { text: text.to_owned(), is_error: true });
        state.recovery = Some(Recovery {
            again: Effect::Resume(Some(RunId(3))),
            held: Some("org.lab.my-flow".to_owned()),
            words: "lets my-flow start again and goes on from frame 41".to_owned(),
        });
        fixture::prints(state);
    };
    check("died_80x24", (80, 24), "", died);
    check("died_40x12", (40, 12), "", died);
    check("died_120x40", (120, 40), "", died);
}
