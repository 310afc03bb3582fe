//! Growth: a stem, limbs that fan out, branches and twigs on them within an oval crown, leaves around each.

use std::f64::consts::{FRAC_PI_2, TAU};

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::{Branch, Item, Leaf, Plant};
use crate::geometry::{Frame, Point};
use crate::moving::Stick;
use crate::settings::Settings;
use crate::texture::Texture;
use crate::wind::{self, Mode};

/// Fundamental of a branch of order 0 to 3, Hz: thin ones are quick.
const BASE_HZ: [f64; 4] = [0.42, 0.75, 1.2, 1.95];
/// Relative sway of a branch of order 0 to 3, chosen so that each order moves the leaves about as far.
const BASE_SWAY_RAD: [f64; 4] = [0.16, 0.55, 1.1, 1.3];
/// Relative sway of a leaf about its petiole.
const FLUTTER_RAD: f64 = 0.55;
/// Where the light comes from.
const TO_LIGHT: Point = Point::new(-0.62, -0.78);
/// The golden angle: from one leaf to the next around its branch, from one tip to the next in the crown.
const GOLDEN_RAD: f64 = 2.399_963;

impl Plant {
    /// Grows a plant that fills the picture.
    pub(crate) fn grow(settings: &Settings, rng: &mut Pcg64Mcg) -> Self {
        let mut grower = Grower::new(settings, rng);
        let n_bearing = ((0.82 * f64::from(settings.n_leaves).sqrt()).round() as usize).max(1);
        grower.wood(n_bearing);
        grower.foliage(settings.n_leaves as usize);
        grower.finish()
    }
}

impl Plant {
    /// A plant of given branches, with leaves on those that end.
    pub(crate) fn of(settings: &Settings, sticks: &[Stick], rng: &mut Pcg64Mcg) -> Self {
        let mut grower = Grower::new(settings, rng);
        for stick in sticks {
            grower.stick(stick);
        }
        grower.foliage(settings.n_leaves as usize);
        grower.finish()
    }
}

struct Grower<'a> {
    rng: &'a mut Pcg64Mcg,
    height_px: f64,
    crown: Crown,
    half_length_px: f64,
    branches: Vec<Branch>,
    /// Frames at rest of the branches.
    frames: Vec<Frame>,
    /// How near each branch is, -1 (far) to 1.
    nearness: Vec<f64>,
    leaves: Vec<Leaf>,
    /// How near each leaf is.
    leaf_nearness: Vec<f64>,
}

impl<'a> Grower<'a> {
    fn new(settings: &Settings, rng: &'a mut Pcg64Mcg) -> Self {
        let (width_px, height_px) = (f64::from(settings.width), f64::from(settings.height));
        let crown = Crown {
            centre: Point::new(width_px * 0.5, height_px * 0.46),
            radius: Point::new((width_px * 0.45).min(height_px * 0.66), height_px * 0.42),
        };
        // Leaves of length l cover about l²/3 each; they are to cover the crown one and a half times, within reason.
        let crown_px2 = std::f64::consts::PI * crown.radius.x * crown.radius.y;
        let length_px = (1.5 * 3.0 * crown_px2 / f64::from(settings.n_leaves)).sqrt();
        let half_length_px = length_px.clamp(0.022 * height_px, 0.082 * height_px) * 0.5;
        Self {
            rng,
            height_px,
            crown,
            half_length_px,
            branches: Vec::new(),
            frames: Vec::new(),
            nearness: Vec::new(),
            leaves: Vec::new(),
            leaf_nearness: Vec::new(),
        }
    }

    /// Stem, limbs, and `n_bearing` branches and twigs for leaves.
    ///
    /// Their tips are spread evenly over the crown first; limbs then grow into the sectors between them.
    fn wood(&mut self, n_bearing: usize) {
        let foot = Point::new(self.crown.centre.x + self.vary(0.02 * self.height_px), self.height_px * 1.03);
        let stem = self.sprout(None, 0.0, foot + Point::new(0.0, -0.26 * self.height_px), 0.0, foot);
        let hub = self.frames[stem].out(self.branches[stem].along(1.0));
        let mut tips: Vec<Tip> = (0..n_bearing).map(|idx| self.tip(idx, n_bearing, hub)).collect();
        tips.sort_by(|a, b| a.bearing_rad.total_cmp(&b.bearing_rad));
        let n_limbs = ((n_bearing as f64).sqrt().round() as usize).max(1);
        for limb_idx in 0..n_limbs {
            let sector = &mut tips[limb_idx * n_bearing / n_limbs..(limb_idx + 1) * n_bearing / n_limbs];
            sector.sort_by(|a, b| b.reach_px.total_cmp(&a.reach_px));
            self.limb(stem, hub, sector);
        }
    }

