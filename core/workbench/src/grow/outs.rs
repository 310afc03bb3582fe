//! What skeletons, and what they carry, are written as.

#[cfg(test)]
mod tests;

use std::borrow::Cow;
use std::fs;
use std::path::{Path, PathBuf};

use honami_exchange::mesh::{Frame, MeshFormat, Up, check_frame, write_frame};
use honami_exchange::plant::PointCache;
use honami_exchange::skeleton::{SkeletonFormat, rigged, usda, write_usda};
use honami_model::mesh::Binding;
use honami_model::skeleton::Skeleton;
use honami_structure::blend::{Blend, blended, carries};
use honami_structure::fewer::Fewer;
use honami_structure::repeat::closed;

use super::assembled::Library;
use super::bound::{Bound, coloured};
use crate::error::WorkbenchError;

/// What names of files end in, in words.
pub const ENDINGS: &str = ".bvh, .csv, .swc, .glb, .usda, .pc2 or as frames, out/%04d.ply or out/%04d.obj";

/// Kinds of files that a skeleton can be written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Out {
    /// Itself, in pixels.
    Skeleton(SkeletonFormat),
    /// What it carries, on bones that move (`.glb`): glTF 2.0, y up.
    Rig,
    /// The same as text of Universal Scene Description (`.usda`), without materials.
    Usd,
    /// What it carries, a file a frame (`%04d.obj`, `%04d.ply`).
    Frames(MeshFormat),
    /// Where the vertices that it carries are in every frame (`.pc2`).
    Cache,
}

/// What is carried, and how it is shown.
#[derive(Clone, Debug)]
pub struct Carried {
    /// What it is; `None`: tubes along the skeleton's own bones.
    pub bound: Option<Bound>,
    /// What siblings are put together of, and the seed that says how.
    pub library: Option<(Library, u64)>,
    /// Metres of a pixel, of tubes.
    pub unit: f64,
    /// How vertices follow several bones, in frames and caches; a rig leaves that to whoever reads it.
    pub blend: Blend,
    /// The bones that rigs have; `None`: all.
    pub fewer: Option<Fewer>,
    /// When a loop begins anew, seconds: rigs have its first pose there once more, for they are played from key to key.
    pub again_s: Option<f64>,
    /// Whether vertices are coloured by the bones that carry them.
    pub are_weights_shown: bool,
}

impl Carried {
    /// What the `number`-th sibling carries: the same, or, of a library, branches of its own.
    ///
    /// # Errors
    /// As [`Bound::assembled`].
    pub fn of_sibling(&self, sibling: &Skeleton, number: u32) -> Result<Cow<'_, Self>, WorkbenchError> {
        let Some((library, seed)) = &self.library else { return Ok(Cow::Borrowed(self)) };
        let bound = Some(Bound::assembled(sibling, library, self.unit, *seed, number)?);
        Ok(Cow::Owned(Self { bound, library: None, fewer: self.fewer.clone(), ..*self }))
    }
}

impl Out {
    /// The kind whose files end so; frames have a number in their name, and others none.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        if numbered(path, 0).is_some() {
            return MeshFormat::of(path).map(Self::Frames);
        }
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "glb" => Some(Self::Rig),
            "usda" => Some(Self::Usd),
            "pc2" => Some(Self::Cache),
            _ => SkeletonFormat::of(path).map(Self::Skeleton),
        }
    }

    /// Frames of a longer motion that stand behind those of so many: nothing takes their place.
    #[must_use]
    pub fn n_behind(self, path: &Path, n_frames: u32) -> usize {
        let there = |frame: &u32| numbered(path, *frame).is_some_and(|name| name.exists());
        match self {
            Self::Frames(_) => (n_frames..).take_while(there).count(),
            _ => 0,
        }
    }

    /// The files that are written as this where a motion has so many frames.
    #[must_use]
    pub fn names(self, path: &Path, n_frames: u32) -> Vec<PathBuf> {
        match self {
            Self::Frames(_) => (0..n_frames).filter_map(|frame| numbered(path, frame)).collect(),
            _ => vec![path.to_owned()],
        }
    }
}

