//! Meshes, and the bones that carry them.

#[cfg(test)]
mod tests;

/// So many bones carry a vertex, at most: engines read no more.
pub const MOST_BONES: usize = 4;

/// Vertices and the triangles between them; z up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Where vertices are.
    pub positions: Vec<[f64; 3]>,
    /// Which way the surface looks there, of length 1: one a vertex, or none at all.
    pub normals: Vec<[f64; 3]>,
    /// Three vertices each, anticlockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Which bones carry a vertex, and how much of it: its weights. They sum up to 1, none is below 0, and of those that are 0
/// the bone is 0, too.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Binding {
    bones: [u16; MOST_BONES],
    weights: [f32; MOST_BONES],
}

impl Binding {
    /// To these bones, each the row of the joint that it ends in, by shares that need not sum up to 1; those that are named
    /// twice are added. The root carries what nothing else does.
    #[must_use]
    pub fn new(shares: [(u16, f64); MOST_BONES]) -> Self {
        let mut summed: [(u16, f64); MOST_BONES] = Default::default();
        let mut n = 0;
        for (bone, share) in shares.into_iter().filter(|(_, share)| share.is_finite() && *share > 0.0) {
            let known = summed[..n].iter().position(|(there, _)| *there == bone);
            let at = known.unwrap_or(n);
            summed[at] = (bone, summed[at].1 + share);
            n += usize::from(known.is_none());
        }
        let total: f64 = summed.iter().map(|(_, share)| share).sum();
        if total <= 0.0 {
            return Self { bones: [0; MOST_BONES], weights: [1.0, 0.0, 0.0, 0.0] };
        }
        summed.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut made = Self::default();
        for (at, (bone, share)) in summed.into_iter().enumerate() {
            let weight = (share / total) as f32;
            if weight > 0.0 {
                (made.bones[at], made.weights[at]) = (bone, weight);
            }
        }
        // To the last bit, which readers look for: what rounding took goes to the largest.
        made.weights[0] = 1.0 - made.weights[1..].iter().sum::<f32>();
        made
    }

    /// Rows of joints; 0 where the weight is 0.
    #[must_use]
    pub fn bones(&self) -> [u16; MOST_BONES] {
        self.bones
    }

    /// How much of the vertex each of [`bones`](Self::bones) carries, most first.
    #[must_use]
    pub fn weights(&self) -> [f32; MOST_BONES] {
        self.weights
    }

    /// Bones and their weights, those above 0.
    pub fn shares(&self) -> impl Iterator<Item = (usize, f64)> {
        let pairs = self.bones.into_iter().zip(self.weights);
        pairs.filter(|(_, weight)| *weight > 0.0).map(|(bone, weight)| (usize::from(bone), f64::from(weight)))
    }
}
