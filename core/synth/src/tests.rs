//! Whole scenes: the same bits again, the level that was asked for, errors, motion and picture against truth.

mod motion;
mod picture;

use crate::{Level, Scene, Settings, SynthError};

/// A small quick scene.
fn small() -> Settings {
    Settings { seed: 3, width: 160, height: 120, n_frames: 24, n_leaves: 60, ..Settings::default() }
}

#[track_caller]
fn scene(settings: &Settings) -> Scene {
    Scene::new(settings).unwrap_or_else(|error| panic!("{settings:?}: {error}"))
}

fn in_pool<T: Send>(n_threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new()
        .num_threads(n_threads)
        .build()
        .unwrap_or_else(|error| panic!("{error}"))
        .install(work)
}

#[test]
fn equal_settings_give_equal_bits_in_any_order_and_with_any_threads() {
    let (one, many) = (in_pool(1, || scene(&small())), in_pool(3, || scene(&small())));
    assert_eq!(one.truth(), many.truth());
    assert_eq!(one.mean_step_px().to_bits(), many.mean_step_px().to_bits());
    let forward: Vec<_> = (0..one.n_frames()).map(|frame| one.render(frame)).collect();
    let mut backward: Vec<_> = std::thread::scope(|scope| {
        let many = &many;
        let halves = [0, 1].map(|odd| {
            scope.spawn(move || {
                let frames = (0..many.n_frames()).rev().filter(move |frame| frame % 2 == odd);
                frames.map(|frame| (frame, many.render(frame))).collect::<Vec<_>>()
            })
        });
        halves.into_iter().flat_map(|half| half.join().unwrap()).collect()
    });
    backward.sort_by_key(|(frame, _)| *frame);
    assert!(forward.iter().eq(backward.iter().map(|(_, picture)| picture)));
}

#[test]
fn another_seed_gives_another_plant_and_another_clip() {
    let (a, b) = (scene(&small()), scene(&Settings { seed: 4, ..small() }));
    assert_ne!(a.truth(), b.truth());
    assert_ne!(a.render(0), b.render(0));
}

#[test]
fn noise_differs_from_frame_to_frame_and_has_the_size_asked_for() {
    let noisy = scene(&Settings { noise: 3.0, lighting: 0.0, ..small() });
    let clean = scene(&Settings { noise: 0.0, lighting: 0.0, ..small() });
    assert_eq!(noisy.truth(), clean.truth(), "noise must not touch the plant");
    let noise = |frame: u32| -> Vec<f64> {
        let (a, b) = (noisy.render(frame), clean.render(frame));
        a.y.iter().zip(&b.y).map(|(&a, &b)| f64::from(a) - f64::from(b)).collect()
    };
    let (first, second) = (noise(0), noise(1));
    let n = first.len() as f64;
    let mean = first.iter().sum::<f64>() / n;
    let sd = (first.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / n).sqrt();
    let together = first.iter().zip(&second).map(|(a, b)| a * b).sum::<f64>() / (n * sd * sd);
    assert!(mean.abs() < 0.1 && (sd - 3.0).abs() < 0.15, "mean {mean}, sd {sd}");
    assert!(together.abs() < 0.05, "correlation {together} between frames");
}

#[test]
fn light_drifts_by_what_was_asked_for() {
    let still = Settings { noise: 0.0, lighting: 0.3, n_frames: 300, ..small() };
    let scene = scene(&still);
    // The top row is background: it changes with the light alone.
    let sky = |frame: u32| scene.render(frame).y[..160].iter().map(|&y| f64::from(y)).sum::<f64>() / 160.0;
    let sky: Vec<f64> = (0..300).step_by(10).map(sky).collect();
    let (low, high) = sky.iter().fold((f64::MAX, 0.0_f64), |(low, high), &y| (low.min(y), high.max(y)));
    assert!(low < 0.85 * high, "{low} to {high}");
    assert!(
        sky.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.12 * high),
        "it drifts, it does not jump"
    );
}

