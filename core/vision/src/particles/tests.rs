//! Particles on pictures whose motion is known, and the mean of those that err.

use std::collections::BTreeSet;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::*;
use crate::texture;

const WIDTH: u32 = 160;
const HEIGHT: u32 = 120;

fn params() -> Params {
    let klt = klt::Params { radius_px: 6, levels: 2, ..klt::Params::default() };
    let corners =
        detect::Params { max_corners: 500, quality: 0.02, min_distance_px: 8.0, ..detect::Params::default() };
    Params { klt, corners, life_frames: 20, scale_px: 1.0, reach_px: 20.0 }
}

/// A texture that moves out to the right and below, for ever.
fn frame(t: u32) -> Pyramid {
    let t = f64::from(t);
    let data = texture::render(WIDTH, HEIGHT, |x, y| texture::value(4, x - 2.1 * t, y - 0.8 * t));
    Pyramid::new(&Gray::packed(&data, WIDTH, HEIGHT), 2, 6)
}

fn step(swarm: &mut Swarm, prev: &Pyramid, next: &Pyramid) -> Spots {
    swarm.step([prev, next], 1, &mut |_| true).unwrap()
}

/// All that entered the picture in the beginning has left it after 80 frames.
#[test]
fn density_holds_while_the_scene_moves_out() {
    const CELL: f32 = 40.0;
    let mut prev = frame(0);
    let mut swarm = Swarm::new(&params(), &prev.picture());
    let (mut counts, mut numbers) = (Vec::new(), BTreeSet::new());
    for t in 1..=300 {
        let next = frame(t);
        step(&mut swarm, &prev, &next);
        prev = next;
        let mut cells = [0; 12];
        for particle in swarm.living() {
            let [column, row] = particle.at.map(|c| (c / CELL) as usize);
            cells[row.min(2) * 4 + column.min(3)] += 1;
            numbers.insert(particle.number);
        }
        counts.push((cells, swarm.living().len()));
    }
    let of = |pick: fn(&[i32; 12]) -> Option<&i32>| counts.iter().filter_map(move |(cells, _)| pick(cells));
    let (fewest, most) = (of(|c| c.iter().min()).min().unwrap(), of(|c| c.iter().max()).max().unwrap());
    let totals = counts.iter().map(|(_, total)| *total);
    let (low, high) = (totals.clone().min().unwrap(), totals.max().unwrap());
    assert!((4..=25).contains(fewest) && (4..=25).contains(most), "{fewest} to {most} particles a cell");
    assert!(high < 2 * low, "{low} to {high} particles");
    // Numbers are in order and never used again.
    assert!(swarm.living().is_sorted_by_key(|particle| particle.number));
    assert!(numbers.len() > 300 * 100 / 20, "only {} were born", numbers.len());
}

#[test]
fn no_particle_outlives_its_time_and_they_do_not_end_together() {
    let still = frame(0);
    let mut swarm = Swarm::new(&params(), &still.picture());
    let first = swarm.living().len();
    let mut ended = Vec::new();
    for t in 1..=20 {
        let before = swarm.living().iter().filter(|particle| particle.number < first as u64).count();
        step(&mut swarm, &still, &still);
        let after = swarm.living().iter().filter(|particle| particle.number < first as u64).count();
        ended.push(before - after);
        assert!(t < 20 || after == 0, "{after} of the first are alive in frame 20");
    }
    assert!(ended.iter().all(|&n| n < first / 8), "of {first}: {ended:?}");
    // In a still picture each is replaced in its place.
    assert_eq!(swarm.living().len(), first);
}

