//! Structure builders: plugins that grow the branches behind grouped tracks. Pixels; x right, y away from the camera, z up,
//! right-handed: a place is seen in the picture at (x, -z).

use crate::{Cx, Gray, Info, Params, Result, Tracks};

/// Grows a skeleton from tracks and their groups.
pub trait Structure: Sized + Send + 'static {
    /// Its parameters, made by [`params!`](crate::params!) (or `()`).
    type Params: Params;
    /// Id, name and description.
    const INFO: Info;

    /// Grows it.
    ///
    /// # Errors
    /// Whatever keeps it from that: nothing is seen, the root lies where all tracks are.
    fn grow(params: &Self::Params, filmed: &Filmed<'_>, cx: &Cx<'_>) -> Result<Skeleton>;
}

/// What a structure builder draws on.
#[derive(Clone, Copy, Debug)]
pub struct Filmed<'a> {
    /// The tracks.
    pub tracks: Tracks<'a>,
    /// Their groups.
    pub groups: Groups<'a>,
    /// Where the plant leaves the ground, pixels (right, down); `None`: nobody has said.
    pub root: Option<[f64; 2]>,
    /// Non-zero where branches may be, of the frames' size; `None`: everywhere.
    pub mask: Option<Gray<'a>>,
}

/// The tree that a hierarchy of tracks was cut into.
#[derive(Clone, Copy, Debug)]
pub struct Groups<'a> {
    /// Of every group the row of the one that it is part of, before its own; -1 for the whole, row 0.
    pub parents: &'a [i32],
    /// Of every track the row of its group, which has no parts; -1 for none.
    pub of: &'a [i32],
}

impl<'a> Groups<'a> {
    /// Number of groups, those with parts counted.
    #[must_use]
    pub fn len(&self) -> usize {
        self.parents.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.parents.is_empty()
    }

    /// Row of the group that a group is part of; `None` for the whole.
    #[must_use]
    pub fn parent(&self, group: usize) -> Option<usize> {
        self.parents.get(group).and_then(|&parent| usize::try_from(parent).ok())
    }

    /// Rows of the parts of a group; none of one that has tracks.
    pub fn parts(&self, group: usize) -> impl Iterator<Item = usize> + use<'a> {
        rows_of(self.parents, group)
    }

    /// Rows of the tracks of a group without parts.
    pub fn tracks(&self, group: usize) -> impl Iterator<Item = usize> + use<'a> {
        rows_of(self.of, group)
    }
}

/// The rows that name `row`.
fn rows_of(rows: &[i32], row: usize) -> impl Iterator<Item = usize> {
    let is_it = move |of: i32| usize::try_from(of).is_ok_and(|of| of == row);
    rows.iter().enumerate().filter(move |(_, of)| is_it(**of)).map(|(k, _)| k)
}

/// Joints at the ends of bones of constant length, and where each bone points in every frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skeleton {
    /// Where the root stands, in all frames.
    pub root: [f64; 3],
    /// Each after its parent, the root first; two at least.
    pub joints: Vec<Joint>,
    /// Of length 1, joint after joint in frame after frame, as in the times. What stands for the root says nothing.
    pub pose: Vec<[f64; 3]>,
    /// What they carry.
    pub leaves: Vec<Leaf>,
}

/// The end of a bone; the root has none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Joint {
    /// Row of the joint that its bone begins at, before its own; `None` for the root, row 0.
    pub parent: Option<u32>,
    /// Length of its bone, pixels: above 0; 0 for the root.
    pub length: f64,
    /// Rows of the groups that it has become; those with parts need not be told of. Of joints with the same group, which are
    /// copies, the first is the one in the picture.
    pub groups: Vec<u32>,
}

/// A track that a joint carries.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Leaf {
    /// Row of the joint.
    pub joint: u32,
    /// Row of the track.
    pub track: u32,
    /// From the joint to it, pixels, a frame each.
    pub offsets: Vec<[f64; 3]>,
}
