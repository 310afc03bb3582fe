//! Skeletons after Zeng (2015, 5.4.2 and 5.5): joints are centroids of clusters, shifted towards what bears them; copies of
//! that stand in planes through the trunk, and their branches are pushed out of these until they fill an envelope.

mod copies;
mod envelope;
mod push;
#[cfg(test)]
mod tests;

use honami_model::clip::FrameTimes;
use honami_model::skeleton::{Skeleton, placed};

use self::copies::Copies;
pub use self::envelope::Alpha;
use self::envelope::Envelope;
use crate::filmed::{Filmed, Track};
use crate::follow::{Followed, Path};
use crate::tree::Group;
use crate::{Grown, StructureError};

/// Copies without a wish: 3 to 5 suffice (Zeng 5.5.1).
pub const COPIES: u32 = 3;
/// How far joints are shifted without a wish; Zeng gives no number.
pub const SHIFT: f64 = 0.5;

/// Offsets of leaves, a frame each, that copies may carry: 6 GB of them.
const MAX_OFFSETS: u64 = 250_000_000;

/// How to grow.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Where the plant leaves the ground, pixels (right, down); `None`: under the mean of all features, as low as the
    /// lowest of them usually is.
    pub root: Option<[f64; 2]>,
    /// Keep it in the plane of the picture: one copy, not pushed.
    pub is_flat: bool,
    /// How far joints are shifted from the centroids of their clusters towards what bears them: 0 to less than 1 of the way.
    pub shift: f64,
    /// Copies, the one in the picture counted, 1 or more.
    pub copies: u32,
    /// Where branches may be; `None`: in the convex hull of all features and joints. Turned about the trunk it is the
    /// envelope.
    pub envelope: Option<Alpha>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { root: None, is_flat: false, shift: SHIFT, copies: COPIES, envelope: None }
    }
}

/// Grows a skeleton from paths, one for each leaf of the dendrogram that `groups` is the tree of.
///
/// # Errors
/// [`StructureError::NothingSeen`] also where one group alone is never seen, [`StructureError::NoExtent`],
/// [`StructureError::Root`], [`StructureError::Path`], [`StructureError::Shift`], [`StructureError::Copies`],
/// [`StructureError::TooManyLeaves`]; [`StructureError::NoWhite`] and [`StructureError::AllCut`] of an envelope that leaves nothing.
pub fn grow(
    paths: &[Path],
    groups: &[Group],
    times: &FrameTimes,
    settings: &Settings,
) -> Result<Grown, StructureError> {
    if !(0.0..1.0).contains(&settings.shift) {
        return Err(StructureError::Shift(settings.shift));
    }
    if settings.copies == 0 {
        return Err(StructureError::Copies);
    }
    let n_copies = if settings.is_flat { 1 } else { settings.copies };
    let n_offsets = paths.len() as u64 * u64::from(times.len()) * u64::from(n_copies);
    if n_copies > 1 && n_offsets > MAX_OFFSETS {
        return Err(StructureError::TooManyLeaves {
            copies: n_copies,
            gigabytes: (n_offsets * 24).div_ceil(1_000_000_000),
        });
    }
    let filmed = Filmed::of(paths, groups, times, settings.root)?;
    let at = shifted(&filmed, settings.shift);
    let bones = filmed.bones(&at)?;
    let (n_collapsed, leaves) = (bones.n_collapsed, filmed.leaves(&at, &bones));
    let flat_joint_of = bones.joint_of.clone();
    let flat = filmed.skeleton(bones, leaves)?;
    let n_joints = flat.joints().len();
    let places = flat.places(flat.rest());
    let trunk = trunk(&flat);
    let axis = places[trunk.iter().rposition(|&is_trunk| is_trunk).unwrap_or_default()][0];
    let crown = crown(&filmed, &places);
    let (envelope, kept) = match &settings.envelope {
        Some(alpha) => {
            let envelope = Envelope::painted(alpha, axis).ok_or(StructureError::NoWhite)?;
            let kept = within(&flat, &trunk, &places, &envelope);
            (envelope, kept)
        }
        None => (Envelope::around(&crown, axis), vec![true; n_joints]),
    };
    if trunk.contains(&false) && kept == trunk {
        return Err(StructureError::AllCut);
    }
    let mut copies = Copies::of(&flat, &trunk, &kept, axis, n_copies);
    if !settings.is_flat {
        let (low, high) = crown
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at[0]), high.max(at[0])));
        copies.push(&envelope, high - low);
    }
    let n_forks = groups.iter().filter(|group| !group.children.is_empty()).count();
    Ok(Grown {
        skeleton: copies.skeleton()?,
        places: filmed.places(),
        joint_of: flat_joint_of.iter().map(|&joint| row_of(joint, &kept)).collect(),
        alphas: vec![1.0 - settings.shift; n_forks],
        n_collapsed,
        n_cut: kept.iter().filter(|kept| !**kept).count(),
    })
}

