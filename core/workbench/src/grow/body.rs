//! A body for bones: tubes along them, so that a skeleton is seen wherever it is opened.

#[cfg(test)]
mod tests;

use honami_mechanics::{Beams, Options};
use honami_model::mesh::{Binding, Mesh};
use honami_model::plant::{Node, Plant};
use honami_model::skeleton::Skeleton;
use honami_model::turn::norm;
use honami_structure::StructureError;

use crate::error::WorkbenchError;
use honami_scene::tubes::{SIDES, Tubes};

/// The thickest bone has such a radius, of how far the farthest joint is from the root.
const THICKEST: f64 = 0.02;

/// Tubes about the bones of a skeleton at rest, each bound to its own; between two that go on, half to either.
///
/// # Errors
/// [`StructureError::TooManyBones`] for more than 65535 joints, as bindings count them; [`WorkbenchError::Beams`].
pub(super) fn body(skeleton: &Skeleton) -> Result<(Mesh, Vec<Binding>), WorkbenchError> {
    about(skeleton, &vec![true; skeleton.joints().len()])
}

/// The same about those bones alone that bear others, as thick; nothing where none does.
///
/// # Errors
/// As [`body`].
pub(super) fn bearing(skeleton: &Skeleton) -> Result<(Mesh, Vec<Binding>), WorkbenchError> {
    let are_bearing: Vec<bool> = skeleton.are_tips().iter().map(|is_tip| !is_tip).collect();
    match are_bearing.iter().filter(|is_bearing| **is_bearing).count() {
        0 | 1 => Ok((Mesh::default(), Vec::new())),
        _ => about(skeleton, &are_bearing),
    }
}

/// Of the bones that are wanted; what bears such a one is, too.
fn about(skeleton: &Skeleton, are_wanted: &[bool]) -> Result<(Mesh, Vec<Binding>), WorkbenchError> {
    let n_joints = skeleton.joints().len();
    if u16::try_from(n_joints).is_err() {
        return Err(StructureError::TooManyBones(n_joints).into());
    }
    let places = skeleton.places(skeleton.rest());
    let radii = radii(skeleton, &places);
    let rows: Vec<usize> = (0..n_joints).filter(|row| are_wanted[*row]).collect();
    let node = |&row: &usize| {
        let parent = skeleton.joints()[row].parent;
        let parent = parent.map(|parent| rows.partition_point(|row| *row < parent as usize) as u32);
        Node { parent, position: places[row], radius: radii[row] }
    };
    let beams = Beams::new(&Plant::new(rows.iter().map(node).collect())?, &Options::default())?;
    let mut bones = vec![0; beams.len()];
    beams.of_plant().iter().zip(&rows).for_each(|(node, row)| bones[*node as usize] = *row as u16);
    let rings = Tubes::new(&beams);
    let bound = rings.rings().iter().flat_map(|ring| {
        let [before, after] = ring.tips().map(|tip| (bones[tip as usize], 0.5));
        [Binding::new([before, after, (0, 0.0), (0, 0.0)]); SIDES]
    });
    Ok((tubes(&beams), bound.collect()))
}

/// Tubes along the branches of a plant.
pub(super) fn tubes(beams: &Beams) -> Mesh {
    let tubes = Tubes::new(beams);
    let mut mesh = Mesh { triangles: tubes.triangles(), ..Mesh::default() };
    for ring in tubes.rings() {
        let centre = beams.position(ring.node as usize);
        for outward in ring.outward() {
            mesh.positions.push((centre + outward * ring.radius).into());
            mesh.normals.push(outward.into());
        }
    }
    mesh
}

/// Every bone has the area of all that it bears (Shinozaki and others, 1964), ends of branches all the same.
fn radii(skeleton: &Skeleton, places: &[[f64; 3]]) -> Vec<f64> {
    let are_tips = skeleton.are_tips();
    let mut areas: Vec<f64> = are_tips.iter().map(|is_tip| f64::from(u8::from(*is_tip))).collect();
    for (row, joint) in skeleton.joints().iter().enumerate().rev() {
        joint.parent.iter().for_each(|&parent| areas[parent as usize] += areas[row]);
    }
    let from_root = |place: &[f64; 3]| norm(std::array::from_fn(|axis| place[axis] - places[0][axis]));
    let size = places.iter().map(from_root).fold(0.0, f64::max);
    areas.iter().map(|area| THICKEST * size * (area / areas[0]).sqrt()).collect()
}
