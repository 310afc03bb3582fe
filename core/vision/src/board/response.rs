//! Where two dark and two bright sectors meet.
//!
//! S. Bennett, J. Lasenby, "ChESS: quick and robust detection of chess-board features", CVIU 118 (2014), 197-210: of 16 samples on a ring,
//! those opposite are alike and those a quarter on are not. An edge or a line has the difference of opposite ones against it, a
//! blob that of the ring and its middle. Noise counts against a corner, never for one.

use honami_model::picture::Gray;

/// Radius of the ring, pixels.
pub(super) const RADIUS_PX: u32 = 5;
/// The ring, clockwise from above, `[x, y]`.
#[rustfmt::skip]
const RING: [[isize; 2]; 16] = [
    [0, -5], [2, -5], [3, -3], [5, -2], [5, 0], [5, 2], [3, 3], [2, 5],
    [0, 5], [-2, 5], [-3, 3], [-5, 2], [-5, 0], [-5, -2], [-3, -3], [-2, -5],
];
/// A corner's response, of what it would be if it were perfect: four differences of four samples, each twice the contrast. Two lines
/// that cross at 30 degrees still have a third.
const WEAKEST: f32 = 0.2;
/// What differs by less is noise of 8-bit pictures, gray levels.
const LEAST_CONTRAST: i32 = 8;
/// A response counts where it is the strongest within this distance, pixels.
const APART_PX: usize = 3;
/// The strongest are kept: a board has some hundred, a meadow has thousands.
const MOST: usize = 2000;

/// Pixels that look like corners, strongest first.
pub(super) fn peaks(picture: &Gray<'_>) -> Vec<[u32; 2]> {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let margin = RADIUS_PX as usize + 1;
    if width <= 2 * margin || height <= 2 * margin {
        return Vec::new();
    }
    let map = map(picture, margin);
    let mut found = Vec::new();
    for y in margin..height - margin {
        for x in margin..width - margin {
            let here = map[y * width + x];
            if here > 0.0 && is_peak(&map, width, height, x, y) {
                found.push((here, [x as u32, y as u32]));
            }
        }
    }
    // Equal ones in the order of rows, so that the same picture has the same corners.
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.truncate(MOST);
    found.into_iter().map(|(_, at)| at).collect()
}

fn is_peak(map: &[f32], width: usize, height: usize, x: usize, y: usize) -> bool {
    let here = map[y * width + x];
    let rows = y.saturating_sub(APART_PX)..(y + APART_PX + 1).min(height);
    let columns = x.saturating_sub(APART_PX)..(x + APART_PX + 1).min(width);
    rows.into_iter().all(|row| {
        // Of equal ones the first counts.
        columns.clone().all(|column| match map[row * width + column] {
            there if (row, column) < (y, x) => there < here,
            there => there <= here,
        })
    })
}

/// Response of each pixel, of what the ring's contrast could make, packed rows; 0 where it is too weak.
fn map(picture: &Gray<'_>, margin: usize) -> Vec<f32> {
    let (width, height, stride) = (picture.width as usize, picture.height as usize, picture.stride as isize);
    let ring = RING.map(|[x, y]| y * stride + x);
    let mut map = vec![0.0; width * height];
    for y in margin..height - margin {
        for x in margin..width - margin {
            let centre = (y * picture.stride + x) as isize;
            let at = |offset: isize| i32::from(picture.data[(centre + offset) as usize]);
            map[y * width + x] = response(ring.map(at), at(0) + at(1) + at(-1) + at(stride) + at(-stride));
        }
    }
    map
}

fn response(ring: [i32; 16], five: i32) -> f32 {
    let (mut least, mut most, mut total) = (255, 0, 0);
    for value in ring {
        (least, most, total) = (least.min(value), most.max(value), total + value);
    }
    let contrast = most - least;
    if contrast < LEAST_CONTRAST {
        return 0.0;
    }
    let quarters: i32 = (0..4).map(|n| (ring[n] + ring[n + 8] - ring[n + 4] - ring[n + 12]).abs()).sum();
    let opposite: i32 = (0..8).map(|n| (ring[n] - ring[n + 8]).abs()).sum();
    let middle = (total as f32 - five as f32 * (16.0 / 5.0)).abs();
    let response = ((quarters - opposite) as f32 - middle) / (8 * contrast) as f32;
    // The stronger of two corners that look alike is the one of more contrast.
    if response < WEAKEST { 0.0 } else { response * contrast as f32 }
}
