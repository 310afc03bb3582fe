//! Clips in memory whose motion is known: a texture that is a formula, or coloured discs, moved by a formula.

use honami_host::{FrameView, Point, StreamInfo};
use honami_model::picture::{Chroma, Gray};
use rand::RngExt;
use rand_pcg::Pcg64;
use std::f64::consts::{PI, TAU};

/// Frames a second of every clip here.
pub(crate) const FPS: f64 = 25.0;

/// Frames of one size, with or without colour.
#[derive(Clone, Debug)]
pub(crate) struct Clip {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) pictures: Vec<Picture>,
}

/// Packed planes.
#[derive(Clone, Debug)]
pub(crate) struct Picture {
    pub(crate) luma: Vec<u8>,
    /// Blue and red difference, half as wide and high, rounded up; empty for gray.
    pub(crate) chroma: [Vec<u8>; 2],
}

impl Clip {
    /// So many gray frames of the brightness `(at, frame)` at the centres of pixels, rounded to 0..=255.
    pub(crate) fn new(
        [width, height]: [u32; 2],
        n_frames: usize,
        brightness: impl Fn([f64; 2], usize) -> f64,
    ) -> Self {
        let picture = |t| {
            let luma = plane([width, height], |at| brightness(at, t));
            Picture { luma, chroma: [Vec::new(), Vec::new()] }
        };
        Self { width, height, pictures: (0..n_frames).map(picture).collect() }
    }

    /// A frame, numbered and timed by its place.
    pub(crate) fn view(&self, t: usize) -> FrameView<'_> {
        let (picture, half) = (&self.pictures[t], [self.width.div_ceil(2), self.height.div_ceil(2)]);
        let chroma = || {
            let [cb, cr] = picture.chroma.each_ref().map(|plane| Gray::packed(plane, half[0], half[1]));
            Chroma { cb, cr }
        };
        FrameView {
            gray: Gray::packed(&picture.luma, self.width, self.height),
            chroma: (!picture.chroma[0].is_empty()).then(chroma),
            range: None,
            index: t as i64,
            time_s: t as f64 / FPS,
        }
    }

    /// What a tracker is told of it: one thread, no births.
    pub(crate) fn stream(&self) -> StreamInfo {
        StreamInfo {
            width: self.width,
            height: self.height,
            fps: Some(FPS),
            n_frames: Some(self.pictures.len() as u64),
            reversed: false,
            max_threads: 1,
            seed: 1,
            births: 0..0,
        }
    }
}

/// Bytes of a plane, from the value at the centre of each pixel.
pub(crate) fn plane([width, height]: [u32; 2], value: impl Fn([f64; 2]) -> f64) -> Vec<u8> {
    let places = (0..height).flat_map(|y| (0..width).map(move |x| [f64::from(x), f64::from(y)]));
    places.map(|at| value(at).round().clamp(0.0, 255.0) as u8).collect()
}

/// A picture without end: a sum of plane waves, none too short for a pixel to see.
#[derive(Clone, Debug)]
pub(crate) struct Texture(Vec<Wave>);

#[derive(Clone, Copy, Debug)]
struct Wave {
    /// Radians a pixel.
    along: [f64; 2],
    phase: f64,
    height: f64,
}

/// Waves of a texture.
const N_WAVES: usize = 14;

impl Texture {
    /// Waves of 8 to 60 px in all directions.
    pub(crate) fn new(chance: &mut Pcg64) -> Self {
        let mut wave = |k: usize| {
            let length_px = 8.0 * 7.5_f64.powf(chance.random::<f64>());
            let angle = (k as f64 + chance.random::<f64>()) * PI / N_WAVES as f64;
            let along = [TAU / length_px * angle.cos(), TAU / length_px * angle.sin()];
            // 45 levels of standard deviation in all: few pixels come to an end of the byte.
            Wave { along, phase: TAU * chance.random::<f64>(), height: 45.0 / (N_WAVES as f64 / 2.0).sqrt() }
        };
        Self((0..N_WAVES).map(&mut wave).collect())
    }

    /// Brightness about 0, 8-bit levels.
    pub(crate) fn at(&self, [x, y]: [f64; 2]) -> f64 {
        self.0.iter().map(|w| w.height * (w.along[0] * x + w.along[1] * y + w.phase).sin()).sum()
    }

    /// Convolved with a Gaussian of this standard deviation, which a wave survives as `exp(-σ²k²/2)` of itself.
    pub(crate) fn blurred(&self, sigma_px: f64) -> Self {
        let left = |w: &Wave| (-0.5 * sigma_px * sigma_px * (w.along[0].powi(2) + w.along[1].powi(2))).exp();
        Self(self.0.iter().map(|w| Wave { height: w.height * left(w), ..*w }).collect())
    }
}

