//! `synth` and `demo`: clips with known truth, and the whole job on one of them.

use std::f64::consts::TAU;
use std::fs;
use std::io::IsTerminal as _;
use std::path::Path;

use anyhow::Context as _;
use honami_model::brief::counted;
use honami_workbench::generate::{self, Generated, Staged};
use honami_workbench::media;
use honami_workbench::plant::mover::Mover;
use honami_workbench::plant::sway::Motion;
use honami_workbench::plant::told::{self, Chosen};
use honami_workbench::plant::weather;
use honami_workbench::plant::{self, Wish, film};
use honami_workbench::plugins::{Kind, quoted};
use honami_workbench::progress::{Flow, Progress};
use honami_workbench::session::Session;
use honami_workbench::synth::{Carried, Level, Settings};
use honami_workbench::track::PointSource;
use serde_json::json;

use super::args::cameras::TargetKind;
use super::args::{Common, Demo, Synth, Wind};
use super::{Answer, Outcome, groups, options, project, report, show, simulate, told_options, track};
use crate::app::Plan;
use crate::app::opening::Tell;

/// Renders a clip and its truth.
pub(super) fn synth(args: &Synth, common: &Common) -> anyhow::Result<Answer> {
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
    if let Some(target) = args.target {
        return stage(target, &settings, &args.out, common);
    }
    if let Some(source) = &args.plant {
        return film(args, source, &settings, common);
    }
    Ok(describe(&generate::generate(&settings, &args.out, &report::Bar::new())?))
}

/// Films a plant as a simulator moves it.
fn film(args: &Synth, source: &str, settings: &Settings, common: &Common) -> anyhow::Result<Answer> {
    let n_modes = args.modes.map(|modes| modes as usize);
    let wish = Wish { classes: args.classes.clone(), unit: args.unit, ..Wish::of(source, n_modes) };
    let (weather, pull) = match (args.pull, args.wind) {
        (Some(pull), _) => ("still".to_owned(), pull),
        (None, Wind::Calm) => (format!("calm:seed={}", args.seed), 0.0),
        (None, Wind::Wind) => (format!("wind:seed={}", args.seed), 0.0),
        (None, Wind::Storm) => (format!("storm:seed={}", args.seed), 0.0),
    };
    let motion = Motion { n_frames: args.frames, fps: args.fps, pull, ..Motion::default() };
    let options = told_options(common);
    let registry = options.registry();
    let plugin = registry.find(Kind::Simulator, args.with.as_deref().unwrap_or(simulate::DEFAULT))?;
    let typed = [(n_modes.is_some(), "modes"), (args.pull.is_some(), "pull")];
    let typed: Vec<String> =
        typed.into_iter().filter(|(is, _)| *is).map(|(_, name)| name.to_owned()).collect();
    let told = told::told(&wish, &motion, plugin, Chosen::Only(&typed), &args.set)?;
    let bar = report::Bar::new();
    let plant = plant::vibrate(&told.wish, &bar)?;
    let wind = weather::read(&weather)?.over(&weather::ground(&plant, &told.motion))?;
    let mover = Mover { host: &options.host, plugin, values: &told.values };
    let film = film::film(&plant, &mover, &*wind, &told.motion, &bar)?;
    let mut answer = describe(&generate::film(settings, &film.filmed, &args.out, &bar)?);
    let damping = told.motion.damping;
    let omega = plant.modes.omegas[0] / damping.mass.sqrt();
    let (hz, ratio) = (omega / TAU, (damping.alpha + damping.beta * omega.powi(2)) / (2.0 * omega));
    answer.text += &format!("\nslowest mode: {hz:.4} Hz, damping {:.2} %", 100.0 * ratio);
    if args.pull.is_none() && damping.air > 0.0 {
        answer.text += " and what the wind adds; --set air_damping=0 leaves that out";
    }
    let warnings = [told.notes, film.warnings].concat();
    answer.text = report::with_warnings(&answer.text, &warnings);
    answer.json["plant"] = json!({
        "source": source,
        "hz": hz,
        "damping": ratio,
        "air_damping": damping.air,
        "simulator": plugin.id,
        "notes": plant.notes,
        "warnings": warnings,
    });
    Ok(answer)
}

/// Films a target by two cameras.
fn stage(target: TargetKind, settings: &Settings, out: &Path, common: &Common) -> anyhow::Result<Answer> {
    let carried = match target {
        TargetKind::Board => Carried::Board,
        TargetKind::Bars => Carried::Bars,
    };
    let made = generate::stage(carried, settings, out, &report::Bar::with(common))?;
    let Staged { files, n_points, baseline_m } = &made;
    let names: Vec<String> = files.iter().map(|path| path.display().to_string()).collect();
    let text = format!(
        "{n_points} points before two cameras that stand {baseline_m:.3} m apart: {}",
        names.join(", ")
    );
    let json = json!({ "files": names, "points": n_points, "baseline_m": baseline_m });
    Ok(Answer { json, text, done: true })
}

