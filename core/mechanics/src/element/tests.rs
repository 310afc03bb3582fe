//! The beam against what it is the integral of, and against bending without strain.

use super::{Section, frame};
use nalgebra::{SMatrix, SVector, Vector3};

const SECTION: Section = Section { length: 0.7, radius: 0.02, young: 1e10, shear: 1e10 / 2.6, density: 1e3 };

/// Gauss's points and weights on 0..1, exact to the seventh power.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

type Whole = SMatrix<f64, 12, 12>;

fn whole(ends: &super::Ends) -> Whole {
    let mut whole = Whole::zeros();
    whole.fixed_view_mut::<6, 6>(0, 0).copy_from(&ends.base);
    whole.fixed_view_mut::<6, 6>(6, 6).copy_from(&ends.tip);
    whole.fixed_view_mut::<6, 6>(6, 0).copy_from(&ends.across);
    whole.fixed_view_mut::<6, 6>(0, 6).copy_from(&ends.across.transpose());
    whole
}

/// The shape functions at a share of the length, 0 to 1: displacement and torsion there from those of the ends, in the
/// frame of the segment (6.4; errata E37, E38).
pub(crate) fn shape(share: f64, length: f64) -> SMatrix<f64, 4, 12> {
    let (p, l) = (share, length);
    let [l1, l2] = [1.0 - p, p];
    let h1 = 1.0 - 3.0 * p.powi(2) + 2.0 * p.powi(3);
    let h2 = l * p * (1.0 - p).powi(2);
    let h3 = p.powi(2) * (3.0 - 2.0 * p);
    let h4 = l * p.powi(2) * (p - 1.0);
    let mut shape = SMatrix::zeros();
    for (row, column, value) in [
        (0, 0, l1),
        (0, 6, l2),
        (1, 1, h1),
        (1, 5, h2),
        (1, 7, h3),
        (1, 11, h4),
        (2, 2, h1),
        (2, 4, -h2),
        (2, 8, h3),
        (2, 10, -h4),
        (3, 3, l1),
        (3, 9, l2),
    ] {
        shape[(row, column)] = value;
    }
    shape
}

/// Displacement and torsion are the shape functions; the kinetic energy is their square (6.8).
#[test]
fn mass_is_the_integral_of_the_shape_functions() {
    // In its own frame: x-axis along, y and z where `frame` puts them.
    let direction = Vector3::x();
    let mut turn = Whole::zeros();
    for k in [0, 3, 6, 9] {
        turn.fixed_view_mut::<3, 3>(k, k).copy_from(&frame(&direction));
    }
    let mut wanted = Whole::zeros();
    for (share, weight) in GAUSS {
        let shape = shape(share, SECTION.length);
        let polar = 2.0 * SECTION.inertia();
        let per_length = SVector::<f64, 4>::new(SECTION.area(), SECTION.area(), SECTION.area(), polar);
        let dense = SMatrix::<f64, 4, 4>::from_diagonal(&(per_length * SECTION.density));
        wanted += shape.transpose() * dense * shape * (weight * SECTION.length);
    }
    let wanted = turn * wanted * turn.transpose();
    let error = (whole(&SECTION.mass(&direction)) - wanted).amax() / wanted.amax();
    assert!(error < 1e-14, "{error}");
}

/// The strain energy is the square of second derivatives (6.5), here by differences of the shape functions, which are
/// cubic: exact but for rounding.
#[test]
fn stiffness_is_the_integral_of_curvatures() {
    let (l, step) = (SECTION.length, 0.01);
    let direction = Vector3::x();
    let mut turn = Whole::zeros();
    for k in [0, 3, 6, 9] {
        turn.fixed_view_mut::<3, 3>(k, k).copy_from(&frame(&direction));
    }
    let mut wanted = Whole::zeros();
    for (share, weight) in GAUSS {
        let [before, here, after] = [share - step, share, share + step].map(|share| shape(share, l));
        let slope = (after - before) / (2.0 * step * l);
        let bend = (after - here * 2.0 + before) / (step * l).powi(2);
        let (young, shear, inertia) = (SECTION.young, SECTION.shear, SECTION.inertia());
        let mut energy = slope.row(0).transpose() * slope.row(0) * (young * SECTION.area());
        energy += slope.row(3).transpose() * slope.row(3) * (shear * SECTION.polar());
        for axis in [1, 2] {
            energy += bend.row(axis).transpose() * bend.row(axis) * (young * inertia);
        }
        wanted += energy * (weight * l);
    }
    let wanted = turn * wanted * turn.transpose();
    let got = whole(&SECTION.stiffness(&direction));
    for (got, wanted) in got.iter().zip(wanted.iter()) {
        assert!((got - wanted).abs() < 1e-7 * wanted.abs().max(1.0), "{got} {wanted}");
    }
}

#[test]
fn a_segment_that_is_carried_or_turned_as_a_whole_is_not_strained() {
    let cases = [Vector3::x(), Vector3::z(), Vector3::new(0.3, -0.5, 0.8).normalize()];
    for direction in cases {
        let stiffness = whole(&SECTION.stiffness(&direction));
        let along = direction * SECTION.length;
        for axis in 0..3 {
            let mut unit = Vector3::zeros();
            unit[axis] = 1.0;
            let turned = unit.cross(&along);
            let carried = SVector::<f64, 12>::from_iterator(
                [unit, Vector3::zeros(), unit, Vector3::zeros()].iter().flat_map(|v| v.iter().copied()),
            );
            let swung = SVector::<f64, 12>::from_iterator(
                [Vector3::zeros(), unit, turned, unit].iter().flat_map(|v| v.iter().copied()),
            );
            for motion in [carried, swung] {
                let force = (stiffness * motion).amax() / stiffness.amax();
                assert!(force < 1e-15, "{direction:?} {axis} {force}");
            }
        }
    }
}

#[test]
fn a_frame_is_right_handed_wherever_it_looks() {
    for direction in
        [Vector3::x(), -Vector3::x(), Vector3::z(), -Vector3::z(), Vector3::new(1e-9, 0.0, 1.0).normalize()]
    {
        let frame = frame(&direction);
        assert!((frame.determinant() - 1.0).abs() < 1e-14);
        assert!((frame * frame.transpose() - nalgebra::Matrix3::identity()).amax() < 1e-14);
    }
}

/// The load on the ends of a segment that is pressed on all along: L/2, L^2/12, L/2, -L^2/12 (errata E37, E38).
#[test]
fn an_even_load_is_shared_by_the_ends_as_in_textbooks() {
    let l = SECTION.length;
    let mut load = SMatrix::<f64, 4, 12>::zeros();
    for (share, weight) in GAUSS {
        load += shape(share, l) * (weight * l);
    }
    let wanted = [l / 2.0, l * l / 12.0, l / 2.0, -l * l / 12.0];
    for (row, places, sign) in [(1, [1, 5, 7, 11], 1.0), (2, [2, 4, 8, 10], -1.0)] {
        for (k, place) in places.into_iter().enumerate() {
            let wanted = if k % 2 == 0 { wanted[k] } else { sign * wanted[k] };
            assert!((load[(row, place)] - wanted).abs() < 1e-15, "{row} {place}: {}", load[(row, place)]);
        }
    }
}
