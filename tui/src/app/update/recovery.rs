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

/// Answers whether a silent plugin is waited for, asked or not.
pub(super) fn answer(state: &mut State, patience: Patience) -> Vec<Effect> {
    let Some(quiet) = state.job.as_ref().and_then(|job| job.quiet.as_ref()) else {
        say(state, "no plugin is silent");
        return Vec::new();
    };
    let plugin = &quiet.plugin;
    let line = match patience {
        Patience::End => format!("{plugin} is ended after {} s without a sign of life", quiet.seconds),
        _ => {
            format!("{plugin} is waited for: asked again after {} s without a sign of life", quiet.again_s())
        }
    };
    say(state, line);
    vec![Effect::Silent(patience)]
}
