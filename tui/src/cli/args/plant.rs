//! What may be typed of plants in the wind.

use std::path::PathBuf;

use clap::parser::ValueSource;
use clap::{ArgMatches, Args, FromArgMatches, Subcommand, ValueEnum};
use honami_workbench::mechanics::Damping;
use honami_workbench::plant::sway::Motion;

use super::WithPlugin;

/// Modes of a plant, and how it moves in the wind.
#[derive(Args, Debug)]
#[command(after_help = honami_workbench::plant::weather::help())]
pub(in crate::cli) struct Simulate {
    // The first, since the others take what they read out of the matches.
    #[command(flatten)]
    pub(in crate::cli) typed: Typed,
    #[command(flatten)]
    pub(in crate::cli) plant: Plant,
    #[command(flatten)]
    pub(in crate::cli) plugin: WithPlugin,
    /// What blows: a name with values, such as steady:speed=5,towards=90, or a table that an anemometer has recorded; or
    /// several with a + between them, wind+vortex:strength=300.
    #[arg(long, value_name = "WIND", default_value = "still")]
    pub(in crate::cli) wind: String,
    /// Begin with the slowest mode of every copy pulled out, metres: so far that the node which it moves most would go in a
    /// straight line (--bend linear). It bends there instead, and is less far from rest the farther it is pulled; a copy that
    /// is s times as large is pulled s times as far.
    #[arg(long, value_name = "M", default_value_t = 0.0, allow_negative_numbers = true)]
    pub(in crate::cli) pull: f64,
    /// How long.
    #[arg(long, value_name = "S", allow_negative_numbers = true, default_value_t = 20.0)]
    pub(in crate::cli) seconds: f64,
    /// Frames per second.
    #[arg(long, value_name = "F", allow_negative_numbers = true, default_value_t = 25.0)]
    pub(in crate::cli) fps: f64,
    /// Steps from frame to frame; what blows at the beginning of one blows till its end.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub(in crate::cli) substeps: u32,
    /// How modes go on in time.
    #[arg(long, value_enum, default_value_t = Method::Exact)]
    pub(in crate::cli) method: Method,
    /// How nodes follow the modes.
    #[arg(long, value_enum, default_value_t = Bend::Turn)]
    pub(in crate::cli) bend: Bend,
    #[command(flatten)]
    pub(in crate::cli) stand: Stand,
    /// Ends of branches of the first copy that are followed, all over it, the highest first.
    #[arg(long, value_name = "N", default_value_t = 12)]
    pub(in crate::cli) sensors: u32,
    /// Follow this node instead, by its number in what --beams writes; give it once for each.
    #[arg(long = "sensor", value_name = "NODE", conflicts_with = "sensors")]
    pub(in crate::cli) nodes: Vec<u32>,
    /// Write where they are, metres from the foot of the plant, z up: sensor,node,frame,time_s,x,y,z. --beams has nodes where
    /// the file has them: the row of node 0 apart.
    #[arg(long, value_name = "FILE.csv")]
    pub(in crate::cli) out: Option<PathBuf>,
    /// Write where all nodes of all copies are in every frame, as a point cache (PC2).
    #[arg(long, value_name = "FILE.pc2")]
    pub(in crate::cli) cache: Option<PathBuf>,
    /// Write the plant with its motion, and all copies, for viewers, engines and modellers (glTF 2.0): as sums of few
    /// shapes, in every frame within a thousandth of the plant's height.
    #[arg(long, value_name = "FILE.glb")]
    pub(in crate::cli) glb: Option<PathBuf>,
    /// Write the beams that the plant was made into, metres: node,parent,x,y,z,radius.
    #[arg(long, value_name = "FILE.csv")]
    pub(in crate::cli) beams: Option<PathBuf>,
    /// Threads (default: as many as there are cores).
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(in crate::cli) threads: Option<usize>,
}

