//! Gaussian pyramid of a picture, each level half the size of the one below it.
//!
//! The filter is the 5x5 binomial `[1 4 6 4 1]ᵀ[1 4 6 4 1] / 256` with pictures mirrored at their outermost pixel
//! centres, rounded to 8 bits: the same bytes as OpenCV's `pyrDown`. (P. J. Burt, E. H. Adelson, "The Laplacian
//! pyramid as a compact image code", IEEE Trans. Commun. 31, 1983.)

#[cfg(test)]
mod tests;

use honami_model::picture::Gray;

/// Bytes behind the last row: kernels read whole vectors, and only the lanes of the window count.
const TAIL: usize = 128;

/// A picture at several sizes, each with a mirrored border as wide as the windows that will be cut from it.
#[derive(Clone, Debug)]
pub struct Pyramid {
    levels: Vec<Level>,
    /// Sums of five rows while a level is halved.
    rows: Vec<u16>,
}

impl Pyramid {
    /// A pyramid of a picture for windows of this radius.
    ///
    /// It has `n_levels` levels, or as many as are larger than a window on both sides; never fewer than one.
    ///
    /// # Panics
    /// When the picture has no pixels.
    #[must_use]
    #[track_caller]
    pub fn new(picture: &Gray<'_>, n_levels: u32, radius_px: u32) -> Self {
        assert!(picture.width > 0 && picture.height > 0, "a pyramid needs a picture with pixels");
        let side = 2 * radius_px + 1;
        let halved = |&(width, height): &(u32, u32)| Some((width.div_ceil(2), height.div_ceil(2)));
        let levels = std::iter::successors(Some((picture.width, picture.height)), halved)
            .take(n_levels.max(1) as usize)
            .enumerate()
            .take_while(|&(level, (width, height))| level == 0 || (width > side && height > side))
            .map(|(_, (width, height))| Level::blank(width, height, border_px(radius_px)))
            .collect();
        let mut pyramid = Self { levels, rows: Vec::new() };
        pyramid.fill(picture);
        pyramid
    }

    /// Takes the next picture of the same size, without allocating.
    ///
    /// # Panics
    /// When the size is another one.
    #[track_caller]
    pub fn fill(&mut self, picture: &Gray<'_>) {
        let base = &mut self.levels[0];
        assert_eq!((picture.width, picture.height), (base.width, base.height), "size of the picture");
        for y in 0..base.height {
            base.row_mut(y).copy_from_slice(picture.row(y));
        }
        base.mirror();
        for level in 1..self.levels.len() {
            let (finer, coarser) = self.levels.split_at_mut(level);
            halve(&finer[level - 1], &mut coarser[0], &mut self.rows);
            coarser[0].mirror();
        }
    }

    /// The levels, full size first.
    #[must_use]
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// The picture itself.
    #[must_use]
    pub fn picture(&self) -> Gray<'_> {
        self.levels[0].picture()
    }
}

/// A window may start one side before the picture, and gradients look one pixel further.
pub(crate) const fn border_px(radius_px: u32) -> u32 {
    2 * radius_px + 1 + 2
}

/// One size of a picture, with a mirrored border.
#[derive(Clone, Debug)]
pub struct Level {
    data: Vec<u8>,
    width: u32,
    height: u32,
    border: usize,
    stride: usize,
}

impl Level {
    fn blank(width: u32, height: u32, border_px: u32) -> Self {
        let border = border_px as usize;
        let stride = width as usize + 2 * border;
        Self { data: vec![0; stride * (height as usize + 2 * border) + TAIL], width, height, border, stride }
    }

    /// The picture without its border.
    #[must_use]
    pub fn picture(&self) -> Gray<'_> {
        Gray {
            data: &self.data[self.index(0, 0)..],
            width: self.width,
            height: self.height,
            stride: self.stride,
        }
    }

    /// Width without the border, pixels.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height without the border, pixels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Bytes from one row to the next.
    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

    pub(crate) fn border_px(&self) -> u32 {
        self.border as u32
    }

    /// All bytes from a pixel on, which may lie in the border.
    #[track_caller]
    pub(crate) fn bytes_from(&self, x: i32, y: i32) -> &[u8] {
        &self.data[self.index(x, y)..]
    }

    #[track_caller]
    fn index(&self, x: i32, y: i32) -> usize {
        let border = self.border as isize;
        let (column, row) = (x as isize + border, y as isize + border);
        assert!(column >= 0 && row >= 0, "pixel ({x}, {y}) before the border");
        row as usize * self.stride + column as usize
    }

    fn row_mut(&mut self, y: u32) -> &mut [u8] {
        let start = self.index(0, y as i32);
        &mut self.data[start..start + self.width as usize]
    }

    /// Fills the border with the picture's mirror image.
    fn mirror(&mut self) {
        let (width, height, border) = (self.width as usize, self.height as usize, self.border);
        let columns: Vec<(usize, usize)> = (0..border)
            .map(|i| (i, border + mirrored(i as isize - border as isize, width)))
            .chain((0..border).map(|i| (border + width + i, border + mirrored((width + i) as isize, width))))
            .collect();
        for row in self.data.chunks_exact_mut(self.stride).skip(border).take(height) {
            for &(to, from) in &columns {
                row[to] = row[from];
            }
        }
        let rows = (-(border as isize)..0).chain(height as isize..(height + border) as isize);
        for row in rows {
            let from = (border + mirrored(row, height)) * self.stride;
            let to = (border as isize + row) as usize * self.stride;
            self.data.copy_within(from..from + self.stride, to);
        }
    }
}

/// The pixel of `0..n` that `i` is the mirror image of: `… 2 1 0 1 2 … n-2 n-1 n-2 …`.
pub(crate) fn mirrored(i: isize, n: usize) -> usize {
    let period = 2 * (n as isize - 1);
    if period == 0 {
        return 0;
    }
    let i = i.rem_euclid(period);
    i.min(period - i) as usize
}

/// Filters and takes every second pixel: rows first, in 16 bits (16 · 255), then columns (256 · 255).
fn halve(fine: &Level, coarse: &mut Level, rows: &mut Vec<u16>) {
    let n = fine.width as usize + 4;
    for y in 0..coarse.height {
        let row = |dy: i32| &fine.bytes_from(-2, 2 * y as i32 + dy)[..n];
        let five = row(-2).iter().zip(row(-1)).zip(row(0)).zip(row(1)).zip(row(2));
        rows.clear();
        rows.extend(five.map(|((((a, b), c), d), e)| {
            let [a, b, c, d, e] = [*a, *b, *c, *d, *e].map(u16::from);
            a + e + 4 * (b + d) + 6 * c
        }));
        let pairs = rows.chunks_exact(2);
        let next = rows[2..].chunks_exact(2);
        let last = rows[4..].iter().step_by(2);
        for (out, ((p, q), e)) in coarse.row_mut(y).iter_mut().zip(pairs.zip(next).zip(last)) {
            *out = ((p[0] + e + 4 * (p[1] + q[1]) + 6 * q[0] + 128) >> 8) as u8;
        }
    }
}
