//! Biovision's motion capture (BVH): a hierarchy of joints, and their angles frame by frame.
//!
//! In BVH a joint turns all that it bears as one, but branches of one fork turn each for itself. So every bone has a joint
//! of its own at its base, those of one fork in one place. Axes are those of most programs that read it: x right, y up, z
//! towards the camera; pixels, degrees, turned about z, then x, then y (the matrix is Rz Rx Ry), from how bones point at
//! rest. The root is in the origin and stays there. Frames are evenly spaced.

use std::fmt::Write as _;

use honami_model::skeleton::{Skeleton, turns};
use honami_model::turn::Turn;

/// What files that are written begin with: others have other names.
pub(super) const BEGIN: &str = "HIERARCHY\nROOT root\n{\n\tOFFSET 0 0 0\n\tCHANNELS 6 Xposition Yposition Zposition \
                                Zrotation Xrotation Yrotation\n\tJOINT bone_1\n";

/// The file.
pub(super) fn text(skeleton: &Skeleton) -> String {
    let joints = skeleton.joints();
    let mut children = vec![Vec::new(); joints.len()];
    for (row, joint) in joints.iter().enumerate() {
        joint.parent.iter().for_each(|&parent| children[parent as usize].push(row));
    }
    let channels = "Zrotation Xrotation Yrotation";
    let mut text = format!(
        "HIERARCHY\nROOT root\n{{\n\tOFFSET 0 0 0\n\tCHANNELS 6 Xposition Yposition Zposition {channels}\n"
    );
    // Bones in the order in which they are written, which is that of their channels.
    let mut order = Vec::with_capacity(joints.len());
    let mut open: Vec<(Option<usize>, usize)> = children[0].iter().rev().map(|&row| (Some(row), 1)).collect();
    while let Some((row, depth)) = open.pop() {
        let tabs = "\t".repeat(depth);
        let Some(row) = row else {
            put(&mut text, format_args!("{tabs}}}\n"));
            continue;
        };
        let base = joints[row].parent.map_or(0, |parent| parent as usize);
        let offset = bone(skeleton, base);
        put(&mut text, format_args!("{tabs}JOINT bone_{row}\n{tabs}{{\n{tabs}\tOFFSET {offset}\n"));
        put(&mut text, format_args!("{tabs}\tCHANNELS 3 {channels}\n"));
        if children[row].is_empty() {
            let end = bone(skeleton, row);
            put(
                &mut text,
                format_args!("{tabs}\tEnd Site\n{tabs}\t{{\n{tabs}\t\tOFFSET {end}\n{tabs}\t}}\n"),
            );
        }
        order.push(row);
        open.push((None, depth));
        open.extend(children[row].iter().rev().map(|&row| (Some(row), depth + 1)));
    }
    text += "}\n";
    motion(skeleton, &order, &mut text);
    text
}

/// The vector of a bone at rest; that of the root is none.
fn bone(skeleton: &Skeleton, row: usize) -> String {
    let [x, y, z] = turned(skeleton.rest()[row]).map(|v| v * skeleton.joints()[row].length);
    format!("{x:.8} {y:.8} {z:.8}")
}

fn motion(skeleton: &Skeleton, order: &[usize], text: &mut String) {
    let times = skeleton.times().as_slice();
    let n_steps = times.len().max(2) - 1;
    let step = match times {
        [first, .., last] => (last - first) / n_steps as f64,
        _ => 0.04,
    };
    put(text, format_args!("MOTION\nFrames: {}\nFrame Time: {step:.9}\n", times.len()));
    let mut before = vec![[0.0; 3]; skeleton.joints().len()];
    for frame in 0..skeleton.times().len() {
        let turns = turns(skeleton.rest(), skeleton.directions(frame));
        text.push_str("0 0 0 0 0 0");
        for &row in order {
            let own = skeleton.joints()[row].parent.filter(|&parent| parent > 0);
            let turn = turns[row];
            let local = own.map_or(turn, |parent| turns[parent as usize].back().after(&turn));
            // The turn of the same orientation that is nearest to the frame before, so that nothing spins between frames.
            for (angle, before) in angles(&local).into_iter().zip(&mut before[row]) {
                *before = angle + 360.0 * ((*before - angle) / 360.0).round();
                put(text, format_args!(" {before:.8}"));
            }
        }
        text.push('\n');
    }
}

/// Writing to a string cannot fail.
fn put(text: &mut String, what: std::fmt::Arguments<'_>) {
    text.write_fmt(what).unwrap_or_default();
}

/// From the axes of plants to those of the file.
fn turned([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, z, -y]
}

/// Angles about z, x and y of the file, degrees, whose product Rz Rx Ry the turn is.
fn angles(turn: &Turn) -> [f64; 3] {
    // Column by column as its axes are turned.
    let columns = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]].map(|axis| turned(turn.apply(axis)));
    let m = |row: usize, column: usize| columns[column][row];
    let x = m(2, 1).clamp(-1.0, 1.0).asin();
    let (z, y) = if m(2, 1).abs() < 1.0 - 1e-12 {
        ((-m(0, 1)).atan2(m(1, 1)), (-m(2, 0)).atan2(m(2, 2)))
    } else {
        // A quarter turn about x makes the others one: all of it is put into the first.
        (m(1, 0).atan2(m(0, 0)), 0.0)
    };
    [z, x, y].map(f64::to_degrees)
}
