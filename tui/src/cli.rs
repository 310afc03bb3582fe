//! The command line: one file a command, each giving an answer for people and for machines.

mod args;
mod begin;
mod bench;
mod calibrate;
mod canvas;
mod check;
mod compare;
mod components;
mod edit;
mod ends;
mod exchange;
mod groups;
mod grow;
mod help;
mod keys;
mod log;
mod matte;
mod movie;
mod project;
mod recipe;
mod replay;
mod report;
mod review;
mod scale;
mod shape;
mod simulate;
mod slurm;
mod spectrum;
mod sync;
mod synth;
mod track;
mod triangulate;
mod view;
mod watch;

use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{CommandFactory as _, Parser as _};
use honami_workbench::WorkbenchError;
use honami_workbench::plant::weather::WeatherError;
use honami_workbench::plugins::{HostError, ValueError, file_of, quoted};
use honami_workbench::session::{Session, SessionOptions};
use honami_workbench::store::{Access, Project};

use self::args::{Cli, Command, Common};
use crate::app::config::Config;
use crate::app::opening::where_is_the_clip;
use crate::app::{Gives, Offer, Offers, Plan};

/// What a command has to say, in two forms.
struct Answer {
    /// For machines: `--json`.
    json: serde_json::Value,
    /// For people; without a final line break.
    text: String,
    /// Whether all was done that was asked for.
    done: bool,
}

/// What a command has come to.
enum Outcome {
    /// It has something to say.
    Answer(Answer),
    /// It has said it all, or ended like this.
    Exit(ExitCode),
}

/// The command line was wrong in a way that its grammar does not catch.
#[derive(Debug)]
struct Usage(String);

impl std::fmt::Display for Usage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Usage {}

/// Fails as wrong usage unless the condition holds.
fn want(condition: bool, otherwise: impl FnOnce() -> String) -> Result<(), Usage> {
    if condition { Ok(()) } else { Err(Usage(otherwise())) }
}

/// Runs the command line of this process.
#[must_use]
pub fn main() -> ExitCode {
    let status = answer();
    honami_workbench::plugins::ended_well();
    status
}

fn answer() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => unknown_command(&error).unwrap_or(error).exit(),
    };
    let result =
        named_there(&cli.common).map_err(Into::into).and_then(|()| match (cli.command, cli.project) {
            (Some(_), Some(project)) => {
                Err(Usage(format!("{} stands before a command", project.display())).into())
            }
            (Some(command), None) => run(command, &cli.common),
            (None, project) => open(project.as_deref(), cli.log, &cli.common).map(Outcome::Exit),
        });
    let printed = result.and_then(|outcome| match outcome {
        Outcome::Answer(answer) => {
            let status = if answer.done { ExitCode::SUCCESS } else { ExitCode::FAILURE };
            answer.print(cli.common.json).map(|()| status)
        }
        Outcome::Exit(status) => Ok(status),
    });
    match printed {
        Ok(status) => status,
        Err(error) if broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            report::complain(&error);
            if is_usage(&error) { ExitCode::from(2) } else { ExitCode::FAILURE }
        }
    }
}

/// Whether what `--plugin` names is there: else another plugin of the same name might be taken for it.
fn named_there(common: &Common) -> Result<(), Usage> {
    let is_there = |path: &&PathBuf| path.exists() || file_of(path).exists();
    common.plugins.iter().find(|path| !is_there(path)).map_or(Ok(()), |path| {
        let wanted = "wanted a library, a plugin in Python or its manifest, or a folder of plugins";
        Err(Usage(format!("--plugin {}: there is no such file; {wanted}", path.display())))
    })
}

/// What to say of a first word that is neither a command nor a file: clap takes it for a project.
fn unknown_command(error: &clap::Error) -> Option<clap::Error> {
    let word = std::env::args().skip(1).find(|word| !word.starts_with('-'))?;
    let mut command = Cli::command();
    let is_command = command.get_subcommands().any(|known| known.get_name() == word);
    if error.kind() != ErrorKind::UnknownArgument || is_command || Path::new(&word).exists() {
        return None;
    }
    let alike = command.get_subcommands().map(clap::Command::get_name);
    let alike: Vec<&str> =
        alike.filter(|name| word.len() > 1 && name.starts_with(&word[..word.len().min(2)])).collect();
    let hint =
        if alike.is_empty() { String::new() } else { format!("; did you mean {}?", alike.join(" or ")) };
    let text = format!("there is no command and no file {word:?}{hint}");
    Some(command.error(ErrorKind::InvalidSubcommand, text))
}

