//! The loops of every instruction set against each other, bit for bit, and against plain sums.

use super::*;
use crate::texture;

/// A desk's worth of cells, and what was sampled for them.
fn cells(n: usize) -> (Vec<Cell>, Vec<Lanes>) {
    let number = |what: u64, k: usize, lane: usize| texture::hash(what, k as i64, lane as i64) as f32;
    let lanes = |what: u64, k: usize| std::array::from_fn(|lane| number(what, k, lane));
    let cell = |k: usize| Cell {
        u: lanes(1, k),
        v: lanes(2, k),
        value: lanes(3, k).map(|x: f32| 90.0 * x),
        dx: lanes(4, k).map(|x: f32| 20.0 * x),
        dy: lanes(5, k).map(|x: f32| 20.0 * x),
        weight: lanes(6, k).map(f32::abs),
    };
    ((0..n).map(cell).collect(), (0..n).map(|k| lanes(7, k).map(|x: f32| 90.0 * x)).collect())
}

const LIGHT: Light = Light { gain: 0.9, offset: 4.0, per_outlier: 0.1 };

#[test]
fn every_level_gives_the_bits_of_the_plain_one() {
    let picture = texture::render(90, 70, |x, y| texture::value(4, x, y));
    let gray = Gray::packed(&picture, 90, 70);
    let (cells, image) = cells(15);
    let taps: Vec<Tap> =
        (0..200).map(|k| Tap { index: 3 * k, w: 0.01 * k as f32, wt: 1.0 - 0.02 * k as f32 }).collect();
    let region: Vec<f32> = (0..700).map(|k| (k % 97) as f32 - 50.0).collect();
    let plain = plain::KERNEL;
    for kernel in simd::available().map(Kernel::of) {
        for at in [[40.3, 30.7], [2.0, 3.0], [88.9, 69.5], [-30.0, 1e9]] {
            let place = Place { at, matrix: [6.1, -1.5, 1.2, 7.3] };
            let [mut one, mut other] = [vec![[0.0; LANES]; 15], vec![[1.0; LANES]; 15]];
            kernel.sample(&gray, place, &cells, &mut one);
            plain.sample(&gray, place, &cells, &mut other);
            assert_eq!(one, other, "{at:?}");
        }
        assert_eq!(kernel.normal(&cells, &image, LIGHT), plain.normal(&cells, &image, LIGHT));
        assert_eq!(kernel.moments(&cells, &image), plain.moments(&cells, &image));
        assert_eq!(kernel.slide(&taps, &region), plain.slide(&taps, &region));
    }
}

#[test]
fn samples_are_bilinear_inside_and_beyond() {
    let picture = texture::render(60, 50, |x, y| texture::value(4, x, y));
    let gray = Gray::packed(&picture, 60, 50);
    let (cells, _) = cells(3);
    for at in [[30.3, 20.7], [2.0, 3.0], [58.0, 49.0], [-9.0, 70.0]] {
        let matrix = [5.0, 2.0, -1.0, 4.0];
        let mut got = vec![[0.0; LANES]; 3];
        Kernel::of(simd::best()).sample(&gray, Place { at, matrix }, &cells, &mut got);
        for (cell, got) in cells.iter().zip(&got) {
            for l in 0..LANES {
                let (u, v) = (cell.u[l], cell.v[l]);
                let place = [at[0] + 5.0 * u + 2.0 * v, at[1] - u + 4.0 * v];
                let want = crate::sample::bilinear(&gray, place) - MID_GRAY;
                assert!((got[l] - want).abs() < 0.01, "{at:?}: {} for {want}", got[l]);
            }
        }
    }
}

#[test]
fn sums_are_those_of_plain_arithmetic() {
    let (cells, image) = cells(15);
    let moments = Kernel::of(simd::best()).moments(&cells, &image);
    let normal = Kernel::of(simd::best()).normal(&cells, &image, LIGHT);
    let mut want = [0.0_f64; 6];
    let mut products = [0.0_f64; N_PRODUCTS];
    let mut right = [0.0_f64; N_BASIS];
    for (cell, image) in cells.iter().zip(&image) {
        for l in 0..LANES {
            let [w, t, i] = [cell.weight[l], cell.value[l], image[l]].map(f64::from);
            for (sum, term) in want.iter_mut().zip([w, w * t, w * i, w * t * t, w * i * i, w * t * i]) {
                *sum += term;
            }
            let [u, v, dx, dy] = [cell.u[l], cell.v[l], cell.dx[l], cell.dy[l]].map(f64::from);
            let off = (i - 0.9 * t - 4.0) / 10.0;
            let w = w / (1.0 + off * off).powi(2);
            let basis = [dx, dy, dx * u, dx * v, dy * u, dy * v, t, 1.0];
            let mut k = 0;
            for a in 0..N_BASIS {
                right[a] += w * basis[a] * i;
                for b in a..N_BASIS {
                    products[k] += w * basis[a] * basis[b];
                    k += 1;
                }
            }
        }
    }
    let Moments { w, t, i, tt, ii, ti } = moments;
    let got = [w, t, i, tt, ii, ti].into_iter().chain(normal.products).chain(normal.right);
    for (got, want) in got.zip(want.into_iter().chain(products).chain(right)) {
        assert!((f64::from(got) - want).abs() < 1e-3 * want.abs().max(30.0), "{got} for {want}");
    }
}
