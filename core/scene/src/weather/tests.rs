//! Winds as typed.

use super::{Ground, N_SAMPLES, STEP_S, WEATHERS, WeatherError, read};
use honami_mechanics::Vector;
use honami_mechanics::wind::{Kaimal, Spectrum, Wind};

/// Over a few trees, for two seconds.
fn blow(typed: &str) -> Result<Box<dyn Wind>, WeatherError> {
    let trees = (0..9).map(|k| ([f64::from(k % 3) * 6.0, f64::from(k / 3) * 6.0], 400.0)).collect();
    read(typed)?.over(&Ground::new(trees, 2.0, 1 << 30))
}

/// A wind that begins again after so many seconds.
fn round(typed: &str, seconds: f64) -> Result<Box<dyn Wind>, WeatherError> {
    read(typed)?.over(&Ground { seconds, ..Ground::default() }.round())
}

/// Each: what is typed, seconds for which it can begin again, and for which it cannot.
#[test]
fn winds_that_go_round_begin_again_and_others_are_refused() {
    let cases: [(&str, &[f64], &[f64]); 9] = [
        ("still", &[7.3], &[]),
        ("steady+vortex", &[7.3], &[]),
        ("storm", &[0.04, 7.3, 20.0], &[]),
        ("rough:seed=4", &[7.3], &[]),
        ("noise+calm", &[2.0, 20.0], &[0.5, 7.3]),
        ("waves", &[10.0, 20.0], &[7.0]),
        ("steady+squall", &[], &[20.0]),
        ("frozen+noise", &[], &[20.0]),
        ("air", &[], &[20.0]),
    ];
    for (typed, can, cannot) in cases {
        for seconds in can {
            let wind = round(typed, *seconds).unwrap();
            for k in 0..9 {
                let (place, t) = (Vector::new(f64::from(k) * 3.0, -4.0, 5.0), 0.37 * f64::from(k));
                let off = (wind.sample(&place, t + seconds) - wind.sample(&place, t)).norm();
                assert!(off < 1e-9, "{typed} {seconds} {t}: {off}");
            }
        }
        for seconds in cannot {
            let error = round(typed, *seconds).err().unwrap().to_string();
            let wanted = format!("is not after {seconds} s what it was");
            assert!(error.contains(&wanted), "{typed}: {error}");
        }
    }
    // Of the spectrum that it was: the same mean, and of its gusts of 1.6 m/s what goes into a minute, read between stations.
    let (wind, n) = (round("wind", 60.0).unwrap(), 6000);
    let along: Vec<f64> = (0..n).map(|k| wind.sample(&Vector::zeros(), f64::from(k) * 0.01).x).collect();
    let mean = along.iter().sum::<f64>() / f64::from(n);
    let deviation = (along.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / f64::from(n)).sqrt();
    assert!((mean - 8.0).abs() < 1e-9 && (0.8..1.6).contains(&deviation), "{mean} {deviation}");
    let error = round("wind", 3601.0).err().unwrap().to_string();
    assert_eq!(error, "a wind begins again after 3600 s at most, not 3601 s");
}

fn at(typed: &str, place: [f64; 3], time: f64) -> Vector {
    blow(typed).unwrap().sample(&Vector::from(place), time)
}

#[test]
fn every_wind_that_has_a_name_blows_with_numbers() {
    for weather in WEATHERS {
        let carries = ["frozen", "log", "power"].contains(&weather.name);
        let carried = if carries { format!("{}+noise", weather.name) } else { weather.name.to_owned() };
        let wind = blow(&carried).unwrap();
        for k in 0..50 {
            let t = f64::from(k);
            let v = wind.sample(&Vector::new(t, -2.0 * t, 5.0), 0.37 * t);
            assert!(v.iter().all(|v| v.is_finite()), "{}: {v}", weather.name);
        }
    }
}

#[test]
fn directions_are_degrees_from_x_towards_y() {
    for (towards, wanted) in [(0, [5.0, 0.0]), (90, [0.0, 5.0]), (180, [-5.0, 0.0])] {
        let v = at(&format!("steady:speed=5,towards={towards}"), [0.0; 3], 0.0);
        assert!((v.x - wanted[0]).abs() < 1e-12 && (v.y - wanted[1]).abs() < 1e-12, "{towards}: {v}");
    }
}

