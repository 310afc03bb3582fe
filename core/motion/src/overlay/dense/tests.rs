//! Fields of known form between their nodes, and on pictures.

use super::*;
use crate::overlay::Dial;

/// A field whose velocity is linear in the position.
fn linear(nx: usize, ny: usize) -> VelocityField {
    let (origin, step_px) = ([3.5, -2.0], 8.0);
    let at = |i: usize| {
        let place = [(i % nx) as f64, (i / nx) as f64];
        truth([0, 1].map(|axis| origin[axis] + place[axis] * step_px)).map(|v| v as f32)
    };
    VelocityField { origin, step_px, nx, velocities: (0..nx * ny).map(at).map(Some).collect() }
}

fn truth([x, y]: [f64; 2]) -> [f64; 2] {
    [2.0 * x - 0.5 * y + 1.0, 0.25 * x + 3.0 * y]
}

#[test]
fn what_is_linear_is_exact_between_the_nodes_and_held_beyond_them() {
    let field = linear(4, 3);
    for point in [[3.5, -2.0], [5.0, 1.0], [27.5, 14.0], [20.25, 13.9]] {
        let (came, wanted) = (field.at(point).unwrap(), truth(point));
        assert!((0..2).all(|axis| (came[axis] - wanted[axis]).abs() < 1e-4), "{point:?}: {came:?}");
    }
    assert_eq!(field.at([0.0, -5.0]), field.at([3.5, -2.0]));
    assert_eq!(field.at([31.0, 17.0]), field.at([27.5, 14.0]));
    for outside in [[-0.6, 0.0], [31.6, 0.0], [5.0, -6.1], [5.0, 18.1], [f64::NAN, 0.0]] {
        assert_eq!(field.at(outside), None, "{outside:?}");
    }
    assert_eq!(linear(1, 1).at([4.0, -3.0]), Some(truth([3.5, -2.0])), "one node");
    assert_eq!(linear(4, 0).at([4.0, -3.0]), None, "no node");
}

#[test]
fn what_is_not_known_leaves_its_weight_to_what_is() {
    let velocities = vec![Some([2.0, 0.0]), None, None, None, Some([8.0, 4.0]), None];
    let field = VelocityField { origin: [0.0; 2], step_px: 4.0, nx: 3, velocities };
    for (point, wanted) in [
        ([0.0, 0.0], Some([2.0, 0.0])),
        ([1.0, 0.0], Some([2.0, 0.0])),
        ([3.0, 0.0], None),
        ([2.0, 2.0], Some([5.0, 2.0])),
        ([4.0, 3.0], Some([8.0, 4.0])),
        ([8.0, 4.0], None),
    ] {
        assert_eq!(field.at(point), wanted, "{point:?}");
    }
    assert_eq!(field.usual_speed(), Some(80.0_f64.sqrt()));
}

#[test]
fn the_usual_speed_is_that_of_what_moves() {
    let mut field =
        VelocityField { origin: [0.0; 2], step_px: 1.0, nx: 20, velocities: vec![Some([0.0; 2]); 400] };
    assert_eq!(field.usual_speed(), None);
    field.velocities[..20].fill(Some([3.0, -4.0]));
    assert_eq!(field.usual_speed(), Some(5.0));
    field.velocities[399] = Some([1000.0, 0.0]);
    assert_eq!(field.usual_speed(), Some(5.0), "one node that went astray");
    assert_eq!(VelocityField { velocities: Vec::new(), ..field }.usual_speed(), None);
}

#[test]
fn each_pixel_takes_the_colour_of_its_own_place() {
    // Two halves that go right and left; the picture shows two image pixels a pixel.
    let velocities = [[10.0, 0.0], [10.0, 0.0], [-5.0, 0.0], [-5.0, 0.0]].map(Some).to_vec();
    let field = VelocityField { origin: [1.5, 4.0], step_px: 4.0, nx: 4, velocities };
    let mapping = Mapping { gain_s_px: 0.1, dial: Dial::ALL };
    let mut pixels = [[100; 3]; 16];
    paint_field(&mut pixels, 8, &field, &mapping, |[x, y]| [2.0 * x + 0.5, 2.0 * y + 3.0]);
    assert_eq!((pixels[0], pixels[7]), ([255, 0, 0], [50, 178, 178]), "the second has half the strength");
    assert_eq!(pixels[8..12], pixels[..4], "within half a step below");
    let left = Mapping { dial: Dial { centre_rad: std::f64::consts::PI, half_width_rad: 0.5 }, ..mapping };
    let mut pixels = [[100; 3]; 8];
    paint_field(&mut pixels, 8, &field, &left, |[x, y]| [2.0 * x + 0.5, 2.0 * y + 4.0]);
    assert_eq!((pixels[0], pixels[7]), ([100; 3], [50, 178, 178]), "the dial leaves one of them out");
}