    /// Tip `idx` of `n`: the seeds of a sunflower, which fill a disc evenly, laid over the crown.
    fn tip(&mut self, idx: usize, n: usize, hub: Point) -> Tip {
        let outness = ((idx as f64 + 0.5) / n as f64).sqrt();
        let place = Point::unit(GOLDEN_RAD * idx as f64 + 0.6) * (outness * 0.9 + self.vary(0.04));
        let at = self.crown.centre + Point::new(place.x * self.crown.radius.x, place.y * self.crown.radius.y);
        // The crown is round: its rim lies in the middle, its middle in front or behind.
        let depth = (1.0 - 0.8 * outness * outness).sqrt();
        let nearness = depth * ((idx as f64 * 0.618_034).fract() * 2.0 - 1.0);
        let way = at - hub;
        Tip { at, nearness, reach_px: way.norm(), bearing_rad: way.x.atan2(-way.y) }
    }

    /// A limb up the middle of its sector, branches from it to every other tip, twigs to those between.
    ///
    /// `sector` is sorted from far to near.
    fn limb(&mut self, stem: usize, hub: Point, sector: &[Tip]) {
        let middle_rad = sector.iter().map(|tip| tip.bearing_rad).sum::<f64>() / sector.len() as f64;
        let way = Point::unit(middle_rad.clamp(-1.5, 1.5) - FRAC_PI_2);
        let nearness = 0.4 * sector.iter().map(|tip| tip.nearness).sum::<f64>() / sector.len() as f64;
        // Limbs that lean out leave the stem lower down.
        let share = (1.0 - 0.3 * middle_rad.abs()).max(0.5);
        let limb = self.sprout(Some(stem), share, hub + way * (0.66 * sector[0].reach_px), nearness, hub);
        let mut bearing: Vec<usize> = Vec::new();
        for (idx, tip) in sector.iter().enumerate() {
            let carrier = if idx % 2 == 0 { limb } else { bearing[idx - 1] };
            let share = self.fork(carrier, tip.at);
            bearing.push(self.sprout(Some(carrier), share, tip.at, tip.nearness, hub));
        }
    }

    /// The share of a branch's length at which a side branch to `tip` leaves it: at some 45 degrees.
    fn fork(&mut self, carrier: usize, tip: Point) -> f64 {
        let local = self.frames[carrier].into_local(tip);
        let length_px = self.branches[carrier].length_px;
        let setback_px = (0.9 * local.y.abs()).max(0.24 * self.height_px);
        ((local.x - setback_px) / length_px + self.vary(0.04)).clamp(0.15, 0.96)
    }

    /// A new branch from a share of its parent's length to `tip`; the stem stands on `foot`.
    fn sprout(&mut self, parent: Option<usize>, share: f64, tip: Point, nearness: f64, foot: Point) -> usize {
        let order = parent.map_or(0, |p| self.branches[p].order + 1);
        let (base, origin, carrier_rad, thickness_px) =
            parent.map_or((foot, foot, 0.0, 0.017 * self.height_px), |p| {
                let (parent, frame) = (&self.branches[p], &self.frames[p]);
                let base = parent.along(share);
                (base, frame.out(base), frame.angle_rad, 0.78 * parent.radius_at(share))
            });
        let way = tip - origin;
        let length_px = way.norm().max(0.1 * self.height_px);
        let root_px = thickness_px.max(0.9);
        let slim = if order < 2 { 0.42 } else { 0.28 };
        let light = self.rng.random_range(0.8..1.0) * (0.78 + 0.22 * nearness);
        let mut branch = Branch {
            parent,
            order,
            base,
            turn_rad: way.y.atan2(way.x) - carrier_rad,
            length_px,
            bend_px: length_px * self.vary(if order == 0 { 0.06 } else { 0.14 }),
            radius_px: [root_px, (root_px * slim).max(0.6)],
            gust_x_px: 0.0,
            modes: wind::modes(self.rng, BASE_HZ[order as usize], BASE_SWAY_RAD[order as usize]),
            colour: [104.0, 84.0, 62.0].map(|c: f32| c * light as f32),
        };
        let frame = branch.frame(parent.map(|p| &self.frames[p]), 0.0);
        branch.gust_x_px = frame.origin.x;
        self.branches.push(branch);
        self.frames.push(frame);
        self.nearness.push(nearness);
        self.branches.len() - 1
    }

    /// A branch that stands by itself, straight.
    fn stick(&mut self, stick: &Stick) {
        let [base, tip] = stick.ends;
        let way = tip - base;
        let light = self.rng.random_range(0.8..1.0) as f32;
        let branch = Branch {
            parent: None,
            // Leaves grow on what is of order 2.
            order: if stick.is_end { 2 } else { 1 },
            base,
            turn_rad: way.y.atan2(way.x),
            length_px: way.norm().max(1e-3),
            bend_px: 0.0,
            radius_px: [stick.radius_px; 2],
            gust_x_px: base.x,
            modes: Vec::new(),
            colour: [104.0, 84.0, 62.0].map(|c: f32| c * light),
        };
        self.frames.push(branch.frame(None, 0.0));
        self.branches.push(branch);
        let nearness = self.vary(0.5);
        self.nearness.push(nearness);
    }

