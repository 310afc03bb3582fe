//! Branches pushed out of their plane until they fill the envelope (Zeng 5.5.2, after Li and others 2011).

use std::f64::consts::PI;

use super::envelope::Envelope;
use crate::bones::distance;
use crate::turn::angle;
use crate::von_mises::VonMises;

/// Places tried to either side of where a joint is.
const STEPS: i32 = 20;
/// How far they go, of the width of the plant (Zeng 5.5.2).
const FARTHEST: f64 = 0.2;
/// What every place gains at least, of the distances that are left: where none gains anything, angles decide (errata Z9).
const LEAST: f64 = 1e-9;

/// A joint that may be pushed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pushed {
    /// Its row; what comes before has been pushed.
    pub(super) row: usize,
    /// Row of the joint that its bone begins at.
    pub(super) parent: usize,
    /// Row that the bone before begins at; `None` at the root, where that is straight up.
    pub(super) before: Option<usize>,
    /// Level of its bone.
    pub(super) level: u32,
    /// The way it is pushed, of length 1.
    pub(super) along: [f64; 3],
}

/// Pushes joints in their order, each with all that it bears; `still` are rows of those that stay. Returns how far each has
/// come, pixels.
///
/// Of the places tried, a joint takes the one with the highest product of the local term, by the angle of its bone (5.8), and
/// the global one, by how much nearer the attractors have a joint then (5.10). There X with the joint is X before and the
/// joint, so that nothing is lost elsewhere by what it bears (errata Z9); the sum below the line is the same for all places.
/// Outside the envelope it is 0; a joint that is outside wherever it goes stays.
pub(super) fn push(
    joints: &[Pushed],
    at: &mut [[f64; 3]],
    still: &[usize],
    envelope: &Envelope,
    width: f64,
) -> Vec<f64> {
    let attractors = envelope.attractors();
    let mut far: Vec<f64> = attractors.iter().map(|_| f64::INFINITY).collect();
    still.iter().for_each(|&row| add(&attractors, &mut far, at[row]));
    let deepest = joints.iter().map(|joint| joint.level).max().unwrap_or_default();
    let angles: Vec<f64> = joints.iter().map(|joint| turns_off(joint, at, at[joint.row])).collect();
    let expected = VonMises::fit(&angles).map_or(0.0, |angles| angles.mu);
    let mut by = vec![0.0; at.len()];
    for joint in joints {
        // Its bearer has taken it along.
        by[joint.row] = by[joint.parent];
        at[joint.row] = moved(at[joint.row], joint.along, by[joint.row]);
        let likely = |place: [f64; 3]| {
            // Never 0, as it is where levels end in print (errata Z7).
            let spread = PI * f64::from(deepest - joint.level + 1) / f64::from(deepest + 1);
            let apart = turns_off(joint, at, place) - expected;
            (-apart * apart / (2.0 * spread * spread)).exp()
        };
        let found = best(at[joint.row], joint.along, FARTHEST * width, likely, |place| {
            envelope.holds(place).then(|| gain(&attractors, &far, place))
        });
        at[joint.row] = moved(at[joint.row], joint.along, found);
        by[joint.row] += found;
        add(&attractors, &mut far, at[joint.row]);
    }
    by
}

/// How far along its way the best of the places tried is, the nearer one of equals.
fn best(
    from: [f64; 3],
    along: [f64; 3],
    farthest: f64,
    likely: impl Fn([f64; 3]) -> f64,
    gain: impl Fn([f64; 3]) -> Option<f64>,
) -> f64 {
    let steps = (0..=STEPS).flat_map(|step| if step == 0 { vec![0] } else { vec![step, -step] });
    let (mut found, mut most) = (0.0, 0.0);
    for step in steps {
        let by = farthest * f64::from(step) / f64::from(STEPS);
        let place = moved(from, along, by);
        let score = gain(place).map_or(0.0, |gain| gain * likely(place));
        if score > most {
            (found, most) = (by, score);
        }
    }
    found
}

/// By how much all attractors together have a joint nearer with one more (5.9, with the sum over all of them: errata Z8).
fn gain(attractors: &[[f64; 3]], far: &[f64], place: [f64; 3]) -> f64 {
    let nearer = |(attractor, far): (&[f64; 3], &f64)| (far - distance(*attractor, place)).max(0.0);
    let left = far.iter().sum::<f64>();
    attractors.iter().zip(far).map(nearer).sum::<f64>() + LEAST * left
}

/// One more joint that is where it stays.
fn add(attractors: &[[f64; 3]], far: &mut [f64], place: [f64; 3]) {
    for (attractor, far) in attractors.iter().zip(far) {
        *far = far.min(distance(*attractor, place));
    }
}

/// By how much a joint's bone turns off the one before, were the joint at a place.
fn turns_off(joint: &Pushed, at: &[[f64; 3]], place: [f64; 3]) -> f64 {
    let base = at[joint.parent];
    let from = joint.before.map_or([0.0, 0.0, 1.0], |before| less(base, at[before]));
    angle(from, less(place, base))
}

fn moved(from: [f64; 3], along: [f64; 3], by: f64) -> [f64; 3] {
    std::array::from_fn(|axis| from[axis] + by * along[axis])
}

fn less(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}
