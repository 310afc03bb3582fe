//! Cameras that are known, and views that cannot tell one.

use nalgebra::Vector3;

use super::*;
use crate::Pixel;
use crate::staged::{LENS, Noise, SIZE, board, board_views, poses, seen};

const EXACT: f64 = 0.0;

fn exact() -> Noise {
    Noise::new(0, EXACT)
}

#[test]
fn exact_views_give_all_nine_numbers_back() {
    let views = board_views(&LENS, 8, &mut exact());
    let found = calibrate(&board(), &views, SIZE, &Options::BOARD).unwrap();
    for (k, (got, want)) in found.camera.numbers().into_iter().zip(LENS.numbers()).enumerate() {
        assert!((got - want).abs() < 1e-5 * want.abs().max(1.0), "{}: {got} for {want}", NUMBERS[k]);
    }
    assert!(found.rms_px < 1e-6, "{}", found.rms_px);
    let stands = poses(8, [100.0, 62.5], 450.0, 60.0);
    assert!(
        found
            .views
            .iter()
            .zip(stands)
            .all(|(view, pose)| (view.pose.translation - pose.translation).norm() < 1e-3)
    );
}

#[test]
fn standard_errors_are_those_of_many_trials() {
    let n = 40;
    let (mut squares, mut told) = ([0.0; N_NUMBERS], [0.0; N_NUMBERS]);
    for seed in 0..n {
        let views = board_views(&LENS, 6, &mut Noise::new(seed, 0.3));
        let found = calibrate(&board(), &views, SIZE, &Options::BOARD).unwrap();
        assert!((found.sigma_px - 0.3).abs() < 0.05, "{}", found.sigma_px);
        for k in 0..N_NUMBERS {
            squares[k] += (found.camera.numbers()[k] - LENS.numbers()[k]).powi(2);
            told[k] += found.errors[k].powi(2);
        }
    }
    for k in 0..N_NUMBERS {
        // Of 40 trials a standard deviation is known to 11 %.
        let ratio = (squares[k] / told[k]).sqrt();
        assert!((0.7..1.35).contains(&ratio), "{}: {ratio}", NUMBERS[k]);
    }
}

/// `calibrateCameraExtended` of OpenCV 5.0, of the same views: six of the board, to whole pixels.
#[test]
fn coarse_views_give_opencvs_numbers_and_standard_errors() {
    let turns = [
        [0.4, 0.1, 0.05],
        [-0.45, 0.05, 0.1],
        [0.05, 0.5, -0.1],
        [0.1, -0.5, 0.2],
        [0.35, 0.4, 0.0],
        [-0.3, 0.35, 0.4],
    ];
    let asides = [[0.0, 0.0], [30.0, -30.0], [-30.0, 30.0], [40.0, 20.0], [-40.0, -20.0], [10.0, 30.0]];
    let view = |(turn, [x, y]): ([f64; 3], [f64; 2])| -> Sighting {
        let turned = Pose::new(turn.into(), Vector3::zeros());
        let translation = Vector3::new(x, y, 420.0) - turned.of(&Vector3::new(100.0, 62.5, 0.0));
        let exactly = seen(&LENS, &Pose { translation, ..turned }, &board(), &mut exact());
        exactly.into_iter().map(|(point, at)| (point, at.map(f64::round))).collect()
    };
    let views: Vec<Sighting> = turns.into_iter().zip(asides).map(view).collect();
    let whole = calibrate(&board(), &views, SIZE, &Options::BOARD).unwrap();
    let few = Model { focal: Focal::Square, centre: false, radial: 2, tangential: false };
    let few = calibrate(&board(), &views, SIZE, &Options { model: few, loss: Loss::Squares }).unwrap();
    #[rustfmt::skip]
    let wanted = [
        (&whole, 0.398_495_331, [
            532.807_121, 529.641_820, 330.996_159, 229.915_095, -0.246_171_634, 0.205_633_541, 6.596_127_8e-4, -1.144_549_4e-3, -0.734_301_948,
        ], [
            2.318_679, 2.343_062, 3.133_479, 2.216_096, 0.050_806_05, 0.814_131_93, 8.284_177e-4, 9.109_142e-4, 3.803_309,
        ]),
        (&few, 0.422_498_320, [
            535.647_095, 535.647_095, 319.5, 239.5, -0.259_951_007, 0.082_378_338, 0.0, 0.0, 0.0,
        ], [
            2.108_894, 2.108_894, 0.0, 0.0, 0.020_728_08, 0.144_963_6, 0.0, 0.0, 0.0,
        ]),
    ];
    for (found, rms_px, numbers, errors) in wanted {
        assert!((found.rms_px - rms_px).abs() < 1e-6, "{}", found.rms_px);
        for k in 0..N_NUMBERS {
            let (got, want) = (found.camera.numbers()[k], numbers[k]);
            assert!((got - want).abs() < 1e-3 * errors[k] + 1e-9, "{}: {got} for {want}", NUMBERS[k]);
            assert!(
                (found.errors[k] - errors[k]).abs() < 0.01 * errors[k] + 1e-12,
                "{}: ± {}",
                NUMBERS[k],
                found.errors[k]
            );
        }
    }
}

