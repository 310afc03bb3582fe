//! The compiled bodies against each other, bit for bit, and against their definitions.

use proptest::prelude::*;

use super::*;
use crate::boxes::Boxes;
use crate::texture;
use honami_model::picture::Gray;

const SIZE: u32 = 70;

fn picture(kind: u8, seed: u64) -> Vec<u8> {
    let noise = |x: f64, y: f64| texture::hash(seed, x as i64, y as i64);
    texture::render(SIZE, SIZE, |x, y| match kind {
        0 => texture::value(seed, x, y),
        1 => 128.0 + 127.0 * noise(x, y),
        _ => 128.0 + 127.0 * noise(x, y).signum(),
    })
}

proptest! {
    #![proptest_config(crate::cases(300))]
    #[test]
    fn every_level_gives_the_sums_of_the_definition(
        kinds in (0_u8..3, 0_u8..3), seed in 0_u64..1000,
        side in prop_oneof![Just(1_usize), Just(21), Just(31), Just(32), Just(33), 1_usize..70],
        starts in prop::collection::vec((0.0_f32..1.0, 0.0_f32..1.0), 1..9),
    ) {
        let (template, data) = (picture(kinds.0, seed), picture(kinds.1, seed + 1));
        let pixels: Vec<u8> = template.chunks(SIZE as usize).take(side).flat_map(|row| &row[..side]).copied().collect();
        let boxes = Boxes::new(&Gray::packed(&data, SIZE, SIZE), 1, 1);
        let plane = &boxes.planes[0];
        let mut cut = Cut::default();
        // Whatever an earlier template left behind must not count.
        cut.take(&[255; 9 * 9], 9);
        cut.take(&pixels, side);
        let free = SIZE as usize + 1 - side;
        let starts: Vec<u32> = starts.iter()
            .map(|&(x, y)| ((y * free as f32) as usize * plane.stride + (x * free as f32) as usize) as u32)
            .collect();
        let want: Vec<(u32, Sums)> = starts.iter().map(|&start| {
            let mut want = (0, Sums::default());
            for (i, &p) in pixels.iter().enumerate() {
                let q = u32::from(plane.data[start as usize + i / side * plane.stride + i % side]);
                let p = u32::from(p);
                want.0 += p.abs_diff(q).pow(2);
                want.1 = Sums { sum: want.1.sum + q, squares: want.1.squares + q * q, products: want.1.products + p * q };
            }
            want
        }).collect();
        let mut memory = Memory::default();
        for level in simd::available() {
            let (mut costs, mut all) = (vec![7], vec![Sums::default(); 3]);
            differences(level, &cut, plane, &starts, &mut costs);
            sums(level, &cut, plane, &starts, &mut all);
            let got: Vec<_> = costs.into_iter().zip(all).collect();
            prop_assert_eq!(&got, &want, "{}", level.name());
            // All windows of some columns and rows, one by one and side by side.
            let first = starts[0] as usize;
            let size = [free - first % plane.stride, (free - first / plane.stride).min(5)];
            let places: Vec<u32> = (0..size[0] * size[1])
                .map(|i| (first + i / size[0] * plane.stride + i % size[0]) as u32)
                .collect();
            let (mut one_by_one, mut side_by_side) = (Vec::new(), vec![1]);
            differences(level, &cut, plane, &places, &mut one_by_one);
            all_differences(level, &mut cut, plane, (first, size), &mut memory, &mut side_by_side);
            prop_assert_eq!(&side_by_side, &one_by_one, "{}", level.name());
        }
    }
}

proptest! {
    #![proptest_config(crate::cases(300))]
    #[test]
    fn the_least_difference_is_found_and_what_is_given_up_is_more(
        kinds in (0_u8..3, 0_u8..3), seed in 0_u64..1000, side in 1_usize..40, n in 1_usize..30,
    ) {
        let (template, data) = (picture(kinds.0, seed), picture(kinds.1, seed + 1));
        let pixels: Vec<u8> = template.chunks(SIZE as usize).take(side).flat_map(|row| &row[..side]).copied().collect();
        let boxes = Boxes::new(&Gray::packed(&data, SIZE, SIZE), 1, 1);
        let plane = &boxes.planes[0];
        let mut cut = Cut::default();
        cut.take(&pixels, side);
        let starts: Vec<u32> = (0..n).map(|i| (i / 6 * plane.stride + i % 6) as u32).collect();
        let (mut all, mut first) = (Vec::new(), None);
        for level in simd::available() {
            let mut few = Vec::new();
            differences(level, &cut, plane, &starts, &mut all);
            least_differences(level, &cut, plane, &starts, &mut few);
            // The order in which windows are done is the kernel's own: what is given up is more than the least of all.
            let least = *all.iter().min().unwrap();
            for (&all, &few) in all.iter().zip(&few) {
                prop_assert!(all == few || (few > least && few < all), "{} of {}, least {}", few, all, least);
            }
            prop_assert_eq!(first.get_or_insert(few.clone()), &few, "{}", level.name());
        }
    }
}

#[test]
fn the_largest_windows_of_the_greatest_contrast_do_not_overflow() {
    let (side, size) = (257, 300);
    let most = (side * side) as u32 * 255 * 255;
    let white = vec![255; size * size];
    let [dark, bright] = [vec![0; size * size], white.clone()]
        .map(|data| Boxes::new(&Gray::packed(&data, size as u32, size as u32), 1, 1));
    let mut cut = Cut::default();
    cut.take(&white[..side * side], side);
    for level in simd::available() {
        let (mut costs, mut all) = (Vec::new(), Vec::new());
        differences(level, &cut, &dark.planes[0], &[0], &mut costs);
        assert_eq!(costs, [most], "{}", level.name());
        let block = (0, [4, 9]);
        all_differences(level, &mut cut, &dark.planes[0], block, &mut Memory::default(), &mut costs);
        assert_eq!(costs, [most; 36], "{}", level.name());
        sums(level, &cut, &bright.planes[0], &[0], &mut all);
        assert_eq!(all, [Sums { sum: most / 255, squares: most, products: most }], "{}", level.name());
        assert_eq!(all[0].spread(side * side), 0);
    }
}

#[test]
fn correlation_is_that_of_three_by_three_by_hand() {
    let template = Sums::of(&[1, 2, 3, 4, 5, 6, 7, 8, 9]);
    // The transposed ramp: 36 of 60 (see `ncc`).
    let transposed = [1_u32, 4, 7, 2, 5, 8, 3, 6, 9];
    let products = transposed.iter().zip(1..).map(|(a, b)| a * b).sum();
    let window = Sums { sum: 45, squares: 285, products };
    assert!(window.correlation(&template, 9).is_some_and(|c| (c - 0.6).abs() < 1e-12));
    assert_eq!(Sums { sum: 45, squares: 225, products: 225 }.correlation(&template, 9), None);
}
