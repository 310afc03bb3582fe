//! Growth: a stem, limbs that fan out, branches and twigs on them within an oval crown, leaves around each.

use std::f64::consts::{FRAC_PI_2, TAU};

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::{Branch, Item, Leaf, Plant};
use crate::geometry::{Frame, Point};
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
/// Turn from one leaf to the next around its branch, radians (the golden angle).
const PHYLLOTAXIS_RAD: f64 = 2.399_963;

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
            centre: Point::new(width_px * 0.5, height_px * 0.47),
            radius: Point::new((width_px * 0.46).min(height_px * 0.68), height_px * 0.44),
        };
        // Leaves of length l cover about l²/3 each; they are to cover the crown nearly twice, within reason.
        let crown_px2 = std::f64::consts::PI * crown.radius.x * crown.radius.y;
        let length_px = (1.75 * 3.0 * crown_px2 / f64::from(settings.n_leaves)).sqrt();
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
    fn wood(&mut self, n_bearing: usize) {
        let foot = Point::new(self.crown.centre.x, self.height_px * 1.03);
        let stem = self.add(None, 0.0, -FRAC_PI_2, self.height_px * 0.42, 0.0, foot);
        let n_limbs = ((n_bearing as f64).sqrt().round() as usize).max(1);
        for limb_idx in 0..n_limbs {
            let n_here = n_bearing / n_limbs + usize::from(limb_idx < n_bearing % n_limbs);
            let fan = if n_limbs == 1 { 0.0 } else { 2.0 * limb_idx as f64 / (n_limbs - 1) as f64 - 1.0 };
            let turn_rad = fan * 1.38 + self.vary(0.09);
            // Outer limbs leave the stem lower down.
            let share = 0.95 - 0.5 * fan.abs() + self.vary(0.05);
            // Neighbours in the fan lie at different depths.
            let nearness = ((limb_idx * 2 + 1) % n_limbs.max(2)) as f64 / n_limbs as f64 * 1.4 - 0.7;
            let origin = self.frames[stem].out(self.branches[stem].along(share));
            let reach_px = self.crown.reach_px(origin, turn_rad - FRAC_PI_2);
            let limb = self.add(Some(stem), share, turn_rad, reach_px * 0.72, nearness, foot);
            self.limb(limb, n_here);
        }
    }

    /// Branches of a limb from its lower part to its tip, every other carrying a twig.
    fn limb(&mut self, limb: usize, n_bearing: usize) {
        let n_branches = n_bearing.div_ceil(2);
        let limb_px = self.branches[limb].length_px;
        for idx in 0..n_branches {
            let last = idx + 1 == n_branches;
            let share = if last { 0.97 } else { 0.36 + 0.52 * idx as f64 / n_branches as f64 + self.vary(0.05) };
            let side = if (idx + limb).is_multiple_of(2) { 1.0 } else { -1.0 };
            let turn_rad = if last { self.vary(0.2) } else { side * 0.75 + self.vary(0.15) };
            let length_px = self.fitted(limb, share, turn_rad, (limb_px * 0.62).max(0.16 * self.height_px));
            let nearness = self.nearness[limb] + self.vary(0.25);
            let branch = self.add_on(limb, share, turn_rad, length_px, nearness);
            if n_branches + idx < n_bearing {
                let share = 0.42 + self.vary(0.08);
                let turn_rad = -side * 0.7 + self.vary(0.15);
                let length_px = self.fitted(branch, share, turn_rad, 0.8 * length_px);
                let nearness = nearness + self.vary(0.15);
                self.add_on(branch, share, turn_rad, length_px, nearness);
            }
        }
    }

    /// A length near `wanted_px` that ends about at the edge of the crown.
    fn fitted(&mut self, parent: usize, share: f64, turn_rad: f64, wanted_px: f64) -> f64 {
        let origin = self.frames[parent].out(self.branches[parent].along(share));
        let edge_px = self.crown.reach_px(origin, self.frames[parent].angle_rad + turn_rad);
        let varied_px = wanted_px * self.rng.random_range(0.85..1.15);
        varied_px.min(edge_px).max(0.11 * self.height_px)
    }

    fn add_on(&mut self, parent: usize, share: f64, turn_rad: f64, length_px: f64, nearness: f64) -> usize {
        self.add(Some(parent), share, turn_rad, length_px, nearness, Point::new(0.0, 0.0))
    }

    /// A new branch at a share of its parent's length; the stem stands on `foot`.
    fn add(
        &mut self,
        parent: Option<usize>,
        share: f64,
        turn_rad: f64,
        length_px: f64,
        nearness: f64,
        foot: Point,
    ) -> usize {
        let order = parent.map_or(0, |p| self.branches[p].order + 1);
        let (base, direction_rad, thickness_px) = parent.map_or((foot, 0.0, 0.021 * self.height_px), |p| {
            let parent = &self.branches[p];
            (parent.along(share), parent.direction_rad(share), 0.8 * parent.radius_at(share))
        });
        let root_px = thickness_px.max(0.9);
        let slim = if order < 2 { 0.42 } else { 0.28 };
        let light = self.rng.random_range(0.8..1.0) * (0.78 + 0.22 * nearness);
        let mut branch = Branch {
            parent,
            order,
            base,
            turn_rad: direction_rad + turn_rad,
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
        let around_rad = PHYLLOTAXIS_RAD * idx as f64 + self.vary(0.5);
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
        let petiole_px = half_length_px * self.rng.random_range(0.3..0.9);
        let centre = frame.out(base) + Point::unit(frame.angle_rad + turn_rad) * (petiole_px + half_length_px);
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
        let light = 0.62 + 0.34 * nearness + 0.42 * lit - 0.3 * inside * (1.0 - nearness) + self.vary(0.1);
        let light = light.clamp(0.22, 1.28);
        let sunny = (0.42 + 0.38 * lit + 0.18 * nearness + self.vary(0.24)).clamp(0.0, 1.0);
        let mix = |shade: f64, sun: f64| ((shade + sunny * (sun - shade)) * light) as f32;
        [mix(52.0, 150.0), mix(104.0, 176.0), mix(58.0, 66.0)]
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

    /// Distance from a place to the edge in a direction; 0 from outside going out.
    fn reach_px(&self, from: Point, angle_rad: f64) -> f64 {
        let (start, way) = (self.normal(from), Point::unit(angle_rad));
        let way = Point::new(way.x / self.radius.x, way.y / self.radius.y);
        let (a, b) = (way.x * way.x + way.y * way.y, start.x * way.x + start.y * way.y);
        let c = start.x * start.x + start.y * start.y - 1.0;
        let root = (b * b - a * c).max(0.0).sqrt();
        ((root - b) / a).max(0.0)
    }
}
