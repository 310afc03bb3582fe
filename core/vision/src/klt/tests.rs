//! The tracker against motion that is known exactly, and against OpenCV.

use honami_model::picture::Gray;

use super::*;
use crate::texture;

const WIDTH: u32 = 320;
const HEIGHT: u32 = 240;

fn pyramid(data: &[u8], width: u32, height: u32, params: &Params) -> Pyramid {
    Pyramid::new(&Gray::packed(data, width, height), params.levels, params.radius_px)
}

/// The texture, moved, then made brighter or darker from left to right, with noise.
fn scene(motion: Point, ramp: f64, noise: f64) -> Vec<u8> {
    let [dx, dy] = motion.map(f64::from);
    texture::render(WIDTH, HEIGHT, |x, y| {
        let grain = noise * texture::hash(9, (x + 1000.0 * dx) as i64, (y + 7.0) as i64);
        texture::value(5, x - dx, y - dy) + ramp * (x / f64::from(WIDTH) - 0.5) + grain
    })
}

/// Points every 16 pixels, `margin` pixels from the border.
fn grid(margin: u32) -> Vec<Point> {
    let along = |n: u32| (margin..n - margin).step_by(16);
    along(HEIGHT).flat_map(|y| along(WIDTH).map(move |x| [x as f32 + 0.37, y as f32 - 0.21])).collect()
}

fn follow(before: &[u8], after: &[u8], from: &[Point], params: &Params) -> Vec<Flow> {
    let [i, j] = [before, after].map(|data| pyramid(data, WIDTH, HEIGHT, params));
    track(&i, &j, from, None, params, 1)
}

/// Mean error along x and y, and root of the mean squared distance.
fn error(flows: &[Flow], from: &[Point], motion: Point) -> ([f32; 2], f32) {
    let n = flows.len() as f32;
    let errors: Vec<[f32; 2]> =
        flows.iter().zip(from).map(|(f, p)| [0, 1].map(|i| f.to[i] - p[i] - motion[i])).collect();
    let bias = [0, 1].map(|i| errors.iter().map(|e| e[i]).sum::<f32>() / n);
    (bias, (errors.iter().map(|e| e[0] * e[0] + e[1] * e[1]).sum::<f32>() / n).sqrt())
}

#[test]
fn known_motion_is_found_to_hundredths_of_a_pixel() {
    let params = Params::default();
    for (motion, ramp, noise, max_bias, max_rms) in [
        ([0.0, 0.0], 0.0, 0.0, 1e-6, 1e-6),
        ([1.0, 0.0], 0.0, 0.0, 0.0005, 0.002),
        ([0.1, -0.25], 0.0, 0.0, 0.006, 0.012),
        ([0.5, 0.5], 0.0, 0.0, 0.015, 0.022),
        ([2.3, -1.6], 0.0, 0.0, 0.015, 0.022),
        ([9.7, 5.3], 0.0, 0.0, 0.015, 0.022),
        ([-14.2, 11.9], 0.0, 0.0, 0.005, 0.012),
        ([2.3, -1.6], 0.0, 4.0, 0.012, 0.06),
        // KLT takes a change of brightness for motion where the window's gradients do not cancel.
        ([2.3, -1.6], 4.0, 0.0, 0.03, 0.12),
    ] {
        let from = grid(32);
        let flows = follow(&scene([0.0; 2], 0.0, 0.0), &scene(motion, ramp, noise), &from, &params);
        assert!(flows.iter().all(|f| f.state == State::Tracked), "{motion:?}");
        let (bias, rms) = error(&flows, &from, motion);
        assert!(
            bias.iter().all(|b| b.abs() <= max_bias) && rms <= max_rms,
            "{motion:?} {ramp} {noise}: {bias:?} {rms}"
        );
    }
}

#[test]
fn a_guess_bridges_what_the_pyramid_cannot() {
    let params = Params { levels: 1, ..Params::default() };
    let motion = [21.4, -13.7];
    let from = grid(48);
    let [i, j] = [scene([0.0; 2], 0.0, 0.0), scene(motion, 0.0, 0.0)]
        .map(|data| pyramid(&data, WIDTH, HEIGHT, &params));
    let guesses: Vec<Point> = from.iter().map(|p| [p[0] + 20.0, p[1] - 15.0]).collect();
    let (_, rms) = error(&track(&i, &j, &from, Some(&guesses), &params, 1), &from, motion);
    assert!(rms < 0.03, "{rms}");
    let (_, rms) = error(&track(&i, &j, &from, None, &params, 1), &from, motion);
    assert!(rms > 5.0, "{rms}");
}

