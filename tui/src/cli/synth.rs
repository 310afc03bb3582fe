//! `synth` and `demo`: clips with known truth, and the whole job on one of them.

use std::fs;
use std::io::IsTerminal as _;

use anyhow::Context as _;
use honami_workbench::generate::{self, Generated};
use honami_workbench::session::Session;
use honami_workbench::synth::{Level, Settings};
use honami_workbench::track::PointSource;
use serde_json::json;

use super::args::{Common, Demo, Synth, Wind};
use super::{Answer, Outcome, groups, options, project, report, show, track};
use crate::app::Plan;

/// Renders a clip and its truth.
pub(super) fn synth(args: &Synth) -> anyhow::Result<Answer> {
    let level = match args.wind {
        Wind::Calm => Level::Calm,
        Wind::Wind => Level::Wind,
        Wind::Storm => Level::Storm,
    };
    let mut settings = Settings {
        seed: args.seed,
        width: args.size.width,
        height: args.size.height,
        n_frames: args.frames,
        fps: args.fps,
        level,
        ..Settings::default()
    };
    if let Some(n_leaves) = args.leaves {
        settings.n_leaves = n_leaves;
    }
    anyhow::ensure!(!args.out.exists(), "{} is there already: choose another name", args.out.display());
    Ok(describe(&generate::generate(&settings, &args.out, &report::Bar::new())?))
}

fn describe(made: &Generated) -> Answer {
    let text = format!(
        "{}: {} leaves on {} branches, moving {:.2} px per frame\ntruth: {}",
        made.clip.display(),
        made.n_leaves,
        made.n_branches,
        made.step_px,
        made.truth.display()
    );
    let json = json!({
        "clip": made.clip,
        "truth": made.truth,
        "leaves": made.n_leaves,
        "branches": made.n_branches,
        "step_px": made.step_px,
    });
    Answer { json, text, done: true }
}

/// The whole job on a generated clip, with its truth beside it; then the terminal UI.
pub(super) fn demo(args: &Demo, common: &Common) -> anyhow::Result<Outcome> {
    fs::create_dir_all(&args.folder).with_context(|| format!("cannot make {}", args.folder.display()))?;
    let (clip, file) = (args.folder.join("shrub.y4m"), args.folder.join("shrub.honami"));
    if !clip.exists() {
        report::say("rendering a shrub in a light wind, with its truth …");
        generate::generate(&Settings::default(), &clip, &report::Bar::new())?;
    }
    let mut session = if file.exists() {
        Session::open(&file, &options(common))?
    } else {
        project::make(&file, &clip, None, common)?
    };
    if session.project.document().runs().is_empty() {
        report::say("tracking …");
        let request = track::request(&session, PointSource::Detect);
        let outcome = track::run(&mut session, &request)?;
        report::say(&outcome.line);
    }
    if session.project.document().clustering().is_none() {
        report::say("clustering …");
        let outcome = groups::run(&mut session, &groups::request())?;
        report::say(&outcome.line);
    }
    let truth = generate::truth_beside(&clip);
    let text = format!(
        "{} is ready: open it with `honami {0}`\nhow good was it: honami compare {} --truth {} --with klt",
        file.display(),
        clip.display(),
        truth.display()
    );
    if args.headless || common.json || !std::io::stdout().is_terminal() {
        let n_tracks = session.project.document().tracks().count();
        let n_groups = session.project.grouping()?.map_or(0, |grouping| grouping.nodes.len());
        let json =
            json!({ "project": file, "clip": clip, "truth": truth, "tracks": n_tracks, "groups": n_groups });
        return Ok(Outcome::Answer(Answer { json, text, done: true }));
    }
    show(Plan::new("shrub.honami", move |_tell| Ok(session))).map(Outcome::Exit)
}
