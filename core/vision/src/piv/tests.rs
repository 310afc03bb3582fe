//! Fields of pictures whose motion is known, and the parts against their definitions.

use super::correlate::peak;
use super::*;
use crate::texture;

const SIZE: u32 = 160;

/// Where a point of the first picture is in the second.
type Motion = fn([f64; 2]) -> [f64; 2];

/// Bright particles of a pixel and a half, or a texture; the second picture has them where the motion brings them.
fn pair(particles: bool, motion: Motion, inverse: Motion) -> [Vec<u8>; 2] {
    if !particles {
        let texture = |at: [f64; 2]| texture::value(7, at[0], at[1]);
        return [
            texture::render(SIZE, SIZE, |x, y| texture([x, y])),
            texture::render(SIZE, SIZE, |x, y| texture(inverse([x, y]))),
        ];
    }
    let place =
        |i: i64| [0, 1].map(|axis| (f64::from(SIZE) + 40.0) * 0.5 * (texture::hash(3, i, axis) + 1.0) - 20.0);
    let render = |motion: Motion| {
        let mut gray = vec![12.0; (SIZE * SIZE) as usize];
        for i in 0..1600 {
            let [px, py] = motion(place(i));
            let bright = 120.0 + 60.0 * texture::hash(4, i, 0);
            for y in (py as i32 - 5).max(0)..(py as i32 + 6).min(SIZE as i32) {
                for x in (px as i32 - 5).max(0)..(px as i32 + 6).min(SIZE as i32) {
                    let square = (f64::from(x) - px).powi(2) + (f64::from(y) - py).powi(2);
                    gray[(y * SIZE as i32 + x) as usize] += bright * (-square / 1.6).exp();
                }
            }
        }
        gray.into_iter().map(|g: f64| g.round().clamp(0.0, 255.0) as u8).collect()
    };
    [render(|at| at), render(motion)]
}

fn gray(data: &[u8]) -> Gray<'_> {
    Gray::packed(data, SIZE, SIZE)
}

/// Share of nodes, those near the border aside, that are known, and the rms error of these, pixels.
fn errors(field: &Field, motion: Motion) -> (f64, f64) {
    let (mut n, mut known, mut sum) = (0.0, 0.0, 0.0);
    for (i, node) in field.grid.nodes().enumerate() {
        if node.iter().any(|&c| !(16.0..SIZE as f32 - 16.0).contains(&c)) {
            continue;
        }
        n += 1.0;
        if field.known[i] {
            let at = node.map(f64::from);
            let to = motion(at);
            known += 1.0;
            sum += (f64::from(field.u[i]) - (to[0] - at[0])).powi(2)
                + (f64::from(field.v[i]) - (to[1] - at[1])).powi(2);
        }
    }
    (known / n, (sum / f64::max(known, 1.0)).sqrt())
}

const MIDDLE: f64 = 80.0;

#[test]
fn shift_shear_and_rotation_are_measured_to_hundredths() {
    let cases: [(&str, Motion, Motion, f64); 5] = [
        ("rest", |at| at, |at| at, 0.02),
        ("a fraction", |[x, y]| [x + 0.35, y - 0.6], |[x, y]| [x - 0.35, y + 0.6], 0.06),
        ("far", |[x, y]| [x + 13.3, y - 7.75], |[x, y]| [x - 13.3, y + 7.75], 0.06),
        (
            "shear",
            |[x, y]| [x + 0.04 * (y - MIDDLE) + 2.0, y],
            |[x, y]| [x - 0.04 * (y - MIDDLE) - 2.0, y],
            0.09,
        ),
        ("rotation", |at| turned(at, 0.04), |at| turned(at, -0.04), 0.13),
    ];
    for (name, motion, inverse, most) in cases {
        for particles in [true, false] {
            let [from, to] = pair(particles, motion, inverse);
            let field = measure(&gray(&from), &gray(&to), &Params::default(), 1, &|_| true).unwrap();
            let (known, rms) = errors(&field, motion);
            assert!(known > 0.97 && rms < most, "{name}, particles {particles}: {known} known, rms {rms} px");
        }
    }
}

/// Turned about the middle, radians.
fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    let (x, y) = (x - MIDDLE, y - MIDDLE);
    [cos * x - sin * y + MIDDLE, sin * x + cos * y + MIDDLE]
}

