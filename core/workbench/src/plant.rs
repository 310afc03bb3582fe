//! Plants: from whatever they were measured as to their vibration modes, and how they move in the wind.

pub mod bench;
mod circling;
pub mod film;
pub mod forms;
pub mod glb;
pub mod mover;
pub mod outs;
pub mod scene;
mod sizes;
pub mod spans;
pub mod sway;
#[cfg(test)]
mod tests;
pub mod told;
pub mod weather;

use std::fs;
use std::path::Path;
use std::time::Instant;

use honami_exchange::plant::{Measured, PlantFileError, mtg, qsm, swc};
use honami_exchange::skeleton::at_rest;
use honami_mechanics::{
    AIR, Beams, BeamsError, Drag, Leaves, MOST_NODES, Modes, ModesError, Options, WindBasis,
};
use honami_model::brief::{Brief, counted};
use honami_model::plant::RadiusRule;
use honami_store::{Access, Project};

use crate::error::WorkbenchError;
use crate::grow;
use crate::progress::{Flow, Progress};

/// Drag coefficients, and kilograms of a cubic metre of what blows: water has a thousand.
const MOST_DRAG: f64 = 1e4;
/// What makes a tree to calculate with, in place of a file: `synth::tree:NODES,SEED`.
const GENERATED: &str = "synth::tree:";

/// Modes, where nobody says how many.
pub const USUAL_MODES: usize = 25;

/// What is wanted of a plant.
#[derive(Clone, Debug, PartialEq)]
pub struct Wish {
    /// A file, or a project, or `synth::tree:NODES,SEED`.
    pub source: String,
    /// Metres of a unit of length, where a file does not say; `None`: as usual in files of its kind.
    pub unit: Option<f64>,
    /// Of a multiscale tree graph: so many units of diameter are one of length; `None`: as usual.
    pub diameters: Option<f64>,
    /// Of a multiscale tree graph: classes of parts that are wood; empty: all.
    pub classes: Vec<String>,
    /// How it becomes beams.
    pub beams: Options,
    /// What hangs on the ends of its branches.
    pub leaves: Leaves,
    /// Drag coefficient of branches.
    pub drag: f64,
    /// Density of the air, kilograms per cubic metre.
    pub air_density: f64,
    /// How many modes; `None`: [`USUAL_MODES`], or as many as a small plant has.
    pub n_modes: Option<usize>,
    /// Of the search for modes; they do not depend on it but for the last digits.
    pub seed: u64,
}

impl Wish {
    /// Of a plant, as it is, with so many modes.
    #[must_use]
    pub fn of(source: &str, n_modes: Option<usize>) -> Self {
        Self {
            source: source.to_owned(),
            unit: None,
            diameters: None,
            classes: Vec::new(),
            beams: Options::default(),
            leaves: Leaves::default(),
            drag: Drag::default().branches,
            air_density: AIR,
            n_modes,
            seed: 1,
        }
    }
}

impl Wish {
    /// Whether its wood, its leaves and the air about it can be.
    ///
    /// # Errors
    /// [`BeamsError::Material`], [`WorkbenchError::Leaves`], [`WorkbenchError::Drag`].
    pub fn check(&self) -> Result<(), WorkbenchError> {
        let (branches, density) = (self.drag, self.air_density);
        if ![branches, density].iter().all(|v| (0.0..=MOST_DRAG).contains(v)) {
            return Err(WorkbenchError::Drag { branches, density });
        }
        self.beams.material.check().map_err(BeamsError::from)?;
        Ok(self.leaves.check()?)
    }
}

/// A plant with its modes.
#[derive(Clone, Debug)]
pub struct Vibrating {
    /// Nodes that the plant was measured with.
    pub n_measured: usize,
    /// From the root to the highest node, metres.
    pub height: f64,
    /// What it bends as.
    pub beams: Beams,
    /// How it swings, slowest first: none below the last was missed.
    pub modes: Modes,
    /// What wind does to them.
    pub basis: WindBasis,
    /// What was merged, dropped or guessed, and what is rough; a sentence each.
    pub notes: Vec<String>,
    /// What finding the modes took.
    pub seconds: f64,
}

