//! What is drawn of a skeleton in a frame, as the card takes it.

use bytemuck::{Pod, Zeroable};
use honami_model::turn::{Turn, norm};
use honami_scene::SkeletonScene;
use honami_scene::control::Chosen;

use super::lens::Lens;
use super::{Part, SkeletonPicture};
use crate::target::Target;

/// Forks, and what belongs to no group.
const NEUTRAL: [f32; 3] = [0.80, 0.82, 0.80];
/// About everything solid.
const DARK: [f32; 3] = [0.035, 0.045, 0.050];
/// About what is chosen, and the root's mark.
const BRIGHT: [f32; 3] = [1.0, 1.0, 1.0];
/// A root that was placed by hand.
const PLACED: [f32; 3] = [0.36, 0.87, 0.55];
/// Copies are so much darker.
const DIM: f32 = 0.42;

/// Radius of a bone that bears no other, of the clip's height; of others it grows with how many tips they bear.
const THIN: f32 = 0.0042;
const GROWS: f32 = 0.4;
/// Nothing is thinner, pixels of the picture.
const THINNEST: f32 = 1.2;
/// What is about solid things, pixels of the picture 720 high.
const OUTLINE: f32 = 1.3;
/// So long trails are, seconds.
const TRAIL_S: f64 = 1.0;
/// How dense ellipsoids are.
const DENSE: f32 = 0.42;

/// As `skeleton.wgsl` has them.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Frame {
    matrix: [[f32; 4]; 4],
    right: [f32; 4],
    up: [f32; 4],
    forward: [f32; 4],
    size: [f32; 4],
    ground: [f32; 4],
    clip: [f32; 4],
}

/// A bone: its ends with their radii, and its colour.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Tube {
    from: [f32; 4],
    to: [f32; 4],
    colour: [f32; 4],
}

/// A ball or an ellipsoid: its centre, its half axes, and its colour.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Ball {
    centre: [f32; 4],
    axes: [[f32; 4]; 3],
    colour: [f32; 4],
}

/// A line of a width, or a point: its ends with half of the widths in pixels, their colours, and its rim.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Stroke {
    from: [f32; 4],
    to: [f32; 4],
    start: [f32; 4],
    end: [f32; 4],
    rim: [f32; 4],
}

/// All of it, in the order in which it is drawn.
pub(super) struct Drawn {
    pub(super) frame: Frame,
    /// Whether the clip is behind.
    pub(super) is_filmed: bool,
    pub(super) tubes: Vec<Tube>,
    pub(super) balls: Vec<Ball>,
    /// The same, larger: only their far sides are seen.
    pub(super) tube_outlines: Vec<Tube>,
    pub(super) ball_outlines: Vec<Ball>,
    pub(super) shells: Vec<Ball>,
    pub(super) strokes: Vec<Stroke>,
    /// Before everything else.
    pub(super) marks: Vec<Stroke>,
}

impl Drawn {
    /// What is drawn in the `row`-th of a skeleton's frames.
    pub(super) fn of(
        picture: &SkeletonPicture,
        row: usize,
        lens: &Lens,
        target: &Target,
        is_filmed: bool,
    ) -> Self {
        let scene = &picture.scene;
        let height = target.size().height;
        let mut drawn = Self {
            frame: frame(scene, lens, target, is_filmed),
            is_filmed,
            tubes: Vec::new(),
            balls: Vec::new(),
            tube_outlines: Vec::new(),
            ball_outlines: Vec::new(),
            shells: Vec::new(),
            strokes: Vec::new(),
            marks: Vec::new(),
        };
        let n = scene.joints.len();
        let Some(at) = scene.places.get(row * n..(row + 1) * n) else { return drawn };
        let a_pixel = 1.0 / lens.pixels(1.0, height);
        let radii = radii(scene, THINNEST * a_pixel);
        let now = Now { picture, at, radii: &radii, a_pixel, bold: height as f32 / 720.0 };
        if picture.parts.contains(&Part::Bones) {
            now.bones(&mut drawn);
            now.root(&mut drawn);
        }
        if picture.parts.contains(&Part::Ellipsoids) {
            now.ellipsoids(&mut drawn);
        }
        if picture.parts.contains(&Part::Trails) {
            now.trails(row, &mut drawn);
        }
        if picture.parts.contains(&Part::Leaves) {
            now.leaves(row, &mut drawn);
        }
        drawn
    }
}

/// A moment of a skeleton.
struct Now<'a> {
    picture: &'a SkeletonPicture,
    /// Where joints are.
    at: &'a [[f32; 3]],
    /// Of bones at their ends.
    radii: &'a [f32],
    /// The length of a pixel of the picture.
    a_pixel: f32,
    /// By how much lines are wider than in a picture of the usual size.
    bold: f32,
}

