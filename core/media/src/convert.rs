//! From pixels as stored to planes: luma as coded, chroma at half size (4:2:0), 8 bits each.

use honami_model::picture::Range;

use crate::source::Shape;

/// How the samples of a stored frame are laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Coded {
    /// Planes Y, U, V (or Y alone), with this subsampling, in samples of this many bits (above 8: little endian).
    Planar { chroma: Chroma, bits: u32 },
    /// Interleaved 8-bit RGB.
    Rgb,
}

/// Chroma subsampling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Chroma {
    None,
    Half,
    HalfWidth,
    Whole,
}

impl Chroma {
    /// Size of a chroma plane, rounded up.
    fn size(self, width: u32, height: u32) -> (usize, usize) {
        let (w, h) = (width as usize, height as usize);
        match self {
            Self::None => (0, 0),
            Self::Half => (w.div_ceil(2), h.div_ceil(2)),
            Self::HalfWidth => (w.div_ceil(2), h),
            Self::Whole => (w, h),
        }
    }
}

impl Coded {
    /// Whether planes made from this have chroma.
    pub(crate) fn colour(self) -> bool {
        !matches!(self, Self::Planar { chroma: Chroma::None, .. })
    }

    /// Bytes of a stored frame.
    pub(crate) fn frame_len(self, width: u32, height: u32) -> usize {
        let pixels = width as usize * height as usize;
        match self {
            Self::Rgb => 3 * pixels,
            Self::Planar { chroma, bits } => {
                let (w, h) = chroma.size(width, height);
                (pixels + 2 * w * h) * if bits > 8 { 2 } else { 1 }
            }
        }
    }

    /// Whether stored bytes are planes already, so that no conversion is needed.
    pub(crate) fn is_planes(self) -> bool {
        matches!(self, Self::Planar { chroma: Chroma::None | Chroma::Half, bits: 8 })
    }

    /// Turns a stored frame into the planes of `shape`.
    pub(crate) fn to_planes(self, stored: &[u8], shape: &Shape, frame: &mut [u8]) {
        match self {
            Self::Rgb => rgb_to_planes(stored, shape, frame),
            Self::Planar { chroma, bits: 8 } => planar_to_planes(chroma, stored, shape, frame),
            Self::Planar { chroma, bits } => {
                let narrow: Vec<u8> = stored
                    .chunks_exact(2)
                    .map(|pair| narrow(u16::from_le_bytes([pair[0], pair[1]]), bits))
                    .collect();
                planar_to_planes(chroma, &narrow, shape, frame);
            }
        }
    }
}

/// A video sample of `bits` bits as 8 bits, rounded: black and white keep their meaning (16 << 2 is 16).
fn narrow(sample: u16, bits: u32) -> u8 {
    let shift = bits - 8;
    ((u32::from(sample) + (1 << (shift - 1))) >> shift).min(255) as u8
}

/// An image sample of 16 bits as 8 bits, rounded: 65535 is 255.
pub(crate) fn narrow_image(sample: u16) -> u8 {
    ((u32::from(sample) + 128) / 257) as u8
}

fn planar_to_planes(chroma: Chroma, stored: &[u8], shape: &Shape, frame: &mut [u8]) {
    let (luma, rest) = stored.split_at(shape.luma_len());
    let (y, uv) = frame.split_at_mut(shape.luma_len());
    y.copy_from_slice(luma);
    if !shape.colour {
        return;
    }
    let (w, h) = chroma.size(shape.width, shape.height);
    for (from, to) in rest.chunks_exact(w * h).zip(uv.chunks_exact_mut(shape.chroma_len())) {
        match chroma {
            Chroma::None => {}
            Chroma::Half => to.copy_from_slice(from),
            Chroma::HalfWidth => halve(from, w, to, w, 1, 2),
            Chroma::Whole => halve(from, w, to, w.div_ceil(2), 2, 2),
        }
    }
}

