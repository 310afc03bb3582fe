//! The search against its definition, and on pictures whose motion is known.

use proptest::prelude::*;

use super::*;
use crate::klt::Reason;
use crate::texture;
use honami_model::picture::Gray;

const SIZE: u32 = 96;

fn picture(seed: u64, shift: [f64; 2]) -> Vec<u8> {
    texture::render(SIZE, SIZE, |x, y| texture::value(seed, x - shift[0], y - shift[1]))
}

fn boxes(data: &[u8], params: &Params) -> Boxes {
    Boxes::new(&Gray::packed(data, SIZE, SIZE), params.levels(), params.radius_px)
}

fn exhaustive(radius_px: u32, search_px: u32, measure: Measure) -> Params {
    Params { radius_px, search_px, method: Method::Exhaustive, measure, min_contrast: 0.0 }
}

fn pyramidal(levels: u32, share: f32, params: Params) -> Params {
    Params { method: Method::Pyramidal { levels, share }, ..params }
}

/// A pixel of a picture that goes on as its mirror image.
fn mirrored(data: &[u8], size: (i32, i32), x: i32, y: i32) -> f64 {
    let fold = |i: i32, n: i32| {
        let i = i.rem_euclid((2 * n - 2).max(1));
        if n == 1 { 0 } else { i.min(2 * n - 2 - i) }
    };
    f64::from(data[(fold(y, size.1) * size.0 + fold(x, size.0)) as usize])
}

/// Eq. 2.3 word by word: the least cost over the search window and all displacements that have it.
fn by_definition(
    i: &[u8],
    j: &[u8],
    size: (i32, i32),
    at: [i32; 2],
    params: &Params,
) -> (f64, Vec<[i32; 2]>) {
    let (r, s) = (params.radius_px as i32, params.search_px as i32);
    let window = |data: &[u8], x: i32, y: i32| -> Vec<f64> {
        (-r..=r)
            .flat_map(|dy| (-r..=r).map(move |dx| (dx, dy)))
            .map(|(dx, dy)| mirrored(data, size, x + dx, y + dy))
            .collect()
    };
    let template = window(i, at[0], at[1]);
    let mut best = (f64::INFINITY, Vec::new());
    for dy in -s..=s {
        for dx in -s..=s {
            let (x, y) = (at[0] + dx, at[1] + dy);
            if !(0..size.0).contains(&x) || !(0..size.1).contains(&y) {
                continue;
            }
            let other = window(j, x, y);
            let cost = match params.measure {
                Measure::Ssd => template.iter().zip(&other).map(|(p, q)| (p - q).powi(2)).sum(),
                Measure::Ncc => 1.0 - correlation(&template, &other),
            };
            if cost < best.0 - 1e-9 {
                best = (cost, Vec::new());
            }
            if cost <= best.0 + 1e-9 {
                best.1.push([dx, dy]);
            }
        }
    }
    best
}

fn correlation(p: &[f64], q: &[f64]) -> f64 {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (a, b) = (mean(p), mean(q));
    let sum = |f: &dyn Fn(f64, f64) -> f64| p.iter().zip(q).map(|(p, q)| f(p - a, q - b)).sum::<f64>();
    let power = sum(&|p, _| p * p) * sum(&|_, q| q * q);
    if power > 1e-6 { sum(&|p, q| p * q) / power.sqrt() } else { -1.0 }
}

