//! Depth from two pictures: points are detected in the left one, followed into the right one, and triangulated; what their depth says of
//! disparity is held against the true one. On generated pictures, and on Middlebury's potted aloe.

#![expect(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::PathBuf;

use honami_cameras::{Camera, Pair, Pixel, Pose, triangulate};
use honami_vision::klt::{self, State};
use honami_vision::ncc::Ncc;
use honami_vision::pyramid::Pyramid;
use honami_vision::{Gray, Point, detect};
use nalgebra::Vector3;

const RADIUS_PX: u32 = 7;
const FOCAL_PX: f64 = 1000.0;
const BASELINE_M: f64 = 0.16;

struct Picture {
    width: u32,
    height: u32,
    luma: Vec<u8>,
}

impl Picture {
    fn gray(&self) -> Gray<'_> {
        Gray::packed(&self.luma, self.width, self.height)
    }
}

/// Where points of the left picture are in the right one: the place in the same row that looks most alike, as rectified cameras have it,
/// and then KLT to a part of a pixel; those that it finds, and that lead back.
fn followed(left: &Picture, right: &Picture, n: usize, disparities: std::ops::Range<u32>) -> Vec<[Point; 2]> {
    let params = detect::Params {
        max_corners: n,
        min_distance_px: 12.0,
        window_radius_px: 3,
        ..detect::Params::default()
    };
    let from: Vec<Point> =
        detect::corners(&left.gray(), None, &[], &params).into_iter().map(|corner| corner.at).collect();
    let mut ncc = Ncc::new(RADIUS_PX);
    let (from, guesses): (Vec<Point>, Vec<Point>) = from
        .into_iter()
        .filter_map(|at| {
            let tried = disparities.clone().map(|d| [at[0] - d as f32, at[1]]).filter(|to| to[0] >= 0.0);
            let alike = tried.filter_map(|to| Some((ncc.compare(&left.gray(), at, &right.gray(), to)?, to)));
            alike.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, to)| (at, to))
        })
        .unzip();
    let [first, second] = [left, right].map(|picture| Pyramid::new(&picture.gray(), 1, RADIUS_PX));
    let params = klt::Params { radius_px: RADIUS_PX, levels: 1, ..klt::Params::default() };
    let there = klt::track(&first, &second, &from, Some(&guesses), &params, 2);
    let to: Vec<Point> = there.iter().map(|flow| flow.to).collect();
    let back = klt::track(&second, &first, &to, Some(&from), &params, 2);
    let found = from.iter().zip(there).zip(back).filter(|((from, there), back)| {
        let both = there.state == State::Tracked && back.state == State::Tracked;
        both && (back.to[0] - from[0]).hypot(back.to[1] - from[1]) < 0.5
    });
    found.map(|((from, there), _)| [*from, there.to]).collect()
}

/// Of each point how far the disparity of its place is from the true one, in pixels, from the least on; points without a truth are left out.
fn errors(points: &[[Point; 2]], size: [u32; 2], truth: impl Fn(Point) -> Option<f64>) -> Vec<f64> {
    let centre = Pixel::new(f64::from(size[0]) / 2.0, f64::from(size[1]) / 2.0);
    let right_from_left = Pose::new(Vector3::zeros(), Vector3::new(-BASELINE_M, 0.0, 0.0));
    let pair = Pair { cameras: [Camera::pinhole(FOCAL_PX, centre); 2], right_from_left };
    let pixel = |[x, y]: Point| Pixel::new(x.into(), y.into());
    let mut errors: Vec<f64> = points
        .iter()
        .filter_map(|&[from, to]| {
            let wanted = truth(from)?;
            let sights = [
                (pair.cameras[0], Pose::identity(), pixel(from)),
                (pair.cameras[1], pair.right_from_left, pixel(to)),
            ];
            let place = triangulate(&sights, 0.3).unwrap().place;
            Some((FOCAL_PX * BASELINE_M / place.z - wanted).abs())
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    errors
}

/// A wavy wall with blots on it; a place of the left picture lies so many pixels farther left in the right one.
fn disparity(x: f64, y: f64) -> f64 {
    30.0 + 6.0 * (x / 60.0).sin() + 4.0 * (y / 45.0).cos()
}

fn generated() -> [Picture; 2] {
    let (width, height) = (320, 200);
    let blots = |x: f64, y: f64| {
        let waves = [
            (0.31, 0.17, 0.4),
            (0.09, 0.41, 1.9),
            (-0.23, 0.29, 3.1),
            (0.47, -0.05, 0.7),
            (0.13, -0.36, 2.2),
        ];
        let sum: f64 =
            waves.iter().map(|(a, b, phase)| (a * x + b * y + phase + (0.05 * y).sin()).sin()).sum();
        128.0 + 24.0 * sum
    };
    let picture = |colour: &dyn Fn(f64, f64) -> f64| {
        let pixels = (0..width * height).map(|k| colour(f64::from(k % width), f64::from(k / width)));
        Picture { width, height, luma: pixels.map(|value| value.round() as u8).collect() }
    };
    let seen_right = |x: f64, y: f64| {
        // Which place of the left picture is seen here: x + disparity of it.
        let there = (0..40).fold(x, |there, _| x + disparity(there, y));
        blots(there, y)
    };
    [picture(&blots), picture(&seen_right)]
}

#[test]
fn depth_of_a_generated_wall_is_that_which_was_rendered() {
    let [left, right] = generated();
    let points = followed(&left, &right, 150, 10..50);
    let errors = errors(&points, [left.width, left.height], |[x, y]| Some(disparity(x.into(), y.into())));
    assert!(errors.len() > 60, "{}", errors.len());
    let (median, most) = (errors[errors.len() / 2], errors[errors.len() * 9 / 10]);
    assert!(median < 0.1 && most < 0.3, "{median} px, nine of ten below {most} px");
}

#[test]
fn depth_of_leaves_of_the_aloe_is_that_of_its_true_disparities() {
    let Some(data) = std::env::var_os("HONAMI_DATA") else {
        eprintln!("skipped: needs HONAMI_DATA (stereo)");
        return;
    };
    let read = |name: &str| {
        let image = image::open(PathBuf::from(&data).join("stereo").join(name)).unwrap().to_luma8();
        Picture { width: image.width(), height: image.height(), luma: image.into_raw() }
    };
    let [left, right, truth] = ["aloeL.jpg", "aloeR.jpg", "aloeGT.png"].map(read);
    let points = followed(&left, &right, 300, 10..240);
    let errors = errors(&points, [left.width, left.height], |[x, y]| {
        // Whole numbers of pixels; 0 where it is not known.
        let at = y.round() as u32 * truth.width + x.round() as u32;
        Some(f64::from(truth.luma[at as usize])).filter(|&known| known > 0.0)
    });
    let median = errors[errors.len() / 2];
    eprintln!("aloe: {} of {} points with a truth, median {median:.3} px", errors.len(), points.len());
    assert!(errors.len() > 100, "{}", errors.len());
    assert!(median <= 0.5, "{median} px");
}
