//! Bilinear sampling between pixel centres.

use honami_model::picture::Gray;

use crate::Point;

/// Brightness at a position, 0..=255; beyond the outermost pixel centres, that of the nearest one.
///
/// # Panics
/// When the picture has no pixels.
#[must_use]
#[track_caller]
pub fn bilinear(picture: &Gray<'_>, at: Point) -> f32 {
    let (right, below) = (picture.width - 1, picture.height - 1);
    let x = at[0].clamp(0.0, right as f32);
    let y = at[1].clamp(0.0, below as f32);
    let (x0, y0) = (x as u32, y as u32);
    let (upper, lower) = (picture.row(y0), picture.row((y0 + 1).min(below)));
    let (left, right) = (x0 as usize, (x0 + 1).min(right) as usize);
    let (fx, fy) = (x - x0 as f32, y - y0 as f32);
    let top = lerp(upper[left], upper[right], fx);
    let bottom = lerp(lower[left], lower[right], fx);
    top + (bottom - top) * fy
}

/// The window of this radius around a position, row-major, `(2r+1, 2r+1)`, into `out`.
///
/// Every pixel is [`bilinear`] at its own position.
///
/// # Panics
/// When the picture has no pixels.
#[track_caller]
pub fn patch(picture: &Gray<'_>, centre: Point, radius_px: u32, out: &mut Vec<f32>) {
    out.clear();
    let radius = radius_px as f32;
    let side = 2 * radius_px as usize + 1;
    let (x, y) = (centre[0] - radius, centre[1] - radius);
    let (width, height) = (picture.width as f32, picture.height as f32);
    if x >= 0.0 && y >= 0.0 && x + side as f32 <= width - 1.0 && y + side as f32 <= height - 1.0 {
        let (x0, y0) = (x as usize, y as u32);
        let (fx, fy) = (x - x0 as f32, y - y0 as f32);
        for row in 0..side as u32 {
            let upper = &picture.row(y0 + row)[x0..=x0 + side];
            let lower = &picture.row(y0 + row + 1)[x0..=x0 + side];
            out.extend(upper.windows(2).zip(lower.windows(2)).map(|(u, l)| {
                let (top, bottom) = (lerp(u[0], u[1], fx), lerp(l[0], l[1], fx));
                top + (bottom - top) * fy
            }));
        }
    } else {
        for row in 0..side {
            out.extend((0..side).map(|column| bilinear(picture, [x + column as f32, y + row as f32])));
        }
    }
}

fn lerp(a: u8, b: u8, t: f32) -> f32 {
    let (a, b) = (f32::from(a), f32::from(b));
    a + (b - a) * t
}

#[cfg(test)]
mod tests {
    use super::*;

    const PICTURE: Gray<'_> = Gray { data: &[0, 10, 99, 20, 30, 99], width: 2, height: 2, stride: 3 };

    #[test]
    fn centres_midpoints_and_beyond() {
        for (at, want) in [
            ([0.0, 0.0], 0.0),
            ([1.0, 1.0], 30.0),
            ([0.5, 0.0], 5.0),
            ([0.0, 0.5], 10.0),
            ([0.5, 0.5], 15.0),
            ([0.25, 0.75], 17.5),
            ([-3.0, -0.5], 0.0),
            ([7.0, 0.5], 20.0),
        ] {
            assert!((bilinear(&PICTURE, at) - want).abs() < 1e-5, "{at:?}");
        }
    }

    #[test]
    fn a_patch_is_its_samples_inside_and_at_the_border() {
        let data: Vec<u8> = (0..13 * 11).map(|i| (i * 37 % 251) as u8).collect();
        let picture = Gray { data: &data, width: 12, height: 11, stride: 13 };
        let mut got = Vec::new();
        for centre in [[5.3, 5.6], [0.0, 0.0], [11.0, 10.0], [2.0, 2.0], [8.99, 7.5], [-4.0, 20.0]] {
            patch(&picture, centre, 2, &mut got);
            let want = (0..25).map(|i| {
                let (row, column) = ((i / 5) as f32, (i % 5) as f32);
                bilinear(&picture, [centre[0] - 2.0 + column, centre[1] - 2.0 + row])
            });
            assert!(got.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-3), "{centre:?}");
            assert_eq!(got.len(), 25);
        }
    }
}
