//! Skeletons after Diener (thesis 4.4): groups are ellipses, forks the means of what they bear, shifted towards the root
//! until bones change their length least; then bones of constant length are moved so that tips are where their groups are.

mod bones;
mod reach;
mod shift;
#[cfg(test)]
mod tests;

use honami_model::clip::FrameTimes;
use honami_model::skeleton::{Leaf, Skeleton, placed};

use self::bones::Bones;
use crate::StructureError;
use crate::ellipse::Ellipse;
use crate::follow::{Followed, Path, follow};
use crate::tree::Group;

/// How to grow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// Where the plant leaves the ground, pixels (right, down); `None`: under the mean of all features, as low as the
    /// lowest of them usually is.
    pub root: Option<[f64; 2]>,
    /// Keep it in the plane of the picture, where else groups lie on the front of an ellipsoid about the whole plant and a
    /// mirror image of all branches on its back.
    pub is_flat: bool,
}

/// A skeleton, and how it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Grown {
    /// The skeleton, with a leaf for every feature.
    pub skeleton: Skeleton,
    /// From the centre of its group to where each path usually is, pixels (right, down); `None` for those in no group.
    pub places: Vec<Option<[f64; 2]>>,
    /// How far each fork stayed from what bears it, 0 to 1 of the way to the mean of what it bears.
    pub alphas: Vec<f64>,
    /// Forks that were one with what bears them, so that more than two bones begin there.
    pub n_collapsed: usize,
}

/// Places of a group, a frame each.
type Track = Vec<[f64; 3]>;

/// Grows a skeleton from paths, one for each leaf of the dendrogram that `groups` is the tree of.
///
/// # Errors
/// [`StructureError::NothingSeen`] also where one group alone is never seen, [`StructureError::NoExtent`],
/// [`StructureError::Root`].
pub fn grow(
    paths: &[Path],
    groups: &[Group],
    times: &FrameTimes,
    settings: Settings,
) -> Result<Grown, StructureError> {
    let n_frames = times.len() as usize;
    let members = |group: &Group| group.leaves.iter().map(|&leaf| &paths[leaf]).collect::<Vec<_>>();
    // Forks have no leaves, and are followed by what they bear.
    let followed: Vec<Option<Followed>> = groups.iter().map(|group| follow(&members(group))).collect();
    let is_blind =
        |(group, followed): (&Group, &Option<Followed>)| group.children.is_empty() && followed.is_none();
    if groups.is_empty() || groups.iter().zip(&followed).any(is_blind) {
        return Err(StructureError::NothingSeen);
    }
    let mut places = vec![None; paths.len()];
    for (group, followed) in groups.iter().zip(&followed) {
        let usual = followed.iter().flat_map(|followed| followed.places.iter().copied());
        group.leaves.iter().zip(usual).for_each(|(&leaf, place)| places[leaf] = Some(place));
    }
    let features = features(paths, groups, &followed, n_frames);
    let root = match settings.root {
        Some(root) => root,
        None => lowest(&features).ok_or(StructureError::NothingSeen)?,
    };
    if !root.iter().all(|v| v.is_finite()) {
        return Err(StructureError::Root { x: root[0], y: root[1] });
    }
    let mut at = centres(groups, &followed, &features, settings.is_flat);
    let base = placed(root, 0.0);
    let alphas = shift::shift(groups, base, &mut at);
    let mut bones = Bones::along(groups, base, &at);
    if bones.joints.len() < 2 {
        return Err(StructureError::NoExtent { x: root[0], y: root[1] });
    }
    for (group, joint) in groups.iter().zip(&bones.joint_of) {
        let tracks = group.leaves.iter().map(|&leaf| paths[leaf].track);
        let joint = &mut bones.joints[*joint as usize];
        joint.groups.extend((!group.leaves.is_empty()).then_some(group.number));
        joint.tracks.extend(tracks);
    }
    let mut leaves = leaves(paths, groups, &followed, &at, &bones);
    if at.iter().flatten().any(|place| place[1].abs() > 0.0) {
        leaves.extend(mirrored(&leaves, bones.mirror()));
    }
    let n_collapsed = bones.n_collapsed;
    let skeleton =
        Skeleton::new(base, bones.joints, interleaved(&bones.directions, n_frames), times.clone())?;
    Ok(Grown { skeleton: skeleton.with_leaves(leaves)?, places, alphas, n_collapsed })
}

