//! Places over time as C3D files, which programs of motion capture read (c3d.org, "The C3D File Format: User Guide", 2021).
//!
//! Blocks of 512 bytes: a header, parameters in groups, and then frame by frame the points, each x, y, z and how well it is known.
//! Numbers are those of Intel's processors, little-endian; places are 32-bit floats, millimetres.

mod parameters;

use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::Path;

use honami_model::space::Fix;

use crate::atomic::AtomicFile;
use crate::table::TableError;
use parameters::Parameters;

/// Bytes of a block.
const BLOCK: usize = 512;
/// The first of the blocks of parameters, counted from 1.
const FIRST_PARAMETERS: u8 = 2;
/// What tells the format: the second byte of header and parameters.
const KEY: u8 = 0x50;
/// More labels than this are in another parameter, as dimensions are bytes.
const MOST_LABELS: usize = 255;
/// A label has at most so many letters.
const MOST_LETTERS: usize = 32;
/// Of the cameras that saw a point, a bit each: the first two.
const CAMERAS: f32 = (0b11 << 8) as f32;
/// A residual is a number of 7 bits.
const MOST_RESIDUAL: f64 = 127.0;
const MM: f64 = 1e3;

/// What a file is to hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Points<'a> {
    /// Of each point its label, and its fixes in order of frames.
    pub points: Vec<(String, &'a [Fix])>,
    /// Frames a second; all are as far apart.
    pub fps: f64,
}

/// Why there is no such file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum C3dError {
    /// The disk says no.
    #[error(transparent)]
    File(#[from] TableError),
    /// There is nothing to write.
    #[error("there are no places to write")]
    Empty,
    /// More than the format can count.
    #[error(
        "C3D holds the labels of {most} points at most, here are {came}: name fewer tracks alike in both projects"
    )]
    TooMany {
        /// Those there are.
        came: usize,
        /// The most.
        most: usize,
    },
}

/// Writes places over time; a point has a residual of -1 in frames in which it has none. Its frames count from 1.
///
/// A point's residual is its standard error, the root of the sum of the squares along the axes; its scale is a 32000th of the farthest
/// coordinate, which is also the finest step of readers that keep whole numbers.
///
/// # Errors
/// [`C3dError::Empty`] and [`C3dError::TooMany`], and what writing met.
pub fn write(out: &Path, what: &Points<'_>) -> Result<(), C3dError> {
    let fixes = || what.points.iter().flat_map(|(_, fixes)| fixes.iter());
    let first = fixes().map(|fix| fix.frame).min().ok_or(C3dError::Empty)?;
    let last = fixes().map(|fix| fix.frame).max().ok_or(C3dError::Empty)?;
    let far = fixes().flat_map(|fix| fix.place_m).fold(0.0_f64, |far, c| far.max(MM * c.abs()));
    let head = Head {
        n_points: what.points.len(),
        frames: [first + 1, last + 1],
        scale: (far / 32_000.0).max(1e-6) as f32,
        fps: what.fps as f32,
    };
    let labels = labels(what.points.iter().map(|(label, _)| label.as_str()));
    let parameters = head.parameters(&labels)?;
    let is_alike = |head: &[u8]| head.starts_with(&[FIRST_PARAMETERS, KEY]);
    let mut file = AtomicFile::create(out, is_alike)?;
    let full = |source| TableError::File { path: out.into(), source };
    file.write_all(&head.header(parameters.len() / BLOCK)).map_err(full)?;
    file.write_all(&parameters).map_err(full)?;
    let mut left: Vec<&[Fix]> = what.points.iter().map(|(_, fixes)| *fixes).collect();
    for frame in first..=last {
        for fixes in &mut left {
            let here = fixes.split_first().filter(|(fix, _)| fix.frame == frame);
            if let Some((_, rest)) = here {
                *fixes = rest;
            }
            for number in point(here.map(|(fix, _)| fix), head.scale) {
                file.write_all(&number.to_le_bytes()).map_err(full)?;
            }
        }
    }
    let n_bytes = left.len() * 16 * (last - first + 1) as usize;
    file.write_all(&vec![0; n_bytes.next_multiple_of(BLOCK) - n_bytes]).map_err(full)?;
    Ok(file.finish()?)
}

/// x, y, z, and which cameras saw it with how well it is known.
fn point(fix: Option<&Fix>, scale: f32) -> [f32; 4] {
    let Some(fix) = fix else { return [0.0, 0.0, 0.0, -1.0] };
    let [x, y, z] = fix.place_m.map(|c| (MM * c) as f32);
    let error = MM * fix.errors_m.iter().map(|&e| f64::from(e).powi(2)).sum::<f64>().sqrt();
    let residual = (error / f64::from(scale)).round().min(MOST_RESIDUAL) as f32;
    [x, y, z, CAMERAS + residual]
}

