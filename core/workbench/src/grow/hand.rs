//! Hand work on what has grown: which bone is which, and how it is shaped.

#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use honami_model::brief::counted;
use honami_model::document::{ClusteringId, Document};
use honami_model::provenance::Value;
use honami_model::shape::{Bone, Shape};
use honami_model::skeleton::Skeleton;
use honami_store::Project;
use honami_structure::shape::{Shaped, shaped};
use honami_structure::tree::Group;
use honami_structure::{Grown, diener};

use super::Growth;
use super::gather::{Gathered, gather};
use crate::error::WorkbenchError;
use crate::shape::ranges;

/// What of a skeleton is hand work.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hand {
    /// Where its root was placed, pixels (right, down); `None`: it was not, or the request said where.
    pub root: Option<[f64; 2]>,
    /// Bones that were shaped, in the order of their joints.
    pub bones: Vec<(Bone, Shape)>,
}

impl Hand {
    /// How bones were shaped, as provenance has it.
    pub(super) fn told(&self) -> Option<(&'static str, Value)> {
        let one = |(bone, shape): &(Bone, Shape)| format!("{}: {shape}", bone.name);
        let all = self.bones.iter().map(one).collect::<Vec<_>>().join("; ");
        (!all.is_empty()).then_some(("shaped", Value::Text(all)))
    }
}

/// The bones of a skeleton, a joint each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bones {
    /// `None` of the root, and of joints of which the structure builder has not told what they are of.
    pub known: Vec<Option<Bone>>,
    /// Row of the joint that each is a copy of.
    pub copy_of: Vec<Option<u32>>,
}

impl Bones {
    /// `named` has the bones that groups are known by, `bears` what joints bear of these, by row: a group that several bear
    /// is borne by the first, and the others are copies of that. What bears a copy, and bears nothing by itself, is one too.
    fn of(skeleton: &Skeleton, named: &[Bone], bears: &[(u32, u32)]) -> Self {
        let joints = skeleton.joints();
        let mut first = vec![None; named.len()];
        let mut group_of = vec![None; joints.len()];
        let mut copy_of: Vec<Option<u32>> = vec![None; joints.len()];
        let told: BTreeSet<(u32, u32)> = bears.iter().copied().filter(|(joint, _)| *joint > 0).collect();
        for (joint, group) in told {
            let (row, group) = (joint as usize, group as usize);
            let original = *first[group].get_or_insert(joint);
            if original < joint {
                copy_of[row] = copy_of[row].or(Some(original));
            } else {
                // Of several that are one the first bears the others.
                group_of[row] = group_of[row].or(Some(group));
            }
        }
        for row in (1..joints.len()).rev() {
            let Some(original) = copy_of[row] else { continue };
            let [own, its] = [row, original as usize].map(|row| joints[row].parent.unwrap_or_default());
            let is_told = group_of[own as usize].is_some() || copy_of[own as usize].is_some();
            if own > its && its > 0 && !is_told {
                copy_of[own as usize] = Some(its);
            }
        }
        let known = |row: usize| {
            let original = copy_of[row].map_or(row, |row| row as usize);
            group_of[original].map(|group| named[group].clone())
        };
        Self { known: (0..joints.len()).map(known).collect(), copy_of }
    }

    /// The skeleton with its bones shaped.
    fn shaped(
        &self,
        skeleton: &Skeleton,
        shape_of: impl Fn(&Bone) -> Shape,
    ) -> Result<Skeleton, WorkbenchError> {
        let by = self.known.iter().zip(&self.copy_of).map(|(known, &copy_of)| Shaped {
            shape: known.as_ref().map_or(Shape::default(), &shape_of),
            copy_of,
        });
        Ok(shaped(skeleton, &by.collect::<Vec<_>>())?)
    }
}

/// What has grown as it is when each bone is shaped so; growth that is not as it grew is shaped once more.
///
/// # Errors
/// [`WorkbenchError::Structure`], which turns of skeletons do not meet.
pub fn shape(growth: &Growth, shape_of: impl Fn(&Bone) -> Shape) -> Result<Skeleton, WorkbenchError> {
    growth.bones.shaped(&growth.skeleton, shape_of)
}

/// A skeleton with the hand work of a project laid over it.
pub(super) struct Laid {
    pub(super) skeleton: Skeleton,
    pub(super) bones: Bones,
    pub(super) hand: Hand,
    /// What is to be said of it.
    pub(super) notes: Vec<String>,
}

