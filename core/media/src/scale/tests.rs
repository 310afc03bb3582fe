//! The box filter against a plain one, its edges, and its colours against the model's.

use honami_model::picture::Gray;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::*;

fn noise(n: usize, seed: u64) -> Vec<u8> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    (0..n).map(|_| random.random()).collect()
}

#[test]
fn whole_blocks_are_their_means() {
    let (width, height) = (12, 8);
    let y = noise(96, 1);
    let planes = Planes { y: Gray::packed(&y, width, height), uv: None, range: Range::Full };
    let got = rgb_area(&planes, Rect::whole(width, height), 4, 2);
    for (at, pixel) in got.iter().enumerate() {
        let (left, top) = (3 * (at % 4), 4 * (at / 4));
        let sum: u32 = (0..12).map(|k| u32::from(y[(top + k / 3) * 12 + left + k % 3])).sum();
        assert_eq!(*pixel, [((sum + 6) / 12) as u8; 3]);
    }
}

#[test]
fn one_to_one_is_the_models_colour() {
    let (width, height) = (31, 17);
    let (y, u, v) = (noise(527, 1), noise(144, 2), noise(144, 3));
    for range in [Range::Full, Range::Limited] {
        let planes = Planes { y: Gray::packed(&y, width, height), uv: Some((&u, &v)), range };
        for (at, pixel) in (0..).zip(rgb(&planes)) {
            let want = planes.rgb(at % width, at / width);
            let far = (0..3).map(|c| pixel[c].abs_diff(want[c])).max();
            assert!(far <= Some(1), "{range:?} {at}: {pixel:?} {want:?}");
        }
    }
}

#[test]
fn outside_is_black_and_magnified_is_nearest() {
    let y = [10, 20, 30, 40];
    let planes = Planes { y: Gray::packed(&y, 2, 2), uv: None, range: Range::Full };
    let wide = rgb_area(&planes, Rect { x: -2.5, y: -0.5, width: 6.0, height: 2.0 }, 6, 2);
    let row = |left, right| [0, 0, left, right, 0, 0].map(|v| [v; 3]);
    assert_eq!(wide, [row(10, 20), row(30, 40)].concat());
    let large = rgb_area(&planes, Rect::whole(2, 2), 6, 2);
    assert_eq!(large[..6], [10, 10, 10, 20, 20, 20].map(|v| [v; 3]));
    for area in [
        Rect { x: f64::NAN, ..Rect::whole(2, 2) },
        Rect { x: 1e300, ..Rect::whole(2, 2) },
        Rect { width: 0.0, ..Rect::whole(2, 2) },
        Rect { width: -3.0, ..Rect::whole(2, 2) },
    ] {
        assert_eq!(rgb_area(&planes, area, 3, 3).len(), 9, "{area:?}");
    }
    assert!(rgb_area(&planes, Rect::whole(2, 2), 0, 3).is_empty());
}
