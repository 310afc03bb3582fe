//! What really happens in the picture: where every leaf is, and which branch carries it.

/// Where a leaf is in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct At {
    /// Of the leaf's centre, pixels to the right of the centre of the top-left pixel.
    pub x: f64,
    /// Of the leaf's centre, pixels below the centre of the top-left pixel.
    pub y: f64,
    /// The centre lies in the picture and no nearer leaf or branch covers it.
    pub visible: bool,
}

/// One leaf through the clip.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafTruth {
    /// Its index in [`Truth::leaves`].
    pub id: u32,
    /// The branch it hangs on.
    pub branch: u32,
    /// Where it is, one entry a frame.
    pub path: Vec<At>,
}

/// One branch and how it sways.
#[derive(Clone, Debug, PartialEq)]
pub struct BranchTruth {
    /// Its index in [`Truth::branches`].
    pub id: u32,
    /// The branch it grows on; `None` for the stem. A parent comes before its children.
    pub parent: Option<u32>,
    /// 0 for the stem, 1 for limbs, 2 for branches, 3 for twigs; leaves hang on orders 2 and 3.
    pub order: u32,
    /// Frequencies of its own sway, strongest first, Hz.
    pub mode_hz: Vec<f64>,
    /// Where it grows from the parent in still air, pixels (x, y).
    pub base: [f64; 2],
    /// Where it ends in still air, pixels (x, y).
    pub tip: [f64; 2],
}

/// All leaves and branches of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Leaves by id; those of one branch lie together.
    pub leaves: Vec<LeafTruth>,
    /// Branches by id.
    pub branches: Vec<BranchTruth>,
}

impl Truth {
    /// Frequencies at which a branch moves in the picture, Hz: its own, then those of all it rides on.
    ///
    /// # Panics
    /// When there is no such branch.
    #[must_use]
    #[track_caller]
    pub fn modes_of(&self, branch: u32) -> Vec<f64> {
        std::iter::successors(Some(branch), |&id| self.branches[id as usize].parent)
            .flat_map(|id| self.branches[id as usize].mode_hz.iter().copied())
            .collect()
    }
}
