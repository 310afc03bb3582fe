//! Skeletons after Diener (thesis 4.4): groups are ellipses, forks the means of what they bear, shifted towards the root
//! until bones change their length least; then bones of constant length are moved so that tips are where their groups are.

mod shift;
#[cfg(test)]
mod tests;

use honami_model::clip::FrameTimes;
use honami_model::skeleton::{Leaf, placed};

use crate::ellipse::Ellipse;
use crate::filmed::{Filmed, Track};
use crate::follow::{Followed, Path};
use crate::tree::Group;
use crate::{Grown, StructureError};

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

/// Grows a skeleton from paths, one for each leaf of the dendrogram that `groups` is the tree of.
///
/// # Errors
/// [`StructureError::NothingSeen`] also where one group alone is never seen, [`StructureError::NoExtent`],
/// [`StructureError::Root`], [`StructureError::Path`].
pub fn grow(
    paths: &[Path],
    groups: &[Group],
    times: &FrameTimes,
    settings: Settings,
) -> Result<Grown, StructureError> {
    let filmed = Filmed::of(paths, groups, times, settings.root)?;
    let mut at = centres(&filmed, settings.is_flat);
    let alphas = shift::shift(groups, filmed.base(), &mut at);
    let mut bones = filmed.bones(&at)?;
    let mut leaves = filmed.leaves(&at, &bones);
    if at.iter().flatten().any(|place| place[1].abs() > 0.0) {
        leaves.extend(mirrored(&leaves, bones.mirror()));
    }
    let (n_collapsed, joint_of) = (bones.n_collapsed, bones.joint_of.iter().copied().map(Some).collect());
    let skeleton = filmed.skeleton(bones, leaves)?;
    Ok(Grown { skeleton, places: filmed.places(), joint_of, alphas, n_collapsed, n_cut: 0 })
}

/// Where every group is in every frame: terminal ones where their features are and, unless flat, on the front of the
/// ellipsoid of the whole plant (thesis 4.4.3); forks in the mean of their two parts (4.4.2).
fn centres(filmed: &Filmed, is_flat: bool) -> Vec<Track> {
    let whole: Vec<Option<Ellipse>> =
        filmed.features.iter().map(|frame| if is_flat { None } else { Ellipse::of(frame) }).collect();
    let on_front =
        |(&at, whole): (&[f64; 2], &Option<Ellipse>)| placed(at, -whole.map_or(0.0, |whole| whole.depth(at)));
    let terminal = |followed: &Option<Followed>| {
        let centre = followed.iter().flat_map(|followed| &followed.centre);
        centre.zip(&whole).map(on_front).collect::<Track>()
    };
    let at = filmed.followed.iter().map(terminal).collect();
    filmed.forks(at, |_| 1.0)
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
