//! What one key does about work that has ended early, and about a plugin that is silent.

use honami_workbench::progress::Patience;

use super::{Effect, State, complain, edit, say};
use crate::app::recovery::Recovery;

/// Goes on with what has ended early.
pub(super) fn go_on(state: &mut State) -> Vec<Effect> {
    if let Some(job) = &state.job {
        let line = format!("{} is still running", job.plugin);
        complain(state, line);
        return Vec::new();
    }
    if !edit::is_writable(state) {
        return Vec::new();
    }
    match state.recovery.take() {
        Some(Recovery { again, held, .. }) => held.map(Effect::Release).into_iter().chain([again]).collect(),
        None => vec![Effect::Resume(None)],
    }
}

/// Answers whether a silent plugin is waited for.
pub(super) fn answer(state: &mut State, patience: Patience) -> Vec<Effect> {
    if state.job.as_ref().is_some_and(|job| job.quiet.is_some()) {
        return vec![Effect::Silent(patience)];
    }
    say(state, "no plugin is silent");
    Vec::new()
}