proptest! {
    #![proptest_config(crate::cases(120))]
    #[test]
    fn exhaustive_is_the_definition_and_so_is_a_pyramid_that_keeps_all(
        size in (1_i32..40, 1_i32..40), radius in 1_u32..8, search in 1_u32..7, seed in 0_u64..1000,
        at in (0.0_f32..1.0, 0.0_f32..1.0), ncc in any::<bool>(), smooth in any::<bool>(),
    ) {
        let pixel = |seed: u64, shift: f64, x: f64, y: f64| {
            if smooth { texture::value(seed, x - shift, y + shift) } else { 128.0 + 127.0 * texture::hash(seed, x as i64, y as i64) }
        };
        let render = |seed: u64, shift: f64| texture::render(size.0 as u32, size.1 as u32, |x, y| pixel(seed, shift, x, y));
        let (i, j) = (render(seed, 0.0), render(seed + u64::from(!smooth), 2.0));
        let params = exhaustive(radius, search, if ncc { Measure::Ncc } else { Measure::Ssd });
        let at = [(at.0 * (size.0 - 1) as f32).round(), (at.1 * (size.1 - 1) as f32).round()];
        let (cost, places) = by_definition(&i, &j, size, at.map(|c| c as i32), &params);
        for params in [params, pyramidal(3, 1.0, params)] {
            let [i, j] = [&i, &j].map(|data| {
                Boxes::new(&Gray::packed(data, size.0 as u32, size.1 as u32), params.levels(), radius)
            });
            let mut runs = simd::available().map(|level| track_at(level, &i, &j, &[at], None, &params, 1)[0]);
            let found = runs.next().unwrap();
            prop_assert!(places.contains(&found.step), "{found:?}, but {places:?} have {cost}");
            if !ncc {
                prop_assert_eq!(f64::from(found.cost).to_bits(), cost.to_bits());
            }
            for other in runs {
                prop_assert_eq!(other, found);
            }
        }
    }
}

#[test]
fn the_sums_have_n_terms_in_each_direction() {
    // Errata E4: for a template of 3x3, nine squares of 10, not sixteen.
    let (dark, bright) = ([20; 49], [30; 49]);
    let [i, j] = [&dark, &bright].map(|data| Boxes::new(&Gray::packed(data, 7, 7), 1, 1));
    let found = track(&i, &j, &[[3.0, 3.0]], None, &exhaustive(1, 1, Measure::Ssd), 1);
    assert_eq!((found[0].cost, found[0].step), (900, [0, 0]));
}

#[test]
fn a_coarse_pixel_is_the_mean_of_four() {
    let data: Vec<u8> = (0..64).map(|i| (i * 53 % 256) as u8).collect();
    let boxes = Boxes::new(&Gray::packed(&data, 8, 8), 3, 4);
    assert_eq!(boxes.n_levels(), 3);
    for level in 1..3 {
        let (fine, coarse) = (&boxes.planes[level - 1], &boxes.planes[level]);
        for (x, y) in [(0, 0), (3, 5), (coarse.stride - 1, 2)] {
            let four = [(0, 0), (1, 0), (0, 1), (1, 1)]
                .map(|(dx, dy)| u32::from(fine.data[(2 * y + dy) * fine.stride + 2 * x + dx]));
            assert_eq!(u32::from(coarse.data[y * coarse.stride + x]), (four.iter().sum::<u32>() + 2) / 4);
        }
        // The margin is a whole number of pixels on each level.
        assert_eq!(fine.margin, 2 * coarse.margin);
    }
    let picture = boxes.picture();
    assert!((0..8).all(|y| picture.row(y) == &data[8 * y as usize..][..8]));
}

#[test]
fn the_pyramid_finds_what_the_exhaustive_search_finds() {
    let points: Vec<Point> =
        (0..400).map(|i| [14.0 + (i % 20) as f32 * 3.4, 12.0 + (i / 20) as f32 * 3.6]).collect();
    for measure in [Measure::Ssd, Measure::Ncc] {
        for shift in [[0.0, 0.0], [7.4, -5.3], [-11.0, 3.5]] {
            let all = exhaustive(6, 16, measure);
            let few = pyramidal(2, 0.05, all);
            let [i, j] = [[0.0; 2], shift].map(|shift| picture(4, shift));
            let run = |params: &Params| {
                let found = track(&boxes(&i, params), &boxes(&j, params), &points, None, params, 1);
                found.into_iter().map(|found| found.cost).collect::<Vec<_>>()
            };
            let same = run(&all).iter().zip(run(&few)).filter(|(a, b)| *a == b).count();
            assert!(same >= 396, "{measure:?} {shift:?}: {same} of 400");
        }
    }
}

#[test]
fn the_fraction_of_a_pixel_is_found() {
    let points: Vec<Point> =
        (0..100).map(|i| [30.3 + (i % 10) as f32 * 4.0, 28.6 + (i / 10) as f32 * 4.0]).collect();
    let mut worst = 0.0_f64;
    for shift in [[0.25, 0.0], [3.5, -2.25], [-6.75, 8.4], [0.1, -0.9]] {
        for measure in [Measure::Ssd, Measure::Ncc] {
            let params = pyramidal(3, 0.07, exhaustive(10, 16, measure));
            let (i, j) = (picture(9, [0.0; 2]), picture(9, shift));
            let found = track(&boxes(&i, &params), &boxes(&j, &params), &points, None, &params, 1);
            let squares = found.iter().zip(&points).map(|(found, from)| {
                assert_eq!(found.state, State::Tracked);
                (0..2).map(|i| (f64::from(found.to[i] - from[i]) - shift[i]).powi(2)).sum::<f64>()
            });
            worst = worst.max((squares.sum::<f64>() / 100.0).sqrt());
        }
    }
    assert!(worst < 0.06, "rms {worst} px");
}

