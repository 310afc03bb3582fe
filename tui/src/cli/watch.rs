//! `track --watch`: track, and again with every rebuilt file of the plugin.

use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use honami_model::document::RunId;
use honami_workbench::plugins::{Kind, PluginInfo, Watch};
use honami_workbench::progress::{Flow, Progress as _};
use honami_workbench::rebuilt::{Difference, LOOK_EVERY};
use honami_workbench::session::Session;
use honami_workbench::store::RunInfo;
use honami_workbench::track::{PointSource, TrackRequest, existing};
use honami_workbench::versus;
use serde_json::json;

use super::args::{Common, Track};
use super::{Answer, report, session, track};

/// Tracks and says what was found, and so again with every build, until Ctrl-C.
pub(super) fn watch(args: &Track, common: &Common) -> anyhow::Result<ExitCode> {
    let mut session = session(&args.project, common)?;
    let mut request = track::asked(args, &session)?;
    let bar = report::Bar::with(common);
    let mut file = File::of(session.registry.find(Kind::Tracker, &request.plugin)?);
    let mut before = None;
    loop {
        match track_once(&mut session, &request, before.as_ref(), &args.project, &bar) {
            Ok((answer, run)) => {
                answer.print(common.json)?;
                file.seen.push(run.build_of(run.found.end).sha256);
                // From now on the same features where they are now: what a bad build reports moves no later one's.
                if before.is_none() {
                    let features = existing(&session, &request.frames, Some(&run.tracks))?;
                    request.points = PointSource::Given(features);
                }
                before = Some(run);
            }
            // The next build may do better.
            Err(error) => report::complain(&error),
        }
        loop {
            report::say("waiting for the next build; Ctrl-C ends it");
            if !file.wait(&bar) {
                return Ok(ExitCode::SUCCESS);
            }
            session.look_for_plugins();
            match track::asked(args, &session) {
                Ok(next) => {
                    request.params = next.params;
                    break;
                }
                Err(error) => report::complain(&error),
            }
        }
    }
}

/// One run, and how it differs from the one before.
fn track_once(
    session: &mut Session,
    request: &TrackRequest,
    before: Option<&RunInfo>,
    project: &Path,
    bar: &report::Bar,
) -> anyhow::Result<(Answer, RunInfo)> {
    let outcome = track::run(session, request, bar)?;
    let run = session.project.run(outcome.run)?;
    let mut answer = track::describe(&outcome, project);
    if let Some(before) = before {
        let frames = before.found.start.max(run.found.start)..before.found.end.min(run.found.end);
        let pair: [RunId; 2] = [before.id, run.id];
        let compared = versus::compare(session.project.path(), pair, &run.tracks)?;
        let difference = Difference::of(frames, &compared.tracks);
        answer.text += &format!("\n{}: {difference}", run.build_of(run.found.end));
        answer.json["run_before"] = json!(before.id.0);
        answer.json["difference"] = track::difference(&difference);
    }
    Ok((answer, run))
}

/// The plugin's file, and which of its contents have been tracked with.
struct File {
    plugin: PluginInfo,
    watch: Watch,
    seen: Vec<String>,
}

impl File {
    fn of(plugin: &PluginInfo) -> Self {
        let seen = plugin.sha256().into_iter().collect();
        Self { plugin: plugin.clone(), watch: Watch::of(plugin), seen }
    }

    /// Waits for another content than the last; whether it came, or nobody wants to wait any more.
    fn wait(&mut self, bar: &report::Bar) -> bool {
        while bar.report(0, 1, "waiting") == Flow::Continue {
            if self.watch.look(Instant::now())
                && let Ok(sha256) = self.plugin.sha256()
                && !self.seen.contains(&sha256)
            {
                self.seen = vec![sha256];
                return true;
            }
            std::thread::park_timeout(LOOK_EVERY);
        }
        false
    }
}