impl Now<'_> {
    fn scene(&self) -> &SkeletonScene {
        &self.picture.scene
    }

    fn is_shown(&self, joint: usize) -> bool {
        self.scene().joints[joint].copy_of.is_none() || self.picture.parts.contains(&Part::Copies)
    }

    fn is_chosen(&self, joint: usize) -> bool {
        let joint = &self.scene().joints[joint];
        let chosen = match self.picture.chosen {
            Some(Chosen::Bone(node)) => Some(node),
            _ => None,
        };
        chosen.is_some() && joint.copy_of.is_none() && joint.bone.map(|bone| bone.node) == chosen
    }

    fn colour(&self, joint: usize) -> [f32; 3] {
        let (scene, joint) = (self.scene(), &self.scene().joints[joint]);
        let of_group = joint.group.and_then(|row| scene.groups.get(row as usize));
        let colour = of_group.map_or(NEUTRAL, |group| bytes(group.colour));
        if joint.copy_of.is_some() { colour.map(|v| v * DIM) } else { colour }
    }

    fn bones(&self, drawn: &mut Drawn) {
        for (row, joint) in self.scene().joints.iter().enumerate().filter(|(row, _)| self.is_shown(*row)) {
            let (is_chosen, end) = (self.is_chosen(row), self.radii[row]);
            let colour = solid(self.colour(row));
            let bold = if is_chosen { 1.5 } else { 1.0 };
            let (about, wide) = if is_chosen { (BRIGHT, 2.0) } else { (DARK, 1.0) };
            let more = wide * OUTLINE * self.bold * self.a_pixel;
            if let Some(parent) = joint.parent {
                let begin = self.radii[parent as usize].min(1.3 * end);
                let (from, to) = (self.at[parent as usize], self.at[row]);
                let tube = |more: f32, colour| Tube {
                    from: with(from, bold * begin + more),
                    to: with(to, bold * end + more),
                    colour,
                };
                drawn.tubes.push(tube(0.0, colour));
                drawn.tube_outlines.push(tube(more, solid(about)));
            }
            let knob = bold * end * 1.25;
            drawn.balls.push(ball(self.at[row], knob, colour));
            drawn.ball_outlines.push(ball(self.at[row], knob + more, solid(about)));
        }
    }

    /// Turned as the bone that ends in their joint is turned out of how it grew at rest.
    fn ellipsoids(&self, drawn: &mut Drawn) {
        let scene = self.scene();
        for group in &scene.groups {
            let Some(row) = group.joint.map(|row| row as usize) else { continue };
            let Some(from) = scene.joints[row].parent.map(|parent| self.at[parent as usize]) else {
                continue;
            };
            let way: [f64; 3] = std::array::from_fn(|axis| f64::from(self.at[row][axis] - from[axis]));
            let rest = scene.joints[row].rest.map(f64::from);
            if norm(way) * norm(rest) <= 0.0 || group.half_axes.as_flattened().iter().all(|v| v.abs() <= 0.0)
            {
                continue;
            }
            let turn = Turn::between(rest, way);
            let turned = |v: [f32; 3]| turn.apply(v.map(f64::from)).map(|v| v as f32);
            let centre = turned(group.centre);
            let [red, green, blue] = bytes(group.colour);
            drawn.shells.push(Ball {
                centre: with(std::array::from_fn(|axis| self.at[row][axis] + centre[axis]), 0.0),
                axes: group.half_axes.map(|axis| with(turned(axis), 0.0)),
                colour: [red, green, blue, DENSE],
            });
        }
    }

    /// Where tips have been, the fainter the longer ago.
    fn trails(&self, row: usize, drawn: &mut Drawn) {
        let scene = self.scene();
        let n = scene.joints.len();
        let now = scene.times[row];
        let first = scene.times[..row].iter().rposition(|time| now - time > TRAIL_S).map_or(0, |k| k + 1);
        let mut is_tip = vec![true; n];
        scene.joints.iter().filter_map(|joint| joint.parent).for_each(|of| is_tip[of as usize] = false);
        for tip in (0..n).filter(|tip| is_tip[*tip] && scene.joints[*tip].copy_of.is_none()) {
            let [red, green, blue] = self.colour(tip);
            let fresh = |k: usize| 1.0 - ((now - scene.times[k]) / TRAIL_S) as f32;
            for k in first..row {
                let end = |k: usize| {
                    let wide = self.bold * (0.6 + 1.5 * fresh(k));
                    (with(scene.places[k * n + tip], wide), [red, green, blue, 0.85 * fresh(k)])
                };
                let ((from, start), (to, end)) = (end(k), end(k + 1));
                drawn.strokes.push(Stroke { from, to, start, end, rim: [0.0; 4] });
            }
        }
    }

    fn leaves(&self, row: usize, drawn: &mut Drawn) {
        let scene = self.scene();
        let chosen = match self.picture.chosen {
            Some(Chosen::Track(track)) => Some(track),
            _ => None,
        };
        for leaf in scene.leaves.iter().filter(|leaf| self.is_shown(leaf.joint as usize)) {
            let is_chosen = chosen == Some(leaf.track) && scene.joints[leaf.joint as usize].copy_of.is_none();
            let colour = self.colour(leaf.joint as usize).map(|v| 0.25 + 0.75 * v);
            let (wide, rim) = match is_chosen {
                true => (5.0, [BRIGHT[0], BRIGHT[1], BRIGHT[2], 0.35]),
                false => (2.5, [DARK[0], DARK[1], DARK[2], 0.30]),
            };
            drawn.strokes.push(point(leaf.places[row], wide * self.bold, colour, 0.9, rim));
        }
    }

    /// Where the plant leaves the ground.
    fn root(&self, drawn: &mut Drawn) {
        let inner = if self.scene().is_placed { PLACED } else { NEUTRAL };
        let [red, green, blue] = DARK;
        let wide = (self.radii[0] / self.a_pixel * 0.8).max(4.0 * self.bold);
        let rim = [BRIGHT[0], BRIGHT[1], BRIGHT[2], 0.32];
        drawn.marks.push(point(self.at[0], wide + 1.5 * self.bold, [red, green, blue], 0.8, [0.0; 4]));
        drawn.marks.push(point(self.at[0], wide, inner, 1.0, rim));
    }
}

