//! Plants of all sizes.

use super::*;
use honami_model::plant::Node;

fn rod(height: f64, radius: f64) -> Plant {
    let node = |parent, z| Node { parent, position: [0.0, 0.0, z], radius };
    Plant::new(vec![node(None, 0.0), node(Some(0), height)]).unwrap()
}

/// A steel rod of 1 mm radius and 200 GPa, 7850 kg/m^3 buckles at 1.72 m (1.98 (B / q)^(1/3) of Timoshenko's Theory of
/// Elastic Stability, 2.12, by which (q l) = 7.837 E I / l^2); wood of the thesis with a radius of 1 cm at 5.85 m.
#[test]
fn a_stem_stands_as_high_as_it_does_not_buckle() {
    let steel = Material { young: 2e11, poisson: 0.3, density: 7850.0 };
    assert!((stands(1e-3, &steel) - 1.72).abs() < 0.005, "{}", stands(1e-3, &steel));
    assert!(
        (stands(0.01, &Material::default()) - 5.845).abs() < 0.005,
        "{}",
        stands(0.01, &Material::default())
    );
}

#[test]
fn what_no_plant_is_like_is_told_with_a_hint() {
    let wood = Material::default();
    for (height, radius, wanted) in [
        (8.0, 0.12, None),
        (0.02, 0.001, None),
        (115.0, 3.0, None),
        (800.0, 12.0, Some("800 m high and 24 m thick at most is odd: plants are 0.01 to 150 m high")),
        (
            0.008,
            0.00012,
            Some("0.008 m high and 0.00024 m thick at most is odd: plants are 0.01 to 150 m high"),
        ),
        (
            8.0,
            2.4,
            Some("8 m high and 4.8 m thick at most is odd: plants are higher than twice their thickness"),
        ),
        (
            28.0,
            0.0188,
            Some("28 m high and 0.0376 m thick at most is odd: a stem so thick stands up to 8.9 m"),
        ),
        (1e300, 1.0, Some("1e300 m high and 2 m thick at most is odd: plants are")),
        (0.0, 1.0, Some("0 m high and 2 m thick at most is odd: plants are")),
    ] {
        let said = odd(&rod(height, radius), &wood, "is it the unit?");
        match (&said, wanted) {
            (Some(said), Some(wanted)) => {
                assert!(said.starts_with(wanted), "{said}");
                assert!(said.ends_with("; is it the unit?"), "{said}");
            }
            _ => assert_eq!(said.as_deref(), wanted, "{height} {radius}"),
        }
    }
}

#[test]
fn what_a_file_without_units_makes_of_a_plant_is_told() {
    let both = |unit: bool, diameters: bool| [("--unit", unit), ("--diameters", diameters)];
    for (options, wanted) in [
        (&both(false, false)[..1], "; --unit says otherwise"),
        (&both(true, false)[..1], ""),
        (&both(false, false), "; --unit and --diameters say otherwise"),
        (&both(true, false), "; --diameters says otherwise"),
        (&both(true, true), ""),
    ] {
        let told = as_taken(&rod(28.314, 0.1875), "lengths taken in 0.01 m", options);
        let taken = "the file names no units: lengths taken in 0.01 m, which makes it 28.3 m high and 0.375 m thick at most";
        assert_eq!(told, format!("{taken}{wanted}"));
    }
}