/// `walk/%04d.ply` as `walk/0007.ply`; `None` where there is not one such place in the name.
fn numbered(path: &Path, frame: u32) -> Option<PathBuf> {
    let name = path.file_name()?.to_str()?;
    let (before, rest) = name.split_once('%')?;
    let (digits, after) = rest.split_once('d')?;
    let width = match digits.strip_prefix('0') {
        Some(width) => width.parse().ok().filter(|width| (1..=9).contains(width))?,
        None if digits.is_empty() => 1,
        None => return None,
    };
    (!after.contains('%')).then(|| path.with_file_name(format!("{before}{frame:0width$}{after}")))
}

/// Writes a skeleton, or what it carries, which may be bound to another of the same bones; tables number frames from `first` on.
///
/// # Errors
/// What the disk met; [`WorkbenchError::Rig`]; [`WorkbenchError::NoVertices`].
pub fn write(
    skeleton: &Skeleton,
    first: u32,
    out: Out,
    carried: &Carried,
    path: &Path,
) -> Result<(), WorkbenchError> {
    if let Out::Skeleton(format) = out {
        return Ok(honami_exchange::skeleton::write(path, format, skeleton, first)?);
    }
    let own;
    let bound = match &carried.bound {
        Some(bound) => bound,
        None => {
            own = Bound::own(skeleton, carried.unit)?;
            &own
        }
    };
    let motion = bound.standing(skeleton)?;
    let keys = || match carried.again_s {
        Some(time_s) => closed(&motion, time_s).map(Cow::Owned),
        None => Ok(Cow::Borrowed(&motion)),
    };
    let colours = |bindings: &[Binding]| match carried.are_weights_shown {
        true => coloured(bindings),
        false => Vec::new(),
    };
    let kept = carried.fewer.as_ref().map(Fewer::rows);
    let of_rig = || match &carried.fewer {
        Some(fewer) => Cow::Owned(bound.bindings.iter().map(|binding| fewer.binding(binding)).collect()),
        None => Cow::Borrowed(&bound.bindings),
    };
    match out {
        Out::Skeleton(_) => {}
        Out::Rig => {
            let (Bound { document, pieces, rest, .. }, bindings) = (bound, of_rig());
            let colours = colours(&bindings);
            rigged(document.clone(), pieces, &bindings, &colours, rest, &*keys()?, kept)?.write(path)?;
        }
        Out::Usd => {
            let (Bound { mesh, rest, .. }, bindings) = (bound, of_rig());
            write_usda(path, &usda(mesh, &bindings, &colours(&bindings), rest, &*keys()?, kept)?)?;
        }
        Out::Frames(format) => {
            // All or none: half of a motion is mixed with what stood there.
            for name in out.names(path, motion.times().len()) {
                check_frame(&name, format)?;
            }
            make_folder(path)?;
            let (triangles, colours) = (&bound.mesh.triangles, colours(&bound.bindings));
            for frame in 0..motion.times().len() {
                let Some(path) = numbered(path, frame) else { continue };
                let positions = moved(bound, &motion, frame, carried.blend, bound.up.unwrap_or(format.up()));
                write_frame(&path, format, &Frame { positions: &positions, triangles, colours: &colours })?;
            }
        }
        Out::Cache => {
            if !bound.is_one {
                return Err(WorkbenchError::NoVertices);
            }
            let n_frames = motion.times().len();
            let mut cache = PointCache::create(path, bound.mesh.positions.len(), n_frames)?;
            for frame in 0..n_frames {
                for place in moved(bound, &motion, frame, carried.blend, bound.up.unwrap_or(Up::Z)) {
                    cache.push(place.map(|v| v as f32))?;
                }
            }
            cache.finish()?;
        }
    }
    Ok(())
}

/// Makes the folder of frames where there is none, in one that there is.
fn make_folder(frames: &Path) -> Result<(), WorkbenchError> {
    let folder = frames.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.exists());
    let Some(folder) = folder else { return Ok(()) };
    let failed =
        |source| WorkbenchError::Io { what: "making the folder of frames", source, path: folder.into() };
    fs::create_dir(folder).map_err(failed)
}

/// Where vertices are in a frame, in the axes of a file.
fn moved(bound: &Bound, motion: &Skeleton, frame: u32, blend: Blend, up: Up) -> Vec<[f64; 3]> {
    let carries = carries(&bound.rest, motion, frame);
    let places = blended(&bound.mesh.positions, &bound.bindings, &carries, blend);
    places.into_iter().map(|place| up.written(place)).collect()
}
