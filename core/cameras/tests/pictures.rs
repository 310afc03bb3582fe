//! From pictures to numbers: boards that are rendered through a known lens, and OpenCV's pictures.

#![expect(clippy::unwrap_used, clippy::print_stderr, reason = "helpers of tests")]

use std::path::PathBuf;

use honami_cameras::{
    Calibration, Camera, Options, Pixel, Place, Pose, Sighting, Stereo, Target, calibrate, stereo,
};
use honami_vision::Gray;
use honami_vision::board::{Board, Window, find};

const BOARD: Board = Board { columns: 9, rows: 6 };
const SIZE: [u32; 2] = [640, 480];

fn target() -> Target {
    Target::board(BOARD.columns, BOARD.rows, 25.0).unwrap()
}

fn sighting(picture: &[u8], window: Window) -> Sighting {
    let found = find(&Gray::packed(picture, SIZE[0], SIZE[1]), BOARD, window).unwrap();
    found.into_iter().map(Pixel::from).enumerate().collect()
}

/// A camera, and the direction of each pixel.
struct Lens {
    camera: Camera,
    rays: Vec<Pixel>,
}

impl Lens {
    fn new(camera: Camera) -> Self {
        let ray = |i: u32| camera.undistort(&[i % SIZE[0], i / SIZE[0]].map(f64::from).into()).unwrap();
        Self { camera, rays: (0..SIZE[0] * SIZE[1]).map(ray).collect() }
    }

    /// What it sees of the board: each pixel gathers light from many rays, spread as Fibonacci's numbers have it, between which the
    /// lens is as good as straight.
    fn picture(&self, camera_from_board: &Pose) -> Vec<u8> {
        const FINE: u32 = 34;
        let board_from_camera = camera_from_board.inverse();
        let (turn, eye) = (board_from_camera.rotation, board_from_camera.translation);
        let light = |ray: Pixel| {
            let along = turn * ray.push(1.0);
            let [column, row] = [0, 1].map(|axis| (eye[axis] - eye.z / along.z * along[axis]) / 25.0);
            let inside =
                |rim: f64| column > -1.0 - rim && row > -1.0 - rim && column < 9.0 + rim && row < 6.0 + rim;
            let is_dark = (column.floor() + row.floor()).rem_euclid(2.0) < 0.5;
            if inside(0.0) && is_dark {
                30.0
            } else if inside(0.5) {
                220.0
            } else {
                90.0
            }
        };
        let [width, height] = SIZE.map(|n| n as usize);
        let pixel = |i: usize| {
            let (x, y) = ((i % width).min(width - 2), (i / width).min(height - 2));
            let near = y * width + x;
            let (right, down) =
                (self.rays[near + 1] - self.rays[near], self.rays[near + width] - self.rays[near]);
            let off = |k: u32| (f64::from(k) + 0.5) / f64::from(FINE) - 0.5;
            let ray = |k: u32| self.rays[i] + right * off(k) + down * off(k * 21 % FINE);
            let sum: f64 = (0..FINE).map(|k| light(ray(k))).sum();
            (sum / f64::from(FINE)).round() as u8
        };
        (0..width * height).map(pixel).collect()
    }
}

/// Poses that turn the board's middle every way, so that both cameras see all of it.
fn poses() -> Vec<Pose> {
    #[rustfmt::skip]
    let turns = [
        [0.4, 0.1, 0.05], [-0.45, 0.05, 0.1], [0.05, 0.5, -0.1], [0.1, -0.5, 0.2], [0.35, 0.4, 0.0], [-0.3, 0.35, 0.4],
        [-0.5, -0.3, -0.3], [0.45, -0.35, 0.6], [0.0, 0.1, -0.5], [0.55, 0.0, 0.3], [-0.1, 0.6, 0.1], [-0.6, 0.1, -0.1],
    ];
    #[rustfmt::skip]
    let asides = [
        [60.0, 20.0], [10.0, -30.0], [30.0, 30.0], [55.0, -35.0], [5.0, 35.0], [35.0, 0.0],
        [20.0, 40.0], [65.0, -10.0], [0.0, 0.0], [45.0, 40.0], [25.0, -45.0], [40.0, -20.0],
    ];
    let pose = |(turn, [x, y]): ([f64; 3], [f64; 2])| {
        let turned = Pose::new(turn.into(), Place::zeros());
        Pose { translation: Place::new(x, y, 400.0) - turned.of(&Place::new(100.0, 62.5, 0.0)), ..turned }
    };
    turns.into_iter().zip(asides).map(pose).collect()
}

