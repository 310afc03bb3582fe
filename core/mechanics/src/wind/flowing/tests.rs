//! Air over trees as a wind.

use super::{Flowing, FlowingError, Inflow};
use crate::wind::{Constant, Draw, Field, Kaimal, Wind};
use nalgebra::Vector3;

const MEAN: Vector3<f64> = Vector3::new(6.0, 2.0, 0.0);

fn inflow<'a>(gusts: &'a dyn Wind, trees: &'a [([f64; 2], f64)]) -> Inflow<'a> {
    Inflow { mean: MEAN, gusts, trees, cell: 4.0, viscosity: 0.5, seconds: 8.0, most_bytes: 1 << 30 }
}

fn gusts() -> Field {
    let kaimal = Kaimal::along(1.5, MEAN.norm(), 60.0);
    let draw = Draw {
        mean: MEAN,
        decay: 10.0,
        first: -40.0,
        n_stations: 5,
        spacing: 20.0,
        n_samples: 512,
        step: 0.1,
        seed: 3,
    };
    Field::new(&draw, [&kaimal; 3])
}

/// Where nothing stands and nothing gusts it is the wind that comes in, everywhere and always.
#[test]
fn over_bare_ground_a_steady_wind_blows_on() {
    let calm = Constant(MEAN);
    let air = Flowing::new(&inflow(&calm, &[])).unwrap();
    for k in 0..200 {
        let t = f64::from(k);
        let v = air.sample(&Vector3::new(3.1 * t - 300.0, 170.0 - 1.7 * t, t / 9.0), 0.07 * t - 1.0);
        assert!((v - MEAN).norm() < 1e-5, "{v}");
    }
}

/// Far from the trees on the windward side what comes in comes; among them it is slower, and slower the more they hold.
#[test]
fn trees_hold_it_back() {
    let calm = Constant(MEAN);
    let trees = |held: f64| -> Vec<([f64; 2], f64)> {
        (0..36).map(|k| ([f64::from(k % 6) * 7.0, f64::from(k / 6) * 7.0], held)).collect()
    };
    let at = |held: f64, place: [f64; 2]| {
        let trees = trees(held);
        let air = Flowing::new(&inflow(&calm, &trees)).unwrap();
        air.sample(&Vector3::new(place[0], place[1], 5.0), 6.0).dot(&MEAN) / MEAN.norm_squared()
    };
    let (few, many) = (at(5.0, [20.0, 20.0]), at(40.0, [20.0, 20.0]));
    assert!(many < 0.7 && many < few - 0.1 && few < 0.99, "{few} {many}");
    let before = at(40.0, [-44.0, 0.0]);
    assert!((0.9..1.0).contains(&before), "{before}");
}

#[test]
fn gusts_come_in_and_no_others() {
    let (gusts, trees) = (gusts(), [([0.0, 0.0], 8.0)]);
    let air = Flowing::new(&inflow(&gusts, &trees)).unwrap();
    let again = Flowing::new(&inflow(&gusts, &trees)).unwrap();
    let (mut off, mut swing) = (0.0, 0.0);
    for k in 0..80 {
        // Two cells from the windward side, and in the middle.
        let (time, place) = (0.1 * f64::from(k), Vector3::new(-42.0, 0.0, 0.0));
        off += (air.sample(&place, time) - gusts.sample(&place, time)).xy().norm_squared();
        swing += (gusts.sample(&place, time) - MEAN).xy().norm_squared();
        let here = air.sample(&Vector3::zeros(), time);
        assert!(here.z == 0.0 && here.xy().norm() < 15.0);
        assert_eq!(here, again.sample(&Vector3::zeros(), time));
    }
    // .38 of it: what two cells of 4 m smooth away. With nothing that comes in it is 1.
    assert!(off < 0.4 * swing, "{off} of {swing}");
}

#[test]
fn air_that_cannot_flow_is_named() {
    let calm = Constant(MEAN);
    let plain = inflow(&calm, &[]);
    let of = |inflow: &Inflow<'_>| Flowing::new(inflow).unwrap_err().to_string();
    for wrong in [
        Inflow { mean: Vector3::zeros(), ..plain },
        Inflow { cell: 0.0, ..plain },
        Inflow { viscosity: -1.0, ..plain },
        Inflow { seconds: f64::NAN, ..plain },
    ] {
        assert!(of(&wrong).starts_with("air flows at more than 0 m/s"), "{}", of(&wrong));
    }
    let far = [([0.0, 0.0], 1.0), ([5000.0, 0.0], 1.0)];
    let error = of(&Inflow { trees: &far, ..plain });
    assert_eq!(
        error,
        "air over 5096 m in cells of 4 m: at most 256 cells a side, so 21.6 m of a cell or more"
    );
    assert!(super::ground(&Inflow { trees: &far, cell: 21.6, ..plain }).is_ok());
    let error = of(&Inflow { seconds: 1e6, ..plain });
    assert!(error.contains("x 24 cells, take 7") && error.contains("1073 MB are there"), "{error}");
    let pushing = [([0.0, 0.0], 1.0), ([1.0, 0.0], -1.0)];
    assert_eq!(
        Flowing::new(&Inflow { trees: &pushing, ..plain }).unwrap_err(),
        FlowingError::Tree { tree: 1, x: 1.0, y: 0.0, held: -1.0 }
    );
    let bytes = Flowing::new(&plain).unwrap().bytes();
    assert!(Flowing::new(&Inflow { most_bytes: bytes, ..plain }).is_ok());
    assert!(Flowing::new(&Inflow { most_bytes: bytes - 1, ..plain }).is_err());
}