/// Labels that the format can hold, none of them twice.
fn labels<'a>(wanted: impl Iterator<Item = &'a str>) -> Vec<String> {
    let (mut given, mut taken) = (Vec::new(), BTreeSet::new());
    for label in wanted {
        let letters: String =
            label.chars().map(|c| if c.is_ascii_graphic() { c } else { '_' }).take(MOST_LETTERS).collect();
        let numbered = (2_u32..).map(|k| {
            let end = format!("_{k}");
            format!("{}{end}", &letters[..letters.len().min(MOST_LETTERS - end.len())])
        });
        let free = std::iter::once(letters.clone()).chain(numbered).find(|label| !taken.contains(label));
        taken.extend(free.clone());
        given.extend(free);
    }
    given
}

struct Head {
    n_points: usize,
    /// The first and the last, counted from 1.
    frames: [u32; 2],
    /// Millimetres of one step of a residual.
    scale: f32,
    fps: f32,
}

impl Head {
    fn n_frames(&self) -> u32 {
        self.frames[1] - self.frames[0] + 1
    }

    fn header(&self, n_blocks: usize) -> [u8; BLOCK] {
        let mut block = [0; BLOCK];
        // Words of 16 bits, counted from 1 as the format's own table does.
        let mut put = |word: usize, bytes: &[u8]| {
            block[2 * (word - 1)..][..bytes.len()].copy_from_slice(bytes);
        };
        put(1, &[FIRST_PARAMETERS, KEY]);
        put(2, &word(self.n_points));
        put(4, &word(self.frames[0] as usize));
        put(5, &word(self.frames[1] as usize));
        // Below 0: places are floats.
        put(7, &(-self.scale).to_le_bytes());
        put(9, &word(usize::from(FIRST_PARAMETERS) + n_blocks));
        put(11, &self.fps.to_le_bytes());
        block
    }

    /// Groups that readers look for, analogue ones of nothing among them.
    fn parameters(&self, labels: &[String]) -> Result<Vec<u8>, C3dError> {
        let mut all = Parameters::new();
        let point = all.group("POINT", "places over time");
        all.word(point, "USED", self.n_points);
        all.word(point, "FRAMES", self.n_frames() as usize);
        all.float(point, "SCALE", -self.scale);
        all.float(point, "RATE", self.fps);
        let data_start = all.word(point, "DATA_START", 0);
        all.text(point, "UNITS", "mm");
        // The left camera's axes, as they are on its pictures.
        all.text(point, "X_SCREEN", "+X");
        all.text(point, "Y_SCREEN", "-Y");
        for (k, labels) in labels.chunks(MOST_LABELS).enumerate() {
            let number = if k == 0 { String::new() } else { (k + 1).to_string() };
            all.texts(point, &format!("LABELS{number}"), labels);
            all.texts(point, &format!("DESCRIPTIONS{number}"), &vec![String::new(); labels.len()]);
        }
        let analog = all.group("ANALOG", "none");
        all.word(analog, "USED", 0);
        all.float(analog, "GEN_SCALE", 1.0);
        // As many samples a frame as the header says: none.
        all.float(analog, "RATE", 0.0);
        all.texts(analog, "LABELS", &[]);
        all.texts(analog, "DESCRIPTIONS", &[]);
        all.texts(analog, "UNITS", &[]);
        all.floats(analog, "SCALE", &[]);
        all.words(analog, "OFFSET", &[]);
        let plates = all.group("FORCE_PLATFORM", "none");
        all.word(plates, "USED", 0);
        let trial = all.group("TRIAL", "frames, which may be more than the header can count");
        for (name, frame) in [("ACTUAL_START_FIELD", self.frames[0]), ("ACTUAL_END_FIELD", self.frames[1])] {
            all.words(trial, name, &[frame as u16, (frame >> 16) as u16]);
        }
        all.float(trial, "CAMERA_RATE", self.fps);
        let n_blocks = all.n_blocks();
        if n_blocks > usize::from(u8::MAX) {
            let of_others = n_blocks * BLOCK / self.n_points.max(1);
            return Err(C3dError::TooMany {
                came: self.n_points,
                most: usize::from(u8::MAX) * BLOCK / of_others,
            });
        }
        all.put_word(data_start, usize::from(FIRST_PARAMETERS) + n_blocks);
        Ok(all.finish())
    }
}

/// 16 bits without a sign; what is more is as much as they hold.
fn word(n: usize) -> [u8; 2] {
    u16::try_from(n).unwrap_or(u16::MAX).to_le_bytes()
}

#[cfg(test)]
mod tests;
