//! Recipes: what is done to every clip, in lines of the command line.

pub(super) mod alone;
pub(super) mod crew;
pub(super) mod many;
mod memory;
pub(super) mod plan;
mod rerun;
mod save;
pub(super) mod told;

use std::path::{Component, Path, PathBuf};

use anyhow::Context as _;
use clap::Parser as _;
use honami_workbench::plugins::Registry;
use serde::Deserialize;

use super::args::{Cli, Command};
use super::{Usage, want};

pub(super) use rerun::rerun;
pub(super) use save::save;

/// What may be a step: it works on a project, or writes what it has found.
const COMMANDS: [&str; 9] =
    ["track", "cluster", "components", "grow", "simulate", "spectrum", "compare", "export", "matte"];

/// Options that name a file to be read: where `{recipe}`, the folder of the recipe, may stand.
const INPUTS: [&str; 12] = [
    "--points",
    "--mask",
    "--truth",
    "--tracks",
    "--sensors",
    "--wind",
    "--scribbles",
    "--trimap",
    "--envelope",
    "--onto",
    "--branches",
    "--set",
];

/// A recipe as it is written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    fps: Option<f64>,
    steps: Vec<String>,
}

/// What is done to every clip.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Recipe {
    /// True frame rate of the clips, where it is not their own.
    pub(super) fps: Option<f64>,
    /// The steps, in their order.
    pub(super) steps: Vec<Line>,
}

/// A step: a line of the command line without `honami` and without the project.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Line {
    /// As it is written.
    pub(super) text: String,
    words: Vec<String>,
    /// Folder of the recipe.
    folder: PathBuf,
}

impl Recipe {
    /// Reads a recipe, and checks every line as the command line would.
    pub(super) fn read(path: &Path) -> anyhow::Result<Self> {
        let shown = path.display();
        let text =
            std::fs::read_to_string(path).with_context(|| format!("cannot read the recipe {shown}"))?;
        let wrong = |why: &dyn std::fmt::Display| Usage(format!("{shown}: {why}"));
        let written: Written = toml::from_str(&text).map_err(|error| wrong(&error.to_string().trim_end()))?;
        want(written.fps.is_none_or(|fps| fps.is_finite() && fps > 0.0), || {
            format!("{shown}: fps wants frames per second, a number above 0")
        })?;
        want(!written.steps.is_empty(), || {
            format!("{shown}: a recipe has steps: steps = [\"track\", \"cluster\"]")
        })?;
        let parent = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = parent.canonicalize().with_context(|| format!("cannot find the folder of {shown}"))?;
        let mut steps = Vec::with_capacity(written.steps.len());
        for (number, text) in (1..).zip(written.steps) {
            let line = Line::read(&text, &folder);
            steps.push(line.map_err(|why| wrong(&format!("step {number}, {text:?}: {why}")))?);
        }
        Ok(Self { fps: written.fps, steps })
    }

    /// Looks for the plugins of all steps.
    ///
    /// # Errors
    /// When one is not there.
    pub(super) fn find_plugins(&self, registry: &Registry) -> anyhow::Result<()> {
        for line in &self.steps {
            let cli = line.command(Path::new("clip.honami"), "clip")?;
            for (kind, name) in cli.command.iter().flat_map(plugins) {
                registry.find(kind, &name)?;
            }
        }
        Ok(())
    }
}

impl Line {
    fn read(text: &str, folder: &Path) -> Result<Self, String> {
        if text.contains(char::is_control) {
            return Err("a line of printed letters is wanted, without control characters".to_owned());
        }
        let words = shlex::split(text).ok_or("a quotation mark without its other")?;
        let command = words.first().ok_or("a step is a command and its options")?;
        if !COMMANDS.contains(&command.as_str()) {
            return Err(format!("{command} is no step; steps are {}", COMMANDS.join(", ")));
        }
        if let Some(word) = ["--resume", "--watch"].into_iter().find(|word| words.iter().any(|w| w == word)) {
            return Err(format!("{word} is for who is there: a recipe goes on by itself"));
        }
        let line = Self { text: text.trim().to_owned(), words, folder: folder.to_owned() };
        line.words.iter().enumerate().skip(1).try_for_each(|(k, word)| line.stays_inside(k, word))?;
        line.command(Path::new("clip.honami"), "clip").map_err(|error| first_line(&error))?;
        Ok(line)
    }

