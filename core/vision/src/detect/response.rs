//! How much of a corner every pixel is.

use honami_model::picture::Gray;

use super::{Method, Params};
use crate::pyramid::mirrored;

/// Weight of the squared trace in Harris's response.
const HARRIS_K: f32 = 0.04;
/// Sums of squared Sobel gradients (each at most 1020²) over a window of this radius stay below 2³¹.
const MAX_WINDOW_RADIUS: u32 = 20;

/// Of one row, `g_x²`, `g_x g_y` and `g_y²`.
type Products<T> = [Vec<T>; 3];

/// Response of every pixel, packed rows. Beyond the border the picture is mirrored, and windows are cut short.
pub(super) fn map(picture: &Gray<'_>, params: &Params) -> Vec<f32> {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let radius = params.window_radius_px;
    assert!(radius <= MAX_WINDOW_RADIUS, "window radius {radius} px exceeds {MAX_WINDOW_RADIUS}");
    let radius = radius as usize;
    let mut sobel = Sobel::new(width);
    let blank = || [0; 3].map(|_| vec![0; width]);
    // The rows of the window, and their sum; whole numbers, so that what is added can be taken off again.
    let mut ring: Vec<Products<i32>> = (0..=2 * radius).map(|_| blank()).collect();
    let mut total: Products<i32> = blank();
    let mut means: Products<f32> = [0; 3].map(|_| vec![0.0; width]);
    let mut map = Vec::with_capacity(width * height);
    for y in 0..height + radius {
        let entering = &mut ring[y % (2 * radius + 1)];
        accumulate(&mut total, entering, |sum, leaving| sum - leaving);
        if y < height {
            sobel.products(picture, y, entering);
            accumulate(&mut total, entering, |sum, entering| sum + entering);
        } else {
            entering.iter_mut().for_each(|row| row.fill(0));
        }
        if let Some(centre) = y.checked_sub(radius) {
            let n_rows = height.min(y + 1) - centre.saturating_sub(radius);
            for (means, total) in means.iter_mut().zip(&total) {
                slide(total, radius, n_rows, means);
            }
            let [xx, xy, yy] = &means;
            let terms = xx.iter().zip(xy).zip(yy).map(|((&xx, &xy), &yy)| (xx, xy, yy));
            match params.method {
                Method::ShiTomasi => map
                    .extend(terms.map(|(xx, xy, yy)| {
                        (xx + yy - ((xx - yy) * (xx - yy) + 4.0 * xy * xy).sqrt()) / 2.0
                    })),
                Method::Harris => {
                    map.extend(terms.map(|(xx, xy, yy)| xx * yy - xy * xy - HARRIS_K * (xx + yy) * (xx + yy)))
                }
            }
        }
    }
    map
}

fn accumulate(total: &mut Products<i32>, row: &Products<i32>, f: impl Fn(i32, i32) -> i32) {
    for (total, row) in total.iter_mut().zip(row) {
        for (sum, value) in total.iter_mut().zip(row) {
            *sum = f(*sum, *value);
        }
    }
}

/// Means over windows of `2 * radius + 1` columns, fewer at the ends, in (gray levels per pixel)².
fn slide(columns: &[i32], radius: usize, n_rows: usize, means: &mut [f32]) {
    // Sobel's weights add to 8.
    let scale = |n_columns: usize| 1.0 / (64.0 * (n_columns * n_rows) as f32);
    let n = columns.len();
    let full = scale(2 * radius + 1);
    let mut sum: i32 = columns.iter().take(radius).sum();
    for (x, mean) in means.iter_mut().enumerate() {
        sum += columns.get(x + radius).copied().unwrap_or(0);
        let whole = x >= radius && x + radius < n;
        let scale = if whole { full } else { scale(n.min(x + radius + 1) - x.saturating_sub(radius)) };
        *mean = sum as f32 * scale;
        sum -= x.checked_sub(radius).map_or(0, |first| columns[first]);
    }
}

/// Sobel's gradients of a row, by way of two sums down its columns.
struct Sobel {
    /// Weights 1, 2, 1 down a column; one mirrored column at either end.
    smooth: Vec<i32>,
    /// Below minus above; likewise.
    down: Vec<i32>,
}

impl Sobel {
    fn new(width: usize) -> Self {
        Self { smooth: vec![0; width + 2], down: vec![0; width + 2] }
    }

    fn products(&mut self, picture: &Gray<'_>, y: usize, out: &mut Products<i32>) {
        let (width, height) = (picture.width as usize, picture.height as usize);
        let row = |dy: isize| picture.row(mirrored(y as isize + dy, height) as u32);
        let rows = row(-1).iter().zip(row(0)).zip(row(1));
        let columns = self.smooth[1..].iter_mut().zip(&mut self.down[1..]);
        for (((&above, &here), &below), (smooth, down)) in rows.zip(columns) {
            let [above, here, below] = [above, here, below].map(i32::from);
            *smooth = above + 2 * here + below;
            *down = below - above;
        }
        for row in [&mut self.smooth, &mut self.down] {
            row[0] = row[1 + mirrored(-1, width)];
            row[width + 1] = row[1 + mirrored(width as isize, width)];
        }
        let gx = self.smooth[2..].iter().zip(&self.smooth).map(|(right, left)| right - left);
        let gy = self.down.iter().zip(&self.down[1..]).zip(&self.down[2..]).map(|((l, m), r)| l + 2 * m + r);
        let [xx, xy, yy] = out;
        for ((gx, gy), ((xx, xy), yy)) in gx.zip(gy).zip(xx.iter_mut().zip(xy).zip(yy)) {
            (*xx, *xy, *yy) = (gx * gx, gx * gy, gy * gy);
        }
    }
}