/// How a plant is damped and how heavy it is, and copies of it.
#[derive(Args, Debug)]
pub(in crate::cli) struct Stand {
    /// Damping by mass, per second.
    #[arg(long, value_name = "X", allow_negative_numbers = true, default_value_t = 0.3)]
    alpha: f64,
    /// Damping by stiffness, seconds.
    #[arg(long, value_name = "X", allow_negative_numbers = true, default_value_t = 0.008)]
    beta: f64,
    /// Damping by the air, which grows with the wind: so many times what the drag of branches and leaves gives; 0: none.
    #[arg(long, value_name = "X", allow_negative_numbers = true, default_value_t = 1.0)]
    air_damping: f64,
    /// So many times as heavy as its wood.
    #[arg(long, value_name = "X", allow_negative_numbers = true, default_value_t = 1.0)]
    heavier: f64,
    /// A forest of so many copies, each at its place in the wind.
    #[arg(long, value_name = "K", allow_negative_numbers = true, value_parser = copies)]
    pub(in crate::cli) forest: Option<u32>,
    /// Copies are up to 1 + X times as large or as small as the plant; the first is as it was measured.
    #[arg(long, value_name = "X", allow_negative_numbers = true, default_value_t = 0.0, requires = "forest")]
    size_spread: f64,
    /// Copies are up to 1 + X times as heavy or as light as one of their size.
    #[arg(long, value_name = "X", allow_negative_numbers = true, default_value_t = 0.0, requires = "forest")]
    mass_spread: f64,
    /// How far copies stand apart, metres (default: 0.8 times the height of the plant); each is up to a quarter of it off.
    #[arg(long, value_name = "M", allow_negative_numbers = true, requires = "forest")]
    spacing: Option<f64>,
    /// Of where copies stand, how they are turned, and their sizes and masses.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
}

impl Stand {
    /// What moves so.
    pub(in crate::cli) fn motion(&self) -> Motion {
        Motion {
            n_copies: self.forest.unwrap_or(1) as usize,
            damping: Damping {
                alpha: self.alpha,
                beta: self.beta,
                mass: self.heavier,
                air: self.air_damping,
            },
            size_spread: self.size_spread,
            mass_spread: self.mass_spread,
            spacing: self.spacing,
            seed: self.seed,
            ..Motion::default()
        }
    }
}

/// Which options were typed, though it be what they are anyhow, by the names of their fields.
#[derive(Debug, Default)]
pub(in crate::cli) struct Typed(pub(in crate::cli) Vec<String>);