    /// Refuses what would read or write elsewhere than beside the project or, to read, beside the recipe.
    fn stays_inside(&self, k: usize, word: &str) -> Result<(), String> {
        let (option, value) = match word.split_once('=') {
            Some((option, value)) if option.starts_with("--") => (option, value),
            _ => (self.words[k - 1].as_str(), word),
        };
        if value.contains("{recipe}") && !INPUTS.contains(&option) {
            return Err(format!(
                "{word}: {{recipe}} is where files are read from, with one of {}; what is written goes beside the project",
                INPUTS.join(", ")
            ));
        }
        // Of `--set model={recipe}/net.onnx` and `--wind w.csv+vortex:strength=3` every part may be a path, and so may the whole.
        let leaves = |part: Component<'_>| !matches!(part, Component::Normal(_) | Component::CurDir);
        let is_outside = |value: &str| {
            let path = Path::new(value.strip_prefix("{recipe}/").unwrap_or(value));
            path.components().any(leaves)
        };
        if is_outside(value) || value.split(['=', '+']).any(is_outside) {
            return Err(format!(
                "{word}: paths of a recipe do not leave the folder of the clip; {{recipe}}/FILE is one beside the recipe"
            ));
        }
        Ok(())
    }

    /// The command for a project, as if it had been typed.
    pub(super) fn command(&self, project: &Path, name: &str) -> Result<Cli, clap::Error> {
        let folder = self.folder.to_string_lossy();
        let filled = self.words.iter().map(|word| word.replace("{clip}", name).replace("{recipe}", &folder));
        let mut words: Vec<std::ffi::OsString> = vec!["honami".into()];
        words.extend(filled.map(Into::into));
        words.insert(2, project.into());
        Cli::try_parse_from(words)
    }

    /// Files beside the recipe that it reads.
    pub(super) fn inputs(&self, name: &str) -> Vec<PathBuf> {
        let named = self.words.iter().filter_map(|word| word.split_once("{recipe}/"));
        named.map(|(_, file)| self.folder.join(file.replace("{clip}", name))).collect()
    }
}

/// What clap says first, without its own heading.
fn first_line(error: &clap::Error) -> String {
    let text = error.to_string();
    let lines = text.lines().take_while(|line| !line.trim().is_empty()).map(str::trim);
    let told = lines.collect::<Vec<_>>().join(" ");
    told.trim_start_matches("error: ").to_owned()
}

/// The plugins that a command works with: of which kind, and by which name.
pub(super) fn plugins(command: &Command) -> Vec<(honami_workbench::plugins::Kind, String)> {
    use honami_workbench::plugins::Kind;
    let named = |name: Option<&String>, default: &str| name.map_or_else(|| default.to_owned(), Clone::clone);
    match command {
        Command::Track(args) => {
            let detect = args.detect.as_ref().filter(|name| !name.is_empty());
            vec![(Kind::Tracker, named(args.plugin.with.as_ref().or(detect), super::track::DEFAULT))]
        }
        Command::Cluster(args) => {
            vec![(Kind::Clusterer, named(args.plugin.with.as_ref(), super::groups::DEFAULT))]
        }
        Command::Grow(args) => {
            vec![(Kind::Structure, named(args.plugin.with.as_ref(), super::grow::DEFAULT))]
        }
        Command::Simulate(args) => {
            vec![(Kind::Simulator, named(args.plugin.with.as_ref(), super::simulate::DEFAULT))]
        }
        Command::Compare(args) if args.with.is_empty() => {
            vec![(Kind::Tracker, super::track::DEFAULT.to_owned())]
        }
        Command::Compare(args) => args.with.iter().map(|name| (Kind::Tracker, name.clone())).collect(),
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests;