/// Each pair: what is typed, and the winds that it is the sum of.
#[test]
fn winds_with_a_plus_between_them_add_up() {
    for (typed, parts) in [
        ("wind+vortex:strength=300", &["wind", "vortex:strength=300"][..]),
        ("steady:speed=1e+1", &["steady:speed=10"]),
        ("steady:speed=+3+squall+noise:speed=0", &["steady:speed=3", "squall", "noise:speed=0"]),
    ] {
        for (place, time) in [([3.0, -8.0, 5.0], 0.4), ([-20.0, 11.0, 2.0], 1.7)] {
            let wanted: Vector = parts.iter().map(|part| at(part, place, time)).sum();
            assert!((at(typed, place, time) - wanted).norm() < 1e-12 && wanted.norm() > 0.1, "{typed}");
        }
    }
}

/// Errata E25: at its time it is what it carries and the mean; later the same further on. What stands before it adds up.
#[test]
fn frozen_carries_what_follows_it() {
    let place = [4.0, 1.0, 2.0];
    let mean = Vector::new(0.0, 5.0, 0.0);
    let of =
        |time: f64, place: [f64; 3]| at("vortex+frozen:speed=5,towards=90,at=3+noise:speed=0", place, time);
    let vortex = |place: [f64; 3]| at("vortex", place, 0.0);
    let given = at("noise:speed=0", place, 3.0) + mean + vortex(place);
    assert!((of(3.0, place) - given).norm() < 1e-12);
    let further = [4.0, 1.0 + 5.0 * 1.5, 2.0];
    let later = of(4.5, further) - vortex(further);
    assert!((later - (of(3.0, place) - vortex(place))).norm() < 1e-9);
}

/// By a power of 1 the wind is twice as fast at twice the height; what stands before it is as it was.
#[test]
fn a_profile_is_of_what_follows_it() {
    for (typed, z, wanted) in [
        ("power:height=5,exponent=1+steady:speed=4", 10.0, 8.0),
        ("steady:speed=1+power:height=5,exponent=1+steady:speed=4", 10.0, 9.0),
        ("log:height=8,roughness=2+steady:speed=4", 32.0, 8.0),
        ("log:height=8,roughness=2+steady:speed=4+steady:speed=2", 32.0, 12.0),
    ] {
        let v = at(typed, [1.0, 2.0, z], 0.5);
        assert!((v.x - wanted).abs() < 1e-12, "{typed}: {v}");
    }
}

#[test]
fn winds_that_end_before_the_motion_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mast.csv");
    let rows: String = (0..40).map(|k| format!("{},1,2\n", 0.5 * f64::from(k))).collect();
    std::fs::write(&path, rows).unwrap();
    let file = path.display();
    let recorded = |seconds: &str| {
        format!("{file}, a recording, lasts for 20.0 s, the motion for {seconds} s: it begins again")
    };
    for (typed, seconds, wanted) in [
        (format!("{file}"), 20.0, vec![]),
        (format!("{file}"), 20.5, vec![recorded("20.5")]),
        (
            format!("storm+steady+{file}"),
            500.0,
            vec![
                "storm lasts for 409.6 s, the motion for 500.0 s: it begins again".to_owned(),
                recorded("500.0"),
            ],
        ),
        (format!("noise+steady+frozen+{file}"), 1e6, vec![]),
    ] {
        assert_eq!(read(&typed).unwrap().again(seconds), wanted);
    }
}

/// Wherever a tree stands it swings as much as was asked for, less what is slower or faster than is drawn: the sum of the
/// spectrum over the frequencies.
#[test]
fn gusts_deviate_at_every_tree_as_they_are_told_to() {
    let (n, step) = (N_SAMPLES as i32, STEP_S);
    let kaimal = Kaimal::along(1.6, 8.0, 60.0);
    let df = 1.0 / (f64::from(n) * step);
    let wanted: f64 = (1..n / 2).map(|k| kaimal.density(f64::from(k) * df) * df).sum();
    assert!((0.9..1.0).contains(&(wanted.sqrt() / 1.6)), "{wanted}");
    let variance = |typed: &str, place: Vector, along: Vector| {
        let wind = blow(typed).unwrap();
        let gust = |k: i32| wind.sample(&place, f64::from(k) * step).dot(&along) - 8.0;
        (0..n).map(|k| gust(k).powi(2)).sum::<f64>() / f64::from(n)
    };
    for towards in [0, 30, 90] {
        let (sin, cos) = f64::from(towards).to_radians().sin_cos();
        let (along, typed) =
            (Vector::new(cos, sin, 0.0), |seed: i32| format!("wind:towards={towards},seed={seed}"));
        for [x, y] in [[0.0, 0.0], [6.0, 6.0], [12.0, 0.0], [0.0, 12.0]] {
            // On a sample of the station, whatever the way to it takes.
            let tree = Vector::new(x, y, 0.0);
            let far = tree.dot(&along);
            let place = tree + along * ((far / 8.0 / step).round() * step * 8.0 - far);
            let mean = (1..=4).map(|seed| variance(&typed(seed), place, along)).sum::<f64>() / 4.0;
            assert!((0.8..1.25).contains(&(mean / wanted)), "{towards} {x} {y}: {mean} of {wanted}");
        }
    }
}