impl FromArgMatches for Typed {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let is_typed = |id: &&str| matches.value_source(id) == Some(ValueSource::CommandLine);
        let ids = matches.ids().map(clap::Id::as_str);
        Ok(Self(ids.filter(is_typed).map(str::to_owned).collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for Typed {
    fn augment_args(command: clap::Command) -> clap::Command {
        command
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        command
    }
}

/// A plant, and what it is made of.
#[derive(Args, Debug)]
pub(in crate::cli) struct Plant {
    /// A digitised plant (.mtg), a skeleton (.swc), a tree of cylinders (.csv, or .mat of MATLAB), the skeleton of a project
    /// (.honami), as `grow` makes it, or synth::tree:NODES,SEED, a tree to calculate with.
    #[arg(value_name = "PLANT")]
    pub(in crate::cli) source: String,
    /// How many modes, the slowest first (default: 25, or as many as a small plant has).
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(u32).range(1..=5000))]
    pub(in crate::cli) modes: Option<u32>,
    /// Of a multiscale tree graph: only parts of these classes, such as S.
    #[arg(long, value_name = "C,…", value_delimiter = ',')]
    pub(in crate::cli) classes: Vec<String>,
    /// Metres of the unit of length of a .mtg or .swc file, which do not say (default: of .mtg a centimetre, of .swc a
    /// metre), or of a pixel of a project.
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub(in crate::cli) unit: Option<f64>,
    /// Of a multiscale tree graph: so many units of diameter are one of length (default: 10).
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(in crate::cli) diameters: Option<f64>,
    /// How thick a segment is between two nodes.
    #[arg(long, value_enum, default_value_t = Radius::Mean)]
    pub(in crate::cli) radius: Radius,
    /// Divide segments longer than this, metres.
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub(in crate::cli) longest: Option<f64>,
    /// Young's modulus of the wood, pascals.
    #[arg(long, value_name = "PA", allow_negative_numbers = true, default_value_t = 1e10)]
    pub(in crate::cli) young: f64,
    /// Poisson's ratio of the wood.
    #[arg(long, value_name = "X", allow_negative_numbers = true, default_value_t = 0.3)]
    pub(in crate::cli) poisson: f64,
    /// Density of the wood, kilograms per cubic metre.
    #[arg(long, value_name = "X", allow_negative_numbers = true, default_value_t = 1000.0)]
    pub(in crate::cli) density: f64,
    /// What all leaves weigh, kilograms, shared by the ends of branches.
    #[arg(long, value_name = "KG", allow_negative_numbers = true, default_value_t = 0.0)]
    pub(in crate::cli) leaf_mass: f64,
    /// Area of all leaves times their drag coefficient, square metres, shared alike.
    #[arg(long, value_name = "M2", allow_negative_numbers = true, default_value_t = 0.0)]
    pub(in crate::cli) leaf_drag: f64,
    /// Drag coefficient of branches: 1 to 1.2 for cylinders across a wind (Hoerner 1965); bundles of twigs have less.
    #[arg(long, value_name = "X", allow_negative_numbers = true, default_value_t = 1.0)]
    pub(in crate::cli) drag: f64,
    /// Density of the air, kilograms per cubic metre: 1.2 at 20 degrees and sea level, 1.29 at 0.
    #[arg(long, value_name = "X", allow_negative_numbers = true, default_value_t = 1.2)]
    pub(in crate::cli) air_density: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum Radius {
    /// The mean of both ends, the base at most 1.5 times the tip.
    Mean,
    /// That of its tip.
    Tip,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum Method {
    /// Exact for a force that stays, stable in steps of any length.
    Exact,
    /// Symplectic Euler, as in the thesis, up to its limit.
    Symplectic,
    /// Newmark's.
    Newmark,
    /// By the spectrum of the wind, not step by step: motion that begins again after --seconds without a jump.
    Spectrum,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum Bend {
    /// Segments turn by all modes together: branches keep their length.
    Turn,
    /// Straight lines: branches grow longer.
    Linear,
    /// One arc tangent a mode and its square: lengths are kept where one mode acts.
    S2,
    /// And its cube.
    S3,
}

#[derive(Debug, Subcommand)]
pub(in crate::cli) enum Bench {
    /// Forests of generated trees, cell by cell of the thesis's tables 6.1 and 6.2: frames per second of its graphics card,
    /// and of this machine with nodes on straight lines and so that branches keep their length.
    Forest(BenchForest),
    /// How long branches stay, and how far nodes are off, by each way in which nodes can follow the modes of a plant.
    Bending(BenchBending),
}

#[derive(Args, Debug)]
pub(in crate::cli) struct BenchBending {
    #[command(flatten)]
    pub(in crate::cli) plant: Plant,
}

#[derive(Args, Debug)]
pub(in crate::cli) struct BenchForest {
    /// Runs of which the median counts.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(in crate::cli) runs: u32,
    /// How long a run lasts, or two frames.
    #[arg(long, value_name = "S", default_value_t = 0.3)]
    pub(in crate::cli) seconds: f64,
    /// Threads (default: as many as there are cores).
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(in crate::cli) threads: Option<usize>,
    /// Only cells of so many copies, nodes and modes, such as 1000x1000x25; give it once for each.
    #[arg(long = "cell", value_name = "KxNxM")]
    pub(in crate::cli) cells: Vec<Cell>,
    /// These cells also with less of what is farther away and nothing of what is out of view.
    #[arg(long, requires = "cells")]
    pub(in crate::cli) in_view: bool,
}

/// `KxNxM`: copies, nodes, modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::cli) struct Cell(pub(in crate::cli) [usize; 3]);

impl std::str::FromStr for Cell {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Vec<usize> = text.split('x').filter_map(|word| word.parse().ok()).collect();
        match numbers[..] {
            [k, n, m] if k > 0 && n > 1 && m > 0 && text.matches('x').count() == 2 => Ok(Self([k, n, m])),
            _ => {
                Err(format!("wanted copies, nodes and modes as KxNxM, for instance 1000x1000x25, got {text}"))
            }
        }
    }
}

/// Copies of a forest.
pub(in crate::cli) fn copies(text: &str) -> Result<u32, String> {
    let copies = text.parse().ok().filter(|n| (1..=10_000_000).contains(n));
    copies.ok_or_else(|| format!("wanted 1 to 10000000 copies, got {text}"))
}

/// Threads of work that all of them share.
fn threads(text: &str) -> Result<usize, String> {
    let threads = text.parse().ok().filter(|n| (1..=1024).contains(n));
    threads.ok_or_else(|| format!("wanted 1 to 1024 threads, got {text}"))
}