/// Whether whoever typed the command asked for what there is not, rather than the work having failed.
fn is_usage(error: &anyhow::Error) -> bool {
    let by_plugin = |error: &HostError| {
        matches!(error, HostError::NotFound { .. } | HostError::Ambiguous { .. } | HostError::Value(_))
    };
    error.chain().any(|cause| {
        let wrapped = cause.downcast_ref::<WorkbenchError>();
        cause.is::<Usage>()
            || cause.is::<ValueError>()
            || cause.downcast_ref::<HostError>().is_some_and(by_plugin)
            || cause.downcast_ref::<WeatherError>().is_some_and(WeatherError::is_as_typed)
            || wrapped.is_some_and(|error| {
                error.is_as_typed() || matches!(error, WorkbenchError::Plugin(error) if by_plugin(error))
            })
    })
}

impl Answer {
    /// Prints the form that was asked for.
    fn print(&self, json: bool) -> anyhow::Result<()> {
        use std::io::Write as _;
        let mut out = std::io::stdout().lock();
        if json {
            writeln!(out, "{}", serde_json::to_string_pretty(&self.json)?)?;
        } else if !self.text.is_empty() {
            writeln!(out, "{}", self.text)?;
        }
        out.flush()?;
        Ok(())
    }
}

/// Whether the reader of a pipe has gone: `honami log P | head` is no failure.
fn broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        cause.downcast_ref::<std::io::Error>().is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
    })
}

fn run(command: Command, common: &Common) -> anyhow::Result<Outcome> {
    if let Err(error) = ends::heed() {
        report::say(&format!("signals cannot be caught here, Ctrl-C ends the program at once: {error}"));
    }
    let answer = match command {
        Command::New(args) => project::new(&args, common)?,
        Command::Relink(args) => project::relink(&args)?,
        Command::Track(args) if args.watch => return watch::watch(&args, common).map(Outcome::Exit),
        Command::Track(args) => track::track(&args, common)?,
        Command::Cluster(args) => groups::cluster(&args, common)?,
        Command::Grow(args) => grow::grow(&args, common)?,
        Command::Scale(args) => scale::scale(&args)?,
        Command::Shape(args) => shape::shape(&args)?,
        Command::View(args) => return view::view(&args, common),
        Command::Edit(args) => {
            return edit::edit(&args.project, common).map(|()| Outcome::Exit(ExitCode::SUCCESS));
        }
        Command::Compare(args) => compare::compare(&args, common)?,
        Command::Calibrate(args) => calibrate::calibrate(&args, common)?,
        Command::Components(args) => components::components(&args)?,
        Command::Matte(args) => matte::matte(&args, common)?,
        Command::Sync(args) => sync::sync(&args, common)?,
        Command::Triangulate(args) => triangulate::triangulate(&args, common)?,
        Command::Spectrum(args) => spectrum::spectrum(&args)?,
        Command::Simulate(args) => simulate::simulate(&args, common)?,
        Command::Export(args) => exchange::export(&args, common)?,
        Command::Import(args) => exchange::import(&args)?,
        Command::Synth(args) => synth::synth(&args, common)?,
        Command::Demo(args) => return synth::demo(&args, common),
        Command::Tutorial => return show(Some(synth::lesson(common)), common).map(Outcome::Exit),
        Command::Plugin(args) => return help::plugin(&args, common),
        Command::Run(args) if args.alone => return recipe::alone::follow(&args, common).map(Outcome::Exit),
        Command::Run(args) => recipe::many::run(&args, common)?,
        Command::Rerun(args) => recipe::rerun(&args.project, common)?,
        Command::Recipe(args::recipe::Recipe::Save { project, out }) => {
            recipe::save(&project, out.as_deref(), common)?
        }
        Command::Submit(args) => slurm::submit(&args, common)?,
        Command::Status(args) => slurm::status(&args)?,
        Command::Cancel(args) => slurm::cancel(&args)?,
        Command::Task(args) => slurm::task(&args)?,
        Command::Review(args) => review::review(&args, common)?,
        Command::Log(args) => log::log(&args)?,
        Command::Replay(args) => replay::replay(&args, common)?,
        Command::Keys(args) => keys::keys(&args),
        Command::Bench(args::plant::Bench::Forest(args)) => bench::forest(&args, common)?,
        Command::Bench(args::plant::Bench::Bending(args)) => bench::bending(&args)?,
        Command::Doctor => help::doctor(common),
        Command::Completions { shell } => help::completions(shell),
        Command::Man { folder } => help::manual(&folder)?,
    };
    Ok(Outcome::Answer(answer))
}

