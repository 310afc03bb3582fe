//! Skeletons for other programs, out: their motion as BVH and as a table of angles, their shape at rest as SWC, their
//! leaves as a table; and meshes that they carry, as rigs.

mod angles;
mod bvh;
mod joints;
mod leaf_table;
mod rig;
mod swc;
#[cfg(test)]
mod tests;
mod usda;

pub use angles::AngleRow;
pub use leaf_table::LeafRow;
pub use rig::{RigError, rigged};
pub use usda::{usda, write_usda};

use std::io::Write;
use std::path::Path;

use honami_model::skeleton::Skeleton;

use crate::atomic::AtomicFile;
use crate::table::{TableError, Writer};

/// Kinds of files that a skeleton can be written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SkeletonFormat {
    /// Motion capture (`.bvh`): a joint a bone that turns and keeps its length, degrees, pixels, y up.
    Bvh,
    /// A table of joints (`.csv`), a row a joint and frame: [`AngleRow`].
    Angles,
    /// The shape at rest (`.swc`), pixels, z up, the root in the origin; radii are 0: not measured.
    Swc,
}

impl SkeletonFormat {
    /// The format whose files end so.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        [("bvh", Self::Bvh), ("csv", Self::Angles), ("swc", Self::Swc)]
            .into_iter()
            .find(|(known, _)| *known == ending)
            .map(|(_, format)| format)
    }
}

/// Writes a skeleton, whole or not at all; tables number its frames from `first` on.
///
/// # Errors
/// [`TableError::File`] when the disk refuses, [`TableError::Precious`] and [`TableError::Unlike`] when something of others
/// stands there.
pub fn write(path: &Path, format: SkeletonFormat, skeleton: &Skeleton, first: u32) -> Result<(), TableError> {
    let (text, begin) = match format {
        SkeletonFormat::Bvh => (bvh::text(skeleton), bvh::BEGIN),
        SkeletonFormat::Swc => (swc::text(skeleton), swc::BEGIN),
        SkeletonFormat::Angles => {
            let mut table = Writer::create(path)?;
            for row in angles::rows(skeleton, first) {
                table.write(&row)?;
            }
            return table.finish();
        }
    };
    let mut file = AtomicFile::create(path, |head| head.starts_with(begin.as_bytes()))?;
    let full = |source| TableError::File { path: path.into(), source };
    file.write_all(text.as_bytes()).map_err(full)?;
    file.finish()
}

/// A skeleton at rest as the text of a `.swc`, which [`swc`](crate::plant::swc) reads.
#[must_use]
pub fn at_rest(skeleton: &Skeleton) -> String {
    swc::text(skeleton)
}

/// Writes where leaves are in every frame, the first of which is numbered `first`; returns how many rows.
///
/// # Errors
/// As [`write()`].
pub fn write_leaves(path: &Path, skeleton: &Skeleton, first: u32) -> Result<usize, TableError> {
    let mut table = Writer::create(path)?;
    let mut n = 0;
    for row in leaf_table::rows(skeleton, first) {
        table.write(&row)?;
        n += 1;
    }
    table.finish()?;
    Ok(n)
}
