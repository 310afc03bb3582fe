//! Box-filtered RGB pictures of a part of a frame, for the terminal.

use honami_model::picture::{Planes, Range};

/// A rectangle in image coordinates, pixels: (0, 0) is the centre of the top-left pixel, so the whole picture
/// reaches from (-0.5, -0.5) to (width - 0.5, height - 0.5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Left edge.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// Extent to the right, positive.
    pub width: f64,
    /// Extent downwards, positive.
    pub height: f64,
}

impl Rect {
    /// All of a picture of this size.
    #[must_use]
    pub fn whole(width: u32, height: u32) -> Self {
        Self { x: -0.5, y: -0.5, width: f64::from(width), height: f64::from(height) }
    }
}

/// Sixteen bits of fraction: enough that 65536 rows of sums of 255 stay below 2^32.
const ONE: i32 = 1 << 16;

/// See [`FrameRef::rgb_area`](crate::FrameRef::rgb_area).
pub(crate) fn rgb_area(planes: &Planes<'_>, area: Rect, width: u32, height: u32) -> Vec<[u8; 3]> {
    let (picture_width, picture_height) = (planes.y.width, planes.y.height);
    let columns = spans(area.x, area.width, width, picture_width);
    let rows = spans(area.y, area.height, height, picture_height);
    let luma = box_means(planes.y.data, planes.y.stride, &columns, &rows);
    let chroma = planes.uv.map(|(u, v)| {
        let stride = picture_width.div_ceil(2) as usize;
        let (columns, rows) = (halved(&columns), halved(&rows));
        [u, v].map(|plane| box_means(plane, stride, &columns, &rows))
    });
    let colours = Colours::of(planes.range);
    let inside =
        rows.iter().flat_map(|row| columns.iter().map(move |column| row.is_some() && column.is_some()));
    let pixel = |(at, inside): (usize, bool)| match (&chroma, inside) {
        (_, false) => [0; 3],
        (None, true) => colours.rgb(luma[at], 128, 128),
        (Some([u, v]), true) => colours.rgb(luma[at], u[at], v[at]),
    };
    inside.enumerate().map(pixel).collect()
}

/// Every pixel as RGB, row-major.
pub(crate) fn rgb(planes: &Planes<'_>) -> Vec<[u8; 3]> {
    let (width, height) = (planes.y.width, planes.y.height);
    rgb_area(planes, Rect::whole(width, height), width, height)
}

/// First source pixel and the one after the last, or `None` outside the picture.
type Span = Option<(usize, usize)>;

/// The source pixels whose centres lie under each of `n` cells; the nearest one where none does.
fn spans(start: f64, extent: f64, n: u32, limit: u32) -> Vec<Span> {
    let step = extent / f64::from(n.max(1));
    let span = |k: u32| {
        let (from, to) = (start + step * f64::from(k), start + step * f64::from(k + 1));
        let middle = ((from + to) / 2.0).round();
        if !(middle >= 0.0 && middle < f64::from(limit)) {
            return None;
        }
        let (first, end) = (from.ceil().max(0.0), to.ceil().min(f64::from(limit)));
        Some(if end > first {
            (first as usize, end as usize)
        } else {
            (middle as usize, middle as usize + 1)
        })
    };
    (0..n).map(span).collect()
}

/// The spans in a plane of half the size.
fn halved(spans: &[Span]) -> Vec<Span> {
    spans.iter().map(|span| span.map(|(first, end)| (first / 2, (end / 2).max(first / 2 + 1)))).collect()
}

/// Rounded means of a plane over every pair of spans, row-major.
fn box_means(plane: &[u8], stride: usize, columns: &[Span], rows: &[Span]) -> Vec<u8> {
    let left = columns.iter().flatten().map(|span| span.0).min().unwrap_or(0);
    let right = columns.iter().flatten().map(|span| span.1).max().unwrap_or(0);
    let mut sums = vec![0_u32; right - left];
    let mut means = vec![0; columns.len() * rows.len()];
    for (row, out) in rows.iter().zip(means.chunks_exact_mut(columns.len().max(1))) {
        let Some((top, bottom)) = *row else { continue };
        sums.fill(0);
        for y in top..bottom {
            let line = &plane[y * stride + left..y * stride + right];
            for (sum, &value) in sums.iter_mut().zip(line) {
                *sum += u32::from(value);
            }
        }
        for (column, out) in columns.iter().zip(out) {
            let Some((first, end)) = *column else { continue };
            let n = ((end - first) * (bottom - top)) as u64;
            let sum: u64 = sums[first - left..end - left].iter().map(|&s| u64::from(s)).sum();
            *out = ((sum + n / 2) / n) as u8;
        }
    }
    means
}

/// BT.601 from YCbCr to RGB in fixed point, as [`Planes::rgb`] in floating point.
struct Colours {
    black: i32,
    luma_gain: i32,
    /// Cr to R, Cb to G, Cr to G, Cb to B.
    chroma_gains: [i32; 4],
}

impl Colours {
    fn of(range: Range) -> Self {
        let (black, luma, chroma) = match range {
            Range::Full => (0, 1.0, 1.0),
            Range::Limited => (16, 255.0 / 219.0, 255.0 / 224.0),
        };
        let fixed = |gain: f64| (gain * f64::from(ONE)).round() as i32;
        Self {
            black,
            luma_gain: fixed(luma),
            chroma_gains: [1.402, -0.344_136, -0.714_136, 1.772].map(|gain| fixed(gain * chroma)),
        }
    }

    fn rgb(&self, y: u8, cb: u8, cr: u8) -> [u8; 3] {
        let luma = (i32::from(y) - self.black) * self.luma_gain + ONE / 2;
        let (cb, cr) = (i32::from(cb) - 128, i32::from(cr) - 128);
        let [red, green_of_cb, green_of_cr, blue] = self.chroma_gains;
        [luma + red * cr, luma + green_of_cb * cb + green_of_cr * cr, luma + blue * cb]
            .map(|value| (value >> 16).clamp(0, 255) as u8)
    }
}

#[cfg(test)]
mod tests;