#[test]
fn what_leaves_the_picture_is_outside() {
    let motion = [6.0, 0.0];
    let from = [[316.0, 100.0], [310.0, 100.0], [-40.0, 10.0], [100.0, 900.0], [f32::MAX, 0.0]];
    let flows = follow(&scene([0.0; 2], 0.0, 0.0), &scene(motion, 0.0, 0.0), &from, &Params::default());
    let states: Vec<State> = flows.iter().map(|f| f.state).collect();
    use State::{Outside, Tracked};
    assert_eq!(states, [Outside, Tracked, Outside, Outside, Outside]);
    assert!(flows.iter().flat_map(|f| f.to).all(f32::is_finite));
}

#[test]
fn windows_without_texture_are_lost() {
    let params = Params::default();
    let flat = vec![77; (WIDTH * HEIGHT) as usize];
    let edge = texture::render(WIDTH, HEIGHT, |x, _| 128.0 + 60.0 * (x / 5.0).sin());
    let step = texture::render(WIDTH, HEIGHT, |x, _| if x < 160.0 { 20.0 } else { 200.0 });
    for data in [&flat, &edge, &step] {
        for flow in follow(data, data, &[[160.2, 120.4], [20.0, 20.0], [0.0, 0.0]], &params) {
            assert_eq!(flow.state, State::Lost(Reason::Flat));
        }
    }
}

#[test]
fn positions_that_are_no_numbers_are_lost_at_a_finite_place() {
    let params = Params::default();
    let data = scene([0.0; 2], 0.0, 0.0);
    let picture = pyramid(&data, WIDTH, HEIGHT, &params);
    for bad in [[f32::NAN, 5.0], [5.0, f32::INFINITY]] {
        let good = [100.0, 100.0];
        for (from, guess) in [(bad, good), (good, bad)] {
            let flow = track(&picture, &picture, &[from], Some(&[guess]), &params, 1)[0];
            assert_eq!(flow, Flow { to: [0.0; 2], state: State::Lost(Reason::NotFinite) });
        }
    }
}

#[test]
fn threads_and_instruction_sets_do_not_change_a_bit() {
    let params = Params::default();
    let [i, j] = [scene([0.0; 2], 0.0, 3.0), scene([3.1, -2.4], 10.0, 3.0)]
        .map(|data| pyramid(&data, WIDTH, HEIGHT, &params));
    let from: Vec<Point> = (0..700).map(|n| [n as f32 * 0.47, (n * 53 % 260) as f32 - 10.0]).collect();
    let bits =
        |flows: Vec<Flow>| -> Vec<_> { flows.iter().map(|f| (f.to.map(f32::to_bits), f.state)).collect() };
    let want = bits(track(&i, &j, &from, None, &params, 1));
    for n_threads in [0, 2, 3, 8, 1000] {
        assert_eq!(bits(track(&i, &j, &from, None, &params, n_threads)), want, "{n_threads} threads");
    }
    for level in simd::available() {
        assert_eq!(bits(track_at(level, &i, &j, &from, None, &params, 1)), want, "{}", level.name());
    }
    assert!(track(&i, &j, &[], None, &params, 4).is_empty());
}

#[test]
fn tiny_pictures_and_any_window_do_no_harm() {
    for (width, height) in [(1_u32, 1_u32), (2, 1), (1, 9), (7, 5), (33, 2)] {
        for radius_px in [0, 1, 3, 10, 40] {
            for max_iterations in [0, 30] {
                let params = Params { radius_px, max_iterations, min_eigenvalue: 0.0, ..Params::default() };
                let [i, j] = [3, 4].map(|seed| {
                    let data = texture::render(width, height, |x, y| texture::value(seed, 9.0 * x, 9.0 * y));
                    pyramid(&data, width, height, &params)
                });
                let from = [[0.0, 0.0], [0.5, 0.4], [width as f32, height as f32], [-3.0, 2.0]];
                for flow in track(&i, &j, &from, None, &params, 2) {
                    assert!(flow.to.iter().all(|c| c.is_finite()), "{width}x{height} r{radius_px} {flow:?}");
                }
            }
        }
    }
}

