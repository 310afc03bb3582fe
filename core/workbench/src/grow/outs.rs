//! What skeletons are written as.

use std::path::Path;

use honami_exchange::skeleton::{SkeletonFormat, rigged};
use honami_model::skeleton::Skeleton;

use super::body::body;
use crate::error::WorkbenchError;

/// Metres of a pixel in a rig, unless told otherwise.
pub const UNIT: f64 = 0.001;

/// Kinds of files that a skeleton can be written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Out {
    /// Itself, in pixels.
    Skeleton(SkeletonFormat),
    /// What it carries, on bones that move (`.glb`): glTF 2.0, metres, y up.
    Rig,
}

impl Out {
    /// The kind whose files end so.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        let is_rig = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("glb"));
        if is_rig { Some(Self::Rig) } else { SkeletonFormat::of(path).map(Self::Skeleton) }
    }
}

/// Writes a skeleton; in a rig a pixel is `unit` metres, the root in the origin, and tubes are what it carries.
///
/// # Errors
/// What the disk met; [`WorkbenchError::Rig`].
pub fn write(skeleton: &Skeleton, out: Out, unit: f64, path: &Path) -> Result<(), WorkbenchError> {
    match out {
        Out::Skeleton(format) => honami_exchange::skeleton::write(path, format, skeleton)?,
        Out::Rig => {
            let skeleton = skeleton.standing([0.0; 3], unit, 0.0)?;
            let (mesh, bindings) = body(&skeleton)?;
            rigged(&mesh, &bindings, &skeleton, &skeleton)?.write(path)?;
        }
    }
    Ok(())
}
