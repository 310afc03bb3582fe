//! The plugins as a host drives them, on pictures whose motion is known; honami's own KLT as an oracle for LK's.

use honami_plugin::{Error, Frame, Gray, Params, Point, Seed, Status, Tracker, Value, testing};
use honami_vision::pyramid::Pyramid;
use honami_vision::{klt, texture};
use opencv::core::{Mat, Point2f};
use opencv::prelude::*;

use super::*;
use crate::dense::Engine as _;
use crate::follow::Method as _;
use crate::picture::Picture;
use crate::settings::{DisSettings, FarnebackSettings, LkSettings, SiftSettings};

const WIDTH: u32 = 200;
const HEIGHT: u32 = 160;

/// Where what was at a place in frame 0 is in frame `t`: it drifts, and turns about the middle.
fn moved([x, y]: [f64; 2], t: usize) -> [f64; 2] {
    let [drift_x, drift_y] = [1.3 * t as f64, -0.7 * t as f64];
    let (sin, cos) = (0.01 * t as f64).sin_cos();
    let [x, y] = [x - 100.0, y - 80.0];
    [100.0 + cos * x - sin * y + drift_x, 80.0 + sin * x + cos * y + drift_y]
}

/// Frame `t` of a texture that moves so; `is_hidden` covers a disc of it with gray.
fn picture(t: usize, is_hidden: bool) -> Vec<u8> {
    texture::render(WIDTH, HEIGHT, |x, y| {
        if is_hidden && (x - 120.0).hypot(y - 90.0) < 30.0 {
            return 128.0;
        }
        let (sin, cos) = (-0.01 * t as f64).sin_cos();
        let [x, y] = [x - 100.0 - 1.3 * t as f64, y - 80.0 + 0.7 * t as f64];
        texture::value(5, 100.0 + cos * x - sin * y, 80.0 + sin * x + cos * y)
    })
}

fn frame(pixels: &[u8], t: usize) -> Frame<'_> {
    Frame::new(Gray::packed(pixels, WIDTH, HEIGHT), t as i64, t as f64 / 25.0)
}

/// Away from the borders by as much as a large window and the motion take.
fn seeds() -> Vec<Seed> {
    let place = |id: u32| Seed { id, x: 45.3 + 11.0 * (id % 10) as f32, y: 45.8 + 10.0 * (id / 10) as f32 };
    (0..70).map(place).collect()
}

fn run<T: Tracker>(params: &T::Params, pictures: &[Vec<u8>]) -> Vec<Vec<Point>> {
    let frames = pictures.iter().enumerate().map(|(t, pixels)| frame(pixels, t));
    testing::track::<T>(params, &testing::stream(WIDTH, HEIGHT), &seeds(), frames).unwrap()
}

/// Distance between a row and where its seed has gone, pixels.
fn error(row: &Point, t: usize) -> f64 {
    let seed = seeds()[row.id as usize];
    let [x, y] = moved([f64::from(seed.x), f64::from(seed.y)], t);
    (f64::from(row.x) - x).hypot(f64::from(row.y) - y)
}

#[test]
fn hard_input_is_borne() {
    testing::suite::<Follower<Lk>>(&LkSettings::default());
    testing::suite::<Follower<Dense<Dis>>>(&DisSettings::default());
    testing::suite::<Follower<Dense<Farneback>>>(&FarnebackSettings::default());
    testing::suite::<Follower<Sift>>(&SiftSettings::default());
}

/// The share of points that is followed, and the median error of those after six frames, pixels.
fn followed<T: Tracker>() -> (f64, f64) {
    let pictures: Vec<_> = (0..7).map(|t| picture(t, false)).collect();
    let rows = &run::<T>(&T::Params::default(), &pictures)[6];
    let mut errors: Vec<_> =
        rows.iter().filter(|row| row.status == Status::Tracked).map(|row| error(row, 6)).collect();
    errors.sort_by(f64::total_cmp);
    (errors.len() as f64 / rows.len() as f64, errors[errors.len() / 2])
}

#[test]
fn a_texture_that_drifts_and_turns_is_followed() {
    let cases = [
        ("lk", followed::<Follower<Lk>>(), 1.0, 0.3),
        ("dis", followed::<Follower<Dense<Dis>>>(), 1.0, 0.3),
        ("farneback", followed::<Follower<Dense<Farneback>>>(), 1.0, 0.3),
        ("sift", followed::<Follower<Sift>>(), 0.3, 0.5),
    ];
    for (name, (share, median), least_share, most) in cases {
        assert!(share >= least_share && median < most, "{name}: {share} followed, median error {median} px");
    }
}