#[test]
fn what_is_not_looked_for_stays() {
    let camera = Camera::pinhole(700.0, Pixel::new(319.5, 239.5));
    let views = board_views(&camera, 3, &mut Noise::new(1, 0.1));
    let found =
        calibrate(&board(), &views, SIZE, &Options { model: Model::FOCAL, loss: Loss::Squares }).unwrap();
    let [fx, fy, rest @ ..] = found.camera.numbers();
    assert_eq!(fx.to_bits(), fy.to_bits());
    assert_eq!(rest.map(f64::to_bits), [319.5, 239.5, 0.0, 0.0, 0.0, 0.0, 0.0].map(f64::to_bits));
    assert!(
        (fx - 700.0).abs() < 4.0 * found.errors[0] && found.errors[0] < 2.0,
        "{fx} ± {}",
        found.errors[0]
    );
    assert_eq!(found.errors[2..], [0.0; 7]);
}

#[test]
fn a_point_taken_for_another_hardly_counts_under_a_robust_loss() {
    let mut views = board_views(&LENS, 8, &mut Noise::new(2, 0.1));
    for view in &mut views {
        view[7].1.x += 20.0;
    }
    let focal =
        |loss| calibrate(&board(), &views, SIZE, &Options { loss, ..Options::BOARD }).unwrap().camera.fx;
    let [squares, huber, cauchy] =
        [Loss::Squares, Loss::Huber(0.3), Loss::Cauchy(0.3)].map(|loss| (focal(loss) - LENS.fx).abs());
    assert!(squares > 5.0 && huber < 2.0 && cauchy < 1.5, "{squares} {huber} {cauchy}");
}

#[test]
fn a_view_that_is_given_twice_is_named() {
    let camera = Camera::pinhole(536.0, Pixel::new(330.0, 232.0));
    let mut views = board_views(&camera, 6, &mut Noise::new(3, 0.1));
    views.push(views[2].clone());
    let error = calibrate(&board(), &views, SIZE, &Options::BOARD).map(|c| c.camera);
    assert_eq!(error, Err(CameraError::SameView { first: 2, second: 6 }));
}

#[test]
fn views_that_do_not_tell_are_named() {
    let stand = |turn: [f64; 3], aside: [f64; 3]| Pose::new(Vector3::from(turn), Vector3::from(aside));
    let asides =
        [[-100.0, -60.0, 450.0], [-40.0, -80.0, 500.0], [-150.0, -30.0, 550.0], [-80.0, -20.0, 480.0]];
    for (turn, sigma) in
        [([0.0; 3], EXACT), ([0.0; 3], 0.2), ([0.0, 0.0, 0.4], 0.2), ([0.3, 0.1, 0.0], EXACT)]
    {
        let mut noise = Noise::new(7, sigma);
        let camera = Camera::pinhole(536.0, Pixel::new(330.0, 232.0));
        let views: Vec<_> =
            asides.iter().map(|&aside| seen(&camera, &stand(turn, aside), &board(), &mut noise)).collect();
        let error = calibrate(&board(), &views, SIZE, &Options::BOARD).map(|c| (c.camera, c.errors));
        assert!(matches!(error, Err(CameraError::Alike { .. })), "{turn:?}, {sigma} px: {error:?}");
        let said = error.unwrap_err().to_string();
        assert!(
            !said.contains("inf") && (said.contains("at all") || said.contains("better than to")),
            "{said}"
        );
    }
    let views = board_views(&LENS, 3, &mut exact());
    assert_eq!(
        calibrate(&board(), &views[..1], SIZE, &Options::BOARD).unwrap_err(),
        CameraError::TooFewViews { wanted: 2, came: 1 }
    );
    // Four corners tell two numbers a view, of nine.
    let small = Target::board(2, 2, 25.0).unwrap();
    let four = |pose: &Pose| seen(&LENS, pose, &small, &mut exact());
    let few: Vec<_> = poses(4, [12.5, 12.5], 450.0, 60.0).iter().map(four).collect();
    let error = calibrate(&small, &few, SIZE, &Options::BOARD).unwrap_err();
    assert_eq!(error, CameraError::TooLittle { n_points: 16, n_views: 4, told: 8, wanted: 9 });
    let mut broken = views.clone();
    broken[2].truncate(9);
    let error = calibrate(&board(), &broken, SIZE, &Options::BOARD).unwrap_err();
    assert_eq!(error, CameraError::View { view: 2, source: Box::new(CameraError::Collinear) });
    assert!(error.to_string().starts_with("view 2: all points"), "{error}");
}
