//! The plugin as a host drives it; what the algorithm can do is tested where it is.

use honami_plugin::{Gray, testing};
use honami_vision::texture;

use super::*;

const WIDTH: u32 = 200;
const HEIGHT: u32 = 150;
/// Motion from each frame to the next, pixels.
const STEP: [f64; 2] = [1.3, -0.7];

/// Frames of a texture that drifts; a gray disc, still, hides part of it in some of them.
fn clip(hidden: std::ops::Range<usize>) -> Vec<Vec<u8>> {
    let frame = |t: usize| {
        texture::render(WIDTH, HEIGHT, |x, y| {
            if hidden.contains(&t) && (x - 70.0).hypot(y - 70.0) < 18.0 {
                return 128.0;
            }
            texture::value(2, x - STEP[0] * t as f64, y - STEP[1] * t as f64)
        })
    };
    (0..12).map(frame).collect()
}

fn frames(clip: &[Vec<u8>]) -> impl Iterator<Item = Frame<'_>> {
    clip.iter()
        .zip(0_u32..)
        .map(|(data, t)| Frame::new(Gray::packed(data, WIDTH, HEIGHT), i64::from(t), f64::from(t) / 25.0))
}

#[test]
fn bad_input_is_borne() {
    testing::suite::<Anchored>(&Settings::default());
}

#[test]
fn every_status_reaches_the_host() {
    let clip = clip(3..8);
    let seeds = [(4, 130.2, 100.8), (9, 65.0, 73.0), (7, 193.0, 90.0)].map(|(id, x, y)| Seed { id, x, y });
    let impatient = Settings { patience: 2, ..Settings::default() };
    for (settings, hidden) in [(Settings::default(), Status::Occluded), (impatient, Status::Lost)] {
        let stream = testing::stream(WIDTH, HEIGHT);
        let rows = testing::track::<Anchored>(&settings, &stream, &seeds, frames(&clip)).unwrap();
        for (t, rows) in rows[..12].iter().enumerate() {
            assert_eq!(rows.iter().map(|row| row.id).collect::<Vec<_>>(), [4, 7, 9], "frame {t}");
            assert_eq!((rows[0].status, rows[0].ncc.is_some()), (Status::Tracked, t > 0), "frame {t}");
            assert_eq!(rows[0].fb.is_some(), t > 0);
        }
        assert_eq!((rows[2][2].status, rows[6][2].status), (Status::Tracked, hidden), "{:?}", rows[6][2]);
        assert_eq!((rows[3][1].status, rows[11][1].status), (Status::Tracked, Status::Outside));
        let found = if hidden == Status::Lost { Status::Lost } else { Status::Tracked };
        assert_eq!(rows[11][2].status, found, "{:?}", rows[11][2]);
    }
}

#[test]
fn seeding_again_moves_a_point_and_retiring_ends_it() {
    let clip = clip(0..0);
    let stream = testing::stream(WIDTH, HEIGHT);
    let mut tracker = Anchored::begin(&Settings::default(), &stream, &testing::cx()).unwrap();
    tracker
        .seed(&[Seed { id: 1, x: 60.0, y: 60.0 }, Seed { id: 2, x: 90.0, y: 80.0 }], &testing::cx())
        .unwrap();
    let mut out = Points::default();
    for (t, frame) in frames(&clip).enumerate() {
        if t == 5 {
            tracker.seed(&[Seed { id: 1, x: 120.0, y: 90.0 }], &testing::cx()).unwrap();
            tracker.retire(&[2, 77]);
        }
        out.restart(frame.index);
        tracker.push(&frame, &mut out, &testing::cx()).unwrap();
    }
    let [row] = out.rows() else { panic!("{:?}", out.rows()) };
    let [x, y] = [120.0 + 7.0 * STEP[0], 90.0 + 7.0 * STEP[1]].map(|c| c as f32);
    assert_eq!((row.id, row.status), (1, Status::Tracked));
    assert!((row.x - x).hypot(row.y - y) < 0.1, "{row:?} for {x}, {y}");
}

#[test]
fn a_larger_radius_is_a_larger_window_all_over() {
    let [usual, twice] = [7, 14].map(|radius| Settings { radius, ..Settings::default() }.tracking());
    assert_eq!(usual, anchor::Params::default());
    assert_eq!((twice.radius_px, twice.klt.radius_px), (14, 14));
    assert!((twice.spread_px / usual.spread_px - 2.0).abs() < 1e-6);
}
