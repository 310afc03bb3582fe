//! Skeletons as hands have shaped them: planes of bones turned out of the picture (thesis 4.4.3, the first method), bones that
//! lean otherwise, curves of their motion made stronger or weaker.
//!
//! Motion is that of local systems along the branches (4.4.2): what a bone does is how it turns beside the bone that bears it.
//! That is a polar angle in the picture, and a spherical one in depth. So whatever turns a bone takes all along that it
//! bears, leaves too, and lengths stay.

#[cfg(test)]
mod tests;

use honami_model::shape::Shape;
use honami_model::skeleton::{Leaf, Skeleton};

use crate::StructureError;
use crate::turn::{Turn, angle, axis};

/// Into the picture, away from the camera.
const AWAY: [f64; 3] = [0.0, 1.0, 0.0];
/// What copies stand about.
const UP: [f64; 3] = [0.0, 0.0, 1.0];
/// Directions so near to each other are one.
const SAME: f64 = 1e-9;

/// How a joint's bone is shaped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shaped {
    /// By hand.
    pub shape: Shape,
    /// Row of the joint that it is a copy of, before its own: a mirror image, or the same turned about the upright. It is
    /// turned as that one looks to itself.
    pub copy_of: Option<u32>,
}

/// Where a copy of the skeleton stands.
#[derive(Clone, Copy, Debug)]
struct Side {
    /// What is away from the camera for the one in the picture.
    away: [f64; 3],
    /// What its bones turn about when they lean.
    lean: [f64; 3],
}

/// The skeleton with its bones shaped, `by` a joint each; where `by` is shorter, the rest are as they are. Bones that
/// nothing was done to, nor to what bears them, keep every bit.
///
/// # Errors
/// [`StructureError::Skeleton`], which turns of skeletons do not meet.
pub fn shaped(skeleton: &Skeleton, by: &[Shaped]) -> Result<Skeleton, StructureError> {
    let n = skeleton.joints().len();
    let shape = |row: usize| by.get(row).map(|by| by.shape).filter(|shape| !shape.is_grown());
    if (1..n).all(|row| shape(row).is_none()) {
        return Ok(skeleton.clone());
    }
    let sides = sides(skeleton, by);
    let turns: Vec<Option<(Turn, f64)>> = (0..n)
        .map(|row| shape(row).map(|shape| (standing(skeleton.rest()[row], &shape, sides[row]), shape.gain)))
        .collect();
    let n_frames = skeleton.times().len();
    let mut directions = Vec::with_capacity(n * n_frames as usize);
    let mut leaves: Vec<Leaf> = skeleton.leaves().to_vec();
    for frame in 0..n_frames {
        let (now, by) = posed(skeleton, frame, &turns);
        directions.extend(now);
        for leaf in &mut leaves {
            if let Some(turn) = by[leaf.joint as usize] {
                let offset = &mut leaf.offsets[frame as usize];
                *offset = turn.apply(*offset);
            }
        }
    }
    let joints = skeleton.joints().to_vec();
    let made = Skeleton::again(skeleton.root(), joints, directions, skeleton.times().clone())?;
    Ok(made.with_leaves(leaves)?)
}

/// How a bone stands otherwise at rest: its plane turned about what is at right angles to it in there, then leaning in the
/// picture.
fn standing(rest: [f64; 3], shape: &Shape, side: Side) -> Turn {
    let out = Turn::about(axis(rest, side.away), shape.plane_rad);
    Turn::about(side.lean, shape.lean_rad).after(&out)
}

/// Where all bones point in a frame, and what turns what they carry; `None` of those that stay.
fn posed(
    skeleton: &Skeleton,
    frame: u32,
    turns: &[Option<(Turn, f64)>],
) -> (Vec<[f64; 3]>, Vec<Option<Turn>>) {
    let mut directions = skeleton.directions(frame).to_vec();
    // Local systems as they were seen, and as they are made: both are none at rest.
    let mut seen = vec![Turn::NONE; directions.len()];
    let mut made: Vec<Option<Turn>> = vec![None; directions.len()];
    let mut by = vec![None; directions.len()];
    for (row, joint) in skeleton.joints().iter().enumerate() {
        let Some(parent) = joint.parent.map(|parent| parent as usize) else { continue };
        let rest = skeleton.rest()[row];
        let local = seen[parent].back().apply(directions[row]);
        let (about, angle) = (axis(rest, local), angle(rest, local));
        seen[row] = seen[parent].after(&Turn::about(about, angle));
        if turns[row].is_none() && made[parent].is_none() {
            continue;
        }
        let (standing, gain) = turns[row].unwrap_or((Turn::NONE, 1.0));
        let bearer = made[parent].unwrap_or(seen[parent]);
        let turn = bearer.after(&standing).after(&Turn::about(about, gain * angle));
        directions[row] = turn.apply(rest);
        by[row] = Some(turn.after(&seen[row].back()));
        made[row] = Some(turn);
    }
    (directions, by)
}

/// Where each joint's copy of the skeleton stands. The n-th copies of all joints are one.
fn sides(skeleton: &Skeleton, by: &[Shaped]) -> Vec<Side> {
    let original = |row: usize| by.get(row).and_then(|by| by.copy_of).map(|row| row as usize);
    let mut n_copies = vec![0; skeleton.joints().len()];
    let mut pairs: Vec<Vec<[usize; 2]>> = Vec::new();
    let number: Vec<usize> = (0..n_copies.len())
        .map(|row| {
            let Some(of) = original(row) else { return 0 };
            n_copies[of] += 1;
            let number: usize = n_copies[of];
            pairs.resize(pairs.len().max(number), Vec::new());
            pairs[number - 1].push([of, row]);
            number
        })
        .collect();
    let mut sides = vec![Side { away: AWAY, lean: AWAY }];
    sides.extend(pairs.iter().map(|pairs| side(skeleton, pairs)));
    number.into_iter().map(|number| sides[number]).collect()
}

/// Where a copy stands, read off its bones beside those that they are copies of: behind the picture as its mirror image, or
/// turned about the upright by what brings horizontal motion of the ones nearest to that of the others. A branch that was
/// pushed out of the plane of its copy moves as it did. What does not move is told by how it points.
fn side(skeleton: &Skeleton, pairs: &[[usize; 2]]) -> Side {
    let frames = || (0..skeleton.times().len()).map(|frame| skeleton.directions(frame));
    let is_image = |directions: &[[f64; 3]], [of, row]: [usize; 2]| {
        let [x, y, z] = directions[of];
        angle([x, -y, z], directions[row]) < SAME
    };
    if frames().all(|directions| pairs.iter().all(|pair| is_image(directions, *pair))) {
        let [x, y, z] = AWAY;
        return Side { away: [x, -y, z], lean: AWAY };
    }
    let first = skeleton.directions(0);
    let sums = |from: &dyn Fn(usize) -> [f64; 3]| {
        let mut sums = [0.0; 2];
        for directions in frames() {
            for pair in pairs {
                let [[ax, ay], [bx, by]] =
                    pair.map(|row| [0, 1].map(|axis| directions[row][axis] - from(row)[axis]));
                sums = [sums[0] + ax * by - ay * bx, sums[1] + ax * bx + ay * by];
            }
        }
        sums
    };
    let moved = sums(&|row| first[row]);
    let is_moved = moved[0].hypot(moved[1]) > SAME * SAME;
    let [across, along] = if is_moved { moved } else { sums(&|_| [0.0; 3]) };
    let away = Turn::about(UP, across.atan2(along)).apply(AWAY);
    Side { away, lean: away }
}
