//! H.264 in MP4, encoded by ffmpeg as a child process.

use std::io::{BufWriter, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};

use honami_model::picture::{Planes, Range};

use super::y4m::{write_frame, write_head};
use super::{Format, Movie, Unfinished};
use crate::error::MediaError;
use crate::programs;

/// Even sides; and what the numbers mean, which later versions of ffmpeg take from here: BT.601, as [`convert`](crate::convert)
/// and [`Planes::rgb`] have it, of the primaries and the curve of screens.
const FILTERS: &str = "pad=ceil(iw/2)*2:ceil(ih/2)*2,\
                       setparams=colorspace=smpte170m:color_primaries=bt709:color_trc=iec61966-2-1";

/// A compressed movie. Odd sizes get one more column or row at the right or lower edge: H.264 has even sizes.
#[derive(Debug)]
pub struct Mp4 {
    format: Format,
    child: Child,
    /// Y4M into ffmpeg; closed to tell it that all frames are in.
    pipe: Option<BufWriter<ChildStdin>>,
    neutral: Vec<u8>,
    unfinished: Unfinished,
}

impl Mp4 {
    /// Starts ffmpeg.
    ///
    /// # Errors
    /// [`MediaError::NeedsFfmpeg`] without it, [`MediaError::Rate`], [`MediaError::Io`].
    pub fn create(path: &Path, format: &Format) -> Result<Self, MediaError> {
        format.check()?;
        if programs::ffmpeg_version().is_none() {
            return Err(MediaError::NeedsFfmpeg {
                path: path.to_path_buf(),
                what: "writing MP4, unlike .y4m or a folder of images,".to_owned(),
            });
        }
        let unfinished = Unfinished::beside(path);
        let (pixels, range) = match format.range {
            Range::Full => ("yuvj420p", "pc"),
            Range::Limited => ("yuv420p", "tv"),
        };
        let mut command = Command::new("ffmpeg");
        command.args([
            "-nostdin",
            "-v",
            "error",
            "-y",
            "-f",
            "yuv4mpegpipe",
            "-color_range",
            range,
            "-i",
            "pipe:0",
        ]);
        command.args(["-vf", FILTERS, "-c:v", "libx264", "-crf", "17"]);
        command.args(["-pix_fmt", pixels, "-color_range", range]);
        // Said, since players guess by the size of the picture; of pixels that came as RGB it is so.
        command.args(["-colorspace", "smpte170m", "-color_primaries", "bt709", "-color_trc", "iec61966-2-1"]);
        command.args(["-movflags", "+faststart", "-f", "mp4"]);
        command.arg(programs::file_url(unfinished.temporary.name()));
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command.spawn().map_err(|e| unfinished.fail("start ffmpeg for", e))?;
        let stdin = child.stdin.take().unwrap_or_else(|| unreachable!("it was asked for"));
        let chroma_len = format.width.div_ceil(2) as usize * format.height.div_ceil(2) as usize;
        let neutral = vec![128; if format.colour { 0 } else { chroma_len }];
        let pipe = Some(BufWriter::with_capacity(1 << 20, stdin));
        let mut movie = Self { format: *format, child, pipe, neutral, unfinished };
        // Gray goes in as colour too, so that the encoder keeps the luma as it is.
        movie.send(|pipe| write_head(pipe, &Format { colour: true, ..*format }))?;
        Ok(movie)
    }

    fn send(
        &mut self,
        write: impl FnOnce(&mut BufWriter<ChildStdin>) -> std::io::Result<()>,
    ) -> Result<(), MediaError> {
        let sent = self.pipe.as_mut().map_or(Ok(()), write);
        // A broken pipe means that ffmpeg gave up; it knows better why.
        sent.or_else(|_| self.end())
    }

    /// Closes the pipe and waits; what ffmpeg complained about is the error.
    fn end(&mut self) -> Result<(), MediaError> {
        let flushed = self.pipe.take().map_or(Ok(()), |mut pipe| pipe.flush());
        let mut complaint = String::new();
        if let Some(mut stderr) = self.child.stderr.take() {
            std::io::Read::read_to_string(&mut stderr, &mut complaint)
                .map_err(|e| self.unfinished.fail("read about", e))?;
        }
        let status = self.child.wait().map_err(|e| self.unfinished.fail("wait for ffmpeg on", e))?;
        if status.success() && flushed.is_ok() {
            return Ok(());
        }
        let line = complaint.lines().next().map_or_else(|| status.to_string(), str::to_owned);
        Err(MediaError::Program { program: "ffmpeg", line, path: self.unfinished.path.clone() })
    }
}

impl Movie for Mp4 {
    fn push(&mut self, frame: &Planes<'_>) -> Result<(), MediaError> {
        self.format.admit(frame)?;
        let neutral = std::mem::take(&mut self.neutral);
        let uv = frame.uv.unwrap_or((&neutral, &neutral));
        let sent = self.send(|pipe| write_frame(pipe, &Planes { uv: Some(uv), ..*frame }));
        self.neutral = neutral;
        sent
    }

    fn format(&self) -> &Format {
        &self.format
    }

    fn finish(mut self: Box<Self>) -> Result<(), MediaError> {
        self.end()?;
        self.unfinished.finish()
    }
}

impl Drop for Mp4 {
    fn drop(&mut self) {
        // Both fail only when it has ended by itself.
        self.child.kill().unwrap_or_default();
        self.child.wait().map(|_| ()).unwrap_or_default();
    }
}
