//! Hand work on skeletons: where the root is, and how bones are turned out of the picture and move.
//!
//! A skeleton is never kept: it grows anew from tracks and groups. What a person does to one is kept beside them, and laid
//! over whatever grows. A bone is known by the node of the dendrogram whose centre it ends at, as names of groups are, so
//! that its shape stays with it when the cut moves.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::brief::{Brief, counted};
use crate::document::{ClusteringId, Document};
use crate::edit::{Edit, Transaction};

/// No bone swings more than so many times as far as it was seen to.
pub const MOST_GAIN: f64 = 10.0;

/// How a bone differs from how it has grown. All that it bears goes along.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// By how much the plane that it moves in is turned about what is at right angles to the bone in that plane, so that it
    /// points away from the camera: radians, -π to π.
    pub plane_rad: f64,
    /// By how much it leans otherwise at rest, clockwise as the bone that bears it sees the picture: radians, -π to π.
    pub lean_rad: f64,
    /// How much of its own swing it keeps, beside that of what bears it: 0 (stiff) to 10, 1 as it was seen.
    pub gain: f64,
}

impl Default for Shape {
    fn default() -> Self {
        Self { plane_rad: 0.0, lean_rad: 0.0, gain: 1.0 }
    }
}

/// Why a bone cannot have a shape.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what}, not {came}")]
pub struct ShapeError {
    what: &'static str,
    came: String,
}

impl Shape {
    /// As it has grown.
    #[must_use]
    pub fn is_grown(&self) -> bool {
        *self == Self::default()
    }

    /// Whether its numbers are in their ranges.
    pub(crate) fn check(&self) -> Result<(), ShapeError> {
        let turns = |what, came: f64| {
            let is_turn = (-PI..=PI).contains(&came);
            if is_turn { Ok(()) } else { Err(ShapeError { what, came: degrees(came) }) }
        };
        turns("the plane of a bone is turned by -180 to 180 degrees", self.plane_rad)?;
        turns("a bone leans by -180 to 180 degrees", self.lean_rad)?;
        match (0.0..=MOST_GAIN).contains(&self.gain) {
            true => Ok(()),
            false => Err(ShapeError {
                what: "the gain of a bone is 0 (stiff) to 10",
                came: Brief(self.gain).to_string(),
            }),
        }
    }

    /// What differs from another, in the user's words: `plane 30°, gain 1.5`.
    fn told(&self, from: &Self) -> String {
        let parts = [
            (self.plane_rad, from.plane_rad, "plane", degrees(self.plane_rad) + "°"),
            (self.lean_rad, from.lean_rad, "lean", degrees(self.lean_rad) + "°"),
            (self.gain, from.gain, "gain", Brief(self.gain).to_string()),
        ];
        let differ = parts.into_iter().filter(|(is, was, ..)| (is - was).abs() > 0.0);
        differ.map(|(.., word, value)| format!("{word} {value}")).collect::<Vec<_>>().join(", ")
    }
}

/// What is other than as grown: `plane 30°, lean -10°, gain 1.5`; nothing where nothing is.
impl std::fmt::Display for Shape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.told(&Self::default()))
    }
}

/// A hundredth of a degree is as much as a person sees.
fn degrees(rad: f64) -> String {
    let rounded = (rad.to_degrees() * 100.0).round() / 100.0;
    // -0 is 0.
    Brief(rounded + 0.0).to_string()
}

/// A bone, as a person speaks of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bone {
    /// The clustering that the node is of.
    pub clustering: ClusteringId,
    /// The node of that clustering's dendrogram whose centre it ends at; of a group made by hand its largest.
    pub node: u32,
    /// What it is called: `group 3 bud-left`, `fork 3,4`.
    pub name: String,
    /// The groups that it ends at, or that the fork bears that it ends at: numbers from 0, rising.
    pub groups: Vec<u32>,
}

/// What a person does to the skeleton of the shown groups.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// The root is here, pixels (right, down), or where whoever grows a skeleton thinks.
    Root(Option<[f64; 2]>),
    /// A bone is shaped so from now on.
    Bone(Bone, Shape),
    /// All is as it grows.
    Release,
}

/// Why a skeleton stays as it is.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Refused {
    /// Nothing is grouped.
    #[error("no clustering is shown: bones are those of its groups")]
    NoGroups,
    /// The bone is of a clustering that is not shown: the node says nothing here.
    #[error("{0} is a bone of other groups than those shown: choose a bone of these")]
    OtherGroups(String),
    /// Nothing would change.
    #[error("{0} already")]
    Same(String),
    /// There is nothing to take back.
    #[error("nothing of the skeleton was placed or shaped by hand: it is as it grows")]
    NothingDone,
}

/// The transaction of a step.
///
/// # Errors
/// [`Refused`] where nothing would change, and of bones where nothing is grouped or other groups are shown.
pub fn transaction(document: &Document, step: &Step) -> Result<Transaction, Refused> {
    match step {
        Step::Root(root) => place(document, *root),
        Step::Bone(bone, shape) => {
            let shown = document.clustering().ok_or(Refused::NoGroups)?;
            match bone.clustering == shown.id {
                true => shape_bone(document, bone, *shape),
                false => Err(Refused::OtherGroups(bone.name.clone())),
            }
        }
        Step::Release => release(document),
    }
}

fn place(document: &Document, root: Option<[f64; 2]>) -> Result<Transaction, Refused> {
    let label = match root {
        Some([x, y]) => format!("root placed at {x:.1}, {y:.1}"),
        None => "root: as it grows".to_owned(),
    };
    match root == document.root() {
        true => Err(Refused::Same(label)),
        false => Ok(Transaction::new(label, vec![Edit::PlaceRoot { root }])),
    }
}

fn shape_bone(document: &Document, bone: &Bone, shape: Shape) -> Result<Transaction, Refused> {
    let Bone { clustering, node, name, .. } = bone;
    let was = document.shape(*clustering, *node).unwrap_or_default();
    let label = |told: String| match shape.is_grown() {
        true => format!("{name}: as it grows"),
        false => format!("{name}: {told}"),
    };
    if shape == was {
        return Err(Refused::Same(label(shape.to_string())));
    }
    let edit =
        Edit::ShapeBone { clustering: *clustering, node: *node, shape: (!shape.is_grown()).then_some(shape) };
    Ok(Transaction::new(label(shape.told(&was)), vec![edit]))
}

fn release(document: &Document) -> Result<Transaction, Refused> {
    let mut edits: Vec<Edit> = document.root().map(|_| Edit::PlaceRoot { root: None }).into_iter().collect();
    let root = if edits.is_empty() { None } else { Some("root".to_owned()) };
    let shapes = document
        .clustering()
        .into_iter()
        .flat_map(|shown| document.shapes(shown.id).map(move |(node, _)| (shown.id, node)));
    edits.extend(shapes.map(|(clustering, node)| Edit::ShapeBone { clustering, node, shape: None }));
    let n_bones = edits.len() - usize::from(root.is_some());
    let bones = (n_bones > 0).then(|| counted(n_bones, "bone"));
    let what: Vec<String> = [root, bones].into_iter().flatten().collect();
    if what.is_empty() {
        return Err(Refused::NothingDone);
    }
    Ok(Transaction::new(format!("{}: as the skeleton grows", what.join(" and ")), edits))
}

#[cfg(test)]
mod tests;