#[test]
fn the_flow_is_that_of_the_scene() {
    let frames = [0, 1, 2].map(frame);
    let mut swarm = Swarm::new(&params(), &frames[0].picture());
    step(&mut swarm, &frames[0], &frames[1]);
    let flow = step(&mut swarm, &frames[1], &frames[2]);
    for y in 0..6 {
        for x in 0..8 {
            let place = [10.0 + 18.0 * x as f32, 12.0 + 18.0 * y as f32];
            let motion = flow.at(place).unwrap();
            assert!((motion[0] - 2.1).hypot(motion[1] - 0.8) < 0.25, "{motion:?} at {place:?}");
        }
    }
    for far in [[-40.0, 60.0], [80.0, 1e9], [f32::NAN, 3.0], [-1e30, f32::INFINITY]] {
        assert_eq!(flow.at(far), None);
    }
    let blank = vec![90; (WIDTH * HEIGHT) as usize];
    let blank = Gray::packed(&blank, WIDTH, HEIGHT);
    assert!(Swarm::new(&params(), &blank).living().is_empty());
    assert_eq!(Spots::new(Vec::new(), 1.0, 20.0).at([3.0, 4.0]), None);
}

/// By hand: two particles, one steady, one that changed by one scale, at known distances.
#[test]
fn weights_are_those_of_the_formula() {
    let spot = |x: f32, right: f32, change_px| Spot { at: [x, 10.0], motion: [right, 0.0], change_px };
    let flow = Spots::new(vec![spot(10.0, 1.0, Some(0.0)), spot(20.0, 3.0, Some(2.0))], 2.0, 20.0);
    // Kernels (1 - 16/400)² and (1 - 36/400)², weights 1 and 1/e.
    let (a, b) = (0.96_f64.powi(2), 0.91_f64.powi(2) * (-1.0_f64).exp());
    let wanted = (a + 3.0 * b) / (a + b);
    let [found, _] = flow.at([14.0, 10.0]).unwrap();
    assert!((f64::from(found) - wanted).abs() < 1e-6, "{found}, not {wanted}");
    // One with a single displacement weighs as much as one that changed by the scale.
    let other = Spots::new(vec![spot(10.0, 1.0, Some(0.0)), spot(20.0, 3.0, None)], 2.0, 20.0);
    assert_eq!(other.at([14.0, 10.0]), flow.at([14.0, 10.0]));
    // However unsteady, those that are there decide.
    let wild = Spots::new(vec![spot(10.0, 1.0, Some(500.0)), spot(20.0, 3.0, Some(900.0))], 1.0, 20.0);
    assert_eq!(wild.at([14.0, 10.0]), Some([1.0, 0.0]));
}

/// The claim of 2.5.3: where a share of the particles errs, otherwise in each frame, weighting by steadiness finds the
/// motion of a region better than the mean does.
#[test]
fn errors_that_are_uncorrelated_in_time_weigh_little() {
    for (share, gain) in [(0.1, 2.0), (0.3, 2.0), (0.5, 2.0)] {
        let (mut weighted, mut plain) = (0.0, 0.0);
        for seed in 0..200 {
            let mut rng = Pcg64Mcg::seed_from_u64(seed);
            let mut noise = |size: f32| size * (rng.random::<f32>() + rng.random::<f32>() - 1.0);
            let spots: Vec<Spot> = (0..30)
                .map(|i| {
                    let size = if (i as f64) < 30.0 * share { 6.0 } else { 0.3 };
                    let at = [noise(15.0), noise(15.0)];
                    let [first, second] = [0, 1].map(|_| [2.0 + noise(size), -1.0 + noise(size)]);
                    let change = (first[0] - second[0]).hypot(first[1] - second[1]);
                    Spot { at, motion: second, change_px: Some(change) }
                })
                .collect();
            let error = |scale_px: f64| {
                let [x, y] = Spots::new(spots.clone(), scale_px, 25.0).at([0.0, 0.0]).unwrap();
                (f64::from(x) - 2.0).powi(2) + (f64::from(y) + 1.0).powi(2)
            };
            weighted += error(1.0);
            plain += error(1e9);
        }
        let [weighted, plain] = [weighted, plain].map(|sum: f64| (sum / 200.0).sqrt());
        assert!(gain * weighted < plain, "{share}: {weighted} px, the mean {plain} px");
    }
}
