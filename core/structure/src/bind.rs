//! Meshes bound to bones by how near they are (smooth skinning, which the thesis 4.5.1 leaves to a program of others).

#[cfg(test)]
mod tests;

use honami_model::mesh::{Binding, MOST_BONES, Mesh};
use honami_model::skeleton::Skeleton;
use honami_model::turn::{dot, norm};

use crate::StructureError;

/// The foot of a mesh is what of it is so low, of its height.
const LOW: f64 = 0.01;
/// Farther than this vertices are no places of a plant: floats of 32 bits still tell a thousandth of it.
const FARTHEST: f64 = 1e9;
/// So much of a plant's length can be a pixel.
const UNITS: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

/// Where a mesh stands: the mean of its lowest vertices, the lowest hundredth of its height. Vertices that no triangle uses
/// are nowhere to be seen, and do not count.
///
/// # Errors
/// [`StructureError::NoMesh`] without triangles, [`StructureError::Vertex`].
pub fn foot(mesh: &Mesh) -> Result<[f64; 3], StructureError> {
    check(mesh)?;
    let used = used(mesh);
    let [low, high] = reach(&used, 2);
    let lowest = || used.iter().filter(|place| place[2] <= low + LOW * (high - low));
    let n = lowest().count() as f64;
    let mean = |axis: usize| lowest().map(|place| place[axis]).sum::<f64>() / n;
    Ok([mean(0), mean(1), low])
}

/// The skeleton where a mesh is that stands on `foot`: root on foot, turned about the upright, counterclockwise from above,
/// and as high, or such that a pixel is `unit` of the mesh's lengths long. How high a skeleton is, its leaves say, too.
///
/// # Errors
/// [`StructureError::NoMesh`], [`StructureError::Vertex`]; [`StructureError::NoHeight`] where either does not rise above its
/// foot and no `unit` is given; [`StructureError::Unit`] for one that is not of 1e-9 to 1e9.
pub fn fitted(
    skeleton: &Skeleton,
    mesh: &Mesh,
    foot: [f64; 3],
    unit: Option<f64>,
    turn_rad: f64,
) -> Result<Skeleton, StructureError> {
    check(mesh)?;
    let unit = match unit {
        Some(unit) => unit,
        None => {
            let of_mesh = used(mesh).iter().map(|place| place[2] - foot[2]).fold(0.0, f64::max);
            let of_skeleton = height(skeleton);
            if of_mesh <= 0.0 || of_skeleton <= 0.0 {
                return Err(StructureError::NoHeight { of_mesh, of_skeleton });
            }
            of_mesh / of_skeleton
        }
    };
    if !UNITS.contains(&unit) {
        return Err(StructureError::Unit(unit));
    }
    Ok(skeleton.standing(foot, unit, turn_rad)?)
}

/// How high a mesh is, and how wide where it is wider, by the vertices that its triangles use; lengths of the mesh.
#[must_use]
pub fn size(mesh: &Mesh) -> [f64; 2] {
    let used = used(mesh);
    let [x, y, z] = [0, 1, 2].map(|axis| reach(&used, axis)).map(|[low, high]| (high - low).max(0.0));
    [z, x.max(y)]
}

/// The lowest and the highest along an axis.
pub(crate) fn reach(places: &[[f64; 3]], axis: usize) -> [f64; 2] {
    let along = || places.iter().map(|place| place[axis]);
    [along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max)]
}

/// The vertices that triangles use, each once.
pub(crate) fn used(mesh: &Mesh) -> Vec<[f64; 3]> {
    let mut is_used = vec![false; mesh.positions.len()];
    for &vertex in mesh.triangles.iter().flatten() {
        if let Some(is_used) = is_used.get_mut(vertex as usize) {
            *is_used = true;
        }
    }
    let used = mesh.positions.iter().zip(is_used).filter(|(_, is_used)| *is_used);
    used.map(|(place, _)| *place).collect()
}