/// Lays the hand work of a document over a skeleton of a clustering's groups, which are known by these bones. A root that
/// stands by hand is told of. Without a document it stays as it grew.
pub(super) fn lay(
    skeleton: Skeleton,
    bears: &[(u32, u32)],
    (clustering, named): (ClusteringId, &[Bone]),
    hands: Option<&Document>,
    root: Option<[f64; 2]>,
) -> Result<Laid, WorkbenchError> {
    let bones = Bones::of(&skeleton, named, bears);
    let shapes: BTreeMap<u32, Shape> =
        hands.into_iter().flat_map(|document| document.shapes(clustering)).collect();
    let shape_of = |bone: &Bone| shapes.get(&bone.node).copied().unwrap_or_default();
    let skeleton = bones.shaped(&skeleton, shape_of)?;
    let own = bones.known.iter().zip(&bones.copy_of).filter(|(_, copy_of)| copy_of.is_none());
    let own: Vec<&Bone> = own.filter_map(|(known, _)| known.as_ref()).collect();
    let is_shaped = |bone: &&&Bone| shapes.contains_key(&bone.node);
    let shaped: Vec<(Bone, Shape)> =
        own.iter().filter(is_shaped).map(|bone| ((*bone).clone(), shape_of(bone))).collect();
    let mut told = Vec::new();
    told.extend(root.map(|[x, y]| format!("root placed by hand at {x:.1}, {y:.1}")));
    if !shaped.is_empty() {
        let names: Vec<&str> = shaped.iter().map(|(bone, _)| &*bone.name).collect();
        told.push(format!("{} shaped by hand: {}", counted(names.len(), "bone"), names.join("; ")));
    }
    let mut notes = Vec::new();
    notes.extend((!told.is_empty()).then(|| told.join("; ")));
    notes.extend(without(shapes.keys().copied(), &own, named));
    Ok(Laid { skeleton, bones, hand: Hand { root, bones: shaped }, notes })
}

/// What is to be said of bones that were shaped by hand and are not there.
fn without(shaped: impl Iterator<Item = u32>, own: &[&Bone], named: &[Bone]) -> Vec<String> {
    let missing: Vec<u32> = shaped.filter(|node| own.iter().all(|bone| bone.node != *node)).collect();
    let here = named.iter().filter(|bone| missing.contains(&bone.node));
    let names: Vec<&str> = here.map(|bone| &*bone.name).collect();
    let mut notes = Vec::new();
    if !names.is_empty() {
        notes.push(format!(
            "{}: shaped by hand, but without a bone of its own here; it is one with what bears it, or the structure builder \
             does not tell of it",
            names.join("; ")
        ));
    }
    if missing.len() > names.len() {
        let n = counted(missing.len() - names.len(), "bone");
        notes.push(format!("{n} shaped by hand, of groups as they were cut or made otherwise"));
    }
    notes
}

/// Which joints bear which groups of what was grown here, as plugins tell it: joints, with rows of groups.
pub(super) fn borne(grown: &Grown, groups: &[Group]) -> Vec<(u32, u32)> {
    let joints = grown.skeleton.joints();
    let mut bears = Vec::new();
    for (row, (group, joint_of)) in (0..).zip(groups.iter().zip(&grown.joint_of)) {
        match group.children.is_empty() {
            false => bears.extend(joint_of.map(|joint| (joint, row))),
            true => {
                let ends = (0..).zip(joints).filter(|(_, joint)| joint.groups.contains(&group.number));
                bears.extend(ends.map(|(joint, _): (u32, _)| (joint, row)));
            }
        }
    }
    bears
}

/// What stands for a project where a plant is wanted.
pub(crate) struct Usual {
    pub(crate) skeleton: Skeleton,
    pub(crate) bones: Bones,
    pub(crate) n_groups: usize,
    pub(crate) notes: Vec<String>,
}

/// As the plugin that is used unless another is named grows it, here, with the project's hand work: whoever wants a plant has
/// no plugins at hand.
///
/// # Errors
/// As [`grow`](super::grow).
pub(crate) fn usual(project: &Project) -> Result<Usual, WorkbenchError> {
    let document = project.document();
    let mut gathered = gather(project, None)?;
    let root = document.root();
    let settings = diener::Settings { root, ..diener::Settings::default() };
    let grown = diener::grow(&gathered.paths, &gathered.groups, &gathered.times, settings)?;
    let bears = borne(&grown, &gathered.groups);
    let known = (gathered.clustering, &gathered.bones[..]);
    let Laid { skeleton, bones, notes, .. } = lay(grown.skeleton, &bears, known, Some(document), root)?;
    let n_groups = gathered.members().len();
    gathered.notes.extend(notes);
    Ok(Usual { skeleton, bones, n_groups, notes: gathered.notes })
}

/// The bones that the groups of a clustering's tree are known by, a group each.
pub(super) fn named<'a>(
    clustering: ClusteringId,
    groups: &[Group],
    name_of: impl Fn(u32) -> Option<&'a str>,
) -> Vec<Bone> {
    let mut below: Vec<Vec<u32>> = vec![Vec::new(); groups.len()];
    for (row, group) in groups.iter().enumerate().rev() {
        if group.children.is_empty() {
            below[row].push(group.number);
        }
        below[row].sort_unstable();
        if let Some(parent) = group.parent {
            let own = below[row].clone();
            below[parent].extend(own);
        }
    }
    let bone = |(group, groups): (&Group, Vec<u32>)| {
        let mut name = match group.children.is_empty() {
            true => format!("group {}", ranges(&groups)),
            false => format!("fork {}", ranges(&groups)),
        };
        if let Some(called) = name_of(group.node) {
            name += &format!(" {called}");
        }
        Bone { clustering, node: group.node, name, groups }
    };
    groups.iter().zip(below).map(bone).collect()
}

/// The bones that the shown groups of a project can have, each with how many are between it and the trunk.
pub(crate) fn named_bones(project: &Project) -> Result<Vec<(Bone, usize)>, WorkbenchError> {
    let Gathered { groups, bones, .. } = gather(project, None)?;
    let mut levels: Vec<usize> = Vec::with_capacity(groups.len());
    groups.iter().for_each(|group| levels.push(group.parent.map_or(0, |parent| levels[parent] + 1)));
    Ok(bones.into_iter().zip(levels).collect())
}