/// Where the first frame has gone: turned and grown about a centre, then shifted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moved {
    pub(crate) turn: f64,
    pub(crate) zoom: f64,
    pub(crate) shift: [f64; 2],
}

impl Moved {
    pub(crate) const NOT: Self = Self { turn: 0.0, zoom: 1.0, shift: [0.0; 2] };

    /// Where a point of the first frame is now.
    pub(crate) fn there(&self, [x, y]: [f64; 2], [cx, cy]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.turn.sin_cos();
        let (x, y) = (self.zoom * (x - cx), self.zoom * (y - cy));
        [cx + cos * x - sin * y + self.shift[0], cy + sin * x + cos * y + self.shift[1]]
    }

    /// Where a point of this frame was in the first.
    pub(crate) fn back(&self, [x, y]: [f64; 2], [cx, cy]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.turn.sin_cos();
        let (x, y) = (x - self.shift[0] - cx, y - self.shift[1] - cy);
        [cx + (cos * x + sin * y) / self.zoom, cy + (cos * y - sin * x) / self.zoom]
    }
}

/// Things that differ in brightness and colour, before a plain wall: for trackers that know things by these.
#[derive(Clone, Debug)]
pub(crate) struct Discs {
    centres: Vec<[f64; 2]>,
    /// Luma, blue and red difference.
    colours: Vec<[f64; 3]>,
}

/// Radius of a disc, pixels.
const DISC_PX: f64 = 10.0;

impl Discs {
    pub(crate) fn new(centres: Vec<[f64; 2]>) -> Self {
        // Golden angles: neighbours differ in hue, and all do in luma.
        let colour = |k: usize| {
            let hue = 2.4 * k as f64;
            [50.0 + 160.0 * ((k * 7) % 12) as f64 / 11.0, 128.0 + 70.0 * hue.cos(), 128.0 + 70.0 * hue.sin()]
        };
        Self { colours: (0..centres.len()).map(colour).collect(), centres }
    }

    /// Luma and the two differences at a place of the first frame, with soft edges.
    fn at(&self, place: [f64; 2]) -> [f64; 3] {
        const WALL: [f64; 3] = [128.0; 3];
        for (centre, colour) in self.centres.iter().zip(&self.colours) {
            let share = (DISC_PX + 0.5 - (place[0] - centre[0]).hypot(place[1] - centre[1])).clamp(0.0, 1.0);
            if share > 0.0 {
                return std::array::from_fn(|c| WALL[c] + share * (colour[c] - WALL[c]));
            }
        }
        WALL
    }

    /// A clip of them in colour.
    pub(crate) fn clip(&self, size: [u32; 2], n_frames: usize, moved: impl Fn(usize) -> Moved) -> Clip {
        let (half, centre) = (size.map(|n| n.div_ceil(2)), centre(size));
        let picture = |t: usize| {
            let back = |at: [f64; 2]| moved(t).back(at, centre);
            // A sample of chroma stands for four pixels.
            let difference =
                |c: usize| plane(half, |[x, y]| self.at(back([2.0 * x + 0.5, 2.0 * y + 0.5]))[c]);
            Picture { luma: plane(size, |at| self.at(back(at))[0]), chroma: [difference(1), difference(2)] }
        };
        Clip { width: size[0], height: size[1], pictures: (0..n_frames).map(picture).collect() }
    }
}

/// The middle of a picture, pixels.
pub(crate) fn centre(size: [u32; 2]) -> [f64; 2] {
    size.map(|n| 0.5 * f64::from(n - 1))
}

/// Points on a grid of so many columns and rows within a margin, numbered from 1, off the grid by chance.
pub(crate) fn grid(
    size: [u32; 2],
    margin_px: f64,
    [columns, rows]: [u32; 2],
    chance: &mut Pcg64,
) -> Vec<Point> {
    let place = |k: u32, n: u32, size: u32, off: f64| {
        let step = (f64::from(size - 1) - 2.0 * margin_px) / f64::from(n.max(2) - 1);
        (margin_px + step * (f64::from(k) + 0.6 * (off - 0.5)).clamp(0.0, f64::from(n - 1))) as f32
    };
    let places = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
    places
        .zip(1..)
        .map(|([column, row], id)| Point {
            id,
            x: place(column, columns, size[0], chance.random()),
            y: place(row, rows, size[1], chance.random()),
        })
        .collect()
}

#[cfg(test)]
mod tests;
