//! What the viewer shows of a project: the skeleton of the shown groups, as a scene.

mod edit;
#[cfg(test)]
mod tests;

use std::path::PathBuf;

use honami_host::{Host, PluginInfo};
use honami_model::shape::Shape;
use honami_model::skeleton::{Leaf, Skeleton};
use honami_scene::skeleton::{Bone, Carried, Film, Group, Joint};
use honami_scene::{SkeletonScene, palette};
use honami_store::Project;
use honami_structure::ellipse::Ellipse;

pub use self::edit::{edit, is_edit, transaction};
use crate::error::WorkbenchError;
use crate::grow::{Bones, GrowRequest, grow};
use crate::progress::Progress;

/// A scene of a project.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// What is drawn.
    pub scene: SkeletonScene,
    /// What whoever looks should know, a sentence each.
    pub notes: Vec<String>,
}

/// Grows the skeleton of a project for whoever draws it, over the clip where that is at hand.
///
/// # Errors
/// As [`grow`].
pub fn skeleton(
    project: &Project,
    host: &Host,
    plugin: &PluginInfo,
    request: &GrowRequest,
    clip: Option<PathBuf>,
    progress: &dyn Progress,
) -> Result<Shown, WorkbenchError> {
    let document = project.document();
    let hands = (!request.as_grown).then_some(document);
    let placed = hands.and_then(|document| document.root()).filter(|_| request.root.is_none());
    // Hand work on bones is laid over what has grown where that is drawn.
    let root = request.root.or(placed);
    let growth =
        grow(project, host, plugin, &GrowRequest { root, as_grown: true, ..request.clone() }, progress)?;
    let record = project.clip();
    let film = Film {
        path: clip,
        sha256: Some(record.sha256.clone()),
        fps: record.fps_override,
        width: record.clip.width,
        height: record.clip.height,
        n_frames: record.clip.n_frames(),
    };
    let shown = document.clustering();
    let mut scene = SkeletonScene {
        name: project.path().file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default(),
        clip: film,
        n_groups: request.groups.or(shown.map(|shown| shown.k)).unwrap_or_default(),
        most_groups: growth.groups.iter().map(Vec::len).sum::<usize>() as u32,
        is_placed: placed.is_some(),
        ..scene(&growth.skeleton, &growth.bones, growth.frames.start)
    };
    let shapes: Vec<(u32, Shape)> = hands.zip(shown).map_or_else(Vec::new, |(document, shown)| {
        document.shapes(shown.id).filter(|(node, _)| scene.row_of(*node).is_some()).collect()
    });
    if !shapes.is_empty() {
        scene.reshape(&shapes)?;
    }
    Ok(Shown { scene, notes: growth.notes })
}

/// What has grown, without what is of the project.
fn scene(skeleton: &Skeleton, bones: &Bones, first_frame: u32) -> SkeletonScene {
    let joint = |(row, joint): (usize, &honami_model::skeleton::Joint)| {
        let known = bones.known.get(row).and_then(Option::as_ref);
        Joint {
            parent: joint.parent,
            group: joint.groups.first().copied(),
            name: known.map(|bone| bone.name.clone()).unwrap_or_default(),
            bone: known.map(|bone| Bone { node: bone.node, gain: 1.0, ..Bone::default() }),
            copy_of: bones.copy_of.get(row).copied().flatten(),
            rest: single(skeleton.rest()[row]),
        }
    };
    let joints: Vec<Joint> = skeleton.joints().iter().enumerate().map(joint).collect();
    let frames: Vec<Vec<[f64; 3]>> =
        (0..skeleton.times().len()).map(|frame| skeleton.places(skeleton.directions(frame))).collect();
    let carried = |leaf: &Leaf| {
        let place = |(places, by): (&Vec<[f64; 3]>, &[f64; 3])| {
            let at = places[leaf.joint as usize];
            single(std::array::from_fn(|axis| at[axis] + by[axis]))
        };
        Carried {
            track: u64::from(leaf.track.0),
            joint: leaf.joint,
            group: joints[leaf.joint as usize].group,
            places: frames.iter().zip(&leaf.offsets).map(place).collect(),
        }
    };
    let leaves = skeleton.leaves().iter().map(carried).collect();
    let times = skeleton.times().as_slice();
    let begin = times.first().copied().unwrap_or_default();
    SkeletonScene {
        groups: groups(skeleton, &joints),
        places: frames.iter().flatten().copied().map(single).collect(),
        first_frame,
        times: times.iter().map(|time| time - begin).collect(),
        joints,
        leaves,
        ..SkeletonScene::default()
    }
}

/// Groups in the order of their numbers, each with the ellipsoid about its members as they usually lie beside its joint.
fn groups(skeleton: &Skeleton, joints: &[Joint]) -> Vec<Group> {
    let n = joints.iter().filter_map(|joint| joint.group).max().map_or(0, |last| last + 1);
    let group = |number: u32| {
        let is_own = |joint: &Joint| joint.group == Some(number) && joint.copy_of.is_none();
        let row = joints.iter().position(is_own).and_then(|row| u32::try_from(row).ok());
        let name = row.map(|row| joints[row as usize].name.clone()).filter(|name| !name.is_empty());
        let members = skeleton.leaves().iter().filter(|leaf| Some(leaf.joint) == row).map(usual);
        let (centre, half_axes) = ellipsoid(&members.collect::<Vec<_>>()).unwrap_or_default();
        Group {
            name: name.unwrap_or_else(|| format!("group {}", number + 1)),
            joint: row,
            centre,
            half_axes,
            colour: palette::group(Some(number)),
        }
    };
    (0..n).map(group).collect()
}

/// Where a leaf is beside its joint, in the mean: right and up, pixels.
fn usual(leaf: &Leaf) -> [f64; 2] {
    let n = leaf.offsets.len().max(1) as f64;
    [0, 2].map(|axis| leaf.offsets.iter().map(|offset| offset[axis]).sum::<f64>() / n)
}

/// The ellipse of some places in the picture, inflated: as deep as it is wide where it is narrowest (thesis 4.4.1). Centre and
/// half axes; `None` of a line or a point, which nothing is about.
fn ellipsoid(places: &[[f64; 2]]) -> Option<([f32; 3], [[f32; 3]; 3])> {
    let ellipse = Ellipse::of(places)?;
    let ([long, short], [c, s], [x, z]) = (ellipse.reach, ellipse.axis, ellipse.centre);
    // Where it is a line it has no depth in its middle.
    let deep = ellipse.depth(ellipse.centre);
    let axes = [[c * long, 0.0, s * long], [-s * short, 0.0, c * short], [0.0, deep, 0.0]];
    (deep > 0.0).then(|| (single([x, 0.0, z]), axes.map(single)))
}

fn single(place: [f64; 3]) -> [f32; 3] {
    place.map(|v| v as f32)
}
