//! What a skeleton carries: tubes along its own bones, or a plant of others, bound to it.

use std::fs;
use std::path::{Path, PathBuf};

use honami_exchange::glb::{Document, Piece};
use honami_exchange::mesh::{MeshFormat, Up};
use honami_exchange::plant::{Measured, PlantFileError};
use honami_mechanics::{Beams, Options};
use honami_model::brief::Brief;
use honami_model::mesh::{Binding, Mesh};
use honami_model::skeleton::Skeleton;
use honami_structure::{StructureError, bind};

use super::assembled::Assembled;
use super::body::{body, tubes};
use crate::error::WorkbenchError;
use crate::plant::{self, Wish};

/// Metres of a pixel where a skeleton carries tubes of its own, unless told otherwise.
pub const UNIT: f64 = 0.001;
/// A plant is at most so many times as wide as it is high, or it lies.
const WIDEST: f64 = 4.0;
/// Files are read whole: larger ones are refused, bytes.
const MOST_BYTES: u64 = 1 << 31;

/// How a plant is put onto a skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct Onto {
    /// `.glb`, `.obj`, `.ply`, or a plant as [`plant::read`] reads it, of which tubes are made.
    pub plant: PathBuf,
    /// Which axis of an `.obj` or a `.ply` points up; `None`: as usual.
    pub up: Option<Up>,
    /// So much of the plant's length is a pixel; `None`: as makes both as high.
    pub unit: Option<f64>,
    /// The skeleton is turned so about the upright, counterclockwise from above, radians.
    pub turn_rad: f64,
}

/// A mesh that is bound to a skeleton.
#[derive(Clone, Debug)]
pub struct Bound {
    /// Where the mesh is.
    pub(super) rest: Skeleton,
    /// z up.
    pub(super) mesh: Mesh,
    pub(super) bindings: Vec<Binding>,
    /// Of the file that it is of; `None` of one that has no axes.
    pub(super) up: Option<Up>,
    pub(super) document: Document,
    pub(super) pieces: Vec<Piece>,
    /// Whether vertices can be told one by one as the file has them.
    pub(super) is_one: bool,
    pub(super) foot: [f64; 3],
    pub(super) unit: f64,
    pub(super) turn_rad: f64,
    /// What it was put together of, if it was.
    pub assembled: Option<Assembled>,
    /// What was left out or guessed, a sentence each.
    pub notes: Vec<String>,
}

/// A plant as it was read.
pub(super) struct Read {
    pub(super) mesh: Mesh,
    pub(super) up: Option<Up>,
    pub(super) document: Document,
    pub(super) pieces: Vec<Piece>,
    is_one: bool,
    /// Where it leaves the ground, if the file says so.
    foot: Option<[f64; 3]>,
    pub(super) notes: Vec<String>,
}

impl Bound {
    /// Tubes along the bones of a skeleton, its root in the origin, a pixel so many metres.
    ///
    /// # Errors
    /// [`WorkbenchError::Unit`], [`WorkbenchError::Beams`].
    pub fn own(skeleton: &Skeleton, unit: f64) -> Result<Self, WorkbenchError> {
        let rest = in_origin(skeleton, unit)?;
        let (mesh, bindings) = body(&rest)?;
        let Read { mesh, up, document, pieces, is_one, notes, .. } = made(mesh, Vec::new())?;
        let (foot, turn_rad) = ([0.0; 3], 0.0);
        Ok(Self {
            rest,
            mesh,
            bindings,
            up,
            document,
            pieces,
            is_one,
            foot,
            unit,
            turn_rad,
            assembled: None,
            notes,
        })
    }

    /// A plant of others, bound to a skeleton that was fitted to it: root on foot, and as high.
    ///
    /// # Errors
    /// What is wrong with the file; [`WorkbenchError::Structure`] for what cannot be bound.
    pub fn onto(skeleton: &Skeleton, onto: &Onto) -> Result<Self, WorkbenchError> {
        let Read { mesh, up, document, pieces, is_one, foot, notes } = match read(&onto.plant, onto.up)? {
            Some(read) => read,
            None => wood(&onto.plant)?,
        };
        let within = |error| refused(error, &onto.plant, up);
        let foot = foot.map_or_else(|| bind::foot(&mesh), Ok).map_err(within)?;
        let turn_rad = onto.turn_rad;
        let rest = bind::fitted(skeleton, &mesh, foot, onto.unit, turn_rad).map_err(within)?;
        let bindings = bind::bind(&mesh, &rest).map_err(within)?;
        let unit = rest.joints()[1].length / skeleton.joints()[1].length;
        Ok(Self {
            rest,
            mesh,
            bindings,
            up,
            document,
            pieces,
            is_one,
            foot,
            unit,
            turn_rad,
            assembled: None,
            notes,
        })
    }

    /// So much of the mesh's length is a pixel.
    #[must_use]
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// How many vertices and triangles are carried.
    #[must_use]
    pub fn sizes(&self) -> [usize; 2] {
        [self.mesh.positions.len(), self.mesh.triangles.len()]
    }

    /// How high what is carried is, and how wide where it is wider, in its lengths.
    #[must_use]
    pub fn extent(&self) -> [f64; 2] {
        bind::size(&self.mesh)
    }