/// Averages blocks of `across` x `down` samples, rounded, with fewer at the right and lower edge.
fn halve(from: &[u8], from_width: usize, to: &mut [u8], to_width: usize, across: usize, down: usize) {
    let rows = from.len() / from_width;
    for (row, line) in to.chunks_exact_mut(to_width).enumerate() {
        let (top, bottom) = (row * down, (row * down + down).min(rows));
        for (column, out) in line.iter_mut().enumerate() {
            let (left, right) = (column * across, (column * across + across).min(from_width));
            let block = from[top * from_width..bottom * from_width].chunks_exact(from_width);
            let sum: u32 = block.flat_map(|r| &r[left..right]).map(|&v| u32::from(v)).sum();
            let n = ((bottom - top) * (right - left)) as u32;
            *out = ((sum + n / 2) / n) as u8;
        }
    }
}

/// Gains of R, G and B in 16-bit fixed point, and what black is.
struct Gains {
    luma: [i32; 3],
    black: i32,
    cb: [i32; 3],
    cr: [i32; 3],
}

/// `Y = .299 R + .587 G + .114 B`, `Cb = (B - Y) / 1.772 + 128`, `Cr = (R - Y) / 1.402 + 128` (BT.601, JFIF 1.02).
const FULL: Gains = Gains {
    luma: [19_595, 38_470, 7_471],
    black: 0,
    cb: [-11_058, -21_710, 32_768],
    cr: [32_768, -27_439, -5_329],
};

/// The same in 219 steps from 16 on, chroma in 224. Gains add up so that gray has no chroma, and white is 235.
const LIMITED: Gains = Gains {
    luma: [16_829, 33_039, 6_416],
    black: 16,
    cb: [-9_714, -19_070, 28_784],
    cr: [28_784, -24_103, -4_681],
};

/// BT.601 in 16-bit fixed point, rounded, in the range of the shape: gray has no chroma, and at full range stays exactly gray.
///
/// Chroma is that of the mean colour of each 2x2 block.
pub(crate) fn rgb_to_planes(rgb: &[u8], shape: &Shape, frame: &mut [u8]) {
    let Gains { luma, black, cb, cr } = match shape.range {
        Range::Full => FULL,
        Range::Limited => LIMITED,
    };
    let weighted = |gains: [i32; 3], colour: [i32; 3]| -> i32 {
        gains.iter().zip(colour).map(|(gain, value)| gain * value).sum()
    };
    let width = shape.width as usize;
    let (y, uv) = frame.split_at_mut(shape.luma_len());
    for (pixel, out) in rgb.chunks_exact(3).zip(y.iter_mut()) {
        let colour = [0, 1, 2].map(|c| i32::from(pixel[c]));
        *out = ((weighted(luma, colour) + (black << 16) + 32_768) >> 16) as u8;
    }
    if !shape.colour {
        return;
    }
    let half = width.div_ceil(2);
    let (u, v) = uv.split_at_mut(shape.chroma_len());
    for (row, (u, v)) in u.chunks_exact_mut(half).zip(v.chunks_exact_mut(half)).enumerate() {
        let top = &rgb[2 * row * 3 * width..][..3 * width];
        let below = rgb.get((2 * row + 1) * 3 * width..(2 * row + 2) * 3 * width).unwrap_or(top);
        for column in 0..half {
            let (left, right) = (6 * column, (6 * column + 3).min(3 * (width - 1)));
            let colour = [0, 1, 2].map(|c| {
                [top[left + c], top[right + c], below[left + c], below[right + c]]
                    .map(i32::from)
                    .iter()
                    .sum::<i32>()
            });
            // Sums of four pixels: two more bits of fraction. 128 in the same scale, and one half to round.
            const BIAS: i32 = (128 << 18) + (1 << 17);
            u[column] = clamped((weighted(cb, colour) + BIAS) >> 18);
            v[column] = clamped((weighted(cr, colour) + BIAS) >> 18);
        }
    }
}

fn clamped(value: i32) -> u8 {
    value.clamp(0, 255) as u8
}

#[cfg(test)]
mod tests;