#[test]
fn equal_parameters_give_the_answer_of_our_klt() {
    let pictures = [picture(0, false), picture(1, false)];
    let points: Vec<_> =
        (0..900).map(|i| [(i % 30) as f32 * 4.9 + 27.7, (i / 30) as f32 * 3.6 + 26.9]).collect();
    for (radius, levels) in [(4, 1), (7, 3), (10, 4), (15, 2)] {
        let mut settings = LkSettings::default();
        settings.set("radius", Value::Int(radius)).unwrap();
        settings.set("levels", Value::Int(levels)).unwrap();
        let params =
            klt::Params { radius_px: radius as u32, levels: levels as u32, ..klt::Params::default() };
        let [from, to] = pictures.each_ref().map(|pixels| {
            let gray = honami_vision::Gray::packed(pixels, WIDTH, HEIGHT);
            Pyramid::new(&gray, params.levels, params.radius_px)
        });
        let ours = klt::track(&from, &to, &points, None, &params, 1);

        let lk = Lk::begin(&settings).unwrap();
        let [from, to] = pictures.each_ref().map(|pixels| lk.pyramid(&mat(pixels, WIDTH, HEIGHT)).unwrap());
        let starts: Vec<_> = points.iter().map(|p| Point2f::new(p[0], p[1])).collect();
        let theirs = lk.flow(&from, &to, &starts).unwrap();

        let both = ours.iter().zip(&theirs).filter(|(a, b)| a.state == klt::State::Tracked && b.1);
        let apart: Vec<_> = both.map(|(a, b)| (a.to[0] - b.0.x).hypot(a.to[1] - b.0.y)).collect();
        let most = apart.iter().copied().fold(0.0, f32::max);
        assert!(
            apart.len() == 900 && most < 0.01,
            "radius {radius}: {} in both, {most} px apart",
            apart.len()
        );
    }
}

#[test]
fn what_opencv_throws_is_an_error_with_its_words() {
    let lk = Lk::begin(&LkSettings::default()).unwrap();
    let [large, small] =
        [(WIDTH, HEIGHT), (60, 40)].map(|(w, h)| lk.pyramid(&mat(&vec![7; (w * h) as usize], w, h)).unwrap());
    let thrown = [
        ("sizes that differ", lk.flow(&large, &small, &[Point2f::new(9.0, 9.0)]).unwrap_err()),
        ("pixels that are no bytes", {
            let numbers = Mat::from_slice(&[0.5_f32; 900]).unwrap();
            lk.pyramid(&numbers.try_clone().unwrap()).err().unwrap()
        }),
        ("sizes that differ, dense", {
            let [large, small] = [(60, 40), (40, 60)].map(|(w, h)| mat(&[7; 2400], w, h));
            Farneback::new(&FarnebackSettings::default()).unwrap().flow(&large, &small).unwrap_err()
        }),
    ];
    for (what, thrown) in thrown {
        let text = Error::from(thrown).to_string();
        assert!(text.contains("OpenCV"), "{what}: {text}");
    }
}

#[test]
fn sift_comes_back_with_what_was_hidden() {
    let hidden = 3..6;
    let pictures: Vec<_> = (0..9).map(|t| picture(t, hidden.contains(&t))).collect();
    let rows = run::<Follower<Sift>>(&SiftSettings::default(), &pictures);
    let behind = |row: &&Point| (row.x - 120.0).hypot(row.y - 90.0) < 15.0;
    let ids: Vec<_> = rows[2].iter().filter(behind).map(|row| row.id as usize).collect();
    let count = |t: usize| ids.iter().filter(|&&id| rows[t][id].status == Status::Tracked).count();
    assert!(
        count(2) > 0 && count(4) == 0 && count(8) > 0,
        "{} then {} then {}",
        count(2),
        count(4),
        count(8)
    );
    // Some may have taken something else for theirs meanwhile.
    let back = ids.iter().map(|&id| &rows[8][id]).filter(|row| row.status == Status::Tracked);
    let mut errors: Vec<_> = back.map(|row| error(row, 8)).collect();
    errors.sort_by(f64::total_cmp);
    assert!(errors[errors.len() / 2] < 1.0, "{errors:?}");
}

#[test]
fn the_way_back_is_measured_where_it_is_wanted() {
    let pictures: Vec<_> = (0..2).map(|t| picture(t, false)).collect();
    for is_wanted in [true, false] {
        let params = DisSettings { back: is_wanted, ..DisSettings::default() };
        let rows = &run::<Follower<Dense<Dis>>>(&params, &pictures)[1];
        assert!(rows.iter().all(|row| row.fb.is_some() == is_wanted && row.ncc.is_some_and(|ncc| ncc > 0.9)));
        assert!(rows.iter().all(|row| row.fb.is_none_or(|fb| fb < 0.5)));
    }
}

#[test]
fn dense_motion_is_that_of_the_texture() {
    let pictures = [picture(0, false), picture(1, false)];
    let [from, to] = [frame(&pictures[0], 0), frame(&pictures[1], 1)];
    let cx = testing::cx();
    let dis = <Follower<Dense<Dis>> as Tracker>::FIELD.unwrap();
    let farneback = <Follower<Dense<Farneback>> as Tracker>::FIELD.unwrap();
    for field in [
        dis(&DisSettings::default(), &from, &to, 1, &cx).unwrap(),
        farneback(&FarnebackSettings::default(), &from, &to, 1, &cx).unwrap(),
    ] {
        for (k, vector) in field.vectors.iter().enumerate() {
            let [u, v] = vector.unwrap_or_default();
            let (column, row) = (k as u32 % field.nx, k as u32 / field.nx);
            let [x, y] =
                [0, 1].map(|axis| f64::from(field.origin[axis] + [column, row][axis] as f32 * field.step));
            let is_inner = (30.0..170.0).contains(&x) && (30.0..130.0).contains(&y);
            let [to_x, to_y] = moved([x, y], 1);
            let off = (f64::from(u) - (to_x - x)).hypot(f64::from(v) - (to_y - y));
            assert!(!is_inner || off < 0.4, "at {x}, {y}: {u}, {v}, off by {off}");
        }
    }
}

fn mat(pixels: &[u8], width: u32, height: u32) -> Mat {
    Picture::copy(&honami_vision::Gray::packed(pixels, width, height)).unwrap().mat
}
