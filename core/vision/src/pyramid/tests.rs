//! Pyramids against the definition, and against bytes that OpenCV's `pyrDown` gave.

use super::*;
use crate::texture;
use proptest::prelude::*;

/// The definition: 25 products in the plane, mirrored, rounded once.
fn halved_plainly(data: &[u8], width: usize, height: usize) -> Vec<u8> {
    const TAPS: [u32; 5] = [1, 4, 6, 4, 1];
    let at = |x: usize, y: usize| -> u8 {
        let mut sum = 128;
        for (j, b) in TAPS.iter().enumerate() {
            for (i, a) in TAPS.iter().enumerate() {
                let column = mirrored((2 * x + i) as isize - 2, width);
                let row = mirrored((2 * y + j) as isize - 2, height);
                sum += a * b * u32::from(data[row * width + column]);
            }
        }
        (sum >> 8) as u8
    };
    (0..height.div_ceil(2))
        .flat_map(|y| (0..width.div_ceil(2)).map(move |x| (x, y)))
        .map(|(x, y)| at(x, y))
        .collect()
}

fn packed(level: &Level) -> Vec<u8> {
    (0..level.height()).flat_map(|y| level.picture().row(y).to_vec()).collect()
}

proptest! {
    #![proptest_config(crate::cases(64))]
    #[test]
    fn levels_are_the_filtered_pictures(width in 1_u32..40, height in 1_u32..40, pad in 0_usize..5, seed in 0_u64..99) {
        let stride = width as usize + pad;
        let data: Vec<u8> = (0..stride * height as usize)
            .map(|i| (texture::hash(seed, i as i64, 0) * 127.0 + 128.0) as u8)
            .collect();
        let picture = Gray { data: &data, width, height, stride };
        let pyramid = Pyramid::new(&picture, 3, 1);
        let mut want: Vec<u8> = (0..height).flat_map(|y| picture.row(y).to_vec()).collect();
        let mut size = (width as usize, height as usize);
        for level in pyramid.levels() {
            prop_assert_eq!((level.width() as usize, level.height() as usize), size);
            prop_assert_eq!(packed(level), want.clone());
            want = halved_plainly(&want, size.0, size.1);
            size = (size.0.div_ceil(2), size.1.div_ceil(2));
        }
    }
}

#[test]
fn opencv_gives_the_same_bytes() {
    // cv2.pyrDown(np.fromfunction(lambda y, x: (x*x*7 + y*13 + x*y*3) % 256, (7, 9)).astype(np.uint8)), OpenCV 5.0.
    let data: Vec<u8> = (0..63)
        .map(|i| (i % 9, i / 9))
        .map(|(x, y)| ((x * x * 7 + y * 13 + x * y * 3) % 256) as u8)
        .collect();
    let pyramid = Pyramid::new(&Gray::packed(&data, 9, 7), 2, 1);
    let want: [u8; 20] =
        [18, 49, 128, 140, 141, 38, 73, 134, 120, 121, 68, 110, 137, 110, 118, 87, 129, 134, 104, 89];
    assert_eq!(packed(&pyramid.levels()[1]), want);
}

#[test]
fn the_border_mirrors_the_picture() {
    let data: Vec<u8> = (0..35).collect();
    for (width, height) in [(1_u32, 1_u32), (2, 1), (7, 5), (1, 35)] {
        let picture = Gray::packed(&data[..(width * height) as usize], width, height);
        let pyramid = Pyramid::new(&picture, 4, 3);
        let level = &pyramid.levels()[0];
        let border = level.border_px() as i32;
        for y in -border..height as i32 + border {
            for x in -border..width as i32 + border {
                let (column, row) =
                    (mirrored(x as isize, width as usize), mirrored(y as isize, height as usize));
                assert_eq!(
                    level.bytes_from(x, y)[0],
                    picture.row(row as u32)[column],
                    "({x}, {y}) of {width}x{height}"
                );
            }
        }
    }
}

#[test]
fn levels_end_where_a_window_no_longer_fits() {
    let data = vec![0; 960 * 720];
    for (width, height, n_levels, radius, want) in [
        (960, 720, 4, 10, 4),
        (960, 720, 9, 10, 6),
        (40, 40, 4, 10, 1),
        (44, 44, 4, 10, 2),
        (7, 5, 4, 10, 1),
        (1, 1, 0, 0, 1),
    ] {
        let picture = Gray { data: &data, width, height, stride: width as usize };
        assert_eq!(Pyramid::new(&picture, n_levels, radius).levels().len(), want, "{width}x{height}");
    }
}

#[test]
fn mirror_image_of_an_index() {
    let got: Vec<usize> = (-5..8).map(|i| mirrored(i, 4)).collect();
    assert_eq!(got, [1, 2, 3, 2, 1, 0, 1, 2, 3, 2, 1, 0, 1]);
    assert_eq!(mirrored(-9, 1), 0);
}