    /// What is to be said of a file that `--up` may be typed of, and that is much wider than high as it was read.
    #[must_use]
    pub fn lying(&self) -> Option<String> {
        let ([height, width], up) = (self.extent(), self.up.filter(|_| self.is_one)?);
        let (taken, other) = if up == Up::Y { ("y", "z") } else { ("z", "y") };
        (width > WIDEST * height).then(|| {
            format!("it is more than {WIDEST} times as wide as it is high, with {taken} taken as up: --up {other} if it lies so")
        })
    }

    /// A skeleton of the same bones where this one's is.
    pub(super) fn standing(&self, skeleton: &Skeleton) -> Result<Skeleton, WorkbenchError> {
        Ok(skeleton.standing(self.foot, self.unit, self.turn_rad)?)
    }
}

/// Vertices in colours of their bones, blended by their weights.
#[must_use]
pub(super) fn coloured(bindings: &[Binding]) -> Vec<[u8; 3]> {
    let of = |binding: &Binding| {
        let mut sum = [0.0; 3];
        for (bone, weight) in binding.shares() {
            let hue = hue(bone);
            (0..3).for_each(|k| sum[k] += weight * hue[k]);
        }
        sum.map(|v| (255.0 * v).round() as u8)
    };
    bindings.iter().map(of).collect()
}

/// A colour for every bone, those of neighbouring rows far apart: hues a golden section of the circle on.
fn hue(bone: usize) -> [f64; 3] {
    let turn = 6.0 * (bone as f64 * 0.618_033_988_749_895).fract();
    [5.0, 3.0, 1.0].map(|n| {
        let k = (n + turn) % 6.0;
        1.0 - 0.85 * k.min(4.0 - k).clamp(0.0, 1.0)
    })
}

/// What is wrong with a plant, vertices as its file has them: in its axes, of an `.obj` counted from 1.
pub(super) fn refused(error: StructureError, path: &Path, up: Option<Up>) -> WorkbenchError {
    let source = match error {
        StructureError::Vertex { vertex, place } => StructureError::Vertex {
            vertex: vertex + usize::from(MeshFormat::of(path) == Some(MeshFormat::Obj)),
            place: up.map_or(place, |up| up.written(place)),
        },
        error => error,
    };
    WorkbenchError::Onto { path: path.to_owned(), source }
}

/// A skeleton with its root in the origin, a pixel so many metres.
pub(super) fn in_origin(skeleton: &Skeleton, unit: f64) -> Result<Skeleton, WorkbenchError> {
    let standing = skeleton.standing([0.0; 3], unit, 0.0);
    standing.map_err(|source| WorkbenchError::Unit { unit, source })
}

fn made(mesh: Mesh, notes: Vec<String>) -> Result<Read, WorkbenchError> {
    let document = Document::of(&mesh);
    let (_, pieces) = document.pieces()?;
    Ok(Read { mesh, up: None, document, pieces, is_one: false, foot: None, notes })
}

/// A mesh as it stands in a file, z up; `None` of a file that is none.
pub(super) fn read(path: &Path, up: Option<Up>) -> Result<Option<Read>, WorkbenchError> {
    let is_glb = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("glb"));
    let format = MeshFormat::of(path);
    if up.is_some() && format.is_none() {
        return Err(WorkbenchError::NoMeaning {
            option: "--up",
            of: vec![".obj".to_owned(), ".ply".to_owned()],
            source_name: path.display().to_string(),
        });
    }
    match format {
        Some(format) => {
            let (mut mesh, notes) = format.read(&bytes(path)?).map_err(|error| error.of(path))?;
            let up = up.unwrap_or(format.up());
            mesh.positions.iter_mut().for_each(|place| *place = up.read(*place));
            Ok(Some(Read { up: Some(up), is_one: true, ..made(mesh, notes)? }))
        }
        None if is_glb => {
            let document = Document::read(&bytes(path)?).map_err(|error| error.of(path))?;
            let (mesh, pieces) = document.pieces().map_err(|error| error.of(path))?;
            let notes = document.notes();
            Ok(Some(Read { mesh, up: Some(Up::Y), document, pieces, is_one: false, foot: None, notes }))
        }
        None => Ok(None),
    }
}

/// Tubes along the branches of a plant.
fn wood(path: &Path) -> Result<Read, WorkbenchError> {
    let Measured { plant, notes } = nodes(path)?;
    let beams = Beams::new(&plant, &Options::default())?;
    let foot = beams.position(0).into();
    Ok(Read { foot: Some(foot), ..made(tubes(&beams), notes)? })
}

/// A plant of nodes.
pub(super) fn nodes(path: &Path) -> Result<Measured, WorkbenchError> {
    let mut measured =
        plant::read(&Wish::of(&path.display().to_string(), None)).map_err(|error| match error {
            WorkbenchError::NoPlant { .. } => WorkbenchError::NoCarried { path: path.to_owned() },
            error => error,
        })?;
    // What `--unit` is there it is not here.
    let note = |note: String| note.split("; --unit").next().unwrap_or_default().to_owned();
    measured.notes = measured.notes.into_iter().map(note).collect();
    Ok(measured)
}

fn bytes(path: &Path) -> Result<Vec<u8>, WorkbenchError> {
    let failed = |source| PlantFileError::Io { path: path.to_owned(), source };
    let size = fs::metadata(path).map_err(failed)?.len();
    if size > MOST_BYTES {
        let what = format!("a plant of up to {} bytes is read, this has {}", MOST_BYTES, Brief(size as f64));
        return Err(PlantFileError::Lacks(what).of(path).into());
    }
    Ok(fs::read(path).map_err(failed)?)
}
