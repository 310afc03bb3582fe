//! Corners against the definition, by brute force, and against pictures drawn by hand.

use honami_model::picture::Gray;
use proptest::prelude::*;

use super::*;
use crate::pyramid::mirrored;
use crate::texture;

/// Response and trace by the definition, in f64: the window of every pixel summed anew.
fn response_plainly(picture: &Gray<'_>, params: &Params) -> Vec<(f64, f64)> {
    let (width, height) = (picture.width as isize, picture.height as isize);
    let pixel = |x: isize, y: isize| {
        f64::from(picture.row(mirrored(y, height as usize) as u32)[mirrored(x, width as usize)])
    };
    let gradient = |x: isize, y: isize| {
        let (mut gx, mut gy) = (0.0, 0.0);
        for (d, weight) in [(-1, 1.0), (0, 2.0), (1, 1.0)] {
            gx += weight * (pixel(x + 1, y + d) - pixel(x - 1, y + d)) / 8.0;
            gy += weight * (pixel(x + d, y + 1) - pixel(x + d, y - 1)) / 8.0;
        }
        (gx, gy)
    };
    let r = params.window_radius_px as isize;
    let strength = |x: isize, y: isize| {
        let (mut xx, mut xy, mut yy, mut n) = (0.0, 0.0, 0.0, 0.0);
        for v in (y - r).max(0)..(y + r + 1).min(height) {
            for u in (x - r).max(0)..(x + r + 1).min(width) {
                let (gx, gy) = gradient(u, v);
                (xx, xy, yy, n) = (xx + gx * gx, xy + gx * gy, yy + gy * gy, n + 1.0);
            }
        }
        let (xx, xy, yy) = (xx / n, xy / n, yy / n);
        let response = match params.method {
            Method::ShiTomasi => (xx + yy) / 2.0 - ((xx - yy).powi(2) / 4.0 + xy * xy).sqrt(),
            Method::Harris => xx * yy - xy * xy - 0.04 * (xx + yy).powi(2),
        };
        (response, xx + yy)
    };
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| strength(x, y)).collect()
}

/// Peaks of a map, strongest first, taken while they keep their distance: every pair compared.
fn corners_plainly(map: &[f32], width: usize, occupied: &[Point], params: &Params) -> Vec<Corner> {
    let height = map.len() / width;
    let inner = || (1..height - 1).flat_map(|y| (1..width - 1).map(move |x| y * width + x));
    let strongest = inner().map(|i| map[i]).fold(0.0, f32::max);
    let mut peaks: Vec<usize> = inner()
        .filter(|&i| map[i] > 0.0 && map[i] >= strongest * params.quality && is_peak(map, width, i))
        .collect();
    peaks.sort_by(|&a, &b| map[b].total_cmp(&map[a]).then(a.cmp(&b)));
    let mut taken: Vec<Corner> = Vec::new();
    for i in peaks {
        let at = summit(map, width, i);
        let far = |other: &Point| (at[0] - other[0]).hypot(at[1] - other[1]) >= params.min_distance_px;
        if occupied.iter().all(far) && taken.iter().all(|c| far(&c.at)) {
            taken.push(Corner { at, score: map[i] });
        }
    }
    taken.truncate(params.max_corners);
    taken
}

proptest! {
    #![proptest_config(crate::cases(96))]
    #[test]
    fn as_by_brute_force(
        size in (3_u32..48, 3_u32..40), pad in 0_usize..4, seed in 0_u64..500, noisy in any::<bool>(),
        window_radius_px in 0_u32..5, harris in any::<bool>(), min_distance_px in 0.0_f32..12.0,
        quality in 0.0_f32..0.3, max_corners in 0_usize..60,
        occupied in prop::collection::vec((-20.0_f32..60.0, -20.0_f32..60.0), 0..4),
    ) {
        let stride = size.0 as usize + pad;
        let data = texture::render(stride as u32, size.1, |x, y| {
            if noisy { 128.0 + 127.0 * texture::hash(seed, x as i64, y as i64) } else { texture::value(seed, x, y) }
        });
        let picture = Gray { data: &data, width: size.0, height: size.1, stride };
        let method = if harris { Method::Harris } else { Method::ShiTomasi };
        let params = Params { method, max_corners, quality, min_distance_px, window_radius_px };
        let map = response::map(&picture, &params);
        let plain = response_plainly(&picture, &params);
        for (got, (want, trace)) in map.iter().zip(&plain) {
            // What is left of differences of f32 as large as the trace, or as its square.
            let large = if harris { trace * trace } else { *trace };
            prop_assert!((f64::from(*got) - want).abs() <= 1e-6 * large, "{} for {}", got, want);
        }
        let occupied: Vec<Point> = occupied.iter().map(|&(x, y)| [x, y]).collect();
        prop_assert_eq!(
            corners(&picture, None, &occupied, &params),
            corners_plainly(&map, size.0 as usize, &occupied, &params)
        );
    }
}

