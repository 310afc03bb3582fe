//! The fast kernels against the plain one, bit for bit, and the plain one against its definition.

use proptest::prelude::*;

use super::*;
use crate::pyramid::Pyramid;
use crate::texture;
use honami_model::picture::Gray;

/// Smooth texture, noise, or the hardest contrast there is: bytes of only 0 and 255.
fn picture(kind: u8, seed: u64, width: u32, height: u32) -> Vec<u8> {
    let noise = |x: f64, y: f64| texture::hash(seed, x as i64, y as i64);
    texture::render(width, height, |x, y| match kind {
        0 => texture::value(seed, x, y),
        1 => 128.0 + 127.0 * noise(x, y),
        2 => 128.0 + 127.0 * noise(x, y).signum(),
        _ => {
            if (x + y) % 4.0 < 2.0 {
                255.0
            } else {
                0.0
            }
        }
    })
}

fn pyramid(data: &[u8], width: u32, height: u32, radius: u32) -> Pyramid {
    Pyramid::new(&Gray::packed(data, width, height), 1, radius)
}

proptest! {
    #![proptest_config(crate::cases(400))]
    #[test]
    fn every_level_gives_the_same_bits(
        size in (1_u32..90, 1_u32..90), kinds in (0_u8..4, 0_u8..4), seed in 0_u64..1000,
        radius in prop_oneof![Just(0_u32), Just(7), Just(8), Just(10), Just(15), Just(16), Just(31), 0_u32..40],
        from in (0.0_f32..1.0, 0.0_f32..1.0), to in (0.0_f32..1.0, 0.0_f32..1.0), whole in any::<bool>(),
    ) {
        let [i, j] = [kinds.0, kinds.1].map(|kind| pyramid(&picture(kind, seed, size.0, size.1), size.0, size.1, radius));
        // Anywhere from just before the picture to just behind it, also where the fraction is nil.
        let place = |t: f32, n: u32| {
            let x = t * (n + 2 * radius) as f32 - radius as f32;
            if whole { x.round() } else { x }
        };
        let from = Corner::of(&i.levels()[0], [place(from.0, size.0), place(from.1, size.1)], radius);
        let to = Corner::of(&j.levels()[0], [place(to.0, size.0), place(to.1, size.1)], radius);
        let (Some(from), Some(to)) = (from, to) else { return Ok(()) };
        let mut runs = simd::available().map(|level| {
            let mut window = Window::new(level, radius);
            // Whatever an earlier window left behind must not count.
            window.cut(&j.levels()[0], to);
            let sums = window.cut(&i.levels()[0], from);
            let mismatch = window.mismatch(&j.levels()[0], to);
            (sums, mismatch, gradients(&window))
        });
        let plain = runs.next();
        for fast in runs {
            prop_assert_eq!(Some(fast), plain.clone());
        }
    }
}

/// Brightness and gradients of the window's own pixels.
fn gradients(window: &Window) -> Vec<[i16; 3]> {
    let pixels = window.blocks.chunks_exact(window.strips).flat_map(|row| {
        (0..window.side)
            .map(move |x| (&row[x / LANES], x % LANES))
            .map(|(b, i)| [b.value[i], b.dx[i], b.dy[i]])
    });
    // Rows beyond the picture keep no brightness.
    pixels.map(|[v, dx, dy]| if dx == 0 && dy == 0 { [0; 3] } else { [v, dx, dy] }).collect()
}

#[test]
fn a_ramp_has_its_slope() {
    // 3 gray levels a pixel to the right, 2 down: Scharr's gradient is 32 times that.
    let data = texture::render(40, 40, |x, y| 3.0 * x + 2.0 * y);
    let pyramid = pyramid(&data, 40, 40, 4);
    let level = &pyramid.levels()[0];
    for level_of_simd in simd::available() {
        for centre in [[20.0, 20.0], [19.3, 21.8]] {
            let mut window = Window::new(level_of_simd, 4);
            let corner = Corner::of(level, centre, 4).unwrap();
            let sums = window.cut(level, corner);
            for [_, dx, dy] in gradients(&window) {
                assert!((dx - 96).abs() <= 1 && (dy - 64).abs() <= 1, "{dx} {dy}");
            }
            let n = 81.0;
            for (got, want) in [(sums.xx, 96.0 * 96.0), (sums.xy, 96.0 * 64.0), (sums.yy, 64.0 * 64.0)] {
                assert!((got as f64 / (n * want) - 1.0).abs() < 0.02, "{got} for {want}");
            }
            // Half a pixel to the right is 1.5 gray levels brighter: 48 in fixed point.
            let half = Corner::of(level, [centre[0] + 0.5, centre[1]], 4).unwrap();
            let mismatch = window.mismatch(level, half);
            assert!((mismatch[0] as f64 / (n * 48.0 * 96.0) - 1.0).abs() < 0.03, "{mismatch:?}");
        }
    }
}

#[test]
fn positions_between_the_outermost_pixel_centres_are_inside() {
    for (start, fraction, side, n, want) in [
        (2, 5, 3, 10, 0..3),
        (-2, 0, 5, 10, 2..5),
        (-2, 9, 5, 10, 2..5),
        (7, 0, 5, 10, 0..3),
        (7, 9, 5, 10, 0..2),
        (-5, 0, 5, 10, 5..5),
        (-3, 9, 7, 1, 3..3),
        (-3, 0, 7, 1, 3..4),
        (9, 1, 5, 10, 0..0),
    ] {
        assert_eq!(inside(start, fraction, side, n), want, "{start} {fraction} {side} {n}");
    }
}