#[test]
fn what_changed_is_not_believed_and_the_rest_is() {
    let motion: Motion = |[x, y]| [x + 3.4, y + 1.2];
    let [from, mut to] = pair(false, motion, |[x, y]| [x - 3.4, y - 1.2]);
    // A square of the second picture shows something else.
    for (x, y) in (60..110).flat_map(|y| (60..110).map(move |x| (x, y))) {
        to[(y * SIZE + x) as usize] = texture::value(99, f64::from(x) * 1.7, f64::from(y) * 1.7) as u8;
    }
    let field = measure(&gray(&from), &gray(&to), &Params::default(), 1, &|_| true).unwrap();
    let (mut inside, mut doubted, mut wrong, mut outside) = (0, 0, 0, 0);
    for (i, [x, y]) in field.grid.nodes().enumerate() {
        let depth = |c: f32| (c - 60.0).min(110.0 - c);
        let is_right = (f64::from(field.u[i]) - 3.4).hypot(f64::from(field.v[i]) - 1.2) < 0.3;
        if depth(x).min(depth(y)) > 10.0 {
            inside += 1;
            doubted += usize::from(!field.known[i]);
        } else if depth(x).min(depth(y)) < -10.0 {
            outside += 1;
            wrong += usize::from(field.known[i] && !is_right);
        }
    }
    assert!(doubted * 2 > inside, "{doubted} of {inside} nodes that show something else are not known");
    assert!(wrong * 50 < outside, "{wrong} of {outside} others are wrong");
}

#[test]
fn flat_small_and_unwanted_pictures_have_no_vectors() {
    let flat = vec![90; (SIZE * SIZE) as usize];
    let field = measure(&gray(&flat), &gray(&flat), &Params::default(), 1, &|_| true).unwrap();
    assert!(!field.grid.is_empty() && field.known.iter().all(|known| !known));
    for (width, height) in [(1, 1), (4, 90), (7, 5), (40, 12)] {
        let data = texture::render(width, height, |x, y| texture::value(1, x, y));
        let picture = Gray::packed(&data, width, height);
        let field = measure(&picture, &picture, &Params::default(), 2, &|_| true).unwrap();
        assert!(field.u.iter().chain(&field.v).all(|c| c.abs() < 0.2), "{width}x{height}: {field:?}");
    }
    assert_eq!(measure(&gray(&flat), &gray(&flat), &Params::default(), 1, &|_| false), None);
}

#[test]
fn threads_do_not_change_a_bit_and_progress_rises_to_one() {
    let [from, to] = pair(true, |[x, y]| [x + 1.5, y - 2.5], |[x, y]| [x - 1.5, y + 2.5]);
    let run = |n_threads: usize| {
        let told = std::cell::RefCell::new(vec![0.0]);
        let go_on = |done: f64| {
            told.borrow_mut().push(done);
            true
        };
        let field = measure(&gray(&from), &gray(&to), &Params::default(), n_threads, &go_on);
        assert!(told.borrow().is_sorted() && told.borrow().last().is_some_and(|&last| last <= 1.0));
        field
    };
    let one = run(1);
    assert_eq!(run(2), one);
    assert_eq!(run(5), one);
}

#[test]
fn correlation_is_its_definition() {
    // ρ(d) = Σ w (A - Ā)(B_d - B̄_d) / √(Var_w A Var_w B_d), summed one by one, has its peak in the same place.
    for weighting in [Weighting::Uniform, Weighting::Gaussian] {
        let radius = 6;
        let correlator = Correlator::new(radius, weighting);
        let mut scratch = correlator.scratch();
        let reach = correlator.reach();
        let second = |x: usize, y: usize| texture::value(5, x as f64 * 2.0, y as f64 * 2.0) as f32;
        let first = |x: usize, y: usize| 20.0 + 0.5 * second(x + reach + 2, y + reach - 1);
        scratch.take(&correlator, first).unwrap();
        scratch.correlate(&correlator, second);
        let found = scratch.peak(&correlator).unwrap();
        let map = scratch.map();
        let side = 2 * radius as usize + 1;
        let weights: Vec<f64> = (0..side * side)
            .map(|i| {
                let away = |c: usize| (c as f64 - f64::from(radius)) / (0.5 * f64::from(radius));
                let square = away(i % side).powi(2) + away(i / side).powi(2);
                if weighting == Weighting::Uniform { 1.0 } else { (-0.5 * square).exp() }
            })
            .collect();
        let total: f64 = weights.iter().sum();
        for dy in 0..=2 * reach {
            for dx in 0..=2 * reach {
                let pairs = || {
                    (0..side * side)
                        .map(|i| (i % side, i / side))
                        .map(|(x, y)| (f64::from(first(x, y)), f64::from(second(x + dx, y + dy))))
                };
                let mean = |f: &dyn Fn(f64, f64) -> f64| {
                    pairs().zip(&weights).map(|((a, b), w)| w * f(a, b)).sum::<f64>() / total
                };
                let (a, b) = (mean(&|a, _| a), mean(&|_, b| b));
                let together = mean(&|p, q| (p - a) * (q - b));
                let want = together / (mean(&|p, _| (p - a).powi(2)) * mean(&|_, q| (q - b).powi(2))).sqrt();
                let got = f64::from(map[dy * (2 * reach + 1) + dx]);
                assert!((got - want).abs() < 2e-3, "{weighting:?} at {dx}, {dy}: {got} for {want}");
            }
        }
        assert!((found.at[0] - 2.0).hypot(found.at[1] + 1.0) < 0.1, "{found:?}");
    }
}

