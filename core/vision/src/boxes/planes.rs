//! A picture and its box averages: the pyramid of thesis 2.5.1, with a mirrored margin.

use honami_model::picture::Gray;

use crate::pyramid::mirrored;

/// Bytes behind the last row: kernels read whole vectors, and only the lanes of the window count.
const TAIL: usize = 96;

/// A picture at several sizes, each pixel the mean of 2x2 of the size below, made for windows of one radius.
#[derive(Clone, Debug)]
pub struct Boxes {
    pub(super) planes: Vec<Plane>,
    width: u32,
    height: u32,
    radius_px: u32,
}

/// One size, margin and all. Its first pixel lies `margin >> level` pixels of this level before the picture.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    pub(super) data: Vec<u8>,
    pub(super) stride: usize,
    rows: usize,
    /// Pixels before the picture, of this level.
    pub(super) margin: i32,
}

impl Boxes {
    /// The pyramid of a picture for windows of this radius: `n_levels` sizes, the picture's own among them, or as many
    /// as leave a window two pixels wide; never fewer than one.
    ///
    /// # Panics
    /// When the picture has no pixels.
    #[must_use]
    #[track_caller]
    pub fn new(picture: &Gray<'_>, n_levels: u32, radius_px: u32) -> Self {
        assert!(picture.width > 0 && picture.height > 0, "a pyramid needs a picture with pixels");
        let n_levels = n_levels.clamp(1, (2 * radius_px + 1).ilog2().max(1));
        // A window whose centre is on the picture reaches one radius beyond it, its neighbours for the sub-pixel peak
        // one pixel more, and where a coarse pixel starts is rounded by less than one of the coarsest.
        let coarsest = 1 << (n_levels - 1);
        let margin = (radius_px as usize + 2 + 2 * coarsest).next_multiple_of(coarsest);
        let size = |n: u32| (n as usize + 2 * margin).next_multiple_of(coarsest);
        let (columns, rows) = (size(picture.width), size(picture.height));
        let plane = |level: u32| Plane {
            data: vec![0; (columns >> level) * (rows >> level) + TAIL],
            stride: columns >> level,
            rows: rows >> level,
            margin: (margin >> level) as i32,
        };
        let planes = (0..n_levels).map(plane).collect();
        let mut boxes = Self { planes, width: picture.width, height: picture.height, radius_px };
        boxes.fill(picture);
        boxes
    }

    /// Takes the next picture of the same size, without allocating.
    ///
    /// # Panics
    /// When the size is another one.
    #[track_caller]
    pub fn fill(&mut self, picture: &Gray<'_>) {
        assert_eq!((picture.width, picture.height), self.size(), "size of the picture");
        let base = &mut self.planes[0];
        let (margin, width) = (base.margin as usize, picture.width as usize);
        let source = |i: usize, n: u32| mirrored(i as isize - margin as isize, n as usize);
        let beyond = (0..margin).chain(margin + width..base.stride);
        let beyond: Vec<(usize, usize)> = beyond.map(|x| (x, source(x, picture.width))).collect();
        for (y, row) in base.data.chunks_exact_mut(base.stride).take(base.rows).enumerate() {
            let from = picture.row(source(y, picture.height) as u32);
            row[margin..margin + width].copy_from_slice(from);
            beyond.iter().for_each(|&(x, source)| row[x] = from[source]);
        }
        for level in 1..self.planes.len() {
            let (finer, coarser) = self.planes.split_at_mut(level);
            halve(&finer[level - 1], &mut coarser[0]);
        }
    }

    /// Width and height of the picture, pixels.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Sizes there are, the picture's own among them.
    #[must_use]
    pub fn n_levels(&self) -> u32 {
        self.planes.len() as u32
    }

    /// The picture itself.
    #[must_use]
    pub fn picture(&self) -> Gray<'_> {
        let Plane { data, stride, margin, .. } = &self.planes[0];
        let first = *margin as usize * (stride + 1);
        Gray { data: &data[first..], width: self.width, height: self.height, stride: *stride }
    }

    pub(super) fn radius_px(&self) -> u32 {
        self.radius_px
    }
}

/// Mean of every 2x2 pixels, rounded (halves up).
fn halve(fine: &Plane, coarse: &mut Plane) {
    let pairs = fine.data[..fine.stride * fine.rows].chunks_exact(2 * fine.stride);
    for (out, pair) in coarse.data.chunks_exact_mut(coarse.stride).zip(pairs) {
        let (upper, lower) = pair.split_at(fine.stride);
        let pair = |two: &[u8; 2]| (u16::from_le_bytes(*two) & 255) + (u16::from_le_bytes(*two) >> 8);
        for ((out, upper), lower) in out.iter_mut().zip(upper.as_chunks().0).zip(lower.as_chunks().0) {
            *out = ((pair(upper) + pair(lower) + 2) >> 2) as u8;
        }
    }
}
