//! Siblings of a skeleton: alike, but not the same (Zeng 5.4.2, 6.2, 6.3).
//!
//! The angle by which a bone turns off the one that bears it is drawn anew, from a distribution of von Mises fitted to all
//! bones of its level and cut off where angles are thin. To which side it turns stays as it is: fitted with their signs,
//! angles of branches to the left and to the right would have a mean between both, where there are none. Lengths stay too.

#[cfg(test)]
mod tests;

use std::f64::consts::PI;

use honami_model::skeleton::Skeleton;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::StructureError;
use crate::turn::{Made, Turn, angle, axis, made_by_all};
use crate::von_mises::{Truncated, VonMises};

/// Angles are drawn from this level on, where there are as many: so the main structure stays (Zeng 5.4.2, step 6).
pub const LEVEL: u32 = 3;
/// Angles are at least so dense, per radian (Zeng 6.2), or half as dense as the densest where these are not much denser.
pub const THRESHOLD: f64 = 0.4;

/// Straight up: what bones at the root turn off.
const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// How siblings may differ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// The first level whose angles are drawn; bones at the root are of level 0. `None`: [`LEVEL`], or the last level of
    /// several bones where that comes before.
    pub level: Option<u32>,
    /// How dense angles are at least, per radian. `None`: [`THRESHOLD`], or half of the highest density of a level where that
    /// is less.
    pub threshold: Option<f64>,
}

/// The angles of one level.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Bones between those of this level and the root.
    pub level: u32,
    /// Bones of this level.
    pub n_bones: usize,
    /// What their angles off the bones that bear them are like, 0 to π as measured.
    pub angles: VonMises,
    /// Angles at least so dense are drawn, per radian.
    pub threshold: f64,
    drawn: Truncated,
}

impl Level {
    /// The least and the largest angle that are drawn, radians: 0 and π at most, where a bone would turn to the other side.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        let (mu, half) = (self.angles.mu, self.drawn.half_width());
        [(mu - half).max(0.0), (mu + half).min(PI)]
    }

    /// The angle of a share of those that are drawn, 0 to 1.
    fn angle(&self, share: f64) -> f64 {
        let [low, high] = [0.0, PI].map(|end| self.drawn.share_below(end));
        self.drawn.quantile(low + share * (high - low)).abs().min(PI)
    }
}

/// What siblings are drawn from.
#[derive(Clone, Debug)]
pub struct Siblings<'a> {
    skeleton: &'a Skeleton,
    /// Of every joint, the level of its bone; that of the root stands for nothing.
    level_of: Vec<u32>,
    levels: Vec<Level>,
}

impl<'a> Siblings<'a> {
    /// Fits the angles at rest. A level of one bone keeps its angle.
    ///
    /// # Errors
    /// [`StructureError::NoLevel`] where no level has two bones, [`StructureError::Threshold`] where a level has no angle that
    /// is dense enough (errata Z5).
    pub fn of(skeleton: &'a Skeleton, settings: Settings) -> Result<Self, StructureError> {
        let level_of = levels(skeleton);
        let deepest = level_of.iter().copied().max().unwrap_or_default();
        let mut angles = vec![Vec::new(); deepest as usize + 1];
        for row in 1..level_of.len() {
            let (from, to) = ends(skeleton, row);
            angles[level_of[row] as usize].push(angle(from, to));
        }
        let fits = (0..).zip(&angles).filter(|(_, angles)| angles.len() > 1);
        let fits: Vec<(u32, usize, VonMises)> =
            fits.filter_map(|(level, angles)| Some((level, angles.len(), VonMises::fit(angles)?))).collect();
        let last = fits.last().map_or(0, |(level, ..)| *level);
        let wanted = settings.level.unwrap_or(LEVEL.min(last));
        let fits: Vec<_> = fits.into_iter().filter(|(level, ..)| *level >= wanted).collect();
        if fits.is_empty() {
            return Err(StructureError::NoLevel { wanted, deepest });
        }
        let least = fits.iter().map(|(.., angles)| angles.peak()).fold(f64::INFINITY, f64::min);
        let level = |&(level, n_bones, angles): &(u32, usize, VonMises)| {
            let most = angles.peak();
            let threshold = settings.threshold.unwrap_or(THRESHOLD.min(most / 2.0));
            let drawn = angles.above(threshold).ok_or(StructureError::Threshold {
                wanted: threshold,
                level,
                most,
                kappa: angles.kappa,
                least: (least * 1000.0).floor() / 1000.0,
            })?;
            Ok(Level { level, n_bones, angles, threshold, drawn })
        };
        let levels = fits.iter().map(level).collect::<Result<_, StructureError>>()?;
        Ok(Self { skeleton, level_of, levels })
    }

    /// The levels whose angles are drawn, the first ones first.
    #[must_use]
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// The `number`-th sibling of a seed, which does not depend on how many there are. It moves as the source does: every bone
    /// swings about how it points at rest as the one it was, and carries its leaves along.
    ///
    /// # Errors
    /// [`StructureError::Skeleton`], which rules of skeletons forbid.
    pub fn draw(&self, seed: u64, number: u32) -> Result<Skeleton, StructureError> {
        let mut rng = Pcg64Mcg::seed_from_u64(seed ^ (u64::from(number) << 32));
        let mut bones: Vec<Made> = Vec::with_capacity(self.level_of.len());
        for (of, joint) in self.skeleton.joints().iter().enumerate() {
            let before = joint.parent.map_or(Turn::NONE, |parent| bones[parent as usize].turn);
            let level = self.levels.iter().find(|level| level.level == self.level_of[of]);
            let level = level.filter(|_| joint.parent.is_some());
            let turn = level.map_or(before, |level| {
                let (from, to) = ends(self.skeleton, of);
                let by = level.angle(rng.random()) - angle(from, to);
                before.after(&Turn::about(axis(from, to), by))
            });
            bones.push(Made { of, parent: joint.parent, length: joint.length, turn, push: None });
        }
        made_by_all(self.skeleton, &bones)
    }
}

/// Bones between each joint's bone and the root.
pub(crate) fn levels(skeleton: &Skeleton) -> Vec<u32> {
    let mut levels = Vec::with_capacity(skeleton.joints().len());
    for joint in skeleton.joints() {
        let level = match joint.parent {
            None | Some(0) => 0,
            Some(parent) => levels[parent as usize] + 1,
        };
        levels.push(level);
    }
    levels
}

/// How the bone that bears a joint's bone points at rest, and how its own does.
pub(crate) fn ends(skeleton: &Skeleton, row: usize) -> ([f64; 3], [f64; 3]) {
    let parent = skeleton.joints()[row].parent.unwrap_or_default() as usize;
    (if parent == 0 { UP } else { skeleton.rest()[parent] }, skeleton.rest()[row])
}
