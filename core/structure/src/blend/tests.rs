//! Closed forms of bending and twisting, and what is rigid stays rigid.

use std::f64::consts::PI;

use honami_model::clip::FrameTimes;
use honami_model::skeleton::Joint;
use honami_model::turn::norm;
use proptest::prelude::*;

use super::*;

const BOTH: [Blend; 2] = [Blend::Linear, Blend::Dual];

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    norm(std::array::from_fn(|axis| a[axis] - b[axis]))
}

fn binding(shares: &[(u16, f64)]) -> Binding {
    Binding::new(std::array::from_fn(|k| shares.get(k).copied().unwrap_or_default()))
}

/// A turn about the upright through a place beside the origin.
fn twist(angle: f64, [x, y]: [f64; 2]) -> Carry {
    let turn = Turn::about([0.0, 0.0, 1.0], angle);
    let there = turn.apply([x, y, 0.0]);
    Carry { turn, by: [x - there[0], y - there[1], 0.0] }
}

/// The candy wrapper: of a tube that is held below and twisted above, a ring that has the weight w above is as thin as
/// |1 - w + w e^(iθ)| by linear blending, nothing at all for half a turn at w = 1/2; by dual quaternions it is as thick as
/// before, and turned by 2 atan2(w sin θ/2, 1 - w + w cos θ/2).
#[test]
fn a_twisted_tube_keeps_its_thickness_by_dual_quaternions_alone() {
    let axis = [3.0, -2.0];
    for degrees in [0.0_f64, 1.0, 45.0, 90.0, 135.0, 179.0, 180.0] {
        let angle = degrees.to_radians();
        let carries = [twist(0.0, axis), twist(angle, axis)];
        for above in [0.0, 0.125, 0.25, 0.5, 0.75, 1.0_f64] {
            let bound = binding(&[(0, 1.0 - above), (1, above)]);
            for corner in [0.0_f64, 1.0, 2.5, 4.0] {
                let place = |turn: f64, radius: f64| {
                    let (sin, cos) = (corner + turn).sin_cos();
                    [axis[0] + radius * cos, axis[1] + radius * sin, 5.0]
                };
                let there = |blend| blended(&[place(0.0, 0.1)], &[bound], &carries, blend)[0];
                let thin = (1.0 - above + above * angle.cos()).hypot(above * angle.sin());
                let found = apart(there(Blend::Linear), [axis[0], axis[1], 5.0]);
                assert!((found - 0.1 * thin).abs() < 1e-12, "{degrees} {above}: {found}");
                let (sin, cos) = (angle / 2.0).sin_cos();
                let turn = 2.0 * (above * sin).atan2(1.0 - above + above * cos);
                assert!(apart(there(Blend::Dual), place(turn, 0.1)) < 1e-9, "{degrees} {above}");
            }
        }
    }
    let carries = [twist(0.0, axis), twist(PI, axis)];
    let ring = [[axis[0] + 0.1, axis[1], 5.0], [axis[0], axis[1] + 0.1, 5.0]];
    let half = [binding(&[(0, 0.5), (1, 0.5)]); 2];
    let gone = blended(&ring, &half, &carries, Blend::Linear);
    assert!(apart(gone[0], gone[1]) < 1e-12, "linear blending leaves nothing of it");
}

/// Bones that are only moved blend to the mean of where they are moved to, either way.
#[test]
fn what_is_moved_and_not_turned_is_moved_by_the_mean() {
    let by = |x: f64| Carry { turn: Turn::NONE, by: [x, -2.0 * x, 0.5] };
    let carries = [by(0.0), by(1.0), by(4.0)];
    let bound = binding(&[(0, 0.25), (1, 0.5), (2, 0.25)]);
    for blend in BOTH {
        let there = blended(&[[7.0, 8.0, 9.0]], &[bound], &carries, blend)[0];
        assert!(apart(there, [8.5, 5.0, 9.5]) < 1e-12, "{there:?}");
    }
}

/// A stem and two branches: what bones carry at their ends is where the joints are, in every frame.
#[test]
fn ends_of_bones_go_where_joints_go() {
    let joint = |parent: u32, length: f64| Joint { parent: Some(parent), length, ..Joint::default() };
    let joints = vec![Joint::default(), joint(0, 3.0), joint(1, 2.0), joint(1, 1.0)];
    let lean = |k: u32| {
        let (turn, depth) = (0.7 * f64::from(k % 5) - 1.0, 0.4 * f64::from(k % 3) - 0.3);
        [turn.sin() * depth.cos(), depth.sin(), turn.cos() * depth.cos()]
    };
    let directions = (0..28).map(lean).collect();
    let times = FrameTimes::constant(7, 25.0).unwrap();
    let skeleton = Skeleton::new([5.0, 1.0, -2.0], joints, directions, times).unwrap();
    let ends = skeleton.places(skeleton.rest());
    let bindings: Vec<Binding> = (0..4).map(|row| binding(&[(row, 1.0)])).collect();
    for (frame, blend) in (0..7).flat_map(|frame| BOTH.map(|blend| (frame, blend))) {
        let carries = carries(&skeleton, &skeleton, frame);
        let found = blended(&ends, &bindings, &carries, blend);
        for (found, wanted) in found.iter().zip(skeleton.places(skeleton.directions(frame))) {
            assert!(apart(*found, wanted) < 1e-12, "frame {frame}, {blend:?}");
        }
    }
}

proptest! {
    /// Where all bones do the same, the mesh does it, whatever it is bound to.
    #[test]
    fn one_motion_of_all_bones_is_rigid(
        axis in prop::array::uniform3(-1.0..1.0_f64).prop_filter("a direction", |v| norm(*v) > 0.1),
        angle in -PI..PI,
        by in prop::array::uniform3(-100.0..100.0_f64),
        vertices in prop::collection::vec(
            (prop::array::uniform3(-10.0..10.0_f64), prop::array::uniform4((0..5_u16, 0.0..1.0_f64))), 1..20),
    ) {
        let carry = Carry { turn: Turn::about(axis.map(|v| v / norm(axis)), angle), by };
        let positions: Vec<[f64; 3]> = vertices.iter().map(|(place, _)| *place).collect();
        let bindings: Vec<Binding> = vertices.iter().map(|(_, shares)| Binding::new(*shares)).collect();
        for blend in BOTH {
            let found = blended(&positions, &bindings, &[carry; 5], blend);
            for (found, place) in found.iter().zip(&positions) {
                // Weights are floats of 32 bits, which sum up to 1 to their last bit.
                prop_assert!(apart(*found, carry.apply(*place)) < 2e-5, "{:?}", blend);
            }
        }
    }
}