/// From the root to the highest joint at rest, or leaf in the mean over the frames.
fn height(skeleton: &Skeleton) -> f64 {
    let n_frames = skeleton.times().len();
    let mut means = vec![0.0; skeleton.leaves().len()];
    for frame in 0..n_frames {
        let places = skeleton.places(skeleton.directions(frame));
        for (mean, leaf) in means.iter_mut().zip(skeleton.leaves()) {
            let height = places[leaf.joint as usize][2] + leaf.offsets[frame as usize][2];
            *mean += height / f64::from(n_frames);
        }
    }
    let joints = skeleton.places(skeleton.rest());
    joints.iter().map(|place| place[2]).chain(means).fold(f64::NEG_INFINITY, f64::max) - skeleton.root()[2]
}

/// Binds every vertex to the bones that are nearest to it at rest, four at most.
///
/// At a distance d a bone has the weight (1/d - 1/R)², where R is the distance of the fifth (Franke and Little, in Barnhill,
/// Rocky Mountain J. Math. 14, 1984): so weights do not jump where another bone becomes the fourth. They are divided by
/// their sum. A vertex on a bone has that bone alone.
///
/// # Errors
/// [`StructureError::NoMesh`], [`StructureError::Vertex`]; [`StructureError::TooManyBones`] for more than 65535 joints.
pub fn bind(mesh: &Mesh, skeleton: &Skeleton) -> Result<Vec<Binding>, StructureError> {
    check(mesh)?;
    let joints = skeleton.joints();
    if u16::try_from(joints.len()).is_err() {
        return Err(StructureError::TooManyBones(joints.len()));
    }
    let ends = skeleton.places(skeleton.rest());
    let bones = joints.iter().enumerate().filter_map(|(row, joint)| Some((row as u16, joint.parent?)));
    let bones: Vec<Bone> = bones
        .map(|(row, parent)| Bone { row, base: ends[parent as usize], tip: ends[usize::from(row)] })
        .collect();
    Ok(mesh.positions.iter().map(|place| bound(*place, &bones)).collect())
}

/// A bone at rest.
struct Bone {
    row: u16,
    base: [f64; 3],
    tip: [f64; 3],
}

impl Bone {
    /// From a place to the nearest point of the bone.
    fn distance(&self, place: [f64; 3]) -> f64 {
        let (along, to) = (less(self.tip, self.base), less(place, self.base));
        let square = dot(along, along);
        // A bone may be too short for its square to be a number above 0.
        let share = if square > 0.0 { (dot(along, to) / square).clamp(0.0, 1.0) } else { 0.0 };
        norm(std::array::from_fn(|axis| to[axis] - share * along[axis]))
    }
}

/// From `b` to `a`.
pub(crate) fn less(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn bound(place: [f64; 3], bones: &[Bone]) -> Binding {
    // The nearest, and one more, nearest first; of those as near the first of their rows.
    let mut nearest = [(f64::INFINITY, 0); MOST_BONES + 1];
    for bone in bones {
        let distance = bone.distance(place);
        if distance < nearest[MOST_BONES].0 {
            let at = nearest.partition_point(|(there, _)| *there <= distance);
            nearest[at..].rotate_right(1);
            nearest[at] = (distance, bone.row);
        }
    }
    let farthest = nearest[MOST_BONES].0;
    // In terms of the nearest, so that nothing overflows.
    let least = nearest[0].0;
    let share = |distance: f64| {
        if distance <= 0.0 {
            1.0
        } else if least <= 0.0 || distance.is_infinite() {
            0.0
        } else {
            (least / distance - least / farthest).powi(2)
        }
    };
    let shares = std::array::from_fn(|k| (nearest[k].1, share(nearest[k].0)));
    // Where five are as near as one another, none has a weight so.
    let is_even = shares.iter().all(|(_, share)| *share <= 0.0);
    Binding::new(if is_even { shares.map(|(row, _)| (row, 1.0)) } else { shares })
}

fn check(mesh: &Mesh) -> Result<(), StructureError> {
    if mesh.triangles.is_empty() || mesh.positions.is_empty() {
        return Err(StructureError::NoMesh);
    }
    let is_place = |place: &[f64; 3]| place.iter().all(|v| v.abs() <= FARTHEST);
    match mesh.positions.iter().position(|place| !is_place(place)) {
        Some(vertex) => Err(StructureError::Vertex { vertex, place: mesh.positions[vertex] }),
        None => Ok(()),
    }
}
