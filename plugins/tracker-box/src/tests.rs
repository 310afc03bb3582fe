//! The plugin as a host drives it, on pictures whose motion is known.

use honami_follow::Losing;
use honami_plugin::{Gray, testing};
use honami_vision::texture;

use super::*;
use crate::settings::{Measure, Strategy};

const WIDTH: u32 = 240;
const HEIGHT: u32 = 180;
/// Motion from each frame to the next, pixels.
const STEP: [f64; 2] = [5.3, -3.6];

/// Frames of a texture that drifts; a gray disc, still, hides it around (60, 100) from frame 3 on.
fn clip(n: usize) -> Vec<Vec<u8>> {
    let frame = |t: usize| {
        texture::render(WIDTH, HEIGHT, |x, y| {
            if t >= 3 && (x - 76.0).hypot(y - 90.0) < 60.0 {
                return 128.0;
            }
            texture::value(2, x - STEP[0] * t as f64, y - STEP[1] * t as f64)
        })
    };
    (0..n).map(frame).collect()
}

fn frames<'a>(clip: &'a [Vec<u8>]) -> impl Iterator<Item = Frame<'a>> {
    let frame = |(t, data): (usize, &'a Vec<u8>)| {
        Frame::new(Gray::packed(data, WIDTH, HEIGHT), t as i64, t as f64 / 25.0)
    };
    clip.iter().enumerate().map(frame)
}

fn seed(id: u32, x: f32, y: f32) -> Seed {
    Seed { id, x, y }
}

fn truth(from: &Seed, t: usize) -> [f32; 2] {
    [from.x + (STEP[0] * t as f64) as f32, from.y + (STEP[1] * t as f64) as f32]
}

/// Each choice once.
fn variants() -> [Settings; 4] {
    let set = |template, measure, strategy| Settings { template, measure, strategy, ..Settings::default() };
    [
        Settings::default(),
        set(Source::Key, Measure::Ncc, Strategy::Pyramidal),
        set(Source::Last, Measure::Ncc, Strategy::Exhaustive),
        set(Source::Key, Measure::Ssd, Strategy::Exhaustive),
    ]
}

#[test]
fn bad_input_is_borne() {
    let quick = |settings| Settings { radius: 4, reach: 6, ..settings };
    for settings in variants() {
        testing::suite::<BoxMatching>(&quick(settings));
    }
}

#[test]
fn points_are_followed_measured_lost_and_left() {
    let clip = clip(8);
    let seeds = [seed(4, 150.2, 140.8), seed(9, 57.0, 102.0), seed(7, 212.0, 90.0)];
    for settings in variants() {
        let strict = Settings { losing: Losing { lose_fb: 2.0, lose_ncc: 0.9 }, ..settings };
        let stream = testing::stream(WIDTH, HEIGHT);
        let rows = testing::track::<BoxMatching>(&strict, &stream, &seeds, frames(&clip)).unwrap();
        for (t, rows) in rows[..8].iter().enumerate() {
            assert_eq!(rows.iter().map(|r| r.id).collect::<Vec<_>>(), [4, 7, 9], "frame {t}");
            let [plain, leaving, hidden] = [rows[0], rows[1], rows[2]];
            let [x, y] = truth(&seeds[0], t);
            assert!((plain.x - x).hypot(plain.y - y) < 0.3, "frame {t}: {plain:?} for {x}, {y}");
            assert_eq!(plain.status, Status::Tracked);
            // Quality belongs to a step: the first frame has none, and there is no way back to a key-frame.
            let way_back = t > 0 && strict.template == Source::Last;
            assert_eq!((plain.fb.is_some(), plain.ncc.is_some()), (way_back, t > 0));
            assert!(
                plain.fb.is_none_or(|fb| fb < 0.2) && plain.ncc.is_none_or(|ncc| ncc > 0.99),
                "{plain:?}"
            );
            // In frame 5 it is on the edge, and may or may not be known again.
            assert!(t == 5 || (leaving.status == Status::Tracked) == (t < 5), "frame {t}: {leaving:?}");
            assert_eq!(hidden.status == Status::Tracked, t < 3, "frame {t}: {hidden:?}");
            assert!(rows.iter().all(|r| r.x.is_finite() && r.y.is_finite()));
        }
    }
}

