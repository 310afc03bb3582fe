//! YUV4MPEG2 out: mono or 4:2:0, exactly the planes that come.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use honami_model::picture::{Planes, Range};

use super::{Format, Movie, Unfinished};
use crate::error::MediaError;

/// An uncompressed movie file.
#[derive(Debug)]
pub struct Y4m {
    format: Format,
    out: BufWriter<File>,
    unfinished: Unfinished,
}

impl Y4m {
    /// Starts a file.
    ///
    /// # Errors
    /// [`MediaError::Rate`], or [`MediaError::Io`] when it cannot be created.
    pub fn create(path: &Path, format: &Format) -> Result<Self, MediaError> {
        format.check()?;
        let unfinished = Unfinished::beside(path);
        let file = File::create(unfinished.temporary.name()).map_err(|e| unfinished.fail("create", e))?;
        let mut out = BufWriter::with_capacity(1 << 20, file);
        write_head(&mut out, format).map_err(|e| unfinished.fail("write", e))?;
        Ok(Self { format: *format, out, unfinished })
    }
}

impl Movie for Y4m {
    fn push(&mut self, frame: &Planes<'_>) -> Result<(), MediaError> {
        self.format.admit(frame)?;
        write_frame(&mut self.out, frame).map_err(|e| self.unfinished.fail("write", e))
    }

    fn format(&self) -> &Format {
        &self.format
    }

    fn finish(mut self: Box<Self>) -> Result<(), MediaError> {
        self.out.flush().map_err(|e| self.unfinished.fail("write", e))?;
        self.unfinished.finish()
    }
}

pub(super) fn write_head(out: &mut impl Write, format: &Format) -> io::Result<()> {
    let (frames, seconds) = rate(format.fps);
    let samples = if format.colour { "420jpeg" } else { "mono" };
    let range = if format.range == Range::Full { "FULL" } else { "LIMITED" };
    let Format { width, height, .. } = format;
    writeln!(out, "YUV4MPEG2 W{width} H{height} F{frames}:{seconds} Ip A1:1 C{samples} XCOLORRANGE={range}")
}

pub(super) fn write_frame(out: &mut impl Write, frame: &Planes<'_>) -> io::Result<()> {
    out.write_all(b"FRAME\n")?;
    for y in 0..frame.y.height {
        out.write_all(frame.y.row(y))?;
    }
    if let Some((u, v)) = frame.uv {
        out.write_all(u)?;
        out.write_all(v)?;
    }
    Ok(())
}

/// A rate as a fraction: whole, NTSC (n * 1000 / 1001), else in millionths.
fn rate(fps: f64) -> (u64, u64) {
    let nearest = |seconds: u64| (fps * seconds as f64).round();
    let fits = |seconds: u64| (nearest(seconds) - fps * seconds as f64).abs() < 1e-6 * fps;
    let seconds = [1, 1001, 1000].into_iter().find(|&s| fits(s)).unwrap_or(1_000_000);
    ((nearest(seconds) as u64).max(1), seconds)
}