impl Vibrating {
    /// How large it is, metres: its height, or, of what hangs, how far it reaches from its root.
    #[must_use]
    pub fn size(&self) -> f64 {
        let root = self.beams.position(0);
        let reach = || (0..self.beams.len()).map(|node| (self.beams.position(node) - root).norm());
        if self.height > 0.0 { self.height } else { reach().fold(0.0, f64::max) }
    }
}

/// Reads a plant and finds its modes.
///
/// # Errors
/// What is wrong with the file or with numbers of the wish; [`WorkbenchError::Stopped`].
pub fn vibrate(wish: &Wish, progress: &dyn Progress) -> Result<Vibrating, WorkbenchError> {
    wish.check()?;
    let Measured { plant, mut notes } = read(wish)?;
    notes.extend(hint(&wish.source).and_then(|hint| sizes::odd(&plant, &wish.beams.material, hint)));
    let mut beams = Beams::new(&plant, &wish.beams)?;
    let mut note = |n: usize, one: &str, many: &str| {
        if n > 0 {
            notes.push(if n == 1 { format!("1 {one}") } else { format!("{n} {many}") });
        }
    };
    note(
        beams.n_merged(),
        "node lies where its parent lies: they are one",
        "nodes lie where their parents lie: they are one",
    );
    note(
        beams.n_stubby(),
        "segment is thicker than long, of which a beam is a rough model",
        "segments are thicker than long, of which beams are a rough model",
    );
    let drag = Drag { branches: wish.drag, density: wish.air_density, ..wish.leaves.hang(&mut beams)? };
    let n_modes = n_modes(wish.n_modes, &beams)?;
    room(beams.len(), n_modes, sway::free())?;
    let begun = Instant::now();
    let found = |n: usize| progress.report(n as u64, n_modes as u64, "modes") == Flow::Continue;
    let modes = Modes::watched(&beams, n_modes, wish.seed, &found);
    let modes = modes.map_err(|error| match error {
        ModesError::Stopped => WorkbenchError::Stopped,
        error => error.into(),
    })?;
    let seconds = begun.elapsed().as_secs_f64();
    let basis = WindBasis::new(&beams, &modes, &drag);
    let (n_measured, height) = (plant.nodes().len(), plant.height());
    Ok(Vibrating { n_measured, height, beams, modes, basis, notes, seconds })
}

/// As many as were asked for, or as are usual and there.
fn n_modes(asked: Option<usize>, beams: &Beams) -> Result<usize, WorkbenchError> {
    let most = Modes::most(beams.len());
    match asked {
        Some(asked) if asked > most => Err(WorkbenchError::TooManyModes { asked, most }),
        asked => Ok(asked.unwrap_or(USUAL_MODES.min(most))),
    }
}

/// Whether modes can be sought in so many bytes that are free.
fn room(nodes: usize, modes: usize, there: usize) -> Result<(), WorkbenchError> {
    let bytes = Modes::bytes(nodes, modes);
    if bytes > there { Err(WorkbenchError::ModesMemory { modes, nodes, bytes, there }) } else { Ok(()) }
}

/// Writes the beams of a plant as a table, for other programs.
///
/// # Errors
/// What the disk says; nothing is left behind then.
pub fn write_beams(plant: &Vibrating, path: &Path) -> Result<(), WorkbenchError> {
    Ok(outs::beams(plant, path)?.finish()?)
}

/// In words: how thick a segment is.
#[must_use]
pub fn words(rule: RadiusRule) -> &'static str {
    match rule {
        RadiusRule::Mean => "the mean of its ends, the base at most 1.5 times the tip",
        RadiusRule::Tip => "that of its tip",
    }
}

/// The skeleton of a project, as [`grow`] makes it unless told otherwise, at rest; a pixel is so many metres.
fn skeleton(path: &Path, unit: Option<f64>) -> Result<Measured, WorkbenchError> {
    let unit = unit.ok_or(WorkbenchError::Pixels)?;
    let grown = grow::usual(&Project::open(path, Access::Read)?)?;
    let mut measured = swc::parse(&at_rest(&grown.skeleton), unit)?;
    let whose = format!(
        "the skeleton that `honami grow` makes of {}, a pixel taken as {} m",
        counted(grown.n_groups, "group"),
        Brief(unit)
    );
    measured.notes.extend(std::iter::once(whose).chain(grown.notes));
    Ok(measured)
}

