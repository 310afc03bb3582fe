//! What a whole frame takes with the way back: pyramid of the new frame, there, and back; on one thread and on two.

use honami_vision::klt;
use honami_vision::pyramid::Pyramid;
use serde_json::{Value, json};

use super::{Frames, milliseconds, spread, starts};

/// Size of the picture and number of points.
const CASES: [(u32, u32, usize); 2] = [(960, 720, 1500), (1920, 1080, 2000)];
const N_PAIRS: usize = 6;

pub(super) fn two_way(params: &klt::Params, repeats: usize) -> Value {
    CASES.iter().map(|&(width, height, n_points)| case(params, repeats, (width, height), n_points)).collect()
}

fn case(params: &klt::Params, repeats: usize, (width, height): (u32, u32), n_points: usize) -> Value {
    let frames = Frames::made(width, height, N_PAIRS + 1);
    let points = starts(&frames, n_points);
    let mut pyramids = [0, 0].map(|i| Pyramid::new(&frames.gray(i), params.levels, params.radius_px));
    let mut ms = [Vec::new(), Vec::new()];
    for _ in 0..repeats {
        for (i, points) in points.iter().enumerate() {
            let [before, now] = &mut pyramids;
            before.fill(&frames.gray(i));
            for (k, ms) in ms.iter_mut().enumerate() {
                ms.push(milliseconds(|| {
                    now.fill(&frames.gray(i + 1));
                    let there = klt::track(before, now, points, None, params, k + 1);
                    let to: Vec<_> = there.iter().map(|flow| flow.to).collect();
                    klt::track(now, before, &to, None, params, k + 1)
                }));
            }
        }
    }
    let [one, two] = &ms;
    let ratio = one.iter().zip(two).map(|(one, two)| one / two).collect();
    let fps = two.iter().map(|ms| 1e3 / ms).collect();
    json!({
        "picture": format!("{width}x{height}"), "points": points.iter().map(Vec::len).max(),
        "ms_one_thread": spread(one.clone()), "ms_two_threads": spread(two.clone()),
        "one_to_two": spread(ratio), "fps_two_threads": spread(fps),
    })
}