#[test]
fn air_that_flows_by_itself_is_held_back_by_the_trees() {
    let along = |typed: &str| {
        let (wind, middle) = (blow(typed).unwrap(), Vector::new(6.0, 6.0, 5.0));
        (0..20).map(|k| wind.sample(&middle, 0.1 * f64::from(k)).x).sum::<f64>() / 20.0
    };
    let [free, some, much] = [0.0, 0.02, 0.2].map(|drag| along(&format!("air:deviation=0,drag={drag}")));
    assert!((free - 8.0).abs() < 1e-5, "what does not gust is steady where nothing holds it back: {free}");
    assert!(some < 0.98 * free && much < 0.8 * some, "{free} {some} {much}");
    // A place is reached by other gusts with another seed, and by none without a deviation.
    let [one, other] = [1, 2].map(|seed| along(&format!("air:seed={seed}")));
    let calm = [1, 2].map(|seed| along(&format!("air:deviation=0,seed={seed}")));
    assert!((one - other).abs() > 0.01 && calm[0].to_bits() == calm[1].to_bits(), "{one} {other} {calm:?}");
}

#[test]
fn what_is_no_wind_is_told_what_there_is() {
    let cases = [
        ("breeze", "\"breeze\" is no wind and no file: there are still, steady, calm,"),
        ("8.5", "\"8.5\" is no wind and no file: there are still,"),
        ("steady.speed=3", "\"steady.speed=3\" is no wind and no file"),
        ("wind.", "\"wind.\" is no wind and no file"),
        ("gusts.csv", "gusts.csv: No such file"),
        ("logs/8.5", "logs/8.5: No such file"),
        ("wind+", "\"\" is no wind and no file: there are still,"),
        ("wind+breeze:speed=3", "\"breeze:speed=3\" is no wind and no file"),
        ("steady:sped=3", "steady has no \"sped\": it takes speed, towards"),
        ("still:speed=3", "still has no \"speed\": it takes nothing"),
        ("steady:speed=NaN", "speed of steady is a number from -1000000 to 1000000, not \"NaN\""),
        ("steady:speed", "speed of steady is a number from -1000000 to 1000000, not \"\""),
        ("noise:cell=0", "cell of noise is a number from 0.000001 to 1000000, not \"0\""),
        ("wind:deviation=-1", "deviation of wind is a number from 0 to 1000000, not \"-1\""),
        ("rough:density=-1", "density of rough is a number from 0 to 1000000, not \"-1\""),
        ("rough:beta=400", "beta of rough is a number from 0 to 20, not \"400\""),
        ("wind:seed=1.5", "seed of wind is a whole number, 0 or more, not \"1.5\""),
        ("wind:speed=8,speed=9", "wind is told its speed twice"),
        ("air:drag=-1", "drag of air is a number from 0 to 1000000, not \"-1\""),
        ("gusts:speed=0", "gusts is carried by its mean: speed is a number above 0, not 0"),
        ("noise+frozen+steady+storm", "storm is carried by a mean of its own: frozen carries what stays"),
        ("wind+frozen", "frozen carries what follows it: frozen+noise:speed=0, for instance"),
        ("power+wind+log", "log carries what follows it: log+noise:speed=0, for instance"),
        (
            "log:height=0.1+wind",
            "log has its wind above the ground: a height above displacement and roughness, 0.1 m",
        ),
        ("log:roughness=0+wind", "roughness of log is a number from 0.000001 to 1000000, not \"0\""),
        ("power:exponent=-1+wind", "exponent of power is a number from 0 to 2, not \"-1\""),
        ("air:cell=0.01", "air over 12 m in cells of 0.01 m: at most 256 cells a side"),
    ];
    for (typed, wanted) in cases {
        let error = blow(typed).err().unwrap().to_string();
        assert!(error.starts_with(wanted), "{error}");
    }
}