/// Reads a plant from a file by its ending, or makes one.
///
/// # Errors
/// What is wrong with the file or the name.
pub fn read(wish: &Wish) -> Result<Measured, WorkbenchError> {
    check_options(wish)?;
    let source = &wish.source;
    let unknown = || WorkbenchError::NoPlant { source_name: source.clone() };
    if let Some(numbers) = source.strip_prefix(GENERATED) {
        let (n, seed) = numbers.split_once(',').unwrap_or((numbers, "1"));
        let (Ok(n), Ok(seed)) = (n.trim().parse::<usize>(), seed.trim().parse()) else {
            return Err(unknown());
        };
        if n < 2 {
            return Err(unknown());
        }
        // Before it grows.
        if n > MOST_NODES {
            return Err(BeamsError::TooMany { nodes: n as f64 }.into());
        }
        let plant = honami_synth::tree(n, seed).map_err(PlantFileError::from)?;
        return Ok(Measured { plant, notes: Vec::new() });
    }
    let (unit, diameters) =
        (wish.unit.unwrap_or(1.0), wish.diameters.unwrap_or(mtg::Options::default().diameters));
    if ![unit, diameters].iter().all(|v| v.is_finite() && *v > 0.0) {
        return Err(WorkbenchError::Units { unit, diameters });
    }
    let typed = [("--unit", wish.unit.is_some()), ("--diameters", wish.diameters.is_some())];
    let path = Path::new(source);
    let bytes = || fs::read(path).map_err(|source| PlantFileError::Io { path: path.to_owned(), source });
    // Some are in Latin-1: only remarks and names of people have such letters.
    let text = || bytes().map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    let within = |error: PlantFileError| error.of(path);
    match ending(source).as_str() {
        "mtg" => {
            let unit = wish.unit.unwrap_or(mtg::Options::default().unit);
            let options = mtg::Options { unit, diameters, classes: wish.classes.clone() };
            let mut measured = mtg::parse(&text()?, &options).map_err(within)?;
            let taken =
                format!("lengths taken in {} m, diameters in {} m", Brief(unit), Brief(unit / diameters));
            measured.notes.push(sizes::as_taken(&measured.plant, &taken, &typed));
            Ok(measured)
        }
        "swc" => {
            let mut measured = swc::parse(&text()?, unit).map_err(within)?;
            let taken = format!("lengths taken in {} m", Brief(unit));
            measured.notes.push(sizes::as_taken(&measured.plant, &taken, &typed[..1]));
            Ok(measured)
        }
        "honami" => skeleton(path, wish.unit),
        "csv" => Ok(qsm::parse_table(&text()?).map_err(within)?),
        "mat" => Ok(qsm::parse_mat(&bytes()?).map_err(within)?),
        _ => Err(unknown()),
    }
}

/// What may be wrong where a plant is of an odd size; of one that is generated nothing.
fn hint(source: &str) -> Option<&'static str> {
    match ending(source).as_str() {
        "mtg" => Some("is --unit or --diameters another?"),
        "swc" | "honami" => Some("is --unit another?"),
        "csv" | "mat" => Some("are its lengths metres?"),
        _ => None,
    }
}

/// Of a file's name, in small letters; empty where it is no file's.
fn ending(source: &str) -> String {
    let ending = Path::new(source).extension().filter(|_| !source.starts_with(GENERATED));
    ending.map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default()
}

/// Refuses options that say nothing of a plant of this kind.
fn check_options(wish: &Wish) -> Result<(), WorkbenchError> {
    let ending = ending(&wish.source);
    let given = [
        ("--classes", !wish.classes.is_empty(), &["mtg"][..]),
        ("--diameters", wish.diameters.is_some(), &["mtg"]),
        ("--unit", wish.unit.is_some(), &["mtg", "swc", "honami"]),
    ];
    match given.iter().find(|(_, is_given, of)| *is_given && !of.contains(&ending.as_str())) {
        Some((option, _, of)) => {
            let (option, of) = (*option, of.iter().map(|ending| format!(".{ending}")).collect());
            Err(WorkbenchError::NoMeaning { option, of, source_name: wish.source.clone() })
        }
        None => Ok(()),
    }
}
