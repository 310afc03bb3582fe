//! The command line: one file a command, each giving an answer for people and for machines.

mod args;
mod compare;
mod edit;
mod groups;
mod help;
mod log;
mod project;
mod report;
mod spectrum;
mod synth;
mod track;

use std::path::Path;
use std::process::ExitCode;

use clap::Parser as _;
use honami_workbench::session::{Session, SessionOptions};
use honami_workbench::store::{Access, Project};

use self::args::{Cli, Command, Common};

/// What a command has to say, in two forms.
struct Answer {
    /// For machines: `--json`.
    json: serde_json::Value,
    /// For people; without a final line break.
    text: String,
}

/// Runs the command line of this process.
#[must_use]
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => error.exit(),
    };
    let result = match cli.command {
        Some(command) => run(command, &cli.common),
        None => open(cli.project.as_deref(), &cli.common).map(|()| None),
    };
    match result.and_then(|answer| answer.map_or(Ok(()), |answer| answer.print(cli.common.json))) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            report::complain(&error);
            ExitCode::FAILURE
        }
    }
}

impl Answer {
    /// Prints the form that was asked for.
    fn print(&self, json: bool) -> anyhow::Result<()> {
        use std::io::Write as _;
        let mut out = std::io::stdout().lock();
        if json {
            serde_json::to_writer_pretty(&mut out, &self.json)?;
            writeln!(out)?;
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

fn run(command: Command, common: &Common) -> anyhow::Result<Option<Answer>> {
    let answer = match command {
        Command::New(args) => project::new(&args, common)?,
        Command::Track(args) => track::track(&args, common)?,
        Command::Cluster(args) => groups::cluster(&args, common)?,
        Command::Edit(args) => return edit::edit(&args.project, common).map(|()| None),
        Command::Compare(args) => compare::compare(&args, common)?,
        Command::Spectrum(args) => spectrum::spectrum(&args)?,
        Command::Export(args) => project::export(&args)?,
        Command::Synth(args) => synth::synth(&args)?,
        Command::Demo(args) => return synth::demo(&args, common),
        Command::Plugin(args) => help::plugin(&args, common)?,
        Command::Log(args) => log::log(&args)?,
        Command::Doctor => help::doctor(common),
        Command::Completions { shell } => help::completions(shell),
        Command::Man { folder } => help::manual(&folder)?,
    };
    Ok(Some(answer))
}

/// Opens the terminal UI on a project, or on a new project made from a clip.
fn open(path: Option<&Path>, common: &Common) -> anyhow::Result<()> {
    let Some(path) = path else {
        anyhow::bail!("a project or a clip is wanted: `honami CLIP` opens a clip, `honami demo` makes one");
    };
    let is_project = path.extension().is_some_and(|e| e == "honami");
    let project = if is_project { path.to_owned() } else { project::name_for(path) };
    let session = if is_project || project.exists() {
        Session::open_or_look(&project, &options(common))?
    } else {
        project::make(&project, path, None, common)?
    };
    crate::app::run(session)
}

fn options(common: &Common) -> SessionOptions {
    SessionOptions { plugin_paths: common.plugins.clone(), read_only: false }
}

/// Opens a project for a command that writes to it.
fn session(path: &Path, common: &Common) -> anyhow::Result<Session> {
    there(path)?;
    let session = Session::open(path, &options(common))?;
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
    let shown = path.display();
    anyhow::ensure!(path.exists(), "there is no project {shown}: make it with `honami new {shown} CLIP`");
    Ok(())
}
