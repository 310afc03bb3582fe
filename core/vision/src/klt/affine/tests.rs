//! Windows of textures that turn, stretch and shear by laws that are known.

use proptest::prelude::*;

use super::*;
use crate::klt::track;
use crate::middlebury::Pair;

const SIZE: (u32, u32) = (240, 180);

/// Points in the middle of the picture, where they were found by translation alone, and refined; and their truth.
fn followed(pair: &Pair, n_threads: usize) -> (Vec<Point>, Vec<Flow>, Vec<Flow>) {
    let params = Params::default();
    let [prev, next] = pair.pictures.each_ref().map(|data| {
        Pyramid::new(&Gray::packed(data, pair.width, pair.height), params.levels, params.radius_px)
    });
    let from: Vec<Point> =
        (0..80).map(|i| [60.5 + 12.0 * (i % 10) as f32, 40.3 + 13.0 * (i / 10) as f32]).collect();
    let moved = track(&prev, &next, &from, None, &params, n_threads);
    let mut refined = moved.clone();
    refine(&prev, &next, &from, &mut refined, &params, n_threads);
    (from, moved, refined)
}

/// Root of the mean squared error.
fn error(pair: &Pair, from: &[Point], flows: &[Flow]) -> f64 {
    let truth = |[x, y]: Point| {
        // The law is affine: the truth between pixels is linear in that of three of them.
        let at = |x: u32, y: u32| pair.truth[(y * pair.width + x) as usize].unwrap().map(f64::from);
        let (o, right, below) = (at(0, 0), at(1, 0), at(0, 1));
        [0, 1].map(|i| o[i] + f64::from(x) * (right[i] - o[i]) + f64::from(y) * (below[i] - o[i]))
    };
    let squares = from.iter().zip(flows).map(|(p, flow)| {
        let d = truth(*p);
        (f64::from(flow.to[0] - p[0]) - d[0]).powi(2) + (f64::from(flow.to[1] - p[1]) - d[1]).powi(2)
    });
    (squares.sum::<f64>() / from.len() as f64).sqrt()
}

proptest! {
    #![proptest_config(crate::cases(24))]

    #[test]
    fn what_turns_stretches_and_shears_is_followed_better_than_by_translation(
        turn in 0.06_f64..0.12, stretch in 0.92_f64..1.08, shear in -0.08_f64..0.08, drift in -3.0_f64..3.0,
    ) {
        let (sin, cos) = turn.sin_cos();
        let pair = Pair::affine("", SIZE, [stretch * cos, sin + shear, -sin, cos], [drift, 1.0]);
        let (from, moved, refined) = followed(&pair, 1);
        let (plain, affine) = (error(&pair, &from, &moved), error(&pair, &from, &refined));
        prop_assert!(affine < 0.5 * plain && affine < 0.1, "{plain} px by translation, {affine} px by affinity");
    }
}

#[test]
fn what_only_moves_stays_where_translation_found_it() {
    let pair = Pair::affine("", SIZE, [1.0, 0.0, 0.0, 1.0], [-2.3, 1.6]);
    let (from, moved, refined) = followed(&pair, 1);
    let (plain, affine) = (error(&pair, &from, &moved), error(&pair, &from, &refined));
    assert!(affine < 1.5 * plain && affine < 0.03, "{plain} {affine}");
}

#[test]
fn six_unknowns_are_solved_and_what_cannot_tell_them_is_refused() {
    let rows = [[4.0, 1.0, 0.5, 0.2, 0.0, 1.0], [0.3, 2.0, 0.1, 0.0, 1.0, 0.0]];
    let basis = |i: usize, k: usize| if i == k { 2.0 } else { rows[i % 2][k] / 3.0 };
    let mut matrix = [[0.0; 6]; 6];
    for (i, k) in (0..6).flat_map(|i| (0..6).map(move |k| (i, k))) {
        matrix[i][k] = (0..6).map(|j| basis(i, j) * basis(k, j)).sum();
    }
    let want = [1.0, -2.0, 0.5, 3.0, -0.25, 4.0];
    let b = matrix.map(|row| row.iter().zip(want).map(|(a, x)| a * x).sum::<f64>());
    let got = solved(&factored(&matrix).unwrap(), b);
    assert!(got.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-9), "{got:?}");
    // Stripes tell nothing along themselves.
    let stripes = crate::texture::render(80, 80, |x, y| 128.0 + 50.0 * ((x + y) / 4.0).sin());
    let mut window = Window::default();
    assert!(!window.cut(&Gray::packed(&stripes, 80, 80), [40.0, 40.0], 10));
    assert!(!window.cut(&Gray::packed(&[7; 6400], 80, 80), [40.0, 40.0], 10));
}

#[test]
fn borders_lost_points_and_threads() {
    let pair = Pair::affine("", SIZE, [1.0, 0.1, -0.1, 1.0], [0.7, 0.3]);
    let (_, _, once) = followed(&pair, 1);
    for n_threads in [2, 5, 100] {
        assert_eq!(followed(&pair, n_threads).2, once);
    }
    let params = Params::default();
    let picture = Pyramid::new(&Gray::packed(&pair.pictures[0], SIZE.0, SIZE.1), 1, params.radius_px);
    let state = |to: Point, state: State| Flow { to, state };
    let from = [[3.0, 90.0], [120.0, 90.0], [120.0, 90.0]];
    let given = [
        state([3.4, 90.0], State::Tracked),
        state([900.0, 90.0], State::Tracked),
        state([120.4, 90.0], State::Outside),
    ];
    let mut flows = given;
    refine(&picture, &picture, &from, &mut flows, &params, 1);
    assert_eq!(flows, given);
}