/// Opens the terminal UI on a project, or on a new project made from a clip; on neither, the start screen.
fn open(path: Option<&Path>, log: Option<PathBuf>, common: &Common) -> anyhow::Result<ExitCode> {
    let Some(path) = path else {
        want(std::io::stdout().is_terminal() && std::io::stdin().is_terminal() && !common.json, || {
            "a project or a clip is wanted: `honami CLIP` opens a clip, `honami demo` makes one".to_owned()
        })?;
        return show(None, common);
    };
    want(path != "plugins" || path.exists(), || "`honami plugin list` lists the plugins".to_owned())?;
    want(path.exists() || path.to_string_lossy().contains(['%', '*', '?']), || {
        format!(
            "there is no file {}: a project, a clip or a command is wanted; see honami --help",
            path.display()
        )
    })?;
    show(Some(Plan::of(path, &options(common)).logged(log)), common)
}

/// Shows a session in the terminal, or the start screen, until it ends; returns the status that says how.
fn show(plan: Option<Plan>, common: &Common) -> anyhow::Result<ExitCode> {
    ends::leave();
    let end = crate::app::run(plan, &offers(common))?;
    Ok(end.map_or(ExitCode::SUCCESS, |end| ExitCode::from(end.status())))
}

/// What the start screen offers besides files.
fn offers(common: &Common) -> Offers {
    let demo = |common: Common| move || synth::plan(Path::new(args::DEMO), &common);
    let lesson = |common: Common| move || synth::lesson(&common);
    let plugins = |common: Common| move || help::listed(&common);
    let doctor = |common: Common| move || help::doctor(&common).text;
    let offer = |name, doc, gives| Offer { name, doc, gives };
    let rows = vec![
        offer("demo", "a generated clip, tracked and grouped", Gives::Plan(Box::new(demo(common.clone())))),
        offer("tutorial", "five minutes: what to press", Gives::Plan(Box::new(lesson(common.clone())))),
        offer("plugins", "trackers and clusterers", Gives::Text(Box::new(plugins(common.clone())))),
        offer("doctor", "what this machine has", Gives::Text(Box::new(doctor(common.clone())))),
    ];
    let lesson = Box::new(lesson(common.clone()));
    Offers { options: options(common), rows, lesson, machine: help::machine }
}

fn options(common: &Common) -> SessionOptions {
    options_of(&Config::load(), common)
}

fn options_of(config: &Config, common: &Common) -> SessionOptions {
    let (plugin_paths, dev) = (common.plugins.clone(), common.dev.clone());
    SessionOptions { plugin_paths, dev, read_only: false, host: config.plugins.host() }
}

/// For a command that starts plugins: what became of them, and what is wrong with what was settled, is said, as the
/// terminal UI says it.
fn told_options(common: &Common) -> SessionOptions {
    told(&Config::load().beginning(), common)
}

/// As they are settled; what is wrong with that is said.
fn told(config: &Config, common: &Common) -> SessionOptions {
    let options = options_of(config, common);
    let too_short = config.plugins.too_short(|| options.registry());
    config.complaints().iter().chain(&too_short).for_each(|complaint| report::say(complaint));
    options
}

/// Opens a project for a command that writes to it.
fn session(path: &Path, common: &Common) -> anyhow::Result<Session> {
    there(path)?;
    let session =
        Session::open(path, &told_options(common)).map_err(|error| where_is_the_clip(error, path))?;
    session.notes.iter().for_each(|note| report::say(note));
    Ok(session)
}

/// Opens a project for a command that only looks, also while another session writes or the clip is away.
fn look(path: &Path) -> anyhow::Result<Project> {
    there(path)?;
    Ok(Project::open(path, Access::Read)?)
}

/// Refuses a project that is not there, and says how to make one.
fn there(path: &Path) -> anyhow::Result<()> {
    let (shown, typed) = (path.display(), quoted(path));
    anyhow::ensure!(path.exists(), "there is no project {shown}: make it with `honami new {typed} CLIP`");
    Ok(())
}
