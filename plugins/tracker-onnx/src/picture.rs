//! Frames as a net sees them, and positions between the two.
//!
//! Positions of a clip are counted from the centre of the first pixel; those of a net from its corner (TAP-Vid's
//! raster), so that a position keeps its place in the picture at any size.

use honami_follow::picture;
use honami_plugin::{Frame, Range};
use honami_vision::Point;
use image::imageops::{FilterType, resize};
use image::{ImageBuffer, Rgb};

use crate::net::FrameShape;

/// The frame in the size that the net wants, red, green and blue from -1 to 1.
pub(crate) fn tensor(frame: &Frame<'_>, shape: &FrameShape) -> Vec<f32> {
    let gray = picture(frame);
    // Black, from there to white, and of a colour difference from one end to the other.
    let (black, white, colourful) = match frame.range {
        Some(Range::Limited) => (16.0, 219.0, 224.0),
        _ => (0.0, 255.0, 255.0),
    };
    let colours = ImageBuffer::from_fn(gray.width, gray.height, |x, y| {
        let luma = (f32::from(gray.row(y)[x as usize]) - black) / white;
        let [blue, red] =
            frame.chroma_at(x, y).map_or([0.0; 2], |c| c.map(|c| (f32::from(c) - 128.0) / colourful));
        // ITU-R BT.601.
        let rgb = [luma + 1.402 * red, luma - 0.344_136 * blue - 0.714_136 * red, luma + 1.772 * blue];
        Rgb(rgb.map(|c| c.clamp(0.0, 1.0)))
    });
    // A triangle as wide as a pixel of the smaller picture; it keeps to numbers from 0 to 1.
    let small = resize(&colours, shape.width, shape.height, FilterType::Triangle);
    let numbers: Vec<f32> = if shape.is_planar {
        (0..3).flat_map(|c| small.pixels().map(move |pixel| pixel.0[c])).collect()
    } else {
        small.into_raw()
    };
    numbers.into_iter().map(|c| 2.0 * c - 1.0).collect()
}

/// From positions of the clip to positions of the net.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    width: f32,
    height: f32,
    x: f32,
    y: f32,
}

impl Scale {
    pub(crate) fn new((width, height): (u32, u32), shape: &FrameShape) -> Self {
        let [width, height] = [width, height].map(|size| size as f32);
        Self { width, height, x: shape.width as f32 / width, y: shape.height as f32 / height }
    }

    pub(crate) fn to_net(self, [x, y]: Point) -> Point {
        [(x + 0.5) * self.x, (y + 0.5) * self.y]
    }

    pub(crate) fn to_clip(self, [x, y]: Point) -> Point {
        [x / self.x - 0.5, y / self.y - 0.5]
    }

    /// Whether a position of the clip is in the picture.
    pub(crate) fn holds(self, [x, y]: Point) -> bool {
        (-0.5..=self.width - 0.5).contains(&x) && (-0.5..=self.height - 0.5).contains(&y)
    }
}
