//! What is filmed of a plant, whatever skeleton is put behind it: its groups followed, all features in every frame, where it
//! leaves the ground; and the skeleton once places of groups are known.

use honami_model::clip::FrameTimes;
use honami_model::skeleton::{Leaf, Skeleton, placed};

use crate::StructureError;
use crate::bones::Bones;
use crate::ellipse::Ellipse;
use crate::follow::{Followed, Path, follow, mean};
use crate::tree::Group;

/// Places of a group, a frame each.
pub(crate) type Track = Vec<[f64; 3]>;

/// A plant as it is seen.
#[derive(Debug)]
pub(crate) struct Filmed<'a> {
    paths: &'a [Path],
    pub(crate) groups: &'a [Group],
    times: &'a FrameTimes,
    /// Terminal groups over the clip; forks have no leaves, and are followed by what they bear.
    pub(crate) followed: Vec<Option<Followed>>,
    /// Where all features of all groups are, frame by frame, pixels (right, down).
    pub(crate) features: Vec<Vec<[f64; 2]>>,
    /// Where it leaves the ground, pixels (right, down).
    root: [f64; 2],
}

impl<'a> Filmed<'a> {
    /// Follows all groups. The root is as given, or under the mean of all features, as low as the lowest usually is.
    pub(crate) fn of(
        paths: &'a [Path],
        groups: &'a [Group],
        times: &'a FrameTimes,
        root: Option<[f64; 2]>,
    ) -> Result<Self, StructureError> {
        check(paths, times.len())?;
        let members = |group: &Group| group.leaves.iter().map(|&leaf| &paths[leaf]).collect::<Vec<_>>();
        let followed: Vec<Option<Followed>> = groups.iter().map(|group| follow(&members(group))).collect();
        let is_blind =
            |(group, followed): (&Group, &Option<Followed>)| group.children.is_empty() && followed.is_none();
        if groups.is_empty() || groups.iter().zip(&followed).any(is_blind) {
            return Err(StructureError::NothingSeen);
        }
        let features = features(paths, groups, &followed, times.len() as usize);
        let root = match root {
            Some(root) => root,
            None => lowest(&features).ok_or(StructureError::NothingSeen)?,
        };
        if !root.iter().all(|v| v.is_finite()) {
            return Err(StructureError::Root { x: root[0], y: root[1] });
        }
        Ok(Self { paths, groups, times, followed, features, root })
    }

    /// Where it leaves the ground.
    pub(crate) fn base(&self) -> [f64; 3] {
        placed(self.root, 0.0)
    }

    /// From the centre of its group to where each path usually is; `None` for those in no group.
    pub(crate) fn places(&self) -> Vec<Option<[f64; 2]>> {
        let mut places = vec![None; self.paths.len()];
        for (group, followed) in self.groups.iter().zip(&self.followed) {
            let usual = followed.iter().flat_map(|followed| followed.places.iter().copied());
            group.leaves.iter().zip(usual).for_each(|(&leaf, place)| places[leaf] = Some(place));
        }
        places
    }

    /// Where every feature is in the mean over the clip, pixels (right, down).
    pub(crate) fn usual(&self) -> Vec<[f64; 2]> {
        usual(&self.features)
    }

    /// Puts every fork in the mean of its parts, which count as `weight` says of their rows; places of terminal groups stay.
    pub(crate) fn forks(&self, mut at: Vec<Track>, weight: impl Fn(usize) -> f64) -> Vec<Track> {
        // Parts come after their wholes: from behind, each is known before it is wanted.
        for (row, group) in
            self.groups.iter().enumerate().rev().filter(|(_, group)| !group.children.is_empty())
        {
            let all = group.children.iter().map(|&child| weight(child)).sum::<f64>();
            let mean = |frame: usize| {
                let parts = group.children.iter().map(|&child| (weight(child) / all, at[child][frame]));
                parts.fold([0.0; 3], |sum, (share, place)| {
                    std::array::from_fn(|axis| sum[axis] + share * place[axis])
                })
            };
            at[row] = (0..self.features.len()).map(mean).collect();
        }
        at
    }

    /// Bones from the root to where groups are, and on which of them which groups are.
    pub(crate) fn bones(&self, at: &[Track]) -> Result<Bones, StructureError> {
        let mut bones = Bones::along(self.groups, self.base(), at);
        if bones.joints.len() < 2 {
            return Err(StructureError::NoExtent { x: self.root[0], y: self.root[1] });
        }
        for (group, joint) in self.groups.iter().zip(&bones.joint_of) {
            let tracks = group.leaves.iter().map(|&leaf| self.paths[leaf].track);
            let joint = &mut bones.joints[*joint as usize];
            joint.groups.extend((!group.leaves.is_empty()).then_some(group.number));
            joint.tracks.extend(tracks);
        }
        Ok(bones)
    }

    /// Features on the ellipsoids of their groups (thesis 4.4.1), carried by the joints that these have become.
    pub(crate) fn leaves(&self, at: &[Track], bones: &Bones) -> Vec<Leaf> {
        let Self { paths, groups, followed, .. } = self;
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
                let Some(ellipse) = Ellipse::of(&places) else {
                    continue;
                };
                let from = bones.at[joint as usize][frame];
                for (leaf, place) in leaves[first..].iter_mut().zip(places) {
                    let place = placed(place, centre[1] - ellipse.depth(place));
                    leaf.offsets.push(std::array::from_fn(|axis| place[axis] - from[axis]));
                }
            }
        }
        leaves
    }

    /// The skeleton of these bones.
    pub(crate) fn skeleton(&self, bones: Bones, leaves: Vec<Leaf>) -> Result<Skeleton, StructureError> {
        let directions = interleaved(&bones.directions, self.features.len());
        let skeleton = Skeleton::new(self.base(), bones.joints, directions, self.times.clone())?;
        Ok(skeleton.with_leaves(leaves)?)
    }
}

/// Whether every path says something finite, or nothing, of every frame.
fn check(paths: &[Path], n_frames: u32) -> Result<(), StructureError> {
    let is_good = |at: &Option<[f64; 2]>| at.is_none_or(|at| at.iter().all(|v| v.is_finite()));
    match paths.iter().find(|path| path.at.len() != n_frames as usize || !path.at.iter().all(is_good)) {
        Some(path) => Err(StructureError::Path { track: path.track, came: path.at.len(), n_frames }),
        None => Ok(()),
    }
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

/// Where every feature is in the mean over frames.
fn usual(features: &[Vec<[f64; 2]>]) -> Vec<[f64; 2]> {
    let n = features.first().map_or(0, Vec::len);
    (0..n).filter_map(|k| mean(features.iter().map(|frame| frame[k]))).collect()
}

/// Under the mean of all features, as low as the lowest usually is; `None` without any.
fn lowest(features: &[Vec<[f64; 2]>]) -> Option<[f64; 2]> {
    let usual = usual(features);
    let [x, _] = mean(usual.iter().copied())?;
    Some([x, usual.iter().map(|at| at[1]).fold(f64::NEG_INFINITY, f64::max)])
}

/// From a row a joint to a row a frame.
fn interleaved(directions: &[Track], n_frames: usize) -> Vec<[f64; 3]> {
    (0..n_frames).flat_map(|frame| directions.iter().map(move |track| track[frame])).collect()
}
