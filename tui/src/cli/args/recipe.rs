//! Recipes: the same steps for many clips.

use std::path::PathBuf;

use clap::{Args, Subcommand};

#[derive(Args, Debug)]
pub(crate) struct Run {
    /// Recipe (.toml): `steps = ["track", "cluster", "export tracks tracks.csv"]`, in words of the command line, without the
    /// project; `fps = 120` where the clips' own rate is wrong.
    pub(crate) recipe: PathBuf,
    /// Clips: videos, image folders or patterns; NAME=CLIP where two would have the same name.
    #[arg(required = true, value_name = "CLIP")]
    pub(crate) clips: Vec<String>,
    /// Folder that gets a folder for each clip, with its project and what the steps write.
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub(crate) into: PathBuf,
    /// So many clips at a time, each with its share of the cores.
    #[arg(short, long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: u16,
    /// Say what would be done, and do nothing.
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// Track anew also where tracks were corrected by hand since; the project with the corrections is kept as
    /// NAME.before.honami.
    #[arg(long)]
    pub(crate) over_edits: bool,
    /// Follow the recipe with one clip in this process, and tell how it goes in JSON: how honami starts its own processes.
    #[arg(long, hide = true)]
    pub(crate) alone: bool,
    /// Wait so many seconds for another honami that is at work on a clip.
    #[arg(long, hide = true, default_value_t = 0)]
    pub(crate) patience: u64,
    /// Threads of each clip; `None`: its share of the cores.
    #[arg(skip)]
    pub(crate) threads: Option<usize>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Recipe {
    /// Write the recipe that a project was made by: of its steps, or of the tracks and groups that are shown.
    Save {
        /// Project file (.honami).
        project: PathBuf,
        /// Recipe to write (default: standard output).
        out: Option<PathBuf>,
    },
}
