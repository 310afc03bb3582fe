//! What becomes of a plant's nodes on their way to beams.

use super::{Beams, BeamsError, Options};
use crate::material::Material;
use honami_model::plant::{Node, Plant};
use nalgebra::Vector3;
use std::f64::consts::PI;

fn plant(rows: &[(Option<u32>, [f64; 3], f64)]) -> Plant {
    let node = |&(parent, position, radius): &(Option<u32>, [f64; 3], f64)| Node { parent, position, radius };
    Plant::new(rows.iter().map(node).collect()).unwrap()
}

/// A stem of 2 m with a branch that begins where the stem ends, by a segment without length.
fn forked() -> Plant {
    plant(&[
        (None, [0.0, 0.0, 0.0], 0.1),
        (Some(0), [0.0, 0.0, 2.0], 0.1),
        (Some(1), [0.0, 0.0, 2.0], 0.02),
        (Some(2), [1.0, 0.0, 2.0], 0.02),
        (Some(1), [0.0, 0.0, 3.0], 0.08),
    ])
}

#[test]
fn nodes_in_one_place_are_one_and_what_they_bear_hangs_on_it() {
    let beams = Beams::new(&forked(), &Options::default()).unwrap();
    assert_eq!((beams.len(), beams.n_merged(), beams.n_stubby()), (4, 1, 0));
    assert_eq!(beams.of_plant(), [0, 1, 1, 2, 3]);
    let parents: Vec<_> = beams.nodes().iter().map(|node| node.parent).collect();
    assert_eq!(parents, [None, Some(0), Some(1), Some(1)]);
}

#[test]
fn a_long_segment_is_divided_into_equal_parts_that_taper_as_it_does() {
    let whole = plant(&[(None, [0.0; 3], 0.03), (Some(0), [0.0, 0.0, 1.0], 0.02)]);
    let beams = Beams::new(&whole, &Options { longest: Some(0.3), ..Options::default() }).unwrap();
    assert_eq!((beams.len(), beams.of_plant()), (5, &[0, 4][..]));
    let radii: Vec<f64> = beams.segments().map(|(_, _, section, _)| section.radius).collect();
    for (radius, wanted) in radii.iter().zip([0.02875, 0.02625, 0.02375, 0.02125]) {
        assert!((radius - wanted).abs() < 1e-15, "{radii:?}");
    }
    for (_, _, section, direction) in beams.segments() {
        assert!((section.length - 0.25).abs() < 1e-15 && (direction - Vector3::z()).norm() < 1e-15);
    }
}

#[test]
fn what_is_thicker_than_long_is_counted() {
    let short =
        plant(&[(None, [0.0; 3], 0.1), (Some(0), [0.0, 0.0, 0.05], 0.1), (Some(1), [0.0, 0.0, 1.0], 0.1)]);
    assert_eq!(Beams::new(&short, &Options::default()).unwrap().n_stubby(), 1);
}

/// The mass of all segments, and of what hangs on them, moves when all nodes move alike.
#[test]
fn mass_is_that_of_the_wood_and_of_what_hangs_on_it() {
    let free =
        plant(&[(None, [0.0; 3], 0.1), (Some(0), [0.0, 0.0, 1e-3], 0.1), (Some(1), [0.0, 0.5, 2.0], 0.1)]);
    let mut beams = Beams::new(&free, &Options::default()).unwrap();
    beams.load([(2, 7.0)]);
    let mass = beams.mass();
    let (mut carried, mut product) = (vec![0.0; 12], vec![0.0; 12]);
    (carried[0], carried[6]) = (1.0, 1.0);
    mass.times(&carried, &mut product);
    let got = product[0] + product[6];
    let length = beams.segments().map(|(_, _, section, _)| section.length).nth(1).unwrap();
    let wanted = 1e3 * PI * 0.01 * length + 7.0;
    // The first segment, of a millimetre, is clamped at one end: 13/35 of it moves.
    let clamped = 13.0 / 35.0 * 1e3 * PI * 0.01 * 1e-3;
    assert!((got - wanted - clamped).abs() < 1e-9, "{got} {wanted}");
}

#[test]
fn what_cannot_be_beams_is_named() {
    let point = plant(&[(None, [1.0; 3], 0.1), (Some(0), [1.0; 3], 0.1)]);
    assert_eq!(Beams::new(&point, &Options::default()).unwrap_err(), BeamsError::Point);
    for longest in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let options = Options { longest: Some(longest), ..Options::default() };
        assert!(matches!(Beams::new(&forked(), &options), Err(BeamsError::Longest(_))), "{longest}");
    }
    let options = Options { longest: Some(1e-9), ..Options::default() };
    let error = Beams::new(&forked(), &options).unwrap_err();
    assert!(error.to_string().contains("nodes of beams, and 4000000 are the most"), "{error}");
    let wood = Material::default();
    let cases = [
        (Material { young: -1e9, ..wood }, "a material has a Young's modulus of more than 0 Pa, not of -1e9"),
        (Material { density: 0.0, ..wood }, "a material has a density of more than 0 kg/m3, not of 0"),
        (Material { density: f64::NAN, ..wood }, "a material has a density of more than 0 kg/m3, not of NaN"),
        (Material { poisson: 0.6, ..wood }, "a material has a Poisson's ratio of -1 to 0.5, not of 0.6"),
    ];
    for (material, wanted) in cases {
        let error = Beams::new(&forked(), &Options { material, ..Options::default() }).unwrap_err();
        assert_eq!(error.to_string(), wanted);
    }
}

#[test]
fn coarse_comes_before_fine_and_parents_before_children() {
    let beams = Beams::new(&honami_synth::tree(300, 1).unwrap(), &Options::default()).unwrap();
    let order = beams.coarse_to_fine();
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(k, node)| place[*node as usize] = k);
    let is_after = |node: usize| beams.parent(node).is_none_or(|parent| place[parent as usize] < place[node]);
    assert!((0..beams.len()).all(is_after));
    let thick = |nodes: &[u32]| nodes.iter().map(|node| beams.radius(*node as usize)).sum::<f64>();
    assert!(thick(&order[..30]) > 3.0 * thick(&order[270..]));
}
