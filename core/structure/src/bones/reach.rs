//! Poses whose tips reach their groups: bones are passed on from the tips to the root and back, each as long as it is,
//! until nothing is left to gain (the method is FABRIK: Aristidou and Lasenby, Graphical Models 73, 2011).
//!
//! A plant of k groups has about 2k bones: that is enough to reach k places in the picture, where aiming bones one by one
//! (thesis 4.4.2) leaves at the tips what lengths have changed by in the clip.

use honami_model::skeleton::Joint;

use super::distance;

/// Rounds at most.
const MAX_ROUNDS: u32 = 20;
/// Tips move less than this in a round, pixels: nothing is left to gain.
const SETTLED: f64 = 1e-4;

/// Moves the joints of one frame so that those with a target come as near to it as bones allow. Joints are each after their
/// parent, and where bones of their length put them.
pub(super) fn reach(joints: &[Joint], targets: &[Option<[f64; 3]>], at: &mut [[f64; 3]]) {
    let mut wishes = vec![([0.0; 3], 0.0); joints.len()];
    for _ in 0..MAX_ROUNDS {
        // Towards the root: what is borne says where its base is to be.
        wishes.fill(([0.0; 3], 0.0));
        for (row, joint) in joints.iter().enumerate().skip(1).rev() {
            let (sum, n) = targets[row].map_or(wishes[row], |target| add(wishes[row], target));
            let wished = if n > 0.0 { sum.map(|v| v / n) } else { at[row] };
            wishes[row] = (wished, 1.0);
            if let Some(parent) = joint.parent.map(|parent| parent as usize) {
                let base = along(wished, at[parent], joint.length).unwrap_or(at[parent]);
                wishes[parent] = add(wishes[parent], base);
            }
        }
        // And back: the root stays, bones point where they are wished.
        let mut farthest: f64 = 0.0;
        for (row, joint) in joints.iter().enumerate().skip(1) {
            let Some(parent) = joint.parent.map(|parent| parent as usize) else {
                continue;
            };
            let Some(end) = along(at[parent], wishes[row].0, joint.length) else {
                continue;
            };
            farthest = farthest.max(distance(end, at[row]));
            at[row] = end;
        }
        if farthest < SETTLED {
            break;
        }
    }
}

fn add((sum, n): ([f64; 3], f64), place: [f64; 3]) -> ([f64; 3], f64) {
    (std::array::from_fn(|axis| sum[axis] + place[axis]), n + 1.0)
}

/// So far from a place towards another; `None` where they are one.
fn along(from: [f64; 3], to: [f64; 3], length: f64) -> Option<[f64; 3]> {
    let far = distance(from, to);
    (far > 1e-9 * length)
        .then(|| std::array::from_fn(|axis| from[axis] + length * (to[axis] - from[axis]) / far))
}
