//! Many clips by the cluster's own engine, Slurm.

use std::path::PathBuf;

use clap::Args;

#[derive(Args, Debug)]
pub(crate) struct Submit {
    /// Recipe (.toml), as for `honami run`; not to be changed until all is through.
    pub(crate) recipe: PathBuf,
    /// Clips: videos, image folders or patterns; NAME=CLIP where two would have the same name.
    #[arg(required = true, value_name = "CLIP")]
    pub(crate) clips: Vec<String>,
    /// Folder that gets a folder for each clip, on a file system that all nodes see.
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub(crate) into: PathBuf,
    /// Partition to submit to (default: the cluster's).
    #[arg(long, value_name = "NAME")]
    pub(crate) partition: Option<String>,
    /// Cores of a task.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) cpus: u16,
    /// Memory of a task, in words of Slurm (`2G`; default: by the size of the largest clip).
    #[arg(long, value_name = "SIZE")]
    pub(crate) mem: Option<String>,
    /// Clips of a task (default: so many short ones that a task is a minute of work, or so).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) per_task: Option<u16>,
    /// So many tasks at a time.
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) at_once: u16,
    /// One more option for sbatch, as often as wanted: `--sbatch=--time=2:00:00 --sbatch=--account=plants`.
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    pub(crate) sbatch: Vec<String>,
    /// Say what would be submitted, and submit nothing.
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// Track anew also where tracks were corrected by hand since; as for `honami run`.
    #[arg(long)]
    pub(crate) over_edits: bool,
}

#[derive(Args, Debug)]
pub(crate) struct Submitted {
    /// Folder that the clips were submitted into.
    #[arg(value_name = "DIR", default_value = ".")]
    pub(crate) into: PathBuf,
}

#[derive(Args, Debug)]
pub(crate) struct Task {
    /// Folder that the clips were submitted into.
    pub(crate) into: PathBuf,
    /// Which task, from 0.
    pub(crate) number: usize,
}
