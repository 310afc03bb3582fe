//! The plugin as a host drives it, on pictures whose motion is known.

use honami_follow::{Detection, Losing};
use honami_plugin::testing::{self, Clip};
use honami_plugin::{Detect, Frame, Gray, Points, Seed, Status, Stream, Tracker};
use honami_vision::texture;

use super::*;

mod dense;

const WIDTH: u32 = 240;
const HEIGHT: u32 = 180;
const MIDDLE: [f64; 2] = [119.5, 89.5];
/// Motion from each frame to the next, pixels.
const STEP: [f64; 2] = [1.7, -0.9];

/// A texture that drifts; a gray disc, still, hides it around (60, 60) from frame 3 on.
fn clip(n_frames: usize) -> Clip {
    Clip::new(WIDTH, HEIGHT, n_frames, |x, y, t| {
        if t >= 3 && (x - 60.0).hypot(y - 60.0) < 25.0 {
            return 128.0;
        }
        texture::value(2, x - STEP[0] * t as f64, y - STEP[1] * t as f64)
    })
}

/// A texture that turns by so many radians a frame.
fn turning(n_frames: usize, turn: f64) -> Clip {
    Clip::new(WIDTH, HEIGHT, n_frames, |x, y, t| {
        let (sin, cos) = (turn * t as f64).sin_cos();
        let (dx, dy) = (x - MIDDLE[0], y - MIDDLE[1]);
        texture::value(5, MIDDLE[0] + cos * dx + sin * dy, MIDDLE[1] - sin * dx + cos * dy)
    })
}

fn seed(id: u32, x: f32, y: f32) -> Seed {
    Seed { id, x, y }
}

fn losing(lose_fb: f64, lose_ncc: f64) -> Settings {
    Settings { losing: Losing { lose_fb, lose_ncc }, ..Settings::default() }
}

#[test]
fn bad_input_is_borne() {
    testing::suite::<Klt>(&Settings::default());
    testing::suite::<Klt>(&Settings { model: Model::Affine, ..Settings::default() });
}

#[test]
fn points_are_followed_measured_lost_and_left() {
    let clip = clip(8);
    let seeds = [seed(4, 150.2, 100.8), seed(9, 57.0, 62.0), seed(7, 232.0, 90.0)];
    let strict = losing(2.0, 0.0);
    let rows = clip.track::<Klt>(&strict, &seeds).unwrap();
    for (t, rows) in rows.iter().enumerate() {
        assert_eq!(rows.iter().map(|r| r.id).collect::<Vec<_>>(), [4, 7, 9], "frame {t}");
        let [plain, leaving, hidden] = [rows[0], rows[1], rows[2]];
        assert!(testing::off_px(&plain, &seeds[0], STEP, t) < 0.1, "frame {t}: {plain:?}");
        assert_eq!(plain.status, Status::Tracked);
        // Quality belongs to a step: the first frame has none.
        assert_eq!((plain.fb.is_some(), plain.ncc.is_some()), (t > 0, t > 0));
        assert!(plain.fb.is_none_or(|fb| fb < 0.05) && plain.ncc.is_none_or(|ncc| ncc > 0.99), "{plain:?}");
        assert_eq!(leaving.status, if t < 5 { Status::Tracked } else { Status::Outside }, "frame {t}");
        assert_eq!(hidden.status, if t < 3 { Status::Tracked } else { Status::Lost }, "frame {t}");
        assert!(rows.iter().all(|r| r.x.is_finite() && r.y.is_finite()));
    }
    // A lost point waits where it was seen last.
    assert_eq!((rows[7][2].x, rows[7][2].y), (rows[2][2].x, rows[2][2].y));
    assert_eq!(rows[7][2].fb, None);
}

#[test]
fn seeding_again_revives_and_retiring_ends() {
    let clip = clip(8);
    let mut tracker =
        Klt::begin(&Settings::default(), &testing::stream(WIDTH, HEIGHT), &testing::cx()).unwrap();
    let push = |tracker: &mut Klt, t: usize| {
        let mut out = Points::default();
        tracker.push(&clip.frame(t), &mut out, &testing::cx()).unwrap();
        out.rows().to_vec()
    };
    tracker.seed(&[seed(1, 57.0, 62.0), seed(2, 150.0, 100.0)], &testing::cx()).unwrap();
    for t in 0..5 {
        push(&mut tracker, t);
    }
    // Seeds hold in the frame pushed last.
    let revived = seed(1, 120.0, 120.0);
    tracker.seed(&[revived, seed(3, 200.0, 120.0)], &testing::cx()).unwrap();
    tracker.retire(&[2, 77]);
    let rows = push(&mut tracker, 5);
    assert_eq!(
        rows.iter().map(|r| (r.id, r.status)).collect::<Vec<_>>(),
        [(1, Status::Tracked), (3, Status::Tracked)]
    );
    assert!(testing::off_px(&rows[0], &revived, STEP, 1) < 0.1, "{:?}", rows[0]);
}