    /// Leaves on all branches of order 2 and 3, as many as their length asks for.
    fn foliage(&mut self, n_leaves: usize) {
        let bearing: Vec<usize> = (0..self.branches.len()).filter(|&b| self.branches[b].order >= 2).collect();
        let total_px: f64 = bearing.iter().map(|&b| self.branches[b].length_px).sum();
        let mut grown_px = 0.0;
        for branch in bearing {
            grown_px += self.branches[branch].length_px;
            let due = (grown_px / total_px * n_leaves as f64).round() as usize;
            let n_here = due - self.leaves.len();
            for idx in 0..n_here {
                self.leaf(branch, idx, n_here);
            }
        }
    }

    /// Leaf `idx` of `n_here` on a branch: they wind around it from a tenth of its length to the tip.
    fn leaf(&mut self, branch: usize, idx: usize, n_here: usize) {
        let share = 1.0 - 0.9 * (idx as f64 + self.rng.random_range(0.0..0.8)) / n_here as f64;
        let around_rad = GOLDEN_RAD * idx as f64 + self.vary(0.5);
        let (aside, ahead) = around_rad.sin_cos();
        let frame = self.frames[branch];
        let wood = &self.branches[branch];
        let base = wood.along(share);
        let direction_rad = wood.direction_rad(share);
        let mut turn_rad = direction_rad + aside * (1.25 - 0.6 * share) + self.vary(0.28);
        // Weight pulls it down a little.
        turn_rad += 0.28 * (frame.angle_rad + turn_rad).cos();
        // Towards the camera it is seen shortened.
        let half_length_px =
            self.half_length_px * self.rng.random_range(0.78..1.18) * (1.0 - 0.28 * ahead.abs());
        let half_width_px = half_length_px * self.rng.random_range(0.46..0.6);
        let petiole_px = half_length_px * self.rng.random_range(0.4..2.4) * (1.0 - 0.6 * share);
        let centre =
            frame.out(base) + Point::unit(frame.angle_rad + turn_rad) * (petiole_px + half_length_px);
        let nearness = self.nearness[branch] + 0.22 * ahead + self.vary(0.05);
        let colour = self.leaf_colour(centre, nearness);
        let texture = Texture::new(self.rng.random(), half_length_px, half_width_px);
        let leaf = Leaf {
            branch,
            base,
            turn_rad,
            petiole_px,
            half_length_px,
            half_width_px,
            ovate: self.rng.random_range(0.15..0.45),
            roll_rad: self.vary(0.75),
            flutter: Mode {
                hz: self.rng.random_range(2.2..4.2),
                phase_rad: self.rng.random_range(0.0..TAU),
                amplitude_rad: FLUTTER_RAD * self.rng.random_range(0.5..1.5),
            },
            colour,
            texture,
        };
        self.leaves.push(leaf);
        self.leaf_nearness.push(nearness);
    }

    /// Green between the blue-green of shade and the yellow-green of sun.
    fn leaf_colour(&mut self, centre: Point, nearness: f64) -> [f32; 3] {
        let lit = self.crown.lit(centre);
        let inside = 1.0 - self.crown.outness(centre).min(1.0);
        let light = 0.76 + 0.2 * nearness + 0.2 * lit - 0.2 * inside * (1.0 - nearness) + self.vary(0.1);
        let light = light.clamp(0.4, 1.16);
        let sunny = (0.42 + 0.2 * lit + 0.2 * nearness + self.vary(0.26)).clamp(0.0, 1.0);
        let mix = |shade: f64, sun: f64| ((shade + sunny * (sun - shade)) * light) as f32;
        [mix(58.0, 162.0), mix(116.0, 186.0), mix(62.0, 78.0)]
    }

    fn finish(self) -> Plant {
        let leaves = self.leaf_nearness.iter().enumerate().map(|(i, &near)| (near, Item::Leaf(i)));
        // Leaves hang around their branch, most of them before it.
        let wood = self.nearness.iter().enumerate().map(|(i, &near)| (near - 0.1, Item::Branch(i)));
        let mut order: Vec<(f64, Item)> = wood.chain(leaves).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        Plant {
            branches: self.branches,
            leaves: self.leaves,
            order: order.into_iter().map(|(_, item)| item).collect(),
        }
    }

    /// A random value in -amount..amount.
    fn vary(&mut self, amount: f64) -> f64 {
        self.rng.random_range(-amount..amount)
    }
}

/// The oval that the leaves fill.
struct Crown {
    centre: Point,
    radius: Point,
}

impl Crown {
    /// A place in units of the radii.
    fn normal(&self, at: Point) -> Point {
        let d = at - self.centre;
        Point::new(d.x / self.radius.x, d.y / self.radius.y)
    }

    /// 0 at the centre, 1 at the edge.
    fn outness(&self, at: Point) -> f64 {
        self.normal(at).norm()
    }

    /// How far towards the light a place lies, about -1 to 1.
    fn lit(&self, at: Point) -> f64 {
        let n = self.normal(at);
        n.x * TO_LIGHT.x + n.y * TO_LIGHT.y
    }
}

/// Where a branch for leaves is to end.
struct Tip {
    at: Point,
    /// -1 (far) to 1.
    nearness: f64,
    /// Distance from the head of the stem, and direction from there: 0 up, positive to the right.
    reach_px: f64,
    bearing_rad: f64,
}
