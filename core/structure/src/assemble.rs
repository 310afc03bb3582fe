//! Plants put together of branches: every bone that bears no other gets one of a library, as large as the bone wants it
//! (thesis 4.5.2, where a user does it by hand).

#[cfg(test)]
mod tests;
mod wood;

use std::f64::consts::TAU;

use honami_model::mesh::{Binding, Mesh};
use honami_model::skeleton::Skeleton;
use honami_model::turn::{Turn, dot, norm};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

pub use self::wood::branches;
use crate::StructureError;
use crate::bind::{foot, less, reach, used};

/// Vertices at least so far from the foot, of the farthest, are where a branch ends.
const OUTERMOST: f64 = 0.9;
/// So many of its vertices, or of a bone's leaves, say how wide it is and how far it reaches: not the one that is farthest.
const MOST: f64 = 0.9;
/// A branch that goes nowhere: from its foot to its tip, of how far its farthest vertex is.
const NOTHING: f64 = 1e-6;
/// Nothing that is smaller can be told from a point, lengths of the library.
const TINIEST: f64 = 1e-9;
/// A pivot lies so near a branch at most, and as far at least from its middle, of the diagonal of its box.
const SLACK: f64 = 0.05;
/// No branch is slimmer, in widths of its length: a line has no width at all.
const SLIMMEST: f64 = 1e-3;
/// Branches whose logarithms of breadth are no more than so much worse than the best are as good.
const ALIKE: f64 = 0.25;
/// What bears a branch carries some of it so near its foot, of its length; half of it at the foot, as of two bones that go on.
const NEAR: f64 = 0.1;
/// So that branches are not drawn as angles of siblings are.
const STREAM: u64 = 0x6772_6166_7473;

/// What tells how a branch is placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch {
    /// Where it begins.
    foot: [f64; 3],
    /// Which way it goes from there, unit.
    axis: [f64; 3],
    /// From the foot to its tip, more than 0.
    length: f64,
    /// How wide it is, of its length.
    breadth: f64,
}

impl Branch {
    /// Of a mesh that begins at `foot`, or at what [`foot`] says.
    ///
    /// Its tip is the mean of the vertices that are at least nine tenths as far from the foot as the farthest. It is as wide
    /// as nine tenths of its vertices are near the line between. Vertices that no triangle uses do not count.
    ///
    /// # Errors
    /// [`StructureError::NoMesh`], [`StructureError::Vertex`]; [`StructureError::NoBranch`] where tip and foot are one place.
    pub fn of(mesh: &Mesh, begin: Option<[f64; 3]>) -> Result<Self, StructureError> {
        // That looks at the mesh, too.
        let lowest = foot(mesh)?;
        let foot = begin.unwrap_or(lowest);
        let vertices: Vec<[f64; 3]> = used(mesh).into_iter().map(|place| less(place, foot)).collect();
        let farthest = vertices.iter().map(|v| norm(*v)).fold(0.0, f64::max);
        let outermost = || vertices.iter().filter(|v| norm(**v) >= OUTERMOST * farthest);
        let n = outermost().count() as f64;
        let tip: [f64; 3] = std::array::from_fn(|axis| outermost().map(|v| v[axis]).sum::<f64>() / n);
        let length = norm(tip);
        // What cancels is not 0 to the last bit.
        if farthest < TINIEST || length < NOTHING * farthest {
            return Err(StructureError::NoBranch { farthest });
        }
        let axis = tip.map(|v| v / length);
        let breadth = most(vertices.iter().map(|v| beside(*v, axis))) / length;
        Ok(Self { foot, axis, length, breadth })
    }

    /// Whether a mesh may begin at its pivot, which is where whoever made it holds it: within the mesh's box, or outside by a
    /// twentieth of the diagonal, and not that near to its middle, where files have it that were centred.
    #[must_use]
    pub fn may_begin(mesh: &Mesh, pivot: [f64; 3]) -> bool {
        let used = used(mesh);
        let sides: [[f64; 2]; 3] = std::array::from_fn(|axis| reach(&used, axis));
        let slack = SLACK * norm(sides.map(|[low, high]| high - low));
        let middle = sides.map(|[low, high]| f64::midpoint(low, high));
        let is_within = |(v, [low, high]): (f64, [f64; 2])| (low - slack..=high + slack).contains(&v);
        pivot.into_iter().zip(sides).all(is_within) && norm(less(pivot, middle)) > slack
    }

    /// How wide it is, of its length.
    #[must_use]
    pub fn breadth(&self) -> f64 {
        self.breadth
    }
}

/// A branch on the bone that bears it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Graft {
    /// Row of the joint that the bone ends in.
    pub bone: usize,
    /// Number of the branch in the library.
    pub branch: usize,
    /// So many times as large as there.
    pub scale: f64,
    foot: [f64; 3],
    /// Near the foot, in lengths of the library.
    near: f64,
    turn: Turn,
    base: [f64; 3],
    /// The bone of row 0 is none: the root carries.
    bones: [u16; 2],
}