#[test]
fn an_affine_window_follows_a_turn_that_translation_drifts_off() {
    const TURN: f64 = 0.08;
    let clip = turning(6, TURN);
    let seeds: Vec<Seed> =
        (0..40).map(|i| seed(i, 95.0 + 6.0 * (i % 8) as f32, 60.0 + 12.0 * (i / 8) as f32)).collect();
    let off = |settings: &Settings| {
        let rows = clip.track::<Klt>(settings, &seeds).unwrap();
        let (sin, cos) = (5.0 * TURN).sin_cos();
        let errors = rows[5].iter().zip(&seeds).map(|(row, seed)| {
            let (dx, dy) = (f64::from(seed.x) - MIDDLE[0], f64::from(seed.y) - MIDDLE[1]);
            let want = [MIDDLE[0] + cos * dx - sin * dy, MIDDLE[1] + sin * dx + cos * dy];
            (f64::from(row.x) - want[0]).hypot(f64::from(row.y) - want[1])
        });
        errors.sum::<f64>() / seeds.len() as f64
    };
    let (plain, affine) =
        (off(&Settings::default()), off(&Settings { model: Model::Affine, ..Settings::default() }));
    assert!(affine < 0.5 * plain && affine < 0.2, "{plain} px by translation, {affine} px by affinity");
}

#[test]
fn limits_lose_points() {
    let clip = clip(2);
    let seeds: Vec<Seed> = (0..40).map(|i| seed(i, 40.0 + 4.0 * i as f32, 40.0 + 2.5 * i as f32)).collect();
    let tracked = |settings: &Settings| {
        let rows = clip.track::<Klt>(settings, &seeds).unwrap();
        rows[1].iter().filter(|r| r.status == Status::Tracked).count()
    };
    assert_eq!(tracked(&Settings::default()), 40);
    assert_eq!(tracked(&losing(0.5, 0.9)), 40);
    assert!(tracked(&losing(1e-4, 0.0)) < 20);
    assert!(tracked(&losing(0.0, 1.0)) < 20);
}

#[test]
fn threads_do_not_change_a_bit() {
    let clip = clip(3);
    let seeds: Vec<Seed> = (0..300).map(|i| seed(i, (i * 17 % 240) as f32, (i * 29 % 180) as f32)).collect();
    let rows = [1, 2, 7].map(|max_threads| {
        let stream = Stream { max_threads, ..testing::stream(WIDTH, HEIGHT) };
        testing::track::<Klt>(&Settings::default(), &stream, &seeds, clip.frames()).unwrap()
    });
    assert_eq!(rows[0], rows[1]);
    assert_eq!(rows[0], rows[2]);
}

#[test]
fn detection_minds_mask_points_and_both_maxima() {
    let clip = clip(1);
    let frame = clip.frame(0);
    // Only the left half; rows of the mask are padded.
    let mask: Vec<u8> = (0..(WIDTH + 3) * HEIGHT).map(|i| u8::from(i % (WIDTH + 3) < 120)).collect();
    let mask = Gray { data: &mask, width: WIDTH, height: HEIGHT, stride: WIDTH as usize + 3 };
    let there = [seed(0, 60.0, 90.0)];
    let wanted =
        Detect { frame, max_features: 500, mask: Some(mask), points: &there, max_threads: 1, seed: 0 };
    let detection = Detection { distance: 10.0, quality: 0.001, ..Detection::default() };
    let found = detection.features(&wanted).unwrap();
    assert!(found.len() > 20 && found.is_sorted_by(|a, b| a.score >= b.score));
    assert!(found.iter().all(|f| f.x < 120.0 && (f.x - 60.0).hypot(f.y - 90.0) >= 10.0));
    let few = Detection { max_features: 7, ..detection };
    assert_eq!(few.features(&wanted).unwrap(), found[..7]);
    assert_eq!(few.features(&Detect { max_features: 3, ..wanted }).unwrap(), found[..3]);
}

#[test]
fn a_frame_of_another_size_is_refused() {
    let clip = clip(1);
    let mut tracker =
        Klt::begin(&Settings::default(), &testing::stream(WIDTH, HEIGHT), &testing::cx()).unwrap();
    let frame = clip.frame(0);
    let mut out = Points::default();
    tracker.push(&frame, &mut out, &testing::cx()).unwrap();
    let smaller = Frame { gray: Gray { width: 100, ..frame.gray }, ..frame };
    let error = tracker.push(&smaller, &mut out, &testing::cx()).unwrap_err();
    assert!(error.to_string().contains("100x180"), "{error}");
}
