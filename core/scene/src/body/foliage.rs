//! Leaves: where they hang on the ends of branches. They are drawn, and weigh nothing: what leaves weigh and how wind presses
//! on them is in the beams.

use honami_mechanics::{Beams, Vector};
use rand::{RngExt as _, SeedableRng as _};

use super::light::Light;
use super::{Leaf, Ring};
use crate::tubes::beside;

/// Leaves of a plant, where nobody says how many: so many, shared by the ends of its branches.
const USUAL: f64 = 14_000.0;
const MOST_OF_END: f64 = 14.0;
/// Length of a leaf, where nobody says: of the plant's height; no longer than so many metres.
const LENGTH: f64 = 0.026;
const LONGEST: f64 = 0.3;
/// Of its length.
const BREADTH: f32 = 0.45;
/// From one leaf to the next about the branch (the golden angle), radians.
const AROUND: f64 = 2.399_963_229_728_653;
/// Of the end segment, from its tip, leaves hang on so much.
const SPREAD: f64 = 0.9;

/// How many leaves, and how large.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foliage {
    /// Leaves on the end of every branch; 0 leaves it bare.
    pub per_end: u32,
    /// Metres.
    pub length: f64,
    /// Of where each hangs.
    pub seed: u64,
}

/// A leaf on the whole plant.
pub(super) struct Hung {
    /// Of the beams, at the tip of the segment on which it hangs.
    pub(super) node: u32,
    /// Where it hangs, metres from the root.
    pub(super) at: Vector,
    pub(super) tip: Vector,
    pub(super) up: Vector,
    pub(super) length: f32,
    pub(super) chance: f32,
}

impl Foliage {
    /// As many as a crown looks full with.
    #[must_use]
    pub fn usual(beams: &Beams) -> Self {
        let root = beams.position(0);
        let size = (0..beams.len()).map(|node| (beams.position(node) - root).norm()).fold(0.0, f64::max);
        let per_end = (USUAL / beams.ends().len().max(1) as f64).clamp(1.0, MOST_OF_END).round() as u32;
        Self { per_end, length: (LENGTH * size).min(LONGEST), seed: 1 }
    }

    /// All leaves: round the last segment of every branch, the stalks up and outward, the blades more or less level.
    pub(super) fn hang(&self, beams: &Beams) -> Vec<Hung> {
        let mut chance = rand_pcg::Pcg64Mcg::seed_from_u64(self.seed);
        let root = beams.position(0);
        let mut hung = Vec::new();
        for end in beams.ends() {
            let tip = beams.position(end as usize) - root;
            let base = beams.parent(end as usize).map_or(tip, |base| beams.position(base as usize) - root);
            let along = (tip - base).try_normalize(1e-9).unwrap_or_else(Vector::z);
            let side = beside(&along);
            let begin = chance.random_range(0.0..std::f64::consts::TAU);
            for k in 0..self.per_end {
                let mut off = |by: f64| chance.random_range(-by..by);
                let (sin, cos) = (begin + AROUND * f64::from(k) + off(0.3)).sin_cos();
                let out = side * cos + along.cross(&side) * sin;
                let share = SPREAD * f64::from(k) / f64::from(self.per_end);
                let at = tip - (tip - base) * share;
                let way = (along * (0.55 + off(0.25)) + out + Vector::z() * off(0.35)).normalize();
                let level = Vector::z() + Vector::new(off(0.5), off(0.5), 0.0);
                let up = (level - way * level.dot(&way)).try_normalize(1e-3).unwrap_or_else(|| beside(&way));
                let length = (self.length * (1.0 + off(0.25))) as f32;
                let chance = chance.random_range(0.0..1.0);
                hung.push(Hung { node: end, at, tip: way, up, length, chance });
            }
        }
        hung
    }
}

/// Of a level: a share of all leaves, larger by as much as there are fewer, each on the ring of the nearest node that is
/// there.
pub(super) fn of_level(
    hung: &[Hung],
    beams: &Beams,
    rows: &[u32],
    (rings, branches): (&[Ring], &[u32]),
    share: f64,
    light: &Light,
) -> Vec<Leaf> {
    // Of every node its ring in its own branch, and not that at the foot of a branch that it bears.
    let mut ring_of = vec![u32::MAX; rows.len()];
    let mut first = 0;
    for n in branches {
        for ring in (first..first + n).rev() {
            let own = &mut ring_of[rings[ring as usize].node as usize];
            if ring > first || *own == u32::MAX {
                *own = ring;
            }
        }
        first += n;
    }
    let larger = (1.0 / share).sqrt() as f32;
    let mut seen = Vec::new();
    // Those alike in number everywhere: the fraction of a share is carried on.
    let mut carried = 0.0;
    for leaf in hung {
        carried += share;
        if carried < 1.0 - 1e-9 {
            continue;
        }
        carried -= 1.0;
        let mut node = leaf.node;
        while ring_of[rows[node as usize] as usize] == u32::MAX {
            let Some(parent) = beams.parent(node as usize) else { break };
            node = parent;
        }
        let ring = ring_of[rows[node as usize] as usize];
        let Some(on) = rings.get(ring as usize) else { continue };
        let at = leaf.at.cast::<f32>();
        seen.push(Leaf {
            ring,
            base: std::array::from_fn(|axis| at[axis] - on.rest[axis]),
            tip: leaf.tip.cast::<f32>().into(),
            up: leaf.up.cast::<f32>().into(),
            length: leaf.length * larger,
            breadth: BREADTH,
            chance: leaf.chance,
            open: light.at(&leaf.at),
        });
    }
    seen
}