#[test]
fn the_level_is_the_mean_displacement_at_any_size_and_rate() {
    let sizes = [(960, 720, 25.0, 300), (640, 360, 25.0, 120), (160, 120, 50.0, 60), (97, 131, 12.5, 40)];
    for level in Level::ALL {
        for (seed, (width, height, fps, n_leaves)) in (1..).zip(sizes) {
            let settings = Settings { seed, width, height, fps, n_leaves, level, n_frames: 50, ..small() };
            let scene = scene(&settings);
            let wanted_px = level.step_px(height, fps);
            let steps = scene.truth().leaves.iter().flat_map(|leaf| leaf.path.windows(2));
            let steps: Vec<f64> =
                steps.map(|pair| (pair[1].x - pair[0].x).hypot(pair[1].y - pair[0].y)).collect();
            let measured_px = steps.iter().sum::<f64>() / steps.len() as f64;
            assert!((measured_px / wanted_px - 1.0).abs() < 0.02, "{settings:?}: {measured_px}");
            assert!((measured_px - scene.mean_step_px()).abs() < 1e-9, "the scene must report what it does");
        }
    }
    assert_eq!(Level::ALL.map(|level| (level.step_px(720, 25.0) * 10.0).round() as u32), [15, 34, 58]);
}

#[test]
fn the_smallest_and_shortest_scenes_work() {
    for (n_leaves, n_frames, fps) in [(1, 2, 10.0), (1, 2, 1000.0), (3, 5, 30.0), (2, 400, 240.0)] {
        for level in Level::ALL {
            let settings = Settings { width: 33, height: 32, n_leaves, n_frames, fps, level, ..small() };
            let scene = scene(&settings);
            let picture = scene.render(n_frames - 1);
            assert_eq!(scene.truth().leaves.len(), n_leaves as usize);
            assert_eq!((picture.y.len(), picture.u.len(), picture.v.len()), (33 * 32, 17 * 16, 17 * 16));
        }
    }
}

#[test]
fn a_setting_out_of_range_is_named() {
    type Change = fn(&mut Settings);
    let bad = |change: Change| {
        let mut settings = small();
        change(&mut settings);
        Scene::new(&settings).unwrap_err().to_string()
    };
    let cases: [(Change, &str); 9] = [
        (|s| s.width = 16, "32x32 to 8192x8192 pixels, got 16x120"),
        (|s| s.height = 9000, "got 160x9000"),
        (|s| s.n_frames = 1, "2 to 20000 frames, got 1"),
        (|s| s.n_leaves = 0, "1 to 20000 leaves, got 0"),
        (|s| s.fps = 5.0, "10 to 1000 frames a second"),
        (|s| s.fps = f64::NAN, "got NaN"),
        (|s| s.noise = -1.0, "0 to 50 levels, got -1"),
        (|s| s.lighting = 0.6, "0 to 0.5 of its mean, got 0.6"),
        (|s| s.lighting = f64::NAN, "got NaN"),
    ];
    for (change, said) in cases {
        let error = bad(change);
        assert!(error.contains(said), "{error:?} lacks {said:?}");
    }
}

#[test]
fn a_plant_that_cannot_move_as_far_says_so() {
    // One leaf, one step of a millisecond, at the turning point of its sway.
    let tiny = Settings { seed: 22, width: 33, height: 32, n_leaves: 1, n_frames: 2, ..small() };
    let error = Scene::new(&Settings { fps: 1000.0, level: Level::Storm, ..tiny }).unwrap_err();
    assert!(matches!(error, SynthError::Level { .. }) && error.to_string().contains("use more frames"));
}

#[test]
fn levels_are_read_as_they_are_written() {
    for level in Level::ALL {
        assert_eq!(level.to_string().parse(), Ok(level));
    }
    assert_eq!("gale".parse::<Level>(), Err(SynthError::UnknownLevel("gale".to_owned())));
}