/// Where all features of all groups are, frame by frame.
fn features(
    paths: &[Path],
    groups: &[Group],
    followed: &[Option<Followed>],
    n_frames: usize,
) -> Vec<Vec<[f64; 2]>> {
    let of_frame = |frame: usize| {
        let groups =
            groups.iter().zip(followed).filter_map(|(group, followed)| Some((group, followed.as_ref()?)));
        groups
            .flat_map(|(group, followed)| {
                let leaves = group.leaves.iter().enumerate();
                leaves.map(move |(k, &leaf)| followed.at(k, &paths[leaf], frame))
            })
            .collect()
    };
    (0..n_frames).map(of_frame).collect()
}

/// Under the mean of all features, as low as the lowest usually is; `None` without any.
fn lowest(features: &[Vec<[f64; 2]>]) -> Option<[f64; 2]> {
    let n_frames = features.len() as f64;
    let n = features.first().filter(|frame| !frame.is_empty())?.len();
    let usual = |k: usize, axis: usize| features.iter().map(|frame| frame[k][axis]).sum::<f64>() / n_frames;
    let x = (0..n).map(|k| usual(k, 0)).sum::<f64>() / n as f64;
    Some([x, (0..n).map(|k| usual(k, 1)).fold(f64::NEG_INFINITY, f64::max)])
}

/// Where every group is in every frame: terminal ones where their features are and, unless flat, on the front of the
/// ellipsoid of the whole plant (thesis 4.4.3); forks in the mean of their two parts (4.4.2).
fn centres(
    groups: &[Group],
    followed: &[Option<Followed>],
    features: &[Vec<[f64; 2]>],
    is_flat: bool,
) -> Vec<Track> {
    let whole: Vec<Option<Ellipse>> =
        features.iter().map(|frame| if is_flat { None } else { Ellipse::of(frame) }).collect();
    let on_front =
        |(&at, whole): (&[f64; 2], &Option<Ellipse>)| placed(at, -whole.map_or(0.0, |whole| whole.depth(at)));
    let terminal = |followed: &Option<Followed>| {
        let centre = followed.iter().flat_map(|followed| &followed.centre);
        centre.zip(&whole).map(on_front).collect::<Track>()
    };
    let mut at: Vec<Track> = followed.iter().map(terminal).collect();
    // Parts come after their wholes: from behind, each is known before it is wanted.
    for (row, group) in groups.iter().enumerate().rev().filter(|(_, group)| !group.children.is_empty()) {
        let share = 1.0 / group.children.len() as f64;
        let mean = |frame: usize| {
            let places = group.children.iter().map(|&child| at[child][frame]);
            places.fold([0.0; 3], |sum, place| std::array::from_fn(|axis| sum[axis] + share * place[axis]))
        };
        at[row] = (0..features.len()).map(mean).collect();
    }
    at
}

/// Features on the ellipsoids of their groups (thesis 4.4.1), carried by the joints that these have become.
fn leaves(
    paths: &[Path],
    groups: &[Group],
    followed: &[Option<Followed>],
    at: &[Track],
    bones: &Bones,
) -> Vec<Leaf> {
    let mut leaves = Vec::new();
    for (row, (group, followed)) in groups.iter().zip(followed).enumerate() {
        let Some(followed) = followed else { continue };
        let joint = bones.joint_of[row];
        let first = leaves.len();
        let leaf = |&leaf: &usize| Leaf { track: paths[leaf].track, joint, offsets: Vec::new() };
        leaves.extend(group.leaves.iter().map(leaf));
        for (frame, centre) in at[row].iter().enumerate() {
            let of = |(k, &leaf): (usize, &usize)| followed.at(k, &paths[leaf], frame);
            let places: Vec<[f64; 2]> = group.leaves.iter().enumerate().map(of).collect();
            let Some(ellipse) = Ellipse::of(&places) else { continue };
            let from = bones.at[joint as usize][frame];
            for (leaf, place) in leaves[first..].iter_mut().zip(places) {
                let place = placed(place, centre[1] - ellipse.depth(place));
                leaf.offsets.push(std::array::from_fn(|axis| place[axis] - from[axis]));
            }
        }
    }
    leaves
}

/// The leaves of the mirror image, whose joints are `n` rows further on.
fn mirrored(leaves: &[Leaf], n: u32) -> Vec<Leaf> {
    let behind = |leaf: &Leaf| Leaf {
        track: leaf.track,
        joint: if leaf.joint == 0 { 0 } else { leaf.joint + n },
        offsets: leaf.offsets.iter().map(|&[x, y, z]| [x, -y, z]).collect(),
    };
    leaves.iter().map(behind).collect()
}

/// From a row a joint to a row a frame.
fn interleaved(directions: &[Track], n_frames: usize) -> Vec<[f64; 3]> {
    (0..n_frames).flat_map(|frame| directions.iter().map(move |track| track[frame])).collect()
}
