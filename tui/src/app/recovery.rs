//! What one key can do about work that has ended early.

use honami_model::document::RunId;
use honami_workbench::WorkbenchError;
use honami_workbench::plugins::HostError;
use honami_workbench::track::TrackOutcome;

use super::update::Effect;

/// What can be done, and how that is said.
#[derive(Clone, Debug, PartialEq)]
pub struct Recovery {
    /// What goes on with the work, or does it again.
    pub again: Effect,
    /// Id of the plugin that has failed too often, and must be let go before.
    pub held: Option<String>,
    /// What that does: `goes on from frame 212`.
    pub words: String,
}

impl Recovery {
    /// Of a run that has ended before the frames that were asked for; `None` of one that is through.
    pub(super) fn of_run(outcome: &TrackOutcome) -> Option<Self> {
        let is_early = outcome.stopped || outcome.error.is_some();
        let words = format!("goes on from frame {}", outcome.unseen_from);
        let held = outcome.error.as_ref().and_then(held);
        is_early.then(|| Self::new(Effect::Resume(Some(outcome.run)), held, words))
    }

    /// Of a run that ended early in a session before this one.
    pub(super) fn of_earlier(run: RunId) -> Self {
        Self::new(Effect::Resume(Some(run)), None, "goes on with it".to_owned())
    }

    /// Of work that has failed and has left nothing; `None` where it would only fail again.
    pub(super) fn of_failure(again: &Effect, error: &WorkbenchError) -> Option<Self> {
        let is_plugins = matches!(
            error,
            WorkbenchError::Plugin(
                HostError::Quarantined { .. }
                    | HostError::Ended { .. }
                    | HostError::Failed { .. }
                    | HostError::Misbehaved { .. }
            )
        );
        is_plugins.then(|| Self::new(again.clone(), held(error), "tries again".to_owned()))
    }

    fn new(again: Effect, held: Option<String>, words: String) -> Self {
        let name = held.as_ref().and_then(|id| id.rsplit('.').next());
        let words = name.map_or(words.clone(), |name| format!("lets {name} start again and {words}"));
        Self { again, held, words }
    }
}

/// The plugin that is not started again, if that is what went wrong.
fn held(error: &WorkbenchError) -> Option<String> {
    match error {
        WorkbenchError::Plugin(HostError::Quarantined { plugin, .. }) => Some(plugin.clone()),
        _ => None,
    }
}