/// Where every group is in every frame: in the centroid of its features, shifted along the line to where what bears it has
/// been shifted to (Zeng 5.4.2). Zeng's share is 1 less that of the thesis (errata E22).
fn shifted(filmed: &Filmed, share: f64) -> Vec<Track> {
    let centre = |followed: &Option<Followed>| {
        followed.iter().flat_map(|followed| &followed.centre).map(|&at| placed(at, 0.0)).collect::<Track>()
    };
    // Every feature counts once, wherever in the hierarchy.
    let mut n_features: Vec<usize> = filmed.groups.iter().map(|group| group.leaves.len()).collect();
    for (row, group) in filmed.groups.iter().enumerate().rev() {
        n_features[row] += group.children.iter().map(|&child| n_features[child]).sum::<usize>();
    }
    let mut at = filmed.forks(filmed.followed.iter().map(centre).collect(), |row| n_features[row] as f64);
    let base = filmed.base();
    for (row, group) in filmed.groups.iter().enumerate() {
        for frame in 0..at[row].len() {
            let from = group.parent.map_or(base, |parent| at[parent][frame]);
            let to = at[row][frame];
            at[row][frame] = std::array::from_fn(|axis| to[axis] + share * (from[axis] - to[axis]));
        }
    }
    at
}

/// Whether each joint is of the trunk: the root, and joints on it as long as it does not fork.
fn trunk(skeleton: &Skeleton) -> Vec<bool> {
    let joints = skeleton.joints();
    let mut trunk = vec![false; joints.len()];
    let mut top = Some(0);
    while let Some(row) = top {
        trunk[row] = true;
        let mut borne = (0..joints.len()).filter(|&on| joints[on].parent == Some(row as u32));
        top = borne.next().filter(|_| borne.next().is_none());
    }
    trunk
}

/// Where features usually are, and joints at rest; pixels (right, up).
fn crown(filmed: &Filmed, places: &[[f64; 3]]) -> Vec<[f64; 2]> {
    let features = filmed.usual().into_iter().map(|[x, y]| [x, -y]);
    features.chain(places.iter().map(|at| [at[0], at[2]])).collect()
}

/// Whether each joint is kept: those of the trunk are, and others within the envelope, on what is kept.
fn within(skeleton: &Skeleton, trunk: &[bool], places: &[[f64; 3]], envelope: &Envelope) -> Vec<bool> {
    let mut kept: Vec<bool> = Vec::with_capacity(trunk.len());
    for (row, joint) in skeleton.joints().iter().enumerate() {
        let is_borne = joint.parent.is_none_or(|parent| kept[parent as usize]);
        kept.push(trunk[row] || (is_borne && envelope.holds(places[row])));
    }
    kept
}

/// The row of a joint where only those that are kept are left, as in the copy in the picture, which comes first.
fn row_of(joint: u32, kept: &[bool]) -> Option<u32> {
    let row = joint as usize;
    kept[row].then(|| kept[..row].iter().filter(|kept| **kept).count() as u32)
}
