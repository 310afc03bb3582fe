//! Where to put features: corners by Shi and Tomasi, or by Harris.
//!
//! Over a small window, `G = mean(g gᵀ)` with the gradient `g` (Sobel, gray levels per pixel). A corner is strong
//! where the smaller eigenvalue of `G` is large (J. Shi, C. Tomasi, "Good features to track", CVPR 1994), or
//! where `det G - k tr² G` is (C. Harris, M. Stephens, "A combined corner and edge detector", 1988, k = 0.04).

mod response;
#[cfg(test)]
mod tests;

use honami_model::picture::Gray;

use crate::Point;

/// What makes a corner strong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Smaller eigenvalue of `G`.
    ShiTomasi,
    /// `det G - 0.04 tr² G`.
    Harris,
}

/// What to look for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// What makes a corner strong.
    pub method: Method,
    /// The most corners to return.
    pub max_corners: usize,
    /// A corner weaker than this share of the strongest is left out, 0..=1.
    pub quality: f32,
    /// Corners keep this distance from each other, pixels.
    pub min_distance_px: f32,
    /// Radius of the window that gradients are averaged over, pixels, 20 at most.
    pub window_radius_px: u32,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            method: Method::ShiTomasi,
            max_corners: 1000,
            quality: 0.01,
            min_distance_px: 8.0,
            window_radius_px: 1,
        }
    }
}

/// A place worth tracking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Position to a fraction of a pixel: the top of a parabola through the response.
    pub at: Point,
    /// Response: (gray levels per pixel)² for Shi-Tomasi, its square for Harris.
    pub score: f32,
}

/// The strongest corners of a picture, strongest first; equal ones from the top, then from the left.
///
/// `mask` has one byte a pixel, packed rows, and allows where it is not 0; `occupied` are features that are there
/// already, which new ones keep clear of. The outermost pixels are never corners.
///
/// # Panics
/// When the mask is not as large as the picture, or the window's radius exceeds 20.
#[must_use]
#[track_caller]
pub fn corners(picture: &Gray<'_>, mask: Option<&[u8]>, occupied: &[Point], params: &Params) -> Vec<Corner> {
    let (width, height) = (picture.width as usize, picture.height as usize);
    assert!(mask.is_none_or(|m| m.len() == width * height), "a mask of {width}x{height} bytes");
    if width < 3 || height < 3 {
        return Vec::new();
    }
    let map = response::map(picture, params);
    let peaks = peaks(&map, width, mask, params.quality);
    let mut spacing = Spacing::new(params.min_distance_px, width, height);
    for &point in occupied {
        spacing.occupy(point);
    }
    let free = peaks.into_iter().filter_map(|(score, i)| {
        let corner = Corner { at: summit(&map, width, i), score };
        spacing.is_free(corner.at).then(|| {
            spacing.occupy(corner.at);
            corner
        })
    });
    free.take(params.max_corners).collect()
}

/// Score and index of every peak that the mask allows and that is strong enough, in the order of [`corners`].
fn peaks(map: &[f32], width: usize, mask: Option<&[u8]>, quality: f32) -> Vec<(f32, usize)> {
    let inner = |i: usize| (1..width - 1).contains(&(i % width));
    let allowed = |i: usize| inner(i) && mask.is_none_or(|m| m[i] != 0);
    let rows = || (1..map.len() / width - 1).map(|y| y * width);
    // Positive floats are in the order of their bits, and whole numbers are compared many at a time.
    let strongest = rows().map(|row| match mask {
        None => map[row + 1..row + width - 1].iter().map(|v| v.to_bits() as i32).max(),
        Some(_) => (row..row + width).filter(|&i| allowed(i)).map(|i| map[i].to_bits() as i32).max(),
    });
    let strongest = f32::from_bits(strongest.flatten().fold(0, i32::max) as u32);
    let weakest = (strongest * quality).max(f32::MIN_POSITIVE);

    let greater = |a: f32, b: f32| if a > b { a } else { b };
    let mut columns = vec![0.0; width];
    let mut found = Vec::new();
    for row in rows() {
        let [above, here, below] = [row - width, row, row + width].map(|start| &map[start..start + width]);
        // Without branches first: as strong as the nine pixels around?
        for (((most, a), h), b) in columns.iter_mut().zip(above).zip(here).zip(below) {
            *most = greater(greater(*a, *h), *b);
        }
        let around = columns.windows(3).map(|c| greater(greater(c[0], c[1]), c[2]));
        let candidates =
            here[1..].iter().zip(around).enumerate().filter(|(_, (h, most))| (*h >= most) & (**h >= weakest));
        let candidates = candidates.map(|(x, _)| row + 1 + x);
        found.extend(candidates.filter(|&i| is_peak(map, width, i) && allowed(i)).map(|i| (map[i], i)));
    }
    found.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    found
}

/// Whether a pixel is at least as strong as its eight neighbours; of equal ones the first counts.
fn is_peak(map: &[f32], width: usize, i: usize) -> bool {
    let before = [i - width - 1, i - width, i - width + 1, i - 1];
    let after = [i + 1, i + width - 1, i + width, i + width + 1];
    before.iter().all(|&j| map[i] > map[j]) && after.iter().all(|&j| map[i] >= map[j])
}

/// Top of the parabolas along x and y through a peak and its neighbours.
fn summit(map: &[f32], width: usize, i: usize) -> Point {
    let offset = |before: f32, at: f32, after: f32| {
        let bend = before - 2.0 * at + after;
        if bend < 0.0 { ((before - after) / (2.0 * bend)).clamp(-0.5, 0.5) } else { 0.0 }
    };
    let dx = offset(map[i - 1], map[i], map[i + 1]);
    let dy = offset(map[i - width], map[i], map[i + width]);
    [(i % width) as f32 + dx, (i / width) as f32 + dy]
}

/// Keeps points apart: a grid of cells no smaller than the distance, so that only nine of them are looked at.
struct Spacing {
    distance: f32,
    cell_px: f32,
    columns: usize,
    rows: usize,
    cells: Vec<Vec<Point>>,
}

impl Spacing {
    fn new(distance: f32, width: usize, height: usize) -> Self {
        /// Smaller cells would cost more memory than they save looking.
        const SMALLEST_CELL_PX: f32 = 8.0;
        let cell_px = distance.max(SMALLEST_CELL_PX);
        let along = |n: usize| (n as f32 / cell_px) as usize + 1;
        let (columns, rows) = (along(width), along(height));
        Self { distance, cell_px, columns, rows, cells: vec![Vec::new(); columns * rows] }
    }

    /// Column and row of the cell that holds a point; those beyond the picture are in the outermost cells, which
    /// brings no two points closer than they are.
    fn cell(&self, [x, y]: Point) -> (usize, usize) {
        let along = |c: f32, n: usize| ((c / self.cell_px) as usize).min(n - 1);
        (along(x, self.columns), along(y, self.rows))
    }

    fn is_free(&self, point: Point) -> bool {
        let (column, row) = self.cell(point);
        let rows = row.saturating_sub(1)..(row + 2).min(self.rows);
        let columns = column.saturating_sub(1)..(column + 2).min(self.columns);
        let near = rows.flat_map(|row| &self.cells[row * self.columns..][columns.clone()]).flatten();
        near.into_iter().all(|other| {
            let (dx, dy) = (point[0] - other[0], point[1] - other[1]);
            dx * dx + dy * dy >= self.distance * self.distance
        })
    }

    fn occupy(&mut self, point: Point) {
        let (column, row) = self.cell(point);
        self.cells[row * self.columns + column].push(point);
    }
}