impl Graft {
    /// Where it has what of the library is at a place.
    #[must_use]
    pub fn apply(&self, place: [f64; 3]) -> [f64; 3] {
        let turned = self.turn.apply(less(place, self.foot));
        std::array::from_fn(|axis| self.base[axis] + self.scale * turned[axis])
    }

    /// Where it has what of the library goes along the three axes by 1, from where that begins.
    #[must_use]
    pub fn axes(&self) -> [[f64; 3]; 3] {
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
            .map(|axis| self.turn.apply(axis).map(|v| self.scale * v))
    }

    /// Which way it has what of the library points so.
    #[must_use]
    pub fn turned(&self, direction: [f64; 3]) -> [f64; 3] {
        self.turn.apply(direction)
    }

    /// Which bones carry what of the library is at a place: its own, and near its foot the one that bears it, too.
    #[must_use]
    pub fn binding(&self, place: [f64; 3]) -> Binding {
        let far = (norm(less(place, self.foot)) / self.near).min(1.0);
        let bearer = 0.5 * (1.0 - far).powi(2);
        Binding::new([(self.bones[0], 1.0 - bearer), (self.bones[1], bearer), (0, 0.0), (0, 0.0)])
    }
}

/// Puts a branch of a library on every bone of a skeleton at rest that bears no other: its foot where the bone begins, and its
/// tip as far along the bone as this goes, or as nine tenths of its leaves are, in the mean over the frames, if these reach
/// beyond. It is turned about the bone at random.
///
/// Of the library it is one whose breadth is that of the leaves about the bone, or, of several that are nearly as good, any; of
/// a bone without leaves any of all. The `number`-th sibling of a seed has other ones.
///
/// # Errors
/// [`StructureError::NoBranches`] for an empty library, [`StructureError::TooManyBones`] for more than 65535 joints.
pub fn assemble(
    rest: &Skeleton,
    library: &[Branch],
    seed: u64,
    number: u32,
) -> Result<Vec<Graft>, StructureError> {
    if library.is_empty() {
        return Err(StructureError::NoBranches);
    }
    let joints = rest.joints();
    if u16::try_from(joints.len()).is_err() {
        return Err(StructureError::TooManyBones(joints.len()));
    }
    let mut rng = Pcg64Mcg::seed_from_u64(seed ^ STREAM ^ (u64::from(number) << 32));
    let places = rest.places(rest.rest());
    let leaves = leaves(rest, &places);
    let mut grafts = Vec::new();
    for (bone, _) in rest.are_tips().iter().enumerate().skip(1).filter(|(_, is_tip)| **is_tip) {
        let parent = joints[bone].parent.unwrap_or_default();
        let (base, along) = (places[parent as usize], rest.rest()[bone]);
        let borne = || leaves[bone].iter().map(|leaf| less(*leaf, base));
        let length = joints[bone].length.max(most(borne().map(|leaf| dot(leaf, along))));
        let breadth = most(borne().map(|leaf| beside(leaf, along))) / length;
        let (drawn, angle) = (rng.random::<f64>(), rng.random::<f64>());
        let branch = choose(library, (!leaves[bone].is_empty()).then_some(breadth), drawn);
        let Branch { foot, axis, length: own, .. } = library[branch];
        grafts.push(Graft {
            bone,
            branch,
            scale: length / own,
            foot,
            near: NEAR * own,
            turn: Turn::between(axis, along).after(&Turn::about(axis, TAU * angle)),
            base,
            bones: [bone as u16, parent as u16],
        });
    }
    Ok(grafts)
}

/// The branch that `drawn`, 0 to less than 1, says of those that are best.
fn choose(library: &[Branch], wanted: Option<f64>, drawn: f64) -> usize {
    let off = |branch: &Branch| {
        wanted.map_or(0.0, |wanted| (branch.breadth.max(SLIMMEST) / wanted.max(SLIMMEST)).ln().abs())
    };
    let least = library.iter().map(off).fold(f64::INFINITY, f64::min);
    let good: Vec<usize> = (0..library.len()).filter(|row| off(&library[*row]) <= least + ALIKE).collect();
    good[((drawn * good.len() as f64) as usize).min(good.len() - 1)]
}

/// Where the leaves of every joint are, in the mean over the frames.
fn leaves(rest: &Skeleton, places: &[[f64; 3]]) -> Vec<Vec<[f64; 3]>> {
    let mut leaves = vec![Vec::new(); places.len()];
    for leaf in rest.leaves() {
        let n = leaf.offsets.len().max(1) as f64;
        let mean = |axis: usize| leaf.offsets.iter().map(|offset| offset[axis]).sum::<f64>() / n;
        let joint = leaf.joint as usize;
        leaves[joint].push(std::array::from_fn(|axis| places[joint][axis] + mean(axis)));
    }
    leaves
}

/// How far a place is from a line through the origin.
fn beside(place: [f64; 3], line: [f64; 3]) -> f64 {
    let along = dot(place, line);
    norm(std::array::from_fn(|axis| place[axis] - along * line[axis]))
}

/// What nine tenths are at most; 0 of none.
fn most(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let n = (MOST * values.len() as f64).ceil() as usize;
    values.get(n.saturating_sub(1)).copied().unwrap_or_default()
}
