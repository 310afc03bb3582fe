//! The part of the picture that a tracker is given: what lies round the path that a feature is known to take.

use honami_model::clip::Clip;
use honami_model::picture::{Chroma, Gray};

/// Corners of crops lie on multiples of this: the coarser levels of a crop's pyramid (up to the seventh) are then
/// made of the same pixels as those of the whole picture, and so are its chroma samples.
const GRID_PX: u32 = 64;

/// The smallest and largest coordinates of some points, pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    low: [f32; 2],
    high: [f32; 2],
}

impl Bounds {
    pub(super) fn of(point: [f32; 2]) -> Self {
        Self { low: point, high: point }
    }

    pub(super) fn add(&mut self, point: [f32; 2]) {
        for (axis, &v) in point.iter().enumerate() {
            self.low[axis] = self.low[axis].min(v);
            self.high[axis] = self.high[axis].max(v);
        }
    }
}

/// A rectangle of whole pixels in the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Crop {
    /// Its corner, pixels.
    pub(super) origin: [u32; 2],
    /// Width and height, pixels.
    pub(super) size: [u32; 2],
    clip: [u32; 2],
}

impl Crop {
    /// The bounds with a margin on every side, as far as the picture goes; at least two margins wide and high.
    pub(super) fn round(bounds: &Bounds, margin_px: u32, clip: &Clip) -> Self {
        let clip = [clip.width, clip.height];
        let side = |axis: usize| {
            let pixel = |v: f32| (v.max(0.0) as u32).min(clip[axis] - 1);
            let (low, high) = (pixel(bounds.low[axis]), pixel(bounds.high[axis]));
            let mut start = low.saturating_sub(margin_px);
            let end = high.saturating_add(margin_px + 1).max(start + 2 * margin_px).min(clip[axis]);
            // At the far edge of the picture the other side gets what this one cannot have.
            start = start.min(end.saturating_sub(2 * margin_px)) / GRID_PX * GRID_PX;
            (start, end - start)
        };
        let (x, y) = (side(0), side(1));
        Self { origin: [x.0, y.0], size: [x.1, y.1], clip }
    }

    /// This part of a picture of the clip.
    pub(super) fn of<'a>(&self, picture: Gray<'a>) -> Gray<'a> {
        let ([x, y], [width, height]) = (self.origin, self.size);
        let data = &picture.data[y as usize * picture.stride + x as usize..];
        Gray { data, width, height, stride: picture.stride }
    }

    /// The chroma of this part, from that of a picture of the clip: half its size (4:2:0).
    pub(super) fn of_chroma<'a>(&self, chroma: &Chroma<'a>) -> Chroma<'a> {
        let half = Self {
            origin: self.origin.map(|px| px / 2),
            size: self.size.map(|px| px.div_ceil(2)),
            clip: self.clip.map(|px| px.div_ceil(2)),
        };
        Chroma { cb: half.of(chroma.cb), cr: half.of(chroma.cr) }
    }

    /// Where a point of the clip lies in it.
    pub(super) fn inward(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        [x - self.origin[0] as f32, y - self.origin[1] as f32]
    }

    /// Where a point in it lies in the clip.
    pub(super) fn outward(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        [x + self.origin[0] as f32, y + self.origin[1] as f32]
    }

    /// Whether a point of the clip is within this distance of an edge behind which the picture goes on.
    pub(super) fn is_cut_near(&self, point: [f32; 2], distance_px: u32) -> bool {
        (0..2).any(|axis| {
            let (start, end) = (self.origin[axis], self.origin[axis] + self.size[axis]);
            let (v, distance) = (point[axis], distance_px as f32);
            (start > 0 && v < start as f32 + distance)
                || (end < self.clip[axis] && v >= end as f32 - distance)
        })
    }

    /// Whether a point of the clip is within this distance of the picture's own edge.
    pub(super) fn is_clip_edge_near(&self, point: [f32; 2], distance_px: u32) -> bool {
        let distance = distance_px as f32;
        (0..2).any(|axis| point[axis] < distance || point[axis] >= self.clip[axis] as f32 - distance)
    }

    /// Whether it is all of the picture.
    pub(super) fn is_whole(&self) -> bool {
        self.size == self.clip
    }
}
