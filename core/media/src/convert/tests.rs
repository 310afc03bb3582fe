//! Rounding of depths and of RGB, over all values.

use honami_model::picture::Range;

use super::*;

#[test]
fn depths_round_to_nearest() {
    for sample in 0..=u16::MAX {
        assert_eq!(narrow_image(sample), (f64::from(sample) / 257.0).round() as u8, "{sample}");
    }
    for (bits, sample, want) in
        [(10, 64, 16), (10, 65, 16), (10, 66, 17), (10, 1023, 255), (16, 0xffff, 255), (9, 3, 2)]
    {
        assert_eq!(narrow(sample, bits), want, "{sample} of {bits} bits");
    }
}

#[test]
fn luma_of_rgb_is_rounded_and_gray_stays_gray() {
    let shape = Shape { width: 1, height: 1, colour: true, range: Range::Full };
    let planes = |rgb: [u8; 3]| {
        let mut frame = [0; 3];
        rgb_to_planes(&rgb, &shape, &mut frame);
        frame
    };
    for v in 0..=255 {
        assert_eq!(planes([v; 3]), [v, 128, 128]);
    }
    for r in (0..=255).step_by(5) {
        for g in (0..=255).step_by(3) {
            for b in (0..=255).step_by(17) {
                let luma = 0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b);
                // Fixed point is within 0.003 of it: only ties may differ.
                assert!((f64::from(planes([r, g, b])[0]) - luma).abs() < 0.503, "{r} {g} {b}");
            }
        }
    }
}

/// BT.601 as the standard has it: Y' in 219 steps from 16, chroma in 224 about 128.
#[test]
fn limited_range_is_that_of_the_standard() {
    let shape = Shape { width: 1, height: 1, colour: true, range: Range::Limited };
    for r in (0..=255).step_by(15) {
        for g in (0..=255).step_by(15) {
            for b in (0..=255).step_by(15) {
                let mut frame = [0; 3];
                rgb_to_planes(&[r, g, b], &shape, &mut frame);
                let [red, green, blue] = [r, g, b].map(|c| f64::from(c) / 255.0);
                let luma = 0.299 * red + 0.587 * green + 0.114 * blue;
                let want = [
                    16.0 + 219.0 * luma,
                    128.0 + 224.0 * (blue - luma) / 1.772,
                    128.0 + 224.0 * (red - luma) / 1.402,
                ];
                for (got, want) in frame.into_iter().zip(want) {
                    assert!((f64::from(got) - want).abs() < 0.505, "{r} {g} {b}: {frame:?}, {want}");
                }
                if r == g && g == b {
                    assert_eq!(frame[1..], [128, 128], "{r}");
                }
            }
        }
    }
}