#[test]
fn there_and_back_no_side_is_favoured() {
    // A window against itself: its peak is at rest, whatever is to be seen beside it.
    let correlator = Correlator::new(6, Weighting::Gaussian);
    let mut scratch = correlator.scratch();
    let reach = correlator.reach();
    let around = |x: usize, y: usize| texture::value(8, x as f64, y as f64) as f32;
    for _ in 0..2 {
        scratch.turn();
        scratch.take(&correlator, |x, y| around(x + reach, y + reach)).unwrap();
        scratch.correlate(&correlator, around);
    }
    let one_way = scratch.peak(&correlator).unwrap();
    scratch.meet();
    let both = scratch.peak(&correlator).unwrap();
    assert!(both.at[0].hypot(both.at[1]) < 1e-3, "{both:?}");
    assert!(one_way.at[0].hypot(one_way.at[1]) > 10.0 * both.at[0].hypot(both.at[1]), "{one_way:?}");
}

#[test]
fn what_is_not_known_is_filled_from_its_neighbours() {
    let grid = Grid { origin: [0.0; 2], step_px: 1.0, nx: 4, ny: 1 };
    let field = Field::new(grid, [Some([2.0, 4.0]), None, None, Some([4.0, 0.0])]);
    let filled = validate::filled(field);
    assert_eq!(
        (filled.u, filled.v, filled.known),
        (vec![2.0, 2.0, 4.0, 4.0], vec![4.0, 4.0, 0.0, 0.0], vec![true; 4])
    );
    let nothing = Field::new(grid, [None; 4]);
    assert_eq!(validate::filled(nothing.clone()), nothing);
}

/// All nodes looked at again for every ring: what `filled` is, said as plainly as can be.
fn filled_plainly(mut field: Field) -> Field {
    let Grid { nx, ny, .. } = field.grid;
    loop {
        let before = field.clone();
        for (i, (x, y)) in (0..ny).flat_map(|y| (0..nx).map(move |x| (x, y))).enumerate() {
            let near = |j: &usize| {
                let (column, row) = ((j % nx as usize) as u32, (j / nx as usize) as u32);
                before.known[*j] && column.abs_diff(x).max(row.abs_diff(y)) == 1
            };
            let around: Vec<usize> = (0..before.known.len()).filter(near).collect();
            if !before.known[i] && !around.is_empty() {
                let mean = |of: &[f32]| around.iter().map(|&j| of[j]).sum::<f32>() / around.len() as f32;
                (field.u[i], field.v[i], field.known[i]) = (mean(&before.u), mean(&before.v), true);
            }
        }
        if field == before {
            return field;
        }
    }
}

#[test]
fn filling_ring_by_ring_is_filling_all_of_it_again_and_again() {
    for (nx, ny, share) in [(1, 1, 0.0), (9, 7, 0.9), (13, 11, -0.5), (16, 3, -0.9), (12, 12, -0.97)] {
        for seed in 0..8 {
            let grid = Grid { origin: [0.0; 2], step_px: 1.0, nx, ny };
            let vectors = (0..grid.len() as i64).map(|i| {
                let drawn = |k: i64| texture::hash(seed, i, k) as f32;
                (drawn(0) < share).then(|| [9.0 * drawn(1), 9.0 * drawn(2)])
            });
            let field = Field::new(grid, vectors);
            assert_eq!(validate::filled(field.clone()), filled_plainly(field), "{nx}x{ny}, seed {seed}");
        }
    }
}

#[test]
fn peaks_are_found_beside_lower_ones_and_not_on_the_edge() {
    let gaussian = |x: f32, y: f32, at: [f32; 2]| (-((x - at[0]).powi(2) + (y - at[1]).powi(2)) / 2.0).exp();
    let map = |f: &dyn Fn(f32, f32) -> f32| -> Vec<f32> {
        (0..121).map(|i| f((i % 11) as f32 - 5.0, (i / 11) as f32 - 5.0)).collect()
    };
    let two = |x: f32, y: f32| gaussian(x, y, [1.3, -2.2]) + 0.5 * gaussian(x, y, [-3.0, 2.0]);
    let found = peak(&map(&two), 11).unwrap();
    assert!((found.at[0] - 1.3).hypot(found.at[1] + 2.2) < 1e-3, "{found:?}");
    // Of the first peak the map has what is at (1, -2).
    assert!((1.8..1.95).contains(&found.ratio), "{found:?}");
    assert_eq!(peak(&map(&|x, y| gaussian(x, y, [5.0, 0.0])), 11), None);
    assert_eq!(peak(&map(&|_, _| -1.0), 11), None);
    assert!(peak(&map(&|x, y| gaussian(x, y, [0.0, 0.0])), 11).is_some_and(|p| p.ratio.is_infinite()));
}

