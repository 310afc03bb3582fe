//! The sun over forests, and what crowns leave of it on the ground.

use crate::body::SHADE;
use crate::forest::ForestScene;

/// From where the sun shines: length 1.
pub const SUN: [f32; 3] = [-0.5398, -0.6197, 0.5697];

/// Of a plant's height: the middle of its crown, and half of how high that is.
const MIDDLE: f32 = 0.62;
const HALF: f32 = 0.38;
/// Of how far its nodes reach from the upright through its root: half of how wide a crown is across the sun's way, and what
/// that adds along it.
const WIDE: f32 = 0.95;
const DEEP: f32 = 0.55;

/// The shadow of a crown on the ground, an ellipse along the sun's way: of the plant in its own size, with its root at 0, 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadow {
    /// Where its middle is, metres.
    pub middle: [f32; 2],
    /// Half of its length along the sun's way, metres.
    pub along: f32,
    /// Half of its width, metres.
    pub wide: f32,
    /// The share of the sun that leaves take: 0 where there are none, to 1. Half of their area is across any ray (Monsi and
    /// Saeki 1953, leaves that look all ways).
    pub dense: f32,
}

impl Shadow {
    /// That of a forest's plant.
    #[must_use]
    pub fn of(scene: &ForestScene) -> Self {
        let height = scene.stirring.height() as f32;
        let reach = scene.stirring.rest().iter().map(|at| at.x.hypot(at.y)).fold(0.0, f64::max) as f32;
        let leaves = scene.body.levels.first().map_or(&[][..], |level| &level.leaves);
        let taken: f32 = leaves.iter().map(|leaf| SHADE as f32 * leaf.length.powi(2)).sum();
        let ground = std::f32::consts::PI * reach.powi(2);
        let [x, y, up] = SUN;
        Self {
            middle: [x, y].map(|v| -MIDDLE * height * v / up),
            along: DEEP * reach + HALF * height * x.hypot(y) / up,
            wide: WIDE * reach,
            dense: 1.0 - (-taken / (ground * up).max(f32::MIN_POSITIVE)).exp(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{SUN, Shadow};
    use crate::testing;

    #[test]
    fn the_sun_is_of_length_1() {
        assert!((SUN.iter().map(|v| v * v).sum::<f32>() - 1.0).abs() < 1e-4);
    }

    /// Through half of the leaves comes the root of what comes through all; without any everything does.
    #[test]
    fn the_fewer_leaves_the_fainter_is_the_shadow_of_a_crown() {
        let scene = testing::forest(1, "still");
        let dense = |part: usize| {
            let mut scene = scene.clone();
            let mut k = 0;
            scene.body.levels[0].leaves.retain(|_| {
                k += 1;
                part > 0 && k % part == 0
            });
            // Of one size, that half of them is half.
            scene.body.levels[0].leaves.iter_mut().for_each(|leaf| leaf.length = 0.1);
            Shadow::of(&scene)
        };
        let [all, half, none] = [1, 2, 0].map(dense);
        assert!((0.2..1.0).contains(&all.dense), "{}", all.dense);
        assert!(((1.0 - half.dense).powi(2) - (1.0 - all.dense)).abs() < 1e-4, "{}", half.dense);
        assert_eq!(none, Shadow { dense: 0.0, ..all });
        // Away from the sun, as far as its rays come down from the middle of the crown.
        let down = all.middle[0].hypot(all.middle[1]) / SUN[0].hypot(SUN[1]) * SUN[2];
        let share = f64::from(down) / scene.stirring.height();
        assert!((0.5..0.75).contains(&share) && all.middle[0] * SUN[0] < 0.0 && all.middle[1] * SUN[1] < 0.0);
    }
}
