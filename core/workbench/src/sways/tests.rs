//! Tables as they come: heads, separators, decimal commas, times; and what is wrong with them, by its line.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;

use super::*;

/// A swing of 0.5 Hz and 5 %, ten samples a second.
fn swung(t: f64) -> f64 {
    (-0.05 * TAU * 0.5 * t).exp() * (TAU * 0.5 * 0.9975_f64.sqrt() * t).cos()
}

fn read(text: &str, fps: Option<f64>, within: Within) -> Result<Sways, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("record.txt");
    fs::write(&path, text).unwrap();
    of_columns(&path, fps, within, Pieces::default())
        .map_err(|error| error.to_string().replace(path.to_str().unwrap(), "FILE"))
}

fn rows(head: &str, row: impl Fn(f64) -> String) -> String {
    (0..200).fold(head.to_owned(), |mut text, k| {
        writeln!(text, "{}", row(f64::from(k) / 10.0)).unwrap();
        text
    })
}

#[test]
fn a_record_is_read_however_its_columns_are_parted_and_named() {
    let comma = |v: f64| format!("{v:.6}").replace('.', ",");
    for (text, fps, name) in [
        (rows("", |t| format!("   {:.7e}", swung(t))), Some(10.0), "column 1"),
        (rows("# strain\n", |t| format!("{}\t{}", swung(t), swung(t))), Some(10.0), "column 1"),
        (rows("t_s,top\n", |t| format!("{t},{}", swung(t))), None, "top"),
        (rows("\"top\";\"Time\"\n", |t| format!("{};{}", comma(swung(t)), comma(t + 7.0))), None, "top"),
        (rows("\u{feff}time_s,top\r\n", |t| format!("{t},{}\r", swung(t))), None, "top"),
        (rows("time_s top\n\n", |t| format!("{t} {}", swung(t))), Some(10.0), "top"),
    ] {
        let found = read(&text, fps, Within::default()).unwrap();
        assert!((found.fps - 10.0).abs() < 1e-6 && found.n_samples == 200, "{name}: {found:?}");
        assert_eq!(found.series[0].name, name);
        let median = found.median.unwrap();
        assert!(
            (median.hz.value - 0.5).abs() < 1e-4 && (median.ratio.value - 0.05).abs() < 1e-3,
            "{median:?}"
        );
    }
}

#[test]
fn what_is_wrong_with_a_record_is_told_by_its_line() {
    let gap = rows("t_s,x\n", |t| format!("{},{}", if t > 5.0 { t + 1.0 } else { t }, swung(t)));
    let cut = Within { to_s: Some(5.0), ..Within::default() };
    assert_eq!(read(&gap, None, cut).unwrap().n_samples, 51);
    let within = |from_s, to_s| Within { from_s, to_s, above_hz: 0.0 };
    for (text, fps, within, wanted) in [
        (
            gap.as_str(),
            None,
            Within::default(),
            "line 53: 1.1000 s after the one before, where 0.1000 s are usual",
        ),
        ("1 2\n3\n", Some(4.0), Within::default(), "line 2: wanted 2 numbers as before, came 1"),
        ("1,2\n\n3,\n", Some(4.0), Within::default(), "line 3, column 2: wanted a number, came nothing"),
        ("1\nNaN\n", Some(4.0), Within::default(), "line 2, column 1: wanted a number, came \"NaN\""),
        ("nan\n1\n", Some(4.0), Within::default(), "line 1, column 1: wanted a number, came \"nan\""),
        ("1\n2 x\n", Some(4.0), Within::default(), "line 2, column 2: wanted a number, came \"x\""),
        (
            "t,x\n0,1\n1,2\n1,3\n",
            None,
            Within::default(),
            "line 4: its time, 1 s, is not after the one before",
        ),
        (
            "t,x\n0,1\n1,2\n2,3\n",
            Some(4.0),
            Within::default(),
            "its times say 1.0000 rows a second, and --fps says 4",
        ),
        ("x\n1\n2\n", None, Within::default(), "its rows have no times: --fps"),
        ("t\n1\n2\n", None, Within::default(), "it has times and no other column"),
        ("x,y\n", Some(4.0), Within::default(), "it has no rows"),
        (
            "1\n2\n3\n",
            Some(1.0),
            within(Some(5.0), None),
            "it lasts from 0 to 2 s, and was asked for from 5 to 2 s",
        ),
        ("1\n2\n3\n", Some(1.0), within(Some(2.0), Some(1.0)), "asked for from 2 to 1 s"),
        (
            "1\n2\n3\n",
            Some(1.0),
            Within { above_hz: 0.5, ..Within::default() },
            "nothing above 0.5 Hz can be seen",
        ),
    ] {
        let said = read(text, fps, within).unwrap_err();
        assert!(said.contains(wanted), "{said:?}, wanted {wanted:?}");
    }
}

#[test]
fn times_count_from_the_record_and_a_part_of_it_is_a_swing_of_its_own() {
    let text = rows("t_s,x\n", |t| format!("{},{}", t + 100.0, swung((t - 4.0).max(0.0))));
    let whole = read(&text, None, Within::default()).unwrap();
    let Ok(swing) = &whole.series[0].swing else { panic!("{whole:?}") };
    assert_eq!((whole.start_s, swing.manner), (100.0, Manner::LetGo));
    assert!((swing.first as f64 / 10.0 - 4.0).abs() < 0.3, "{swing:?}");
    let within = Within { from_s: Some(104.0), to_s: Some(114.0), above_hz: 0.0 };
    let part = read(&text, None, within).unwrap();
    assert_eq!((part.start_s, part.n_samples), (104.0, 101));
    assert!((part.median.unwrap().ratio.value - 0.05).abs() < 1e-4, "{part:?}");
}

#[test]
fn a_median_is_as_uncertain_as_its_swings_or_as_they_differ() {
    let told = |value, error| Told { value, error };
    let one = |hz, error, manner| Swing {
        manner,
        hz: told(hz, error),
        ratio: told(0.05, 0.01),
        n_cycles: 9.0,
        first: 0,
    };
    let alike = median(vec![one(0.3, 0.01, Manner::LetGo), one(0.3, 0.03, Manner::LetGo)]).unwrap();
    assert_eq!(alike.hz, told(0.3, 0.02));
    let manners = [Manner::LetGo, Manner::Driven, Manner::LetGo, Manner::Steady];
    let apart = median((0..4).map(|k| one(f64::from(k), 0.01, manners[k as usize])).collect()).unwrap();
    assert_eq!((apart.hz.value, apart.manner), (1.5, Manner::LetGo));
    // 0, 1, 2, 3 lie 1.5, .5, .5, 1.5 from their median.
    assert!((apart.hz.error - 1.2533 * 1.4826 * 1.0 / 2.0).abs() < 1e-12, "{apart:?}");
    assert_eq!(median(Vec::new()), None);
}