#[test]
fn rendered_boards_give_cameras_and_their_distance_to_a_thousandth() {
    let left = Camera { k1: -0.25, k2: 0.06, p1: 0.001, ..Camera::pinhole(535.0, Pixel::new(331.0, 233.0)) };
    let right = Camera { k1: -0.2, ..Camera::pinhole(542.0, Pixel::new(315.0, 245.0)) };
    let right_from_left = Pose::new([0.01, -0.05, 0.02].into(), Place::new(-83.0, 1.0, 3.0));
    let lenses = [left, right].map(Lens::new);
    let views: Vec<[Sighting; 2]> = poses()
        .iter()
        .map(|pose| {
            let pictures = [lenses[0].picture(pose), lenses[1].picture(&right_from_left.after(pose))];
            pictures.map(|picture| sighting(&picture, Window::Squares))
        })
        .collect();
    let found = stereo(&target(), &views, [SIZE; 2], &Options::BOARD).unwrap();
    for (camera, truth) in found.pair.cameras.iter().zip(lenses.map(|lens| lens.camera)) {
        for (got, want) in [(camera.fx, truth.fx), (camera.fy, truth.fy)] {
            assert!((got / want - 1.0).abs() < 1e-3, "{camera:?}");
        }
    }
    assert!((found.baseline / right_from_left.translation.norm() - 1.0).abs() < 1e-3, "{}", found.baseline);
    assert!(found.rms_px < 0.06 && found.epipolar_px < 0.06, "{} {}", found.rms_px, found.epipolar_px);
}

fn opencv(window: Window) -> Option<[Vec<Sighting>; 2]> {
    let Some(root) = std::env::var_os("HONAMI_DATA") else {
        eprintln!("skipped: needs HONAMI_DATA (calib/opencv)");
        return None;
    };
    let folder = PathBuf::from(root).join("calib/opencv");
    let views = |side: &str| {
        let picture = |number| image::open(folder.join(format!("{side}{number:02}.jpg"))).unwrap().to_luma8();
        (1..10).chain(11..15).map(|number| sighting(picture(number).as_raw(), window)).collect()
    };
    Some(["left", "right"].map(views))
}

fn both(views: &[Vec<Sighting>; 2], options: &Options) -> ([Calibration; 2], Stereo) {
    let alone = views.each_ref().map(|views| calibrate(&target(), views, SIZE, options).unwrap());
    let pairs: Vec<[Sighting; 2]> =
        views[0].iter().zip(&views[1]).map(|(l, r)| [l.clone(), r.clone()]).collect();
    (alone, stereo(&target(), &pairs, [SIZE; 2], options).unwrap())
}

/// `calibrateCameraExtended` and `stereoCalibrate` of OpenCV 5.0 after `cornerSubPix` with a radius of 11 px.
#[test]
fn in_opencvs_window_its_pictures_give_opencvs_numbers() {
    let Some(views) = opencv(Window::Radius(11)) else { return };
    let ([left, right], stereo) = both(&views, &Options::BOARD);
    let numbers =
        |c: &Calibration| [c.camera.fx, c.camera.fy, c.camera.cx, c.camera.cy, c.errors[0], c.errors[2]];
    let wanted_left = [536.065, 536.008, 342.370, 235.532, 0.926, 0.970];
    let wanted_right = [542.341, 541.602, 328.326, 246.955, 1.087, 1.167];
    for (found, wanted) in [(&left, wanted_left), (&right, wanted_right)] {
        for (got, want) in numbers(found).into_iter().zip(wanted) {
            assert!((got - want).abs() < 0.03, "{got} for {want}");
        }
    }
    for (got, want) in [
        (left.rms_px, 0.4080),
        (right.rms_px, 0.4578),
        (left.camera.k1, -0.2651),
        (right.camera.k1, -0.2806),
        (stereo.rms_px, 0.4439),
        (stereo.baseline, 83.4527),
    ] {
        assert!((got - want).abs() < 0.002, "{got} for {want}");
    }
}

/// A window that belongs to its corner leaves less than half of the error, and gives other numbers: in OpenCV's, edges of other corners
/// draw those of oblique boards off by up to 6 px (views 2 and 13).
#[test]
fn windows_that_belong_to_their_corners_fit_twice_as_well() {
    let Some(views) = opencv(Window::Squares) else { return };
    let ([left, right], stereo) = both(&views, &Options::BOARD);
    assert!(left.rms_px < 0.19 && right.rms_px < 0.19, "{} {}", left.rms_px, right.rms_px);
    assert!(stereo.rms_px < 0.2 && stereo.epipolar_px < 0.14, "{} {}", stereo.rms_px, stereo.epipolar_px);
    // With a radius of 5 and of 7 px OpenCV has 532.8 and 533.0, each ± 0.4.
    assert!(
        (left.camera.fx - 533.0).abs() < 1.0 && left.errors[0] < 0.45,
        "{} ± {}",
        left.camera.fx,
        left.errors[0]
    );
    assert!((stereo.baseline - 83.18).abs() < 0.1 && stereo.baseline_error < 0.05, "{}", stereo.baseline);
    assert!(left.views.iter().all(|view| view.worst_px < 1.0));
}
