//! Meshes of other programs, in, and out again frame by frame: Wavefront (`.obj`) and Stanford (`.ply`).

mod obj;
mod ply;
#[cfg(test)]
mod tests;

use std::io::Write as _;
use std::path::Path;

use honami_model::mesh::Mesh;

use crate::atomic::AtomicFile;
use crate::glb::{laid, upright};
use crate::plant::PlantFileError;
use crate::table::TableError;

/// Kinds of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Text; usually y up.
    Obj,
    /// Text or numbers; usually z up.
    Ply,
}

/// Which axis of a file points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Up {
    /// x right, z towards who looks.
    Y,
    /// x right, y away, as here.
    Z,
}

impl Up {
    /// From the axes of a file to ours.
    #[must_use]
    pub fn read(self, place: [f64; 3]) -> [f64; 3] {
        if self == Self::Y { laid(place) } else { place }
    }

    /// From our axes to those of a file.
    #[must_use]
    pub fn written(self, place: [f64; 3]) -> [f64; 3] {
        if self == Self::Y { upright(place) } else { place }
    }
}

impl MeshFormat {
    /// The format whose files end so.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        let known = [("obj", Self::Obj), ("ply", Self::Ply)];
        known.into_iter().find(|(known, _)| *known == ending).map(|(_, format)| format)
    }

    /// The axis that usually points up in such files.
    #[must_use]
    pub fn up(self) -> Up {
        if self == Self::Obj { Up::Y } else { Up::Z }
    }

    /// Reads a mesh in the axes of the file, and notes of what was left out; polygons become triangles.
    ///
    /// # Errors
    /// [`PlantFileError`] with the line, or what is missing.
    pub fn read(self, bytes: &[u8]) -> Result<(Mesh, Vec<String>), PlantFileError> {
        match self {
            Self::Obj => obj::read(&String::from_utf8_lossy(bytes)),
            Self::Ply => ply::read(bytes),
        }
    }
}

/// A frame of a mesh, in the axes of the file.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Vertices.
    pub positions: &'a [[f64; 3]],
    /// Three vertices each.
    pub triangles: &'a [[u32; 3]],
    /// Red, green and blue of every vertex, or of none.
    pub colours: &'a [[u8; 3]],
}

/// Whether what stands where a frame is to be written would give way, if anything does.
///
/// # Errors
/// [`TableError::Precious`], [`TableError::Unlike`].
pub fn check_frame(path: &Path, format: MeshFormat) -> Result<(), TableError> {
    let begin = if format == MeshFormat::Obj { obj::BEGIN } else { ply::BEGIN };
    AtomicFile::check(path, |head| head.starts_with(begin.as_bytes()))
}

/// Writes a frame, whole or not at all.
///
/// # Errors
/// What the disk says.
pub fn write_frame(path: &Path, format: MeshFormat, frame: &Frame<'_>) -> Result<(), TableError> {
    let (bytes, begin) = match format {
        MeshFormat::Obj => (obj::written(frame), obj::BEGIN),
        MeshFormat::Ply => (ply::written(frame), ply::BEGIN),
    };
    let mut file = AtomicFile::create(path, |head| head.starts_with(begin.as_bytes()))?;
    file.write_all(&bytes).map_err(|source| TableError::File { path: path.into(), source })?;
    file.finish()
}

/// Triangles about the first corner of a polygon, which is convex in all that programs write.
pub(crate) fn fan(corners: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]])
}
