//! Winds as typed.

use super::{WEATHERS, blow};
use honami_mechanics::Direction;

#[test]
fn every_wind_that_has_a_name_blows_with_numbers() {
    for weather in WEATHERS {
        let wind = blow(weather.name).unwrap();
        for k in 0..50 {
            let t = f64::from(k);
            let v = wind.sample(&Direction::new(t, -2.0 * t, 5.0), 0.37 * t);
            assert!(v.iter().all(|v| v.is_finite()), "{}: {v}", weather.name);
        }
    }
}

#[test]
fn directions_are_degrees_from_x_towards_y() {
    for (towards, wanted) in [(0, [5.0, 0.0]), (90, [0.0, 5.0]), (180, [-5.0, 0.0])] {
        let wind = blow(&format!("steady:speed=5,towards={towards}")).unwrap();
        let v = wind.sample(&Direction::zeros(), 0.0);
        assert!((v.x - wanted[0]).abs() < 1e-12 && (v.y - wanted[1]).abs() < 1e-12, "{towards}: {v}");
    }
}

#[test]
fn what_is_no_wind_is_told_what_there_is() {
    let cases = [
        ("breeze", "\"breeze\" is no wind and no file: there are still, steady, calm,"),
        ("steady:sped=3", "steady has no \"sped\": it takes speed, towards"),
        ("still:speed=3", "still has no \"speed\": it takes nothing"),
        ("steady:speed=NaN", "speed of steady is a number from -1000000 to 1000000, not \"NaN\""),
        ("steady:speed", "speed of steady is a number from -1000000 to 1000000, not \"\""),
        ("noise:cell=0", "cell of noise is a number from 0.000001 to 1000000, not \"0\""),
        ("gusts:speed=0", "gusts is carried by its mean: speed is a number above 0, not 0"),
    ];
    for (typed, wanted) in cases {
        let error = blow(typed).err().unwrap().to_string();
        assert!(error.starts_with(wanted), "{error}");
    }
}