fn describe(made: &Generated) -> Answer {
    let text = format!(
        "{}: {} on {}, moving {:.2} px per frame\ntruth: {}",
        made.clip.display(),
        counted(made.n_leaves, "leaf"),
        counted(made.n_branches, "branch"),
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

/// Who is told of the steps of the demo, and watches each.
struct Watch<'a> {
    say: &'a dyn Fn(&str),
    progress: &'a dyn Fn() -> Box<dyn Progress + 'a>,
}

/// Tells how far a job is as opening does.
struct Told<'a>(&'a Tell<'a>);

impl Progress for Told<'_> {
    fn report(&self, done: u64, total: u64, what: &str) -> Flow {
        let of = if total > 0 { format!(" of {total}") } else { String::new() };
        (self.0)(format!("the demo: {what} {done}{of}"));
        Flow::Continue
    }
}

/// The whole job on a generated clip, with its truth beside it; then the terminal UI.
pub(super) fn demo(args: &Demo, common: &Common) -> anyhow::Result<Outcome> {
    let watch = Watch { say: &report::say, progress: &|| Box::new(report::Bar::new()) };
    let session = make(&args.folder, common, &watch)?;
    let (clip, file) = (args.folder.join(CLIP), session.project.path());
    let truth = generate::truth_beside(&clip);
    let text = format!(
        "{} is ready: open it with `honami {}`\nhow good was it: honami compare {} --truth {} --with anchored --with klt",
        file.display(),
        quoted(file),
        quoted(&clip),
        quoted(&truth)
    );
    if args.headless || common.json || !std::io::stdout().is_terminal() {
        let n_tracks = session.project.document().tracks().count();
        let n_groups = session.project.grouping()?.map_or(0, |grouping| grouping.nodes.len());
        let json =
            json!({ "project": file, "clip": clip, "truth": truth, "tracks": n_tracks, "groups": n_groups });
        return Ok(Outcome::Answer(Answer { json, text, done: true }));
    }
    show(Some(Plan::new("shrub.honami", move |_tell| Ok(session))), common).map(Outcome::Exit)
}

/// The same, to be made while the screen says how far it is.
pub(super) fn plan(folder: &Path, common: &Common) -> Plan {
    let (folder, common) = (folder.to_owned(), common.clone());
    Plan::new("demo", move |tell| {
        make(&folder, &common, &Watch { say: &|_| {}, progress: &|| Box::new(Told(tell)) })
    })
}

/// The tutorial: a fresh project, tracked and not grouped, on a clip that is made once and kept with the caches.
pub(super) fn lesson(common: &Common) -> Plan {
    let common = common.clone();
    Plan::new("tutorial", move |tell| {
        let caches = media::cache_folder().unwrap_or_else(|| std::env::temp_dir().join("honami"));
        let folder = caches.join("tutorial");
        let watch = Watch { say: &|_| {}, progress: &|| Box::new(Told(tell)) };
        // Closed before it is copied: what it holds is then in its file.
        drop(tracked(&folder, &common, &watch)?);
        let (kept, fresh) = (folder.join(CLIP).with_extension("honami"), folder.join("tutorial.honami"));
        // Of another session that is at it, only its name goes.
        if fresh.exists() {
            fs::remove_file(&fresh).with_context(|| format!("cannot replace {}", fresh.display()))?;
        }
        fs::copy(&kept, &fresh).with_context(|| format!("cannot write {}", fresh.display()))?;
        Ok(Session::open(&fresh, &options(&common))?)
    })
    .with_lesson()
}

/// Name of the demo's clip.
const CLIP: &str = "shrub.y4m";

/// Makes what is not there yet of the demo: the clip, its project, tracks, groups.
fn make(folder: &Path, common: &Common, watch: &Watch<'_>) -> anyhow::Result<Session> {
    let mut session = tracked(folder, common, watch)?;
    if session.project.document().clustering().is_none() {
        (watch.say)("clustering …");
        let outcome = groups::run(&mut session, &groups::request(), &*(watch.progress)())?;
        (watch.say)(&outcome.line);
    }
    Ok(session)
}

/// The demo without its groups.
fn tracked(folder: &Path, common: &Common, watch: &Watch<'_>) -> anyhow::Result<Session> {
    let Watch { say, progress } = watch;
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let (clip, file) = (folder.join(CLIP), folder.join(CLIP).with_extension("honami"));
    if !clip.exists() {
        say("rendering a shrub in a light wind, with its truth …");
        generate::generate(&Settings::default(), &clip, &*progress())?;
    }
    let mut session = if file.exists() {
        Session::open(&file, &options(common))?
    } else {
        project::make(&file, &clip, None, common)?
    };
    if session.project.document().runs().is_empty() {
        say("tracking …");
        let request = track::request(&session, PointSource::Detect);
        let outcome = track::run(&mut session, &request, &*progress())?;
        say(&outcome.line);
    }
    Ok(session)
}