#[test]
fn a_key_frame_s_template_does_not_drift_with_noise() {
    let n = 30;
    let noisy = |t: usize| {
        texture::render(WIDTH, HEIGHT, |x, y| {
            texture::value(2, x - 0.4 * t as f64, y) + 12.0 * texture::hash(t as u64 + 5, x as i64, y as i64)
        })
    };
    let clip: Vec<_> = (0..n).map(noisy).collect();
    let seeds: Vec<Seed> =
        (0..60).map(|i| seed(i, 40.0 + (i % 10) as f32 * 15.0, 30.0 + (i / 10) as f32 * 20.0)).collect();
    let median = |template: Source| {
        let settings = Settings { template, reach: 8, ..Settings::default() };
        let stream = testing::stream(WIDTH, HEIGHT);
        let rows = testing::track::<BoxMatching>(&settings, &stream, &seeds, frames(&clip)).unwrap();
        let moved = 0.4 * (n - 1) as f32;
        let error = |(row, seed): (&Point, &Seed)| (row.x - seed.x - moved).hypot(row.y - seed.y);
        let mut errors: Vec<f32> = rows[n - 1].iter().zip(&seeds).map(error).collect();
        errors.sort_by(f32::total_cmp);
        errors[errors.len() / 2]
    };
    let (last, key) = (median(Source::Last), median(Source::Key));
    assert!(key < 0.25 && last > 2.0 * key, "{last} px from frame to frame, {key} px from the key-frame");
}

#[test]
fn seeding_again_takes_a_new_template() {
    let clip = clip(6);
    for settings in variants() {
        let mut tracker =
            BoxMatching::begin(&settings, &testing::stream(WIDTH, HEIGHT), &testing::cx()).unwrap();
        let push = |tracker: &mut BoxMatching, t: usize| {
            let mut out = Points::default();
            tracker.push(&frames(&clip).nth(t).unwrap(), &mut out, &testing::cx()).unwrap();
            out.rows().to_vec()
        };
        tracker.seed(&[seed(1, 200.0, 140.0), seed(2, 190.0, 40.0)], &testing::cx()).unwrap();
        (0..4).for_each(|t| drop(push(&mut tracker, t)));
        let moved = seed(1, 160.4, 150.0);
        tracker.seed(&[moved], &testing::cx()).unwrap();
        tracker.retire(&[2, 77]);
        let rows = push(&mut tracker, 4);
        let [x, y] = truth(&moved, 1);
        assert_eq!(rows.iter().map(|r| (r.id, r.status)).collect::<Vec<_>>(), [(1, Status::Tracked)]);
        assert!((rows[0].x - x).hypot(rows[0].y - y) < 0.3, "{:?} for {x}, {y}", rows[0]);
    }
}

#[test]
fn dense_motion_is_that_of_the_texture() {
    let clip = clip(2);
    let [from, to] = [0, 1].map(|t| frames(&clip).nth(t).unwrap());
    let field = dense::field(&Settings::default(), &from, &to, 1, &testing::cx()).unwrap();
    assert_eq!((field.nx, field.ny, field.step), (24, 18, 10.0));
    let near = |[u, v]: &&[f32; 2]| (f64::from(*u) - STEP[0]).hypot(f64::from(*v) - STEP[1]) < 0.4;
    let known = field.vectors.iter().flatten().count();
    let right = field.vectors.iter().flatten().filter(near).count();
    // What leaves the picture is not known; nearly all that is known is right.
    assert!(right > 300 && right * 10 > known * 9, "{right} of {known} known, {} nodes", field.vectors.len());
}

/// Two frames whose parts move each their own way, up to twelve pixels, with noise of their own.
fn gust(seed: u64) -> [Vec<u8>; 2] {
    let sway =
        |axis: u64, x: f64, y: f64| 12.0 * (texture::value(seed + axis, 0.12 * x, 0.12 * y) - 128.0) / 128.0;
    [0, 1].map(|t| {
        texture::render(480, 360, |x, y| {
            let [u, v] = [1, 2].map(|axis| t as f64 * sway(axis, x, y).clamp(-12.0, 12.0));
            texture::value(seed, x - u, y - v) + 6.0 * texture::hash(seed + t, x as i64, y as i64)
        })
    })
}

#[test]
fn the_defaults_find_what_the_exhaustive_search_finds() {
    for (seed, least) in [(31, 99.0), (32, 99.0)] {
        let frames = gust(seed);
        let gray = |i: usize| honami_vision::Gray::packed(&frames[i], 480, 360);
        let wanted =
            honami_vision::detect::Params { max_corners: 500, min_distance_px: 5.0, ..Default::default() };
        let found = honami_vision::detect::corners(&gray(0), None, &[], &wanted);
        let points: Vec<_> = found.iter().map(|corner| corner.at).collect();
        let costs = |strategy| {
            let params = Settings { strategy, ..Settings::default() }.matching();
            let [from, to] = [0, 1].map(|i| Boxes::new(&gray(i), params.levels(), params.radius_px));
            let found = boxes::track(&from, &to, &points, None, &params, 1);
            found.iter().map(|found| found.cost).collect::<Vec<_>>()
        };
        let (all, few) = (costs(Strategy::Exhaustive), costs(Settings::default().strategy));
        let same = all.iter().zip(&few).filter(|(a, b)| a == b).count();
        let agree = 100.0 * same as f64 / points.len() as f64;
        assert!(points.len() > 300 && all.iter().all(|cost| *cost > 0), "{} points", points.len());
        assert!(agree >= least, "seed {seed}: {agree:.2} % of {}", points.len());
    }
}
