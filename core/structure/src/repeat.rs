//! Loops: the part of a motion that comes back nearest to how it began, with what is left of the jump spread over it.

#[cfg(test)]
mod tests;

use std::ops::Range;

use honami_model::clip::FrameTimes;
use honami_model::skeleton::{Leaf, Skeleton};

use crate::StructureError;

/// Frames that it may be of, at least.
const MIN_FRAMES: u32 = 4;
/// A loop is at least this share of the frames that it may be of.
const MIN_SHARE: f64 = 0.5;

/// The skeleton over the frames of its best loop, all of them `within` some, and which those are: after the last comes the
/// first, without a jump. Times stay.
///
/// Best is where directions of bones, weighted by length, and their changes from frame to frame are most alike at both
/// ends; no shorter than half of the frames that it is within.
///
/// # Errors
/// [`StructureError::TooBrief`] for less than 4 frames.
pub fn repeat(skeleton: &Skeleton, within: Range<u32>) -> Result<(Skeleton, Range<u32>), StructureError> {
    let within = within.start..within.end.min(skeleton.times().len());
    let n_frames = within.end.saturating_sub(within.start);
    if n_frames < MIN_FRAMES {
        return Err(StructureError::TooBrief { came: n_frames, wanted: MIN_FRAMES });
    }
    let least = ((f64::from(n_frames) * MIN_SHARE).ceil() as u32).max(2);
    let frames = smoothest(skeleton, &within, least);
    let (first, last) = (skeleton.directions(frames.start), skeleton.directions(frames.end));
    let directions = frames.clone().flat_map(|frame| {
        let share = share(&frames, frame);
        let corrected = move |((now, first), last): ((&[f64; 3], &[f64; 3]), &[f64; 3])| {
            let moved: [f64; 3] = std::array::from_fn(|axis| now[axis] - share * (last[axis] - first[axis]));
            let length = moved.iter().map(|v| v * v).sum::<f64>().sqrt();
            // Only a bone that turns round within the loop has no direction on its way.
            if length > 1e-6 { moved.map(|v| v / length) } else { *now }
        };
        skeleton.directions(frame).iter().zip(first).zip(last).map(corrected)
    });
    let times = skeleton.times().as_slice()[frames.start as usize..frames.end as usize].to_vec();
    let leaves = skeleton.leaves().iter().map(|leaf| carried(leaf, &frames)).collect();
    let joints = skeleton.joints().to_vec();
    let repeated = Skeleton::new(skeleton.root(), joints, directions.collect(), FrameTimes::new(times)?)?
        .with_leaves(leaves)?;
    Ok((repeated, frames))
}

/// A loop that ends as it begins: with its first pose once more at a time after its last frame, for what is played from key to
/// key. It carries no leaves.
///
/// # Errors
/// [`StructureError::Times`] for a time that is not later than the last.
pub fn closed(skeleton: &Skeleton, time_s: f64) -> Result<Skeleton, StructureError> {
    let frames = (0..skeleton.times().len()).chain([0]);
    let directions = frames.flat_map(|frame| skeleton.directions(frame)).copied().collect();
    let times = skeleton.times().as_slice().iter().copied().chain([time_s]).collect();
    let joints = skeleton.joints().to_vec();
    Ok(Skeleton::again(skeleton.root(), joints, directions, FrameTimes::new(times)?)?)
}

/// How much of the way from the first to the last pose is taken back in a frame.
fn share(frames: &Range<u32>, frame: u32) -> f64 {
    f64::from(frame - frames.start) / f64::from(frames.end - frames.start)
}

/// The range of at least so many frames whose ends have the smallest jump, the first of equals.
///
/// All are tried, in long clips hundreds of millions: bones that move most come first, so that a range is given up soon.
fn smoothest(skeleton: &Skeleton, within: &Range<u32>, least: u32) -> Range<u32> {
    let poses: Vec<&[[f64; 3]]> = within.clone().map(|frame| skeleton.directions(frame)).collect();
    let moves = |row: usize| -> f64 {
        poses
            .iter()
            .map(|pose| squared(std::array::from_fn(|axis| pose[row][axis] - skeleton.rest()[row][axis])))
            .sum()
    };
    let mut bones: Vec<(f64, usize, f64)> = (skeleton.joints().iter().enumerate().skip(1))
        .map(|(row, joint)| (joint.length * moves(row), row, joint.length))
        .collect();
    bones.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let (n, least) = (poses.len(), least as usize);
    let (mut found, mut smallest) = (0..n - 1, f64::INFINITY);
    for first in 0..n {
        for end in first + least..n {
            let jump = jump(&poses, &bones, first..end, smallest);
            if jump < smallest {
                (found, smallest) = (first..end, jump);
            }
        }
    }
    within.start + found.start as u32..within.start + found.end as u32
}

/// How far the pose at the end of a range of frames is from that at its beginning, and how differently both go on; something
/// above `most` where it is above.
fn jump(poses: &[&[[f64; 3]]], bones: &[(f64, usize, f64)], frames: Range<usize>, most: f64) -> f64 {
    let (first, second) = (poses[frames.start], poses[frames.start + 1]);
    let (before, last) = (poses[frames.end - 1], poses[frames.end]);
    let mut sum = 0.0;
    for &(_, row, length) in bones {
        let apart = std::array::from_fn(|axis| last[row][axis] - first[row][axis]);
        let bend = std::array::from_fn(|axis| {
            (last[row][axis] - before[row][axis]) - (second[row][axis] - first[row][axis])
        });
        sum += length * (squared(apart) + squared(bend));
        if sum > most {
            break;
        }
    }
    sum
}

fn squared([x, y, z]: [f64; 3]) -> f64 {
    x * x + y * y + z * z
}

/// A leaf over the loop, corrected as the bones are.
fn carried(leaf: &Leaf, frames: &Range<u32>) -> Leaf {
    let (first, last) = (leaf.offsets[frames.start as usize], leaf.offsets[frames.end as usize]);
    let corrected = |frame: u32| {
        let (now, share) = (leaf.offsets[frame as usize], share(frames, frame));
        std::array::from_fn(|axis| now[axis] - share * (last[axis] - first[axis]))
    };
    Leaf { track: leaf.track, joint: leaf.joint, offsets: frames.clone().map(corrected).collect() }
}
