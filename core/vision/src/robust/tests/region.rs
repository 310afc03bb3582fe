//! Regions on pictures whose motion is known.

use super::super::{Moved, Region, State, follow};
use super::*;
use crate::klt;
use crate::pyramid::Pyramid;
use crate::{Gray, Point, texture};

const WIDTH: u32 = 160;
const HEIGHT: u32 = 120;
const REGION: Region = Region {
    radius_px: 12,
    step_px: 3,
    klt: klt::Params { radius_px: 5, levels: 3, max_iterations: 30, epsilon_px: 0.01, min_eigenvalue: 1e-4 },
    mode: Params { floor_px: 0.2, min_effective: 3.0, epsilon_px: 1e-3, max_iterations: 50 },
};

fn pyramid(gray: impl Fn(f64, f64) -> f64) -> Pyramid {
    let data = texture::render(WIDTH, HEIGHT, gray);
    Pyramid::new(&Gray::packed(&data, WIDTH, HEIGHT), REGION.klt.levels, REGION.klt.radius_px)
}

fn moved(prev: &Pyramid, next: &Pyramid, centres: &[Point], n_threads: usize) -> Vec<Moved> {
    follow([prev, next], centres, &REGION, n_threads, &mut |_| true).unwrap()
}

/// A second texture slides over the lower part, which begins 4 px below the centres: about 30 % of each region's nodes.
#[test]
fn a_region_follows_the_larger_part() {
    let ground = |x: f64, y: f64| texture::value(3, x, y);
    let (motion, other) = ([1.2, -0.6], [-3.5, 0.4]);
    let scene = |t: f64| {
        pyramid(move |x, y| {
            if y > 64.0 {
                texture::value(8, x - t * other[0], y - t * other[1])
            } else {
                ground(x - t * motion[0], y - t * motion[1])
            }
        })
    };
    let (prev, next) = (scene(0.0), scene(1.0));
    let centres: Vec<Point> = (0..10).map(|i| [30.0 + 10.0 * i as f32, 59.3]).collect();
    for (moved, centre) in moved(&prev, &next, &centres, 1).iter().zip(&centres) {
        let error = [0, 1].map(|axis| moved.to[axis] - centre[axis] - motion[axis] as f32);
        assert_eq!(moved.state, State::Tracked);
        assert!(error[0].hypot(error[1]) < 0.15, "{moved:?} from {centre:?}");
        assert!(moved.share > 0.3 && moved.share < 0.75 && moved.spread_px < 0.5, "{moved:?}");
    }
}

#[test]
fn regions_without_nodes_texture_or_room_say_so() {
    let still = pyramid(|x, y| if x < 80.0 { texture::value(3, x, y) } else { 90.0 });
    let centres =
        [[40.0, 60.0], [120.0, 60.0], [-40.0, 10.0], [158.0, 2.0], [f32::NAN, 4.0], [1e30, 1e30], [0.0, 0.0]];
    let found = moved(&still, &still, &centres, 1);
    let states: Vec<State> = found.iter().map(|moved| moved.state).collect();
    let flat = State::Lost(Degenerate::Empty);
    let unknown = State::Lost(Degenerate::NotFinite);
    assert_eq!(states, [State::Tracked, flat, State::Outside, flat, unknown, State::Outside, State::Tracked]);
    let stays = |(moved, centre): (&Moved, &Point)| moved.to.map(f32::to_bits) == centre.map(f32::to_bits);
    assert!(found.iter().zip(&centres).all(|pair| pair.0.state == unknown || stays(pair)));
    assert!(found[0].share > 0.999, "all nodes of a still picture agree: {:?}", found[0]);

    let gone = pyramid(|x, y| texture::value(3, x + 6.0, y));
    let start = pyramid(|x, y| texture::value(3, x, y));
    assert_eq!(moved(&start, &gone, &[[3.0, 60.0]], 1)[0].state, State::Outside);
}

#[test]
fn a_region_says_why_it_has_no_motion() {
    // Only the first columns have texture: in the picture half, one or two columns of nodes, and none.
    let still = pyramid(|x, y| if x < 40.0 { texture::value(3, x, y) } else { 90.0 });
    let state = |radius_px: u32, step_px: u32, centre: Point| {
        let region = Region { radius_px, step_px, ..REGION };
        follow([&still, &still], &[centre], &region, 1, &mut |_| true).unwrap()[0].state
    };
    let lost = State::Lost;
    assert_eq!(state(2, 16, [24.0, 24.0]), lost(Degenerate::Empty), "no node is as near");
    assert_eq!(state(2, 16, [16.0, 16.0]), lost(Degenerate::Few), "one node");
    assert_eq!(state(8, 16, [24.0, 16.0]), lost(Degenerate::Few), "two nodes");
    assert_eq!(state(12, 16, [24.0, 24.0]), State::Tracked, "four nodes");
    assert_eq!(state(12, 3, [100.0, 60.0]), lost(Degenerate::Empty), "nodes without texture");
    let bare = Region { mode: Params { floor_px: 0.0, ..REGION.mode }, ..REGION };
    let found = follow([&still, &still], &[[20.0, 20.0]], &bare, 1, &mut |_| true).unwrap();
    assert_eq!(found[0].state, lost(Degenerate::Equal), "nothing moved, and nothing is noise");
}

#[test]
fn threads_do_not_change_a_bit_and_a_user_may_stop() {
    let (prev, next) =
        (pyramid(|x, y| texture::value(1, x, y)), pyramid(|x, y| texture::value(1, x - 2.0, y)));
    let centres: Vec<Point> = (0..1200).map(|i| [(i % 40) as f32 * 4.0, (i / 40) as f32 * 4.0]).collect();
    let one = moved(&prev, &next, &centres, 1);
    assert_eq!(one, moved(&prev, &next, &centres, 3));
    let mut asked = Vec::new();
    let mut stop_at = |n: usize| {
        asked.clear();
        let answer = follow([&prev, &next], &centres, &REGION, 1, &mut |share| {
            asked.push(share);
            asked.len() < n
        });
        (answer.is_some(), asked.clone())
    };
    let (done, shares) = stop_at(usize::MAX);
    assert!(done && shares.len() > 2 && shares.is_sorted() && shares.iter().all(|s| (0.0..1.0).contains(s)));
    let (first, last) = (stop_at(1), stop_at(shares.len()));
    assert_eq!((first.0, first.1.len(), last.0, last.1.len()), (false, 1, false, shares.len()));
}