#[test]
fn one_vector_among_others_is_doubted_and_replaced() {
    let grid = Grid { origin: [0.0; 2], step_px: 8.0, nx: 5, ny: 5 };
    let vector = |to: [f32; 2], ratio: f32| Some(Vector { to, ratio });
    let mut found = vec![vector([2.0, 1.0], 3.0); 25];
    // All neighbours agree: ε alone is the measure, 0.15 / 0.1 and 0.25 / 0.1.
    found[6] = vector([2.15, 1.0], 3.0);
    found[12] = vector([2.25, 1.0], 3.0);
    found[18] = vector([2.0, 1.0], 1.1);
    found[4] = None;
    let field = validate::validate(grid, &found, &Params::default());
    let at = |i: usize| field.known[i].then_some([field.u[i], field.v[i]]);
    assert_eq!(at(6), Some([2.15, 1.0]));
    assert_eq!(at(12), Some([2.0, 1.0]), "doubted, and replaced by the median of its neighbours");
    assert_eq!(at(18), Some([2.0, 1.0]), "too low a peak, replaced");
    assert_eq!(at(4), None, "three neighbours do not stand in for a corner");
    let lenient = Params { median_limit: 0.0, peak_ratio: 0.0, ..Params::default() };
    assert!((validate::validate(grid, &found, &lenient).u[12] - 2.25).abs() < 1e-6);
}

/// Known displacements of a pair of the real data, along x and along y, and the share of nodes that are known.
fn real(name: &str, radius_px: u32) -> Option<([Vec<f32>; 2], f64)> {
    let Some(root) = std::env::var_os("HONAMI_DATA") else {
        eprintln!("skipped: needs HONAMI_DATA (piv/{name})");
        return None;
    };
    let picture = |which: &str| {
        let file = name.replace('*', which);
        image::open(std::path::Path::new(&root).join("piv").join(file)).unwrap().to_luma8()
    };
    let pair = if name.starts_with("openpiv") { ["a", "b"] } else { ["01", "02"] }.map(picture);
    let [from, to] = pair.each_ref().map(|p| Gray::packed(p.as_raw(), p.width(), p.height()));
    let params = Params { radius_px, coarser: 1, step_px: radius_px, ..Params::default() };
    let field = measure(&from, &to, &params, 2, &|_| true).unwrap();
    let known = |values: &[f32]| {
        let mut known: Vec<f32> =
            values.iter().zip(&field.known).filter(|&(_, known)| *known).map(|(&v, _)| v).collect();
        known.sort_by(f32::total_cmp);
        known
    };
    let share = field.known.iter().filter(|known| **known).count() as f64 / field.known.len() as f64;
    Some(([known(&field.u), known(&field.v)], share))
}

#[test]
fn the_jet_of_openpiv_moves_as_openpiv_says() {
    let Some(([u, v], share)) = real("openpiv_exp1_001_*.bmp", 16) else { return };
    let (u, v) = (u[u.len() / 2], v[v.len() / 2]);
    // OpenPIV's medians with windows of 32 px are (-0.07, 5.03). Those of a plain correlation of the same windows, each
    // with one in place, are (-0.11, 5.16), and of OpenCV's `matchTemplate` (-0.12, 5.20), which loses no pixels of a
    // window that moved: that is what is held here.
    assert!((u + 0.12).abs() < 0.1 && (v - 5.2).abs() < 0.1 && share > 0.9, "({u}, {v}), {share} known");
}

#[test]
fn the_vortex_street_of_pivlab_is_known_nearly_everywhere() {
    let Some(([u, v], share)) = real("pivlab_karman_*.bmp", 8) else { return };
    let middle = |values: &[f32]| values[values.len() / 2];
    let within = |values: &[f32]| values[values.len() / 50] > -8.0 && values[values.len() * 49 / 50] < 8.0;
    assert!(share > 0.85 && within(&u) && within(&v), "{share} known");
    assert!((middle(&u) + 1.8).abs() < 0.6 && middle(&v).abs() < 0.3, "({}, {})", middle(&u), middle(&v));
}