/// A bright square with corners at (10.5, 8.5) and (25.5, 20.5).
fn square() -> Vec<u8> {
    texture::render(40, 32, |x, y| {
        if (11.0..=25.0).contains(&x) && (9.0..=20.0).contains(&y) { 200.0 } else { 30.0 }
    })
}

#[test]
fn a_square_has_four_corners() {
    let data = square();
    for method in [Method::ShiTomasi, Method::Harris] {
        let params = Params { method, quality: 0.5, min_distance_px: 4.0, ..Params::default() };
        let found = corners(&Gray::packed(&data, 40, 32), None, &[], &params);
        let places: Vec<Point> = found.iter().map(|c| c.at).collect();
        for want in [[10.5, 8.5], [25.5, 8.5], [10.5, 20.5], [25.5, 20.5]] {
            let near = places.iter().any(|p| (p[0] - want[0]).hypot(p[1] - want[1]) < 1.2);
            assert!(near, "{method:?}: {want:?} not among {places:?}");
        }
        assert_eq!(found.len(), 4, "{method:?}");
        // Equal strength: from the top, then from the left.
        let order: Vec<(i32, i32)> =
            places.iter().map(|p| (p[1].round() as i32, p[0].round() as i32)).collect();
        assert!(order.is_sorted(), "{order:?}");
    }
}

#[test]
fn masks_and_features_keep_corners_away() {
    let data = square();
    let picture = Gray::packed(&data, 40, 32);
    let params = Params { quality: 0.5, min_distance_px: 6.0, ..Params::default() };
    let left: Vec<u8> = (0..40 * 32).map(|i| u8::from(i % 40 < 18)).collect();
    let found = corners(&picture, Some(&left), &[], &params);
    assert!(found.len() == 2 && found.iter().all(|c| c.at[0] < 18.0), "{found:?}");
    let found = corners(&picture, Some(&left), &[[12.0, 10.0]], &params);
    assert!(found.len() == 1 && found[0].at[1] > 18.0, "{found:?}");
    assert!(corners(&picture, Some(&[0; 40 * 32]), &[], &params).is_empty());
}

#[test]
fn edges_and_flat_pictures_have_none() {
    let flat = vec![9; 40 * 32];
    let edge = texture::render(40, 32, |x, _| if x < 20.0 { 10.0 } else { 240.0 });
    for data in [&flat, &edge] {
        for method in [Method::ShiTomasi, Method::Harris] {
            let params = Params { method, quality: 0.0, ..Params::default() };
            assert_eq!(corners(&Gray::packed(data, 40, 32), None, &[], &params), []);
        }
    }
}

#[test]
fn tiny_pictures_do_no_harm() {
    for (width, height) in [(1_u32, 1_u32), (2, 1), (2, 9), (3, 3), (7, 5)] {
        let data = texture::render(width, height, |x, y| texture::value(1, 9.0 * x, 9.0 * y));
        let params = Params { window_radius_px: 20, quality: 0.0, min_distance_px: 0.0, ..Params::default() };
        let found = corners(&Gray::packed(&data, width, height), None, &[[f32::NAN, 0.0]], &params);
        assert!(found.len() <= ((width - 1) * (height - 1)) as usize);
    }
}

#[test]
fn corners_move_with_the_picture_by_fractions_of_a_pixel() {
    // Smooth blobs: the response is smooth too, and its top follows them.
    let blobs = |dx: f64| {
        texture::render(64, 64, |x, y| {
            let at = |cx: f64, cy: f64| (-((x - dx - cx).powi(2) + (y - cy).powi(2)) / 12.0).exp();
            20.0 + 200.0 * (at(20.0, 20.0) + at(44.0, 40.0))
        })
    };
    let params = Params { quality: 0.3, min_distance_px: 12.0, window_radius_px: 4, ..Params::default() };
    let place = |dx: f64| corners(&Gray::packed(&blobs(dx), 64, 64), None, &[], &params)[0].at;
    let start = place(0.0);
    for dx in [0.2, 0.4, 0.6, 0.8] {
        let moved = place(dx)[0] - start[0];
        assert!((moved - dx as f32).abs() < 0.1, "{moved} for {dx}");
    }
}
