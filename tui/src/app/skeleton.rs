//! The skeleton over the picture: what has grown behind the screen, how hands have shaped it, and where its joints are seen.

use std::collections::BTreeMap;
use std::sync::Arc;

use honami_model::brief::counted;
use honami_model::document::Document;
use honami_model::skeleton::Skeleton;
use honami_model::turn::angle;
use honami_workbench::WorkbenchError;
use honami_workbench::grow::{self, Growth};
use honami_workbench::shape::{Bone, Shape};

use super::panel::Panel;
use super::state::{Mode, State};

/// A step of the view round the plant, degrees.
pub const ORBIT: i32 = 15;

/// What is known of the skeleton of the shown groups.
#[derive(Clone, Debug, Default)]
pub struct Skeletal {
    /// Whether it is shown.
    pub is_on: bool,
    /// How often what it grows from has changed.
    pub revision: u64,
    /// What was done to it by hand.
    pub hand: Hand,
    /// What has grown; what was before, until another has.
    pub bones: Option<Arc<Bones>>,
    /// Whether that is of groups that were others: it is grey then, and nothing is done to it.
    pub is_past: bool,
    /// Where its joints are, as hands have shaped it.
    pub pose: Option<Arc<Pose>>,
    /// The node of the bone that is chosen; without one, that of the selected track's group is.
    pub chosen: Option<u32>,
    /// From where it is seen: degrees about the upright, counterclockwise from above; 0 from the front.
    pub azimuth: i32,
    /// What is awaited of the growth that goes on; `None` while none does.
    pub awaited: Option<Awaited>,
    /// The revision that was asked for last.
    asked: Option<u64>,
}

/// What a person has done to it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hand {
    /// Where its root was placed, pixels (right, down).
    pub root: Option<[f64; 2]>,
    /// How bones are shaped, by their nodes.
    pub shapes: BTreeMap<u32, Shape>,
}

impl Hand {
    /// What a document has of it.
    #[must_use]
    pub fn of(document: &Document) -> Self {
        let shapes = document.clustering().map(|shown| document.shapes(shown.id).collect());
        Self { root: document.root(), shapes: shapes.unwrap_or_default() }
    }

    /// How a bone is shaped.
    #[must_use]
    pub fn shape(&self, node: u32) -> Shape {
        self.shapes.get(&node).copied().unwrap_or_default()
    }
}

/// A bone that is being shaped.
#[derive(Clone, Debug, PartialEq)]
pub struct Shaping {
    /// The bone.
    pub bone: Bone,
    /// How it is to be.
    pub shape: Shape,
    /// All joints as they will be then.
    pub pose: Arc<Pose>,
}

/// What is awaited of a growth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Awaited {
    /// A line, too: somebody has asked for it.
    Line,
    /// The bones alone: what they grow from has changed meanwhile.
    Bones,
}

/// A skeleton as it grew, without hand work on its bones.
#[derive(Clone, Debug, PartialEq)]
pub struct Bones {
    /// What has grown; what its joints carry is not drawn, and left out.
    pub growth: Growth,
    /// Rows of the bones, copies apart.
    pub own: Vec<usize>,
    /// Half-way between the outermost places, right and away, pixels: what the view goes round, however bones are shaped.
    middle: [f32; 2],
}

/// Where all joints are, and what is to be said of their bones.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Joint after joint in frame after frame: right, away, up, pixels.
    places: Vec<[f32; 3]>,
    n_joints: usize,
    first: u32,
    /// What the view goes round, right and away.
    pub middle: [f32; 2],
    /// How far each bone moves about how it is at rest, with what bears it, root mean square, degrees: the bones in their
    /// order, copies apart.
    pub moves_deg: Vec<f64>,
}

impl Bones {
    /// What has grown, without what it carries.
    #[must_use]
    pub fn of(growth: Growth) -> Self {
        let copy_of = |row: usize| growth.bones.copy_of.get(row).copied().flatten();
        let own = (1..growth.skeleton.joints().len()).filter(|row| copy_of(*row).is_none()).collect();
        let growth = Growth { skeleton: growth.skeleton.without_leaves(), ..growth };
        let middle = middle(&places(&growth.skeleton));
        Self { growth, own, middle }
    }

    /// The bone that ends at a joint; `None` where the structure builder has not told what it is of.
    #[must_use]
    pub fn known(&self, row: usize) -> Option<&Bone> {
        self.growth.bones.known.get(row)?.as_ref()
    }

    /// The row of the bone with a node.
    #[must_use]
    pub fn row_of(&self, node: u32) -> Option<usize> {
        self.own.iter().copied().find(|row| self.known(*row).is_some_and(|bone| bone.node == node))
    }

    /// Where all joints are when bones are shaped so.
    ///
    /// # Errors
    /// What cannot be shaped.
    pub fn pose(&self, shape_of: impl Fn(u32) -> Shape) -> Result<Arc<Pose>, WorkbenchError> {
        let shaped = grow::shape(&self.growth, |bone| shape_of(bone.node))?;
        Ok(Arc::new(Pose::of(&shaped, self)))
    }

    /// What it is and what it took: `skeleton: 9 bones of 4 groups, diener, 0.2 s`.
    #[must_use]
    pub fn words(&self, hand: &Hand) -> String {
        let id = &self.growth.provenance.plugin_id;
        let n_shaped = hand.shapes.keys().filter(|node| self.row_of(**node).is_some()).count();
        let root = hand.root.map(|_| "the root".to_owned());
        let by_hand: Vec<String> =
            root.into_iter().chain((n_shaped > 0).then(|| counted(n_shaped, "bone"))).collect();
        let by_hand = match by_hand.is_empty() {
            true => String::new(),
            false => format!(", {} by hand", by_hand.join(" and ")),
        };
        let mut words = format!(
            "skeleton: {} of {}{by_hand}, {}, {:.1} s",
            counted(self.own.len(), "bone"),
            counted(self.growth.groups.len(), "group"),
            id.rsplit('.').next().unwrap_or(id),
            self.growth.seconds
        );
        let n_without = hand.shapes.len() - n_shaped;
        if n_without > 0 {
            let shaped = counted(n_without, "bone");
            words.push_str(&format!(" · {shaped} shaped by hand, but not there in these groups"));
        }
        for note in &self.growth.notes {
            words.push_str(&format!(" · {note}"));
        }
        words
    }
}