#[test]
fn rows_may_be_padded() {
    let params = Params { radius_px: 5, ..Params::default() };
    let tight = scene([0.0; 2], 0.0, 2.0);
    let moved = pyramid(&scene([1.2, 0.7], 0.0, 2.0), WIDTH, HEIGHT, &params);
    let stride = WIDTH as usize + 13;
    let mut padded = vec![255; stride * HEIGHT as usize];
    for (to, from) in padded.chunks_exact_mut(stride).zip(tight.chunks_exact(WIDTH as usize)) {
        to[..from.len()].copy_from_slice(from);
    }
    let loose = Pyramid::new(&Gray { data: &padded, width: WIDTH, height: HEIGHT, stride }, params.levels, 5);
    let tight = pyramid(&tight, WIDTH, HEIGHT, &params);
    let from = grid(4);
    assert_eq!(
        track(&loose, &moved, &from, None, &params, 1),
        track(&tight, &moved, &from, None, &params, 1)
    );
}

#[test]
#[should_panic(expected = "pyramid made for a smaller radius")]
fn a_pyramid_serves_its_radius_only() {
    let small = Params { radius_px: 3, ..Params::default() };
    let picture = pyramid(&scene([0.0; 2], 0.0, 0.0), WIDTH, HEIGHT, &small);
    let _unused = track(&picture, &picture, &[[9.0, 9.0]], None, &Params::default(), 1);
}

/// Radius, levels, and where `calcOpticalFlowPyrLK` of OpenCV 5.0 (30 steps, epsilon 0.01, threshold 1e-4) finds
/// points of `scene([0, 0])` in `scene([2.3, -1.6])`: from, to.
type FromOpenCv = (u32, u32, [(Point, Point); 9]);
const OPENCV: [FromOpenCv; 3] = [
    (
        10,
        4,
        [
            ([3.5, 2.25], [5.630, 0.591]),
            ([251.5, 2.25], [253.847, 0.600]),
            ([65.5, 60.25], [67.790, 58.644]),
            ([189.5, 60.25], [191.787, 58.640]),
            ([127.5, 118.25], [129.783, 116.644]),
            ([313.5, 118.25], [315.743, 116.851]),
            ([127.5, 176.25], [129.797, 174.645]),
            ([251.5, 176.25], [253.807, 174.624]),
            ([189.5, 234.25], [191.792, 232.639]),
        ],
    ),
    (
        7,
        3,
        [
            ([3.5, 2.25], [5.641, 0.648]),
            ([251.5, 2.25], [253.875, 0.556]),
            ([65.5, 60.25], [67.769, 58.646]),
            ([189.5, 60.25], [191.771, 58.638]),
            ([127.5, 118.25], [129.778, 116.653]),
            ([313.5, 118.25], [315.774, 116.926]),
            ([127.5, 176.25], [129.791, 174.650]),
            ([251.5, 176.25], [253.806, 174.630]),
            ([189.5, 234.25], [191.791, 232.638]),
        ],
    ),
    (
        4,
        1,
        [
            ([3.5, 2.25], [5.720, 0.486]),
            ([251.5, 2.25], [253.938, 0.285]),
            ([65.5, 60.25], [67.727, 58.661]),
            ([189.5, 60.25], [191.757, 58.650]),
            ([127.5, 118.25], [129.787, 116.632]),
            ([313.5, 118.25], [315.912, 116.760]),
            ([127.5, 176.25], [129.797, 174.660]),
            ([251.5, 176.25], [253.813, 174.643]),
            ([189.5, 234.25], [191.830, 232.650]),
        ],
    ),
];

#[test]
fn opencv_finds_the_same_places() {
    for (radius_px, levels, points) in OPENCV {
        let params = Params { radius_px, levels, ..Params::default() };
        let from = points.map(|(from, _)| from);
        let flows = follow(&scene([0.0; 2], 0.0, 0.0), &scene([2.3, -1.6], 0.0, 0.0), &from, &params);
        for (flow, (from, want)) in flows.iter().zip(points) {
            let apart = (flow.to[0] - want[0]).hypot(flow.to[1] - want[1]);
            // Windows cut by the border: OpenCV gives their last column a share of its weight, we none. Both are
            // then some tenths of a pixel off the truth.
            let radius = radius_px as f32;
            let cut =
                from[0] < radius || from[1] < radius || from[0] > 319.0 - radius || from[1] > 239.0 - radius;
            assert!(apart < if cut { 0.12 } else { 0.003 }, "{radius_px} {levels} {from:?}: {apart} px");
        }
    }
}
