//! Filters against sums written out, gradients against polynomials, motion against its own law.

use super::*;

fn plane(width: usize, height: usize, value: impl Fn(f32, f32) -> f32) -> Plane {
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x as f32, y as f32)));
    Plane { width, height, data: pixels.map(|(x, y)| value(x, y)).collect() }
}

#[test]
fn a_filter_is_its_weighted_sum() {
    let picture = plane(9, 6, |x, y| (x * 7.0 + y * y * 3.0) % 11.0);
    let weights = gaussian(1.1, 2);
    for border in [Border::Mirrored, Border::Nothing] {
        let got = picture.filtered(&weights, border, 1);
        for (y, x) in (0..6).flat_map(|y| (0..9).map(move |x| (y, x))) {
            let mut want = 0.0;
            for (dy, dx) in (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| (dy, dx))) {
                let (column, row) = (x as isize + dx, y as isize + dy);
                let inside = (0..9).contains(&column) && (0..6).contains(&row);
                if inside || border == Border::Mirrored {
                    let value = picture.row(mirrored(row, 6))[mirrored(column, 9)];
                    want += weights[dx.unsigned_abs()] * weights[dy.unsigned_abs()] * value;
                }
            }
            assert!((got.row(y)[x] - want).abs() < 1e-4, "{border:?} {x} {y}: {} {want}", got.row(y)[x]);
        }
    }
}

#[test]
fn a_gaussian_adds_to_one_and_none_is_the_picture() {
    let weights = gaussian(2.5, 8);
    assert!((weights[0] + 2.0 * weights[1..].iter().sum::<f32>() - 1.0).abs() < 1e-6);
    assert_eq!(gaussian(0.0, 0), [1.0]);
    let picture = plane(5, 4, |x, y| x * y);
    assert_eq!(picture.filtered(&[1.0], Border::Nothing, 1), picture);
}

#[test]
fn a_median_is_the_middle_of_nine() {
    let picture = plane(7, 5, |x, y| (x * 5.0 + y * 7.0 + x * y) % 13.0);
    let got = picture.median(1);
    for (y, x) in (0..5).flat_map(|y| (0..7).map(move |x| (y, x))) {
        let near = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (y as isize + dy, x as isize + dx)));
        let mut near: Vec<f32> = near.map(|(y, x)| picture.row(mirrored(y, 5))[mirrored(x, 7)]).collect();
        near.sort_by(f32::total_cmp);
        assert_eq!(got.row(y)[x].to_bits(), near[4].to_bits());
    }
}

#[test]
fn the_gradient_of_a_cubic_is_exact() {
    let picture = plane(20, 16, |x, y| 0.01 * x * x * x - 0.2 * x * y + 0.05 * y * y);
    let [dx, dy] = picture.gradient(1);
    for (y, x) in (2..14).flat_map(|y| (2..18).map(move |x| (y, x))) {
        let (fx, fy) = (x as f32, y as f32);
        assert!((dx.row(y)[x] - (0.03 * fx * fx - 0.2 * fy)).abs() < 1e-3);
        assert!((dy.row(y)[x] - (0.1 * fy - 0.2 * fx)).abs() < 1e-3);
    }
}

#[test]
fn a_level_pixel_lies_at_twice_its_place() {
    let gray: Vec<u8> = (0..64 * 50).map(|i| (i % 64 + 2 * (i / 64)) as u8).collect();
    let scales = Scales::new(&Gray::packed(&gray, 64, 50), 9, 0.0, 1);
    let sizes: Vec<_> = scales.levels.iter().map(|l| (l.width, l.height)).collect();
    assert_eq!(sizes, [(64, 50), (32, 25), (16, 13)]);
    for (k, level) in scales.levels.iter().enumerate() {
        let (x, y) = (level.width / 2, level.height / 2);
        let want = ((x + 2 * y) << k) as f32;
        assert!((level.row(y)[x] - want).abs() < 1e-3, "level {k}");
    }
    assert_eq!(scales.picture().data, gray);
}

#[test]
fn doubled_motion_is_twice_as_long_at_twice_the_place() {
    let coarse = Motion { u: plane(10, 8, |x, y| x - 0.5 * y), v: plane(10, 8, |x, _| 0.25 * x) };
    let fine = coarse.doubled(19, 15, 1);
    for (y, x) in (0..15).flat_map(|y| (0..19).map(move |x| (y, x))) {
        let (fx, fy) = (x as f32 / 2.0, y as f32 / 2.0);
        assert!((fine.u.row(y)[x] - 2.0 * (fx - 0.5 * fy)).abs() < 1e-5);
        assert!((fine.v.row(y)[x] - 0.5 * fx).abs() < 1e-5);
    }
}

#[test]
fn a_mismatch_is_what_motion_leaves_and_nothing_beyond_the_picture() {
    let slope = |x: f32, y: f32| 3.0 * x + 2.0 * y;
    let (i, j) = (plane(12, 9, slope), plane(12, 9, |x, y| slope(x - 1.5, y + 0.5)));
    let still = Plane::blank(12, 9);
    let moved = |u: f32, v: f32| Motion {
        u: Plane { data: vec![u; 108], ..still.clone() },
        v: Plane { data: vec![v; 108], ..still.clone() },
    };
    let [delta, inside] = moved(1.5, -0.5).mismatch(&i, &j, 1);
    assert!(delta.row(4)[2..9].iter().all(|d| d.abs() < 1e-4));
    assert_eq!((inside.row(4)[10], inside.row(4)[11]), (1.0, 0.0));
    let [delta, _] = moved(1.0, -0.5).mismatch(&i, &j, 1);
    assert!(delta.row(4)[2..9].iter().all(|d| (d + 1.5).abs() < 1e-4));
    let [delta, inside] = moved(f32::NAN, 0.0).mismatch(&i, &j, 1);
    assert!(delta.data.iter().chain(&inside.data).all(|v| *v == 0.0));
}