#[test]
fn what_has_not_moved_is_found_where_it_was() {
    let points: Vec<Point> = (0..50).map(|i| [30.3 + i as f32, 28.6 + i as f32 * 0.7]).collect();
    let params = pyramidal(3, 0.07, exhaustive(10, 16, Measure::Ssd));
    let i = picture(9, [0.0; 2]);
    let found = track(&boxes(&i, &params), &boxes(&i, &params), &points, None, &params, 1);
    assert_eq!(found.iter().map(|found| found.to).collect::<Vec<_>>(), points);
}

#[test]
fn correlation_bears_another_brightness_and_contrast() {
    let i = picture(3, [0.0; 2]);
    let j: Vec<u8> = picture(3, [4.0, -3.0]).iter().map(|p| p / 2 + 100).collect();
    let step = |measure: Measure| {
        let params = pyramidal(3, 0.07, exhaustive(10, 16, measure));
        track(&boxes(&i, &params), &boxes(&j, &params), &[[48.0, 48.0]], None, &params, 1)[0].step
    };
    assert_eq!(step(Measure::Ncc), [4, -3]);
    assert_ne!(step(Measure::Ssd), [4, -3]);
}

#[test]
fn what_cannot_be_looked_for_says_why() {
    let (i, j) = (picture(5, [0.0; 2]), picture(5, [-9.0, 0.0]));
    let params = Params { search_px: 16, min_contrast: 1.0, ..Params::default() };
    let flat = vec![90; (SIZE * SIZE) as usize];
    let run = |i: &[u8], at: Point, guess: Point| {
        track(&boxes(i, &params), &boxes(&j, &params), &[at], Some(&[guess]), &params, 1)[0]
    };
    let inside = [40.0, 50.0];
    assert_eq!(run(&i, inside, inside).state, State::Tracked);
    assert_eq!(run(&flat, inside, inside).state, State::Lost(Reason::Flat));
    assert_eq!(
        run(&i, [f32::NAN, 3.0], inside),
        Match { to: [0.0, 3.0], state: State::Lost(Reason::NotFinite), step: [0; 2], cost: 0 }
    );
    assert_eq!(run(&i, inside, [f32::INFINITY, 0.0]).state, State::Lost(Reason::NotFinite));
    assert_eq!(run(&i, [-1.0, 3.0], inside).state, State::Outside);
    // A spot leaves the picture: what is left of it is found at the edge.
    let spot = |centre: f64| {
        let spot = texture::render(SIZE, SIZE, |x, y| {
            200.0 * (-((x - centre).powi(2) + (y - 50.0).powi(2)) / 40.0).exp()
        });
        boxes(&spot, &params)
    };
    let gone = track(&spot(12.0), &spot(0.0), &[[12.3, 50.0]], None, &params, 1)[0];
    assert_eq!((gone.state, gone.step), (State::Outside, [-12, 0]));
}

#[test]
fn threads_and_templates_kept_do_not_change_a_bit() {
    let params = Params { search_px: 12, ..Params::default() };
    let (i, j) = (boxes(&picture(1, [0.0; 2]), &params), boxes(&picture(1, [2.3, 1.1]), &params));
    let points: Vec<Point> =
        (0..300).map(|k| [(k * 17 % 96) as f32 + 0.3, (k * 29 % 96) as f32 - 0.2]).collect();
    let one = track(&i, &j, &points, None, &params, 1);
    assert_eq!(track(&i, &j, &points, None, &params, 3), one);
    let templates: Vec<Template> = points
        .iter()
        .map(|&point| {
            let mut template = Template::default();
            template.cut(&i, point);
            template
        })
        .collect();
    let templates: Vec<&Template> = templates.iter().collect();
    assert_eq!(find(&templates, &j, &points, &params, 2), one);
}