impl Pose {
    fn of(skeleton: &Skeleton, bones: &Bones) -> Self {
        let frames = 0..skeleton.times().len();
        let moves = |row: usize| {
            let squares = frames.clone().map(|frame| {
                angle(skeleton.rest()[row], skeleton.directions(frame)[row]).to_degrees().powi(2)
            });
            (squares.sum::<f64>() / f64::from(frames.end.max(1))).sqrt()
        };
        Self {
            places: places(skeleton),
            n_joints: skeleton.joints().len(),
            first: bones.growth.frames.start,
            middle: bones.middle,
            moves_deg: bones.own.iter().copied().map(moves).collect(),
        }
    }

    /// Where all joints are in a frame of the clip; `None` where it has none.
    #[must_use]
    pub fn at(&self, frame: u32) -> Option<&[[f32; 3]]> {
        self.places.chunks(self.n_joints).nth(frame.checked_sub(self.first)? as usize)
    }

    /// Where a place is seen from an azimuth, pixels (right, down), and how far behind the middle it is then.
    #[must_use]
    pub fn seen(&self, [x, y, z]: [f32; 3], azimuth: i32) -> ([f32; 2], f32) {
        let (sin, cos) = (azimuth as f32).to_radians().sin_cos();
        let (right, away) = (x - self.middle[0], y - self.middle[1]);
        ([self.middle[0] + cos * right + sin * away, -z], cos * away - sin * right)
    }
}

/// Joint after joint in frame after frame: right, away, up, pixels.
fn places(skeleton: &Skeleton) -> Vec<[f32; 3]> {
    let place = |frame: u32| skeleton.places(skeleton.directions(frame));
    (0..skeleton.times().len()).flat_map(place).map(|at| at.map(|v| v as f32)).collect()
}

/// Half-way between the outermost places, right and away.
fn middle(places: &[[f32; 3]]) -> [f32; 2] {
    [0, 1].map(|axis| {
        let along = || places.iter().map(|at| at[axis]);
        f32::midpoint(along().fold(f32::INFINITY, f32::min), along().fold(f32::NEG_INFINITY, f32::max))
    })
}

impl Skeletal {
    /// What it grows from is another now.
    pub fn outdate(&mut self) {
        self.revision += 1;
    }

    /// There is nothing to grow from.
    pub fn wither(&mut self) {
        (self.bones, self.pose, self.awaited, self.asked) = (None, None, None, None);
        (self.is_past, self.azimuth) = (false, 0);
    }

    /// What was done to it by hand is this now: roots change what grows.
    pub fn take(&mut self, hand: Hand) {
        if self.hand.root != hand.root {
            self.outdate();
        }
        self.hand = hand;
    }

    /// Shows it, from its growth on.
    pub fn show(&mut self) {
        (self.is_on, self.awaited) = (true, Some(Awaited::Line));
    }

    /// Shows it no longer; what grows is stopped.
    pub fn hide(&mut self) {
        self.wither();
        self.is_on = false;
        // What was asked for before is not what is asked for from now on.
        self.outdate();
    }

    /// From where it is seen, degrees: from elsewhere than the camera, the picture is not behind it. What is done in the
    /// picture is done from the front.
    #[must_use]
    pub fn azimuth(state: &State) -> i32 {
        let is_in_picture =
            matches!(state.mode, Mode::Place(_) | Mode::Root(_) | Mode::Move(_) | Mode::Sketch(_))
                || matches!(state.mode, Mode::Label(_) | Mode::Dial(_));
        if is_in_picture || state.skeleton.pose.is_none() { 0 } else { state.skeleton.azimuth }
    }

    /// Whether it grows, or is about to.
    #[must_use]
    pub fn is_growing(state: &State) -> bool {
        let skeleton = &state.skeleton;
        let is_asked = skeleton.asked == Some(skeleton.revision);
        skeleton.is_on && state.groups.is_some() && (skeleton.awaited.is_some() || !is_asked)
    }

    /// The row of the bone that is chosen among those listed or is being shaped, else of that of the selected track's group.
    #[must_use]
    pub fn current(state: &State) -> Option<usize> {
        let bones = state.skeleton.bones.as_deref().filter(|_| !state.skeleton.is_past)?;
        let is_listed = state.panel == Some(Panel::Skeleton) || matches!(state.mode, Mode::Shape(_));
        let chosen = state.skeleton.chosen.filter(|_| is_listed).and_then(|node| bones.row_of(node));
        chosen.or_else(|| {
            let group = state.groups.as_ref()?.of(state.selected?)?;
            let is_its = |row: &usize| bones.growth.skeleton.joints()[*row].groups.contains(&group);
            bones.own.iter().copied().find(is_its)
        })
    }

    /// The revision that is to grow now, once.
    pub fn request(state: &mut State) -> Option<u64> {
        let skeleton = &mut state.skeleton;
        let wanted = Some(skeleton.revision).filter(|_| skeleton.is_on && state.groups.is_some())?;
        if skeleton.asked.replace(wanted) == Some(wanted) {
            return None;
        }
        skeleton.awaited.get_or_insert(Awaited::Bones);
        Some(wanted)
    }
}