/// Of bones at their ends, by how many tips they bear; none is below `least`.
fn radii(scene: &SkeletonScene, least: f32) -> Vec<f32> {
    let mut tips = vec![0_u32; scene.joints.len()];
    for (row, joint) in scene.joints.iter().enumerate().rev() {
        tips[row] = tips[row].max(1);
        if let Some(parent) = joint.parent.filter(|_| joint.copy_of.is_none()) {
            tips[parent as usize] += tips[row];
        }
    }
    let thin = (THIN * scene.clip.height as f32).max(least);
    tips.into_iter().map(|tips| thin * (tips as f32).powf(GROWS)).collect()
}

fn frame(scene: &SkeletonScene, lens: &Lens, target: &Target, is_filmed: bool) -> Frame {
    let [right, up, forward] = lens.axes;
    let size = target.size();
    let lowest = |at: &[f32; 3]| at[2];
    let n = scene.joints.len();
    let root = scene.places.first().copied().unwrap_or_default();
    let floor = scene.places.iter().take(n).map(lowest).fold(root[2], f32::min);
    let (width, height) = (scene.clip.width as f32, scene.clip.height as f32);
    // The clip fades as its front is left, and the ground comes.
    let film = if is_filmed { (1.0 - 2.5 * lens.depth).max(0.0) } else { 0.0 };
    Frame {
        matrix: lens.matrix,
        right: with(right, film),
        up: with(up, 1.0 - film),
        forward: with(forward, 0.0),
        size: [size.width as f32, size.height as f32, 0.0, 0.0],
        ground: [root[0], root[1], floor, 1.1 * width.max(height)],
        clip: [-0.5, -0.5, width - 0.5, height - 0.5],
    }
}

fn ball(at: [f32; 3], radius: f32, colour: [f32; 4]) -> Ball {
    let axes = [[radius, 0.0, 0.0, 0.0], [0.0, radius, 0.0, 0.0], [0.0, 0.0, radius, 0.0]];
    Ball { centre: with(at, 0.0), axes, colour }
}

fn point(at: [f32; 3], radius: f32, [red, green, blue]: [f32; 3], alpha: f32, rim: [f32; 4]) -> Stroke {
    let (at, colour) = (with(at, radius), [red, green, blue, alpha]);
    Stroke { from: at, to: at, start: colour, end: colour, rim }
}

fn solid([red, green, blue]: [f32; 3]) -> [f32; 4] {
    [red, green, blue, 1.0]
}

fn with([x, y, z]: [f32; 3], w: f32) -> [f32; 4] {
    [x, y, z, w]
}

fn bytes(colour: [u8; 3]) -> [f32; 3] {
    colour.map(|byte| f32::from(byte) / 255.0)
}
